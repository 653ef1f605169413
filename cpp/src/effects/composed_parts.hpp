// SPDX-License-Identifier: BSD-3-Clause
// What a composed model consists of: its effects taken apart into varying parameters, terms,
// corrections and delays, with every input and parameter as an index into the joint tables.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/effect.hpp"

namespace sepcal::effects {

struct VaryingPart {
  DriverPointer driver;
  int driver_input = -1;     // -1: the driver reads none
  int shape = -1;            // its nonlinear parameter; -1: none
  int first = 0;             // its first linear parameter
  std::vector<int> targets;  // a component's linear parameter of the model, or -1
  std::vector<std::vector<std::pair<int, int>>> shares;  // a component's (output, input)
};

struct TermPart {
  std::shared_ptr<const BlockModel> model;
  std::vector<int> inputs;
  int first_linear = 0;
  int first_nonlinear = 0;
};

struct CorrectionPart {
  std::shared_ptr<const Correction> correction;
  std::vector<int> inputs;
  int first_nonlinear = 0;
};

struct DelayPart {
  Delay delay;
  int parameter = 0;  // nonlinear
  std::vector<int> inputs;

  Delay::Kind kind() const { return delay.kind; }
};

struct ComposedParts {
  std::vector<int> model_inputs;
  std::vector<VaryingPart> varying;
  std::vector<TermPart> terms;
  std::vector<CorrectionPart> corrections;
  std::vector<DelayPart> delays;
  std::vector<std::string> driven_by;  // by input: the effect that it drives, or ""
};

/// `tables`: join_tables() of `model` and `effects`, in whose order parameters are counted off.
/// Throws Error naming the effect for a target, an output or a delayed input that isn't there, for
/// an input that lags twice or two lags of the outputs, and where a state that is carried from
/// sample to sample meets what needs samples by themselves.
ComposedParts find_parts(const Tables& tables, const BlockModel& model,
                         const std::vector<Effect>& effects);

}  // namespace sepcal::effects
