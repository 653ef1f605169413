// SPDX-License-Identifier: BSD-3-Clause
// What the solver beneath the fit says by itself.
#pragma once

namespace sepcal {

/// Keeps Ceres and glog, on which the fit is built, from writing to standard error in this process.
/// The apps and the Python module call it; a program that logs through glog itself may not want it.
void silence_solver_log();

}  // namespace sepcal
