// SPDX-License-Identifier: BSD-3-Clause
// What the columns of all air data probes have in common: the density, logged or computed, the
// temperature, and rows in which no air moves.
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

/// The temperature [K] as the column "temperature", where it was logged in every kept row.
void offer_temperature(RecordBuilder& builder);

/// Drops rows of still air, which hold no airspeed. Throws Error, which says `check_what`, where
/// that loses more than a fifth of the rows.
void keep_moving_air(RecordBuilder& builder, const Flight& flight,
                     const RecordBuilder::RowTest& moves, std::string_view reason,
                     std::string_view check_what);

}  // namespace sepcal::probes
