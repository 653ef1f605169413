// SPDX-License-Identifier: BSD-3-Clause
// What a check asks of whatever is fitted, a probe or an aircraft.
#pragma once

#include <functional>
#include <string>

#include "flight/checks/motion.hpp"
#include "flight/probes/quantities.hpp"
#include "sepcal/flight/check.hpp"

namespace sepcal::checks {

struct CheckedSubject {
  std::string model;  // as results call it
  std::string app;    // the command that fits it
  probes::ModelQuantities quantities;
  Settings settings = {};
  bool asks_for_turns = true;  // to tell wind and the airspeed's errors apart
  /// What a fit takes of a flight; throws Error where that is nothing.
  std::function<ProbeRecord(const Flight& flight, const LogChoice& log)> prepare;
};

/// As the public check().
FlightCheck check_subject(const CheckedSubject& subject, const Flight& logged,
                          const LogChoice& choice,
                          const std::function<std::string(const std::string& name)>& spell);

}  // namespace sepcal::checks
