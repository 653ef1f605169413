// SPDX-License-Identifier: BSD-3-Clause
// The corrections that several probes share.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sepcal/flight/probe.hpp"

namespace sepcal::probes {

/// One column a header, NaN until a row is set.
std::vector<CorrectedColumn> empty_columns(const std::vector<std::string>& headers,
                                           std::size_t rows);

/// The field h of every row that the sensor reads as m = C h + n with the effects, NaN where the
/// reading is not valid: solved at once where the effects are linear in h, else by Newton's steps.
/// Throws Error where C is singular.
std::vector<CorrectedColumn> correct_field(const ProbeReadings& readings, const Eigen::Matrix3d& C,
                                           const Eigen::Vector3d& n,
                                           const std::vector<std::string>& headers,
                                           const ReadingEffects& effects);

}  // namespace sepcal::probes
