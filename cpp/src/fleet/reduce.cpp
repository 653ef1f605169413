// SPDX-License-Identifier: BSD-3-Clause
// A flight's rows [own | parameters | candidates | residual], each output in units of its own
// residual, in one triangle; below its own parameters' rows stands what the fleet needs. Rows are
// not whitened: filtered against a residual that wanders, a model with noisy inputs (gusts in a
// velocity) is fitted where these are loudest, and its scale comes out too small.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/thread_pool.hpp"
#include "diagnosis/candidate.hpp"
#include "diagnosis/held_out.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fleet.hpp"

namespace sepcal {

using namespace diagnosis;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Each output's residual, as it was first found.
using Scales = std::vector<double>;

/// The fit with what bounds held freed, and at the values that are given.
DiagnosedFit moved(const DiagnosedFit& fitted, const std::map<std::string, double>& at) {
  DiagnosedFit there = fitted;
  for (const auto& [name, value] : at) {
    const auto parameter = std::ranges::find(there.fit.parameters, name, &Parameter::name);
    if (parameter == there.fit.parameters.end()) {
      throw Error("no parameter is called '" + name + "'");
    }
    parameter->value = value;
  }
  for (Parameter& parameter : there.fit.parameters) parameter.at_bound = false;
  return there;
}

/// Those that the room can make, without one that a shape would have to be found for.
std::vector<Candidate> make_linear(CandidateRoom& room, const ReduceOptions& options) {
  std::vector<Candidate> made;
  for (const std::string& name : options.candidates) {
    EffectSetting setting{.name = name};
    const auto centre = options.centres.find(name);
    if (centre != options.centres.end()) setting.centre = centre->second;
    try {
      const Candidate& candidate = room.make(setting);
      if (candidate.shape.parameter.empty() && is_simple(candidate)) made.push_back(candidate);
    } catch (const Error&) {
      continue;  // the flight doesn't have what it takes
    }
  }
  return made;
}

/// One visit of the flight at a point.
class Visit {
 public:
  Visit(const DiagnosedFit& fitted, const std::vector<std::string>& own, base::ThreadPool& pool)
      : room_(fitted, pool) {
    const std::vector<std::string>& parameters = room_.fit().parameters;
    const auto is_own = [&](const std::string& name) {
      return std::ranges::find(own, name) != own.end();
    };
    for (const bool wanted : {true, false}) {
      for (std::size_t k = 0; k < parameters.size(); ++k) {
        if (is_own(parameters[k]) != wanted) continue;
        order_.push_back(static_cast<Index>(k));
        n_own_ += wanted ? 1 : 0;
      }
    }
  }

  CandidateRoom& room() { return room_; }
  Index n_own() const { return n_own_; }
  Index parameters() const { return static_cast<Index>(order_.size()) - n_own_; }
  const std::string& name(Index k) const {
    return room_.fit().parameters[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])];
  }

  /// [own | parameters | candidates | residual], in units of the flight's residual, which is found
  /// where it is not known yet.
  TriangularFactor factor(const std::vector<Candidate>& candidates, Scales& scales,
                          std::vector<Whitener>* whiteners = nullptr) const {
    const RowLayout& layout = room_.fit().layout;
    if (layout.outputs.empty()) {
      throw Error("the model leaves nothing of this flight: it has no noise to be weighed by");
    }
    Columns all = room_.fit().tangent(Eigen::all, order_).eval();
    for (const Candidate& candidate : candidates) {
      all = join(all, room_.columns(candidate, not_a_number).whole);
    }
    MatrixXd rows(layout.count(), all.cols() + 1);
    rows << all.dense(layout), room_.fit().residual;
    if (scales.empty()) {
      for (const UsedOutput& output : layout.outputs) scales.push_back(output.scale);
    }
    if (scales.size() != layout.outputs.size()) {
      throw Error("an output's residual is zero at one point and not at another");
    }
    for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
      auto of_output = rows.middleRows(layout.first(j), layout.rows);
      of_output *= layout.outputs[j].scale / scales[j];
      if (whiteners != nullptr) (*whiteners)[j].apply(of_output);
    }
    TriangularFactor factor(static_cast<int>(rows.cols()));
    factor.absorb(rows);
    if (!factor.all_finite()) throw Error("the model is not finite at the fleet's estimates");
    return factor;
  }

 private:
  CandidateRoom room_;
  std::vector<Index> order_ = {};  // of the fit's columns: own ones first
  Index n_own_ = 0;
};

