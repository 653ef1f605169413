// SPDX-License-Identifier: BSD-3-Clause
// Three inputs, and the outputs that apply() gives of them: the vehicle's own check of the header.
#pragma once

#include <string>

#include "flight/export/probe_body.hpp"

namespace sepcal::exporting {

/// The function self_test() as text, which returns 0 where the correction gives these outputs.
std::string self_test(const Calibration& calibration, const ProbeBody& body,
                      const Correction& correction, const Dialect& dialect);

}  // namespace sepcal::exporting
