// SPDX-License-Identifier: BSD-3-Clause
// What a model with a state is told between two rows of a record.
#pragma once

namespace sepcal {

/// What inputs do from one row to the next. Half a sample of time lies between the two.
enum class InputsBetweenRows { linear, hold };

}  // namespace sepcal
