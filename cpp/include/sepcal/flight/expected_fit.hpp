// SPDX-License-Identifier: BSD-3-Clause
// What inputs would tell of an aircraft before they are flown: the model of a fit flies them, and
// the outputs that it gives are fitted in their turn. As they have no noise, the estimates stay
// where they are; their covariance is (sum_k S_k' R^-1 S_k)^-1, S_k the sensitivities of the
// outputs of a row: the bound of Cramer and Rao.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/aircraft.hpp"
#include "sepcal/flight/frequency.hpp"

namespace sepcal {

/// What an output does while the inputs are flown.
struct OutputRange {
  std::string name;
  std::string unit;
  double low = 0.0;
  double high = 0.0;
};

struct ExpectedFit {
  Fit fit;                          // of the flight that is not yet flown
  std::vector<OutputValue> had;     // the standard errors of the fit that flies it, where it has
                                    // that parameter
  std::vector<OutputRange> ranges;  // a model flies farther than it is true
  std::vector<std::string> notes = {};  // one line each, for people
};

/// The aircraft begins where `flight` does, with its first row's columns and the fit's initial
/// state; `inputs` has a time and columns that add to what the first row has of them,
/// `elevator_rad`. Noise is white, of the fit's size, and of a fit by filter error the air's too;
/// parameters that were held stay held. Throws Error for a path and for equation error, which fly
/// nothing, for a column that is no input of the model, and as fit_aircraft() does.
ExpectedFit expect_aircraft(const AircraftFit& fitted, const Flight& flight, const Flight& inputs);
ExpectedFit expect_aircraft(const AircraftFit& fitted, const Flight& flight,
                            const InputDesign& inputs);

std::string to_text(const ExpectedFit& expected, Detail detail = Detail::brief);
std::string to_json(const ExpectedFit& expected);

/// The design with what is expected of it, as `expected`.
std::string to_json(const InputDesign& design, const ExpectedFit& expected);

}  // namespace sepcal
