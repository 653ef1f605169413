// SPDX-License-Identifier: BSD-3-Clause
// A model with a state of your own as a probe: it is laid along each flight that a verb is given.
//
//   const auto roll = own_model("roll", RollMode{}, {.substeps = 2});
//   const Calibration base = calibrate(roll, read_csv("rolls.csv"));
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/flight/own_model.hpp"
#include "sepcal/states/state_model.hpp"
#include "sepcal/states/trajectory_model.hpp"

namespace sepcal {

/// What own_model() takes of a model that is laid along a record.
inline LaidModel laid_model(const std::shared_ptr<const StateBlockModel>& model,
                            const TrajectoryOptions& options) {
  const TrajectoryPlan& plan = model->plan();
  LaidModel laid{
      .model = model, .initial_states = {}, .varying = plan.linear().size(), .options = options};
  for (const int i : plan.integrated()) {
    laid.initial_states.push_back(plan.model().states[static_cast<std::size_t>(i)].name + "_0");
  }
  return laid;
}

template <StateModel M>
std::shared_ptr<const Probe> own_model(std::string name, const M& model,
                                       const TrajectoryOptions& options = {}) {
  const LaidAlong lay = [=](const Record* record) {
    if (record != nullptr) {
      return laid_model(std::make_shared<const TrajectoryModel<M>>(model, *record, options),
                        options);
    }
    TrajectoryOptions uncut = options;
    uncut.shoot = infinity;  // there is nothing to cut
    return laid_model(std::make_shared<const TrajectoryModel<M>>(model, uncut), options);
  };
  return own_model(std::move(name), lay);
}

}  // namespace sepcal
