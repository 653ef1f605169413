// SPDX-License-Identifier: BSD-3-Clause
// Who works asks here, between two pieces of work, whether to go on (sepcal/stop.hpp).
#pragma once

#include <chrono>

#include "sepcal/stop.hpp"

namespace sepcal::base {

inline constexpr std::chrono::milliseconds between_asking{50};

/// Throws where this thread's work is to stop. Costs a look at the clock.
void heed_stop();

/// The stop that this thread's work heeds; null: none.
Stop* heeded_stop();

/// While it lives, this thread works for another and heeds what that one heeds.
class HeedStop {
 public:
  explicit HeedStop(Stop* stop);
  HeedStop(const HeedStop&) = delete;
  HeedStop& operator=(const HeedStop&) = delete;
  ~HeedStop();

 private:
  Stop* before_;
};

}  // namespace sepcal::base
