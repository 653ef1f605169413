// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/solver_log.hpp"

#if defined(SEPCAL_GLOG)
#include <glog/logging.h>
#elif defined(SEPCAL_ABSEIL_LOG)
#include <absl/log/globals.h>
#endif

namespace sepcal {

// Ceres writes to glog up to 2.2, to Abseil's log after it. Built with the log of its own, which
// has no level to set at run time, it says what its build let it say.
void silence_solver_log() {
#if defined(SEPCAL_GLOG)
  FLAGS_minloglevel = google::GLOG_FATAL;
#elif defined(SEPCAL_ABSEIL_LOG)
  absl::SetStderrThreshold(absl::LogSeverityAtLeast::kFatal);
#endif
}

}  // namespace sepcal
