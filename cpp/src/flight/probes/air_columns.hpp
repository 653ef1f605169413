// SPDX-License-Identifier: BSD-3-Clause
// What the columns of all air data probes have in common: the density and the airspeed, logged or
// computed, the temperature, and rows in which no air moves.
#pragma once

#include <string_view>

#include "flight/probes/record_builder.hpp"

namespace sepcal::probes {

/// Of dry air, ps / (R T) [kg/m^3], from Pa and K.
double density_of_air(double pressure, double temperature);

/// Asks for the density [kg/m^3], logged or else ps / (287.05287 T). Throws Error, which says
/// `log_what`, where neither is there. To be called before keep_valid(), the other after it.
void need_density(RecordBuilder& builder, const Flight& flight, std::string_view log_what);
void keep_positive_density(RecordBuilder& builder);

/// The density of the flight's rows, once it is known to be there.
RecordBuilder::RowValue density_of(const RecordBuilder& builder);

/// The density where it was logged, or can be computed, and is positive in every kept row; else
/// the record has none; returns whether it has. To be called after the rows were chosen, like the
/// next.
bool offer_density(RecordBuilder& builder);

/// Where the airspeed as read comes from: a column of it, or the impact pressure dp, sqrt(2 dp /
/// rho).
enum class AirspeedSource { reading, pressure };

/// `first` where the log has what it takes, else the other. Throws Error where both are incomplete.
AirspeedSource choose_airspeed(const RecordBuilder& builder, const Flight& flight,
                               AirspeedSource first);

/// The column "airspeed" [m/s] and what it takes: needed, and its rows valid.
void need_airspeed(RecordBuilder& builder, const Flight& flight, AirspeedSource source);

/// A tube in still air reads noise about zero, or the zero that its driver makes of it; and what is
/// said of rows that fail.
RecordBuilder::RowTest air_meets_tube(const RecordBuilder& builder, AirspeedSource source);
const char* still_in_tube(AirspeedSource source);

/// Body rates of zero, where no fit needs any.
void zero_rates(RecordBuilder& builder);

/// The temperature [K] as the column "temperature", where it was logged in every kept row.
void offer_temperature(RecordBuilder& builder);

/// Drops rows of still air, which hold no airspeed. Throws Error, which says `check_what`, where
/// that loses more than a fifth of the rows.
void keep_moving_air(RecordBuilder& builder, const Flight& flight,
                     const RecordBuilder::RowTest& moves, std::string_view reason,
                     std::string_view check_what);

}  // namespace sepcal::probes
