// SPDX-License-Identifier: BSD-3-Clause
// Misuse and bad input. Non-convergence is not an error: it is a status of the fit.
#pragma once

#include <stdexcept>
#include <string>

namespace sepcal {

/// Bad input or misuse. what() is one line that names the culprit and the way out.
class Error : public std::runtime_error {
 public:
  /// A message may quote what a file holds: control characters, line ends among them, and bytes
  /// that are not UTF-8 become escapes like "\n" and "\x1b".
  explicit Error(const std::string& message);
};

}  // namespace sepcal
