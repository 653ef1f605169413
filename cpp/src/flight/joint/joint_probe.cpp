// SPDX-License-Identifier: BSD-3-Clause
#include "flight/joint/joint_probe.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <ranges>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal {
namespace joint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::vector<std::string> labels_of(const JointSetup& setup) {
  std::vector<std::string> labels;
  for (const JoinedFlight& flight : setup.flights) labels.push_back(flight.label);
  return labels;
}

/// Rows and columns of a covariance, not-a-number where there is no place (-1); none of none.
MatrixXd take(const MatrixXd& covariance, const std::vector<Index>& places) {
  if (covariance.size() == 0) return {};
  const auto n = static_cast<Index>(places.size());
  MatrixXd taken = MatrixXd::Constant(n, n, not_a_number);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) {
      const Index row = places[static_cast<std::size_t>(i)];
      const Index column = places[static_cast<std::size_t>(k)];
      if (row >= 0 && column >= 0) taken(i, k) = covariance(row, column);
    }
  }
  return taken;
}

}  // namespace

bool is_own(const JointSetup& setup, const std::string& name) {
  return std::ranges::find(setup.own, name) != setup.own.end();
}

bool is_of_one_flight(const JointSetup& setup, const std::string& name) {
  const std::size_t at = name.find('@');
  return at != std::string::npos && is_own(setup, name.substr(0, at));
}

Fit fit_on_flight(const Fit& fit, const JointSetup& setup, const std::string& flight) {
  Fit one;
  one.status = fit.status;
  one.message = fit.message;
  one.noise = fit.noise;
  one.rmse = fit.rmse;
  one.rows = fit.rows;
  one.n_1 = fit.n_1;
  std::vector<Index> places;
  const auto place_of = [&](const std::string& name) {
    const auto found = std::ranges::find(fit.parameters, name, &Parameter::name);
    return found == fit.parameters.end() ? Index{-1} : found - fit.parameters.begin();
  };
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    const Parameter& parameter = fit.parameters[k];
    if (is_of_one_flight(setup, parameter.name)) {
      if (static_cast<int>(k) < fit.n_1) --one.n_1;
      continue;
    }
    if (!is_own(setup, parameter.name)) {
      places.push_back(static_cast<Index>(k));
      one.parameters.push_back(parameter);
      continue;
    }
    places.push_back(flight.empty() ? -1 : place_of(name_of_own(parameter.name, flight)));
    Parameter own{.name = parameter.name, .unit = parameter.unit};
    own.value = own.standard_error = own.standard_error_white = not_a_number;
    if (places.back() >= 0) {
      own = fit.parameters[static_cast<std::size_t>(places.back())];
      own.name = parameter.name;
    }
    one.parameters.push_back(std::move(own));
  }
  one.covariance = take(fit.covariance, places);
  one.correlation = take(fit.correlation, places);
  one.covariance_white = take(fit.covariance_white, places);
  one.covariance_noise_model = take(fit.covariance_noise_model, places);
  one.covariance_blocks = take(fit.covariance_blocks, places);
  return one;
}

JointProbe::JointProbe(std::shared_ptr<const Probe> one, JointSetup setup)
    : one_(std::move(one)),
      setup_(std::move(setup)),
      model_(one_->model(), setup_.own, labels_of(setup_)) {}

std::shared_ptr<const Probe> JointProbe::along(const Record& record) const {
  std::shared_ptr<const Probe> laid = one_->along(record);
  if (!laid) return nullptr;
  return std::make_shared<const JointProbe>(std::move(laid), setup_);
}

std::vector<CorrectedColumn> JointProbe::correct(const ProbeReadings& /*readings*/,
                                                 const Eigen::VectorXd& /*values*/,
                                                 const ReadingEffects& /*effects*/) const {
  throw Error("a joint calibration is applied to one flight at a time");
}

std::map<std::string, double> JointProbe::held() const {
  std::map<std::string, double> held = one_->held();
  for (const std::string& name : setup_.own) held[name] = 0.0;
  return held;
}

FitOptions JointProbe::complete(const FitOptions& options, const Record& record) const {
  FitOptions completed = one_->complete(options, record);
  spread_own(completed.bounds, setup_);
  spread_own(completed.start, setup_);
  return completed;
}

