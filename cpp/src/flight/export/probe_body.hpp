// SPDX-License-Identifier: BSD-3-Clause
// The correction of each probe as text: its own constants, the readings that it takes, the outputs,
// and the body that makes these of those with what the effects add.
#pragma once

#include <string>
#include <vector>

#include "flight/export/correction.hpp"

namespace sepcal::exporting {

/// A reading or an output: an argument of the function, of one number or three.
struct Quantities {
  std::string argument;              // "m_ut"
  int size = 1;                      // 3: an array
  std::vector<std::string> headers;  // of a log: "mx_ut", ...
  std::string comment;               // "uT, the field as read, x y z"
  bool is_difference = false;        // the first header's column less the second's
};

struct ProbeBody {
  std::string summary;  // "V = (1 + lambda_va) v + b_va ..."
  std::vector<Quantities> readings;
  std::vector<Quantities> outputs;  // headers: those of apply()
  std::vector<Constant> constants;
  std::string text;  // of the body, between the look at the inputs and that at the outputs
  std::vector<std::vector<double>>
      trials;  // three inputs for the self-test, in the readings' order
};

}  // namespace sepcal::exporting
