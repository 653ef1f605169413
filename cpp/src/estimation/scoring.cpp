// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/scoring.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "numerics/bounded_least_squares.hpp"
#include "numerics/symmetric.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// R and q of the k free ones.
auto root(const Scored& at) {
  const Index k = at.factor.columns() - 1;
  return at.factor.matrix().topLeftCorner(k, k);
}
auto pull(const Scored& at) {
  const Index k = at.factor.columns() - 1;
  return at.factor.matrix().topRightCorner(k, 1);
}

/// Of the free ones.
Prior prior_of(const Scoring& scoring) {
  return {scoring.prior.mean(scoring.free), scoring.prior.weight(scoring.free)};
}

/// What minimisation compares: V_m with the prior's part.
double whole_cost(const Scoring& scoring, double cost, const VectorXd& theta) {
  return cost + 0.5 * prior_of(scoring).square(theta(scoring.free));
}

VectorXd gradient(const Scored& at) { return -(root(at).transpose() * pull(at)); }

/// How far each of the free ones may move: to its bound, and a logarithm by 1.
numerics::Box room(const Scoring& scoring, const VectorXd& theta) {
  const VectorXd x = theta(scoring.free);
  numerics::Box room{scoring.box.lower(scoring.free) - x, scoring.box.upper(scoring.free) - x};
  const Index logarithms = scoring.model.size() - scoring.model.noises() - scoring.model.outputs();
  for (Index i = 0; i < x.size(); ++i) {
    if (scoring.free[static_cast<std::size_t>(i)] < logarithms) continue;
    room.lower[i] = std::max(room.lower[i], -1.0);
    room.upper[i] = std::min(room.upper[i], 1.0);
  }
  return {room.lower.cwiseMin(0.0), room.upper.cwiseMax(0.0)};
}

/// min |R x - q|^2 + damping |D x|^2, D the lengths of R's columns, and how far V_m falls by it.
struct Step {
  VectorXd x;
  double promise = 0.0;
};
Step find_step(const Scoring& scoring, const Scored& at, double damping) {
  const Index k = at.factor.columns() - 1;
  MatrixXd R(2 * k, k);
  R << MatrixXd(root(at)), MatrixXd::Zero(k, k);
  for (Index i = 0; i < k; ++i) R(k + i, i) = std::sqrt(damping) * root(at).col(i).norm();
  VectorXd q = VectorXd::Zero(2 * k);
  q.head(k) = pull(at);
  const numerics::Box box = room(scoring, at.theta);
  const Index rows = damping > 0.0 ? 2 * k : k;
  Step step;
  step.x = numerics::solve_bounded(MatrixXd(R.topRows(rows)), VectorXd(q.head(rows)), box).x;
  const VectorXd left = pull(at) - root(at) * step.x;
  step.promise = 0.5 * (pull(at).squaredNorm() - left.squaredNorm());
  return step;
}

VectorXd moved(const Scoring& scoring, const VectorXd& theta, const VectorXd& step) {
  VectorXd result = theta;
  for (Index i = 0; i < step.size(); ++i)
    result[scoring.free[static_cast<std::size_t>(i)]] += step[i];
  return scoring.box.clip(result);
}

void find_bounds(const Scoring& scoring, Scored& at) {
  const VectorXd g = gradient(at);
  at.at_bound.assign(scoring.free.size(), false);
  for (std::size_t i = 0; i < scoring.free.size(); ++i) {
    const Index place = scoring.free[i];
    const double slope = g[static_cast<Index>(i)];
    const double x = at.theta[place];
    at.at_bound[i] = (x <= scoring.box.lower[place] && slope >= 0.0) ||
                     (x >= scoring.box.upper[place] && slope <= 0.0);
  }
}

/// Whether noise i, an end of theta's, is on its way to its floor: its logarithm falls as far as a
/// step may take it, or falls again by a length that V_m doesn't shorten, as where the others
/// explain an output completely.
bool is_sinking(double step, double last) {
  constexpr double all_the_way = -0.999;
  constexpr double steadily = -0.1;
  return step <= all_the_way || (step <= steadily && last <= steadily);
}

/// Points beyond `to` with the noises that are on their way further along it, the farthest, their
/// floors, first: what else has to move with them may bear no more than a part of the way. None
/// where none sinks.
std::vector<VectorXd> beyond(const Scoring& scoring, const VectorXd& to, const VectorXd& step,
                             const VectorXd& last) {
  const Index logarithms = scoring.model.size() - scoring.model.noises() - scoring.model.outputs();
  std::vector<VectorXd> points;
  for (const double times : {std::numeric_limits<double>::infinity(), 8.0, 3.0}) {
    VectorXd point = to;
    for (Index i = 0; i < step.size(); ++i) {
      const Index place = scoring.free[static_cast<std::size_t>(i)];
      const double floor = scoring.box.lower[place];
      if (place < logarithms || !std::isfinite(floor)) continue;
      if (!is_sinking(step[i], last.size() == 0 ? 0.0 : last[i])) continue;
      point[place] = std::max(floor, to[place] + times * step[i]);
    }
    if (point == to) return {};
    points.push_back(std::move(point));
  }
  return points;
}

/// Below this two values of V_m can't be told apart.
double resolution(const Scored& at) {
  return 1e-13 * (std::abs(at.cost) + static_cast<double>(at.readings));
}

}  // namespace

double cost_with_prior(const Scoring& scoring, const Scored& at) {
  return whole_cost(scoring, at.cost, at.theta);
}

