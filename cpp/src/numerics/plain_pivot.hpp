// SPDX-License-Identifier: BSD-3-Clause
// What tells a triangle that is solved by back substitution from one that calls for a closer look.
#pragma once

namespace sepcal::numerics {

/// Back substitution is accurate to the condition number; a tinier pivot than this part of its
/// column calls for the slow way.
inline constexpr double smallest_plain_pivot = 1e-7;

}  // namespace sepcal::numerics
