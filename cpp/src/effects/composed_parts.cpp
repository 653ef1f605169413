// SPDX-License-Identifier: BSD-3-Clause
#include "effects/composed_parts.hpp"

#include <algorithm>
#include <set>

#include "effects/composed_tables.hpp"
#include "sepcal/detail/path_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal::effects {
namespace {

class PartFinder {
 public:
  PartFinder(const Tables& tables, const BlockModel& model)
      : tables_(tables),
        model_(model),
        linear_(model.tables().n_1()),
        nonlinear_(model.tables().n_2()) {
    parts_.model_inputs = indices(model.tables().inputs);
    parts_.driven_by.resize(tables.inputs.size());
    physical_.insert(parts_.model_inputs.begin(), parts_.model_inputs.end());
  }

  void add(const Effect& effect) {
    for (const Varying& varying : effect.varying) add(varying, effect.name);
    for (const auto& term : effect.terms) add(term, effect.name);
    for (const auto& correction : effect.corrections) add(correction, effect.name);
    for (const Delay& delay : effect.delays) add(delay, effect.name);
  }

  ComposedParts finish() {
    const bool carries = model_.new_carry() != nullptr;
    if (carries && dynamic_cast<const PathModel*>(&model_) == nullptr &&
        !(parts_.delays.empty() && parts_.varying.empty())) {
      throw Error("a model that carries a state takes terms and corrections only");
    }
    std::set<int> lagging;
    bool outputs_lag = false;
    for (DelayPart& delay : parts_.delays) {
      if (delay.inputs.empty()) delay.inputs.assign(physical_.begin(), physical_.end());
      if (delay.kind() == Delay::Kind::outputs_lagging) {
        if (carries) {
          throw Error("outputs of a model with a state can't lag; let its inputs come early");
        }
        if (outputs_lag) throw Error("the outputs lag in two effects; leave one out");
        outputs_lag = true;
      }
      if (delay.kind() != Delay::Kind::inputs_lagging) continue;
      for (const int input : delay.inputs) {
        if (lagging.insert(input).second) continue;
        throw Error("input '" + tables_.inputs[static_cast<std::size_t>(input)].name +
                    "' lags in two effects; leave one out");
      }
    }
    return std::move(parts_);
  }

 private:
  std::vector<int> indices(const std::vector<Variable>& inputs) const {
    std::vector<int> found;
    for (const Variable& input : inputs) found.push_back(input_index(tables_, input.name));
    return found;
  }

  int target_index(const std::string& name, const std::string& effect) const {
    const auto& linear = model_.tables().linear;
    const auto at = std::ranges::find(linear, name, &Variable::name);
    if (at != linear.end()) return static_cast<int>(at - linear.begin());
    throw Error("effect " + effect + " varies '" + name +
                "', which is no linear parameter of the model");
  }

  void note_driver(int input, const std::string& effect) {
    parts_.driven_by[static_cast<std::size_t>(input)] = effect;
  }

  void add(const Varying& varying, const std::string& effect) {
    VaryingPart part;
    part.driver = varying.driver;
    part.first = linear_;
    if (const auto& input = varying.driver->input()) {
      part.driver_input = input_index(tables_, input->name);
      note_driver(part.driver_input, effect);
    }
    if (varying.driver->shape()) part.shape = nonlinear_++;
    for (const Varying::Component& component : varying.components) {
      part.targets.push_back(component.target.empty() ? -1
                                                      : target_index(component.target, effect));
      part.shares.emplace_back();
      for (const Varying::Share& share : component.shares) {
        if (share.output < 0 || share.output >= tables_.n_z()) {
          throw Error("effect " + effect + " has a share in output " +
                      std::to_string(share.output) + ", counted from 0, and the model has " +
                      std::to_string(tables_.n_z()));
        }
        const int input = input_index(tables_, share.source.name);
        part.shares.back().emplace_back(share.output, input);
        physical_.insert(input);
      }
      linear_ += varying.driver->functions();
    }
    parts_.varying.push_back(std::move(part));
  }

  void add(const std::shared_ptr<const BlockModel>& term, const std::string& effect) {
    if (term->new_carry() != nullptr) {
      throw Error("effect " + effect + " has a term that carries a state; only a model can");
    }
    parts_.terms.push_back({term, indices(term->tables().inputs), linear_, nonlinear_});
    linear_ += term->tables().n_1();
    nonlinear_ += term->tables().n_2();
    physical_.insert(parts_.terms.back().inputs.begin(), parts_.terms.back().inputs.end());
  }

  void add(const std::shared_ptr<const Correction>& correction, const std::string& effect) {
    const std::vector<int> inputs = indices(correction->inputs());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (correction->is_driver(static_cast<int>(i))) {
        note_driver(inputs[i], effect);
      } else {
        physical_.insert(inputs[i]);
      }
    }
    parts_.corrections.push_back({correction, inputs, nonlinear_});
    nonlinear_ += static_cast<int>(correction->nonlinear().size());
  }

  void add(const Delay& delay, const std::string& effect) {
    DelayPart part{delay, nonlinear_++, {}};
    for (const std::string& name : delay.inputs) {
      if (std::ranges::find(tables_.inputs, name, &Variable::name) == tables_.inputs.end()) {
        throw Error("effect " + effect + " acts on the input '" + name +
                    "', which neither the model nor an effect has");
      }
      part.inputs.push_back(input_index(tables_, name));
    }
    parts_.delays.push_back(std::move(part));
  }

  const Tables& tables_;
  const BlockModel& model_;
  int linear_;
  int nonlinear_;
  ComposedParts parts_;
  std::set<int> physical_;  // inputs that aren't drivers alone
};

}  // namespace

ComposedParts find_parts(const Tables& tables, const BlockModel& model,
                         const std::vector<Effect>& effects) {
  PartFinder finder(tables, model);
  for (const Effect& effect : effects) finder.add(effect);
  return finder.finish();
}

}  // namespace sepcal::effects
