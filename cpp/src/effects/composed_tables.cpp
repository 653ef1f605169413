// SPDX-License-Identifier: BSD-3-Clause
#include "effects/composed_tables.hpp"

#include <algorithm>
#include <map>

#include "sepcal/error.hpp"

namespace sepcal::effects {
namespace {

/// Tables that grow, and who brought what.
class Joint {
 public:
  explicit Joint(const Tables& model) : tables_(model) {
    for (const Variable& input : model.inputs) input_owner_[input.name] = "the model";
    for (const Variable& parameter : model.parameters()) owner_[parameter.name] = "the model";
  }

  void add_input(const Variable& input, const std::string& owner) {
    const auto [at, is_new] = input_owner_.try_emplace(input.name, owner);
    if (is_new) {
      tables_.inputs.push_back(input);
      return;
    }
    const auto there = std::ranges::find(tables_.inputs, input.name, &Variable::name);
    if (there->unit.empty() || input.unit.empty() || there->unit == input.unit) return;
    throw Error("input '" + input.name + "' is in " + there->unit + " for " + at->second +
                " and in " + input.unit + " for " + owner + "; take one unit");
  }

  void add_linear(const Variable& parameter, const std::string& owner) {
    claim(parameter.name, owner);
    tables_.linear.push_back(parameter);
  }

  void add_nonlinear(const Variable& parameter, const std::string& owner) {
    claim(parameter.name, owner);
    tables_.nonlinear.push_back(parameter);
  }

  Tables take() { return std::move(tables_); }

 private:
  void claim(const std::string& name, const std::string& owner) {
    const auto [at, is_new] = owner_.try_emplace(name, owner);
    if (is_new) return;
    throw Error("parameter '" + name + "' belongs to " + at->second + " and to " + owner +
                " alike; leave one out or rename one");
  }

  Tables tables_;
  std::map<std::string, std::string> input_owner_;
  std::map<std::string, std::string> owner_;
};

void join(Joint& joint, const Varying& varying, const std::string& effect,
          const std::string& owner) {
  if (varying.driver->input()) joint.add_input(*varying.driver->input(), owner);
  for (const Varying::Component& component : varying.components) {
    for (const Varying::Share& share : component.shares) joint.add_input(share.source, owner);
    for (const std::string& suffix : varying.driver->suffixes()) {
      joint.add_linear({effect + "." + component.name + suffix, varying.unit}, owner);
    }
  }
  if (const auto& shape = varying.driver->shape()) {
    joint.add_nonlinear({effect + "." + shape->name, shape->unit, shape->lower, shape->upper},
                        owner);
  }
}

void join(Joint& joint, const BlockModel& term, const Tables& model, const std::string& owner) {
  if (term.tables().n_z() != model.n_z()) {
    throw Error(owner + " has columns for " + std::to_string(term.tables().n_z()) +
                " outputs, and the model has " + std::to_string(model.n_z()));
  }
  for (const Variable& input : term.tables().inputs) joint.add_input(input, owner);
  for (const Variable& parameter : term.tables().linear) joint.add_linear(parameter, owner);
  for (const Variable& parameter : term.tables().nonlinear) joint.add_nonlinear(parameter, owner);
}

}  // namespace

Tables join_tables(const BlockModel& model, const std::vector<Effect>& effects) {
  Joint joint(model.tables());
  for (const Effect& effect : effects) {
    const std::string owner = "effect " + effect.name;
    for (const Varying& varying : effect.varying) join(joint, varying, effect.name, owner);
    for (const auto& term : effect.terms) join(joint, *term, model.tables(), owner);
    for (const auto& correction : effect.corrections) {
      for (const Variable& input : correction->inputs()) joint.add_input(input, owner);
      for (const Variable& parameter : correction->nonlinear()) {
        joint.add_nonlinear(parameter, owner);
      }
    }
    for (const Delay& delay : effect.delays) joint.add_nonlinear(delay.parameter, owner);
  }
  return joint.take();
}

int input_index(const Tables& tables, const std::string& name) {
  const auto at = std::ranges::find(tables.inputs, name, &Variable::name);
  if (at == tables.inputs.end()) throw Error("there is no input '" + name + "'");
  return static_cast<int>(at - tables.inputs.begin());
}

}  // namespace sepcal::effects
