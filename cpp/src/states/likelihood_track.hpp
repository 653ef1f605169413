// SPDX-License-Identifier: BSD-3-Clause
// Recursive maximum likelihood along a record, for models of any size, on a computer that has a
// heap.
#pragma once

#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/states/track.hpp"

namespace sepcal::states {

/// Throws Error as track(), and for a start that knows no sizes of the process noises.
Track track_likelihood(const StateBlockModel& model, const Record& record, const StreamStart& start,
                       const TrackOptions& options);

}  // namespace sepcal::states