Scored score_at(const Scoring& scoring, const VectorXd& theta) {
  Scored at;
  at.theta = theta;
  const auto k = static_cast<Index>(scoring.free.size());
  at.factor = TriangularFactor(static_cast<int>(k) + 1);
  std::vector<Index> columns = scoring.free;
  columns.push_back(scoring.model.size());
  const ScoredLikelihood::Value value =
      scoring.model.scores(theta, [&](std::size_t /*row*/, MatrixXd& rows) {
        MatrixXd chosen = rows(Eigen::all, columns);
        at.factor.absorb(chosen);
      });
  prior_of(scoring).join(at.factor, theta(scoring.free));
  at.cost = at.factor.all_finite() ? value.cost : std::numeric_limits<double>::infinity();
  at.readings = value.readings;
  at.row = value.row;
  find_bounds(scoring, at);
  return at;
}

Scored minimise_by_scoring(const Scoring& scoring, const VectorXd& theta) {
  Scored at = score_at(scoring, scoring.box.clip(theta));
  double damping = 0.0;
  VectorXd last;             // step, of the free ones
  double left_before = 0.0;  // of what the last step, where that was a whole one, promised
  for (int iteration = 0; std::isfinite(at.cost) && iteration < scoring.iterations; ++iteration) {
    if (scoring.progress) scoring.progress(iteration);
    const double left = find_step(scoring, at, 0.0).promise;
    if (left <= scoring.promise) {
      at.converged = true;
      break;
    }
    // Steps contract: this one is so short that the factor stays as it is, and the next no step.
    constexpr double short_step = 1e-10;  // 1.4e-5 standard errors
    const double ratio = left_before > 0.0 ? std::max(left / left_before, 1e-4) : 1.0;
    const bool is_last = left <= short_step && left * ratio <= scoring.promise;
    constexpr double most_damping = 1e8;
    Scored next;
    VectorXd taken;
    bool lower = false;
    bool whole = false;
    while (!lower && damping <= most_damping) {
      const Step step = find_step(scoring, at, damping);
      VectorXd to = moved(scoring, at.theta, step.x);
      const double before = whole_cost(scoring, at.cost, at.theta);
      // What V_m can't resolve any more the gradient still does.
      const double slack = step.promise < resolution(at) ? resolution(at) : 0.0;
      const double after = whole_cost(scoring, scoring.model.value(to).cost, to);
      lower = after <= before - 1e-4 * step.promise + slack;
      whole = lower && damping == 0.0;
      if (is_last && whole) {
        at.theta = to;
        at.cost = after - 0.5 * prior_of(scoring).square(to(scoring.free));
        at.converged = true;
        ++at.iterations;
        return at;
      }
      for (const VectorXd& point :
           lower ? beyond(scoring, to, step.x, last) : std::vector<VectorXd>()) {
        if (!(whole_cost(scoring, scoring.model.value(point).cost, point) < after)) continue;
        to = point;
        whole = false;
        break;
      }
      if (lower) {
        next = score_at(scoring, to);
        lower = std::isfinite(next.cost);
        taken = to(scoring.free) - at.theta(scoring.free);
      }
      damping = lower ? damping * 0.1 : std::max(damping * 10.0, 1e-3);
    }
    if (!lower) {  // no step is short enough: the minimum, as far as it can be seen
      at.converged = left < 1e-4;
      break;
    }
    if (damping < 1e-6) damping = 0.0;
    left_before = whole ? left : 0.0;
    last = taken;
    const int count = at.iterations + 1;
    at = std::move(next);
    at.iterations = count;
  }
  return at;
}

MatrixXd observed_hessian(const Scoring& scoring, const Scored& at) {
  const Index k = at.factor.columns() - 1;
  MatrixXd H(k, k);
  const MatrixXd inverse = generalised_inverse(MatrixXd(root(at)));
  for (Index i = 0; i < k; ++i) {
    constexpr double share = 1e-3;  // of a standard error: the gradient is exact
    const double h = share * inverse.row(i).norm();
    VectorXd to = at.theta;
    const Index place = scoring.free[static_cast<std::size_t>(i)];
    to[place] = at.theta[place] + h;
    const VectorXd above = gradient(score_at(scoring, to));
    to[place] = at.theta[place] - h;
    H.col(i) = (above - gradient(score_at(scoring, to))) / (2.0 * h);
  }
  return numerics::symmetric_part(H);
}

Scored finish_by_newton(const Scoring& scoring, Scored at) {
  constexpr int most_newton_steps = 10;
  for (int i = 0; i < most_newton_steps && std::isfinite(at.cost); ++i) {
    std::vector<Index> inside;
    for (std::size_t j = 0; j < at.at_bound.size(); ++j) {
      if (!at.at_bound[j]) inside.push_back(static_cast<Index>(j));
    }
    if (inside.empty()) break;
    const MatrixXd H = observed_hessian(scoring, at)(inside, inside);
    const Eigen::LLT<MatrixXd> root(H);
    if (!H.allFinite() || root.info() != Eigen::Success) break;
    const VectorXd g = gradient(at)(inside);
    const VectorXd inner = root.solve(-g);
    const double promise = -0.5 * g.dot(inner);
    VectorXd step = VectorXd::Zero(at.factor.columns() - 1);
    step(inside) = inner;
    const numerics::Box box = room(scoring, at.theta);
    const VectorXd to = moved(scoring, at.theta, step.cwiseMax(box.lower).cwiseMin(box.upper));
    Scored next = score_at(scoring, to);
    const double before = whole_cost(scoring, at.cost, at.theta);
    if (!(whole_cost(scoring, next.cost, to) <= before + resolution(at))) break;
    next.iterations = at.iterations + 1;
    next.converged = at.converged;
    at = std::move(next);
    if (promise <= scoring.promise) {
      at.converged = true;
      break;
    }
  }
  return at;
}

}  // namespace sepcal::estimation
