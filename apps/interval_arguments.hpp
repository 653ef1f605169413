// SPDX-License-Identifier: BSD-3-Clause
// The options of intervals that all apps share.
#pragma once

#include <CLI/App.hpp>

#include "sepcal/profile.hpp"

namespace sepcal::app {

class IntervalArguments {
 public:
  void add_to(CLI::App& intervals) {
    intervals
        .add_option("--level", asked_.level,
                    "how often an interval should hold the true value [0.95]")
        ->type_name("LEVEL");
    intervals.add_option("--parameter", asked_.names, "only this one; may be given several times")
        ->type_name("NAME")
        ->allow_extra_args(false);
  }

  const ProfileOptions& resolve() const { return asked_; }

 private:
  ProfileOptions asked_;
};

}  // namespace sepcal::app