std::unique_ptr<const Probe> JointProbe::settle(const Flight& flight, const LogChoice& log) const {
  std::unique_ptr<const Probe> settled = one_->settle(flight, log);
  if (!settled) return nullptr;
  return std::make_unique<const JointProbe>(std::move(settled), setup_);
}

std::unique_ptr<const Probe> JointProbe::with_noise(double standard_deviation) const {
  std::unique_ptr<const Probe> changed = one_->with_noise(standard_deviation);
  if (!changed) return nullptr;
  return std::make_unique<JointProbe>(std::move(changed), setup_);
}

std::vector<DerivedQuantity> JointProbe::derive(const Fit& fit) const {
  std::vector<DerivedQuantity> derived = one_->derive(fit);
  std::erase_if(derived, [&](const DerivedQuantity& quantity) {
    return std::ranges::any_of(quantity.slopes,
                               [&](const auto& slope) { return is_own(setup_, slope.first); });
  });
  return derived;
}

std::vector<Restatement> JointProbe::restate(const Fit& fit) const {
  std::vector<std::vector<Restatement>> by_flight;
  for (const JoinedFlight& flight : setup_.flights) {
    by_flight.push_back(one_->restate(fit_on_flight(fit, setup_, flight.label)));
  }
  std::vector<Restatement> all;
  for (std::size_t k = 0; k < by_flight.size(); ++k) {
    for (Restatement& one : by_flight[k]) {
      const auto is_the_same = [&](const std::vector<Restatement>& others) {
        return std::ranges::any_of(others, [&](const Restatement& other) {
          return other.name == one.name && other.sentence == one.sentence;
        });
      };
      const bool is_shared = std::ranges::all_of(by_flight, is_the_same);
      if (is_shared && k + 1 < by_flight.size()) continue;  // said once
      if (!is_shared) one.name += "@" + setup_.flights[k].label;
      all.push_back(one);
    }
  }
  return all;
}

const JointProbe* as_joint(const Probe& probe) { return dynamic_cast<const JointProbe*>(&probe); }

}  // namespace joint

std::vector<std::string> resolve_own(const Probe& probe, const std::vector<std::string>& names) {
  const std::vector<Variable> parameters = probe.model().tables().parameters();
  std::vector<std::string> own;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(own, name) == own.end()) own.push_back(name);
  };
  for (const std::string& name : names) {
    const bool is_parameter =
        std::ranges::find(parameters, name, &Variable::name) != parameters.end();
    if (is_parameter) {
      add(name);
      continue;
    }
    const std::size_t before = own.size();
    if (name == "wind") {
      for (const std::string wind : {"w_n", "w_e", "w_d"}) {
        const auto found = std::ranges::find(parameters, wind, &Variable::name);
        if (found != parameters.end() && !probe.held().contains(wind)) add(wind);
      }
    }
    if (own.size() > before) continue;
    throw Error(fmt::format("own {}: there is no such parameter; the model has: {}", name,
                            fmt::join(parameters | std::views::transform(&Variable::name), ", ")));
  }
  return own;
}

std::shared_ptr<const Probe> joint_probe(std::shared_ptr<const Probe> one, JointSetup setup) {
  const std::vector<Variable> parameters = one->model().tables().parameters();
  const std::vector<std::string> own = resolve_own(*one, setup.own);
  if (!one->initial_states().empty() && !own.empty()) {
    throw Error(fmt::format(
        "own {}: flights of a model with a state have their initial states for themselves, and "
        "share all else; leave it out",
        fmt::join(own, ", ")));
  }
  setup.own.clear();
  for (const Variable& parameter : parameters) {  // in the probe's order
    if (std::ranges::find(own, parameter.name) != own.end()) setup.own.push_back(parameter.name);
  }
  const std::map<std::string, double> held = one->held();
  for (const std::string& name : setup.own) {
    if (!held.contains(name)) continue;
    throw Error(fmt::format("own {0}: {0} is held at {1} in every flight; leave it out", name,
                            held.at(name)));
  }
  if (setup.own.size() + held.size() >= parameters.size()) {
    throw Error("own names every parameter: nothing is left to share; fit the flights one by one");
  }
  return std::make_shared<joint::JointProbe>(std::move(one), std::move(setup));
}

const JointSetup* joint_setup(const Probe& probe) {
  const joint::JointProbe* const found = joint::as_joint(probe);
  return found == nullptr ? nullptr : &found->setup();
}

}  // namespace sepcal
