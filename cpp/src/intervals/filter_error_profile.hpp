// SPDX-License-Identifier: BSD-3-Clause
// Profiles of filter error's likelihood: V_m with one parameter held, the others and the sizes of
// the noises scored again; twice its rise is chi-squared of one degree.
#pragma once

#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/profile.hpp"

namespace sepcal::intervals {

/// As profile_intervals(), of a fit by filter error to `record`, whose rows it took all.
std::vector<ProfileInterval> profile_filter_error(const BlockModel& model, const Record& record,
                                                  const Fit& fit, const FitOptions& options,
                                                  const ProfileOptions& asked);

}  // namespace sepcal::intervals
