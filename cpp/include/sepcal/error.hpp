// SPDX-License-Identifier: BSD-3-Clause
// Misuse and bad input. Non-convergence is not an error: it is a status of the fit.
#pragma once

#include <stdexcept>

namespace sepcal {

/// Bad input or misuse. what() is one line that names the culprit and the way out.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sepcal
