// SPDX-License-Identifier: BSD-3-Clause
// The whole header: where it is from, constants, the correction, and its self-test.
#pragma once

#include <string>
#include <vector>

#include "flight/export/correction.hpp"

namespace sepcal::exporting {

struct Header {
  std::string text;
  std::vector<std::string> left_to_others;  // effects on the reference or the wind
};

/// `id`: of the calibration, 64 hexadecimal digits. `comment`: lines at its head. Throws Error for
/// an effect that can't be followed on board.
Header header_text(const Calibration& calibration, const Dialect& dialect, const std::string& id,
                   const std::vector<std::string>& comment);

}  // namespace sepcal::exporting
