// SPDX-License-Identifier: BSD-3-Clause
// Ctrl-C: the work ends at its next piece, within a second, and files that it would have written
// aren't there.
#pragma once

#include <string>

#include "sepcal/stop.hpp"

namespace sepcal::app {

/// The exit code of what Ctrl-C ended, as shells have it.
inline constexpr int interrupted = 130;

/// While it lives, Ctrl-C throws Stopped out of the work. Where that takes more than a second, as a
/// read from a pipe may, the process ends there and then; a second Ctrl-C ends it at once. A
/// process that was told to ignore Ctrl-C (nohup) goes on doing so. To be called once.
StopScope heed_interrupts(const std::string& app);

}  // namespace sepcal::app