/// Moves the flight's own parameters to their best at the others' values.
void settle_own(DiagnosedFit& there, const std::vector<std::string>& own, base::ThreadPool& pool,
                Scales& scales) {
  constexpr int most_steps = 30;
  constexpr double small = 1e-9;  // |step| in standard errors
  for (int step = 0; step < most_steps; ++step) {
    const Visit visit(there, own, pool);
    const Index n = visit.n_own();
    if (n == 0) return;
    const MatrixXd T = visit.factor({}, scales).matrix();
    const VectorXd q = T.col(T.cols() - 1).head(n);
    if (q.norm() < small) return;
    const VectorXd change = solve_triangular(T.topLeftCorner(n, n), q).x;
    for (Index k = 0; k < n; ++k) {
      std::ranges::find(there.fit.parameters, visit.name(k), &Parameter::name)->value += change[k];
    }
  }
}

/// By what an error to be believed exceeds that of white noise, as a factor of variances.
double inflation_of(const Parameter& parameter) {
  const double ratio = parameter.standard_error / parameter.standard_error_white;
  return std::isfinite(ratio) ? std::max(1.0, ratio * ratio) : 1.0;
}

}  // namespace

FlightFactor reduce(const DiagnosedFit& fitted, const ReduceOptions& options) {
  base::ThreadPool pool(1);
  DiagnosedFit there = moved(fitted, options.at);
  Scales scales;
  settle_own(there, options.own, pool, scales);
  Visit visit(there, options.own, pool);
  const std::vector<Candidate> candidates = make_linear(visit.room(), options);
  const TriangularFactor factor = visit.factor(candidates, scales);
  std::vector<Whitener> whiteners = find_null(visit.room().fit()).whiteners;
  const MatrixXd whitened = visit.factor({}, scales, &whiteners).matrix();
  const Index own = visit.n_own();
  const Index below = factor.columns() - own;
  const RowLayout& layout = visit.room().fit().layout;

  const Index readings = layout.count() - own;
  FlightFactor reduced{
      .triangle = factor.matrix().bottomRightCorner(below, below),
      .whitened = whitened.bottomRightCorner(visit.parameters() + 1, visit.parameters() + 1),
      .readings = static_cast<double>(readings),
      .rmse = total_rmse(layout, visit.room().fit().residual)};
  reduced.values.resize(visit.parameters());
  reduced.inflation.resize(visit.parameters());
  for (Index k = 0; k < own + visit.parameters(); ++k) {
    const Parameter& parameter = there.fit[visit.name(k)];
    if (k < own) {
      reduced.own[parameter.name] = parameter.value;
    } else {
      reduced.parameters.push_back(parameter.name);
      reduced.units.push_back(parameter.unit);
      reduced.values[k - own] = parameter.value;
      reduced.inflation[k - own] = inflation_of(fitted.fit[parameter.name]);
    }
  }
  for (const Candidate& candidate : candidates) {
    for (const Variable& coefficient : candidate.coefficients) {
      reduced.columns.push_back(
          {candidate.name, coefficient.name, coefficient.unit, candidate.stands_in});
    }
    const EffectSetting& setting = candidate.settings.front();
    if (setting.centre && parse_effect_name(setting.name).base != "time") {
      reduced.centres[candidate.name] = *setting.centre;
    }
  }
  return reduced;
}

}  // namespace sepcal
