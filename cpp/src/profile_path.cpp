// SPDX-License-Identifier: BSD-3-Clause
#include "profile_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double root_tolerance = 1e-9;    // |root - height| / height
constexpr double width_tolerance = 1e-12;  // of a bracket, relative: the profile jumps there
constexpr int most_refits = 80;
constexpr int most_failures = 8;

/// The options of a refit: begun from a neighbour, by the fit's own method, R settled.
FitOptions refit_options(const Problem& problem, SecondStage method) {
  FitOptions options = problem.options();
  options.second_stage = method;
  options.noise_tolerance = std::min(options.noise_tolerance, FitOptions{}.noise_tolerance);
  options.noise_iterations = std::max(options.noise_iterations, FitOptions{}.noise_iterations);
  options.progress = {};
  return options;
}

/// What a normal knowledge of the parameter adds to J while it is held.
double known_cost(const FitOptions& options, const std::string& name, double value) {
  const auto known = options.knowledge.find(name);
  if (known == options.knowledge.end()) return 0.0;
  const double r = (value - known->second.mean) / known->second.standard_deviation;
  return 0.5 * r * r;
}

/// The bracket of a crossing, narrowed by the Illinois rule: a secant that halves the height of an
/// end that stays twice.
class Bracket {
 public:
  explicit Bracket(double height) : height_(height), low_excess_(-height) {}

  bool closed() const { return high_ > 0; }
  double width() const { return high_ - low_; }
  double high() const { return high_; }

  /// The first point is the minimum: distance 0, root 0.
  void add(double distance, double root) {
    const bool above = root > height_;
    if (!above) {
      slope_ = (root - height_ - low_true_) / (distance - low_);
      low_ = distance;
      low_excess_ = low_true_ = root - height_;
    } else {
      high_ = distance;
      high_excess_ = root - height_;
    }
    const int side = above ? 1 : -1;
    if (closed() && last_side_ == side) (above ? low_excess_ : high_excess_) *= 0.5;
    last_side_ = side;
  }

  double next() const {
    constexpr double most_growth = 4.0;
    if (closed()) return low_ - low_excess_ * (high_ - low_) / (high_excess_ - low_excess_);
    const double longest = most_growth * low_;
    return slope_ > 0 ? std::min(low_ - low_true_ / slope_, longest) : longest;
  }

  double low() const { return low_; }

 private:
  double height_;
  double low_ = 0.0;
  double low_excess_;  // root - height, halved by the rule
  double low_true_ = -height_;
  double slope_ = 0.0;  // of the last two points below
  double high_ = 0.0;   // zero: none yet
  double high_excess_ = 0.0;
  int last_side_ = 0;  // of the point added last: 1 above the height, -1 below
};

}  // namespace

std::optional<ProfileMinimum> find_minimum(const Problem& problem, const Measurements& measurements,
                                           StageOne start, ThreadPool& pool) {
  constexpr int most_rounds = 15;
  constexpr double settled = 1e-5;  // of J: it moves an end by 1e-5 of the interval at most
  const auto rows = static_cast<double>(measurements.rows());
  const Index n_1 = problem.model().tables().n_1();
  double before = infinity;
  for (int round = 0; round < most_rounds; ++round) {
    ProfileMinimum now{run_stage_two(problem, measurements, start, pool)};
    now.cost = find_cost(problem, now.two, rows);
    if (!std::isfinite(now.cost)) return {};
    if (now.two.converged || std::abs(now.cost - before) < settled) return now;
    before = now.cost;
    start.xi1 = now.two.x.head(n_1);
    start.xi2 = now.two.x.tail(now.two.x.size() - n_1);
    start.noise = now.two.noise;
  }
  return {};
}

ProfilePath::ProfilePath(const BlockModel& model, const Problem& problem,
                         const Measurements& measurements, const ProfileMinimum& minimum, Index k,
                         bool up)
    : model_(model),
      problem_(problem),
      measurements_(measurements),
      minimum_(minimum),
      k_(k),
      up_(up),
      points_{{0.0, 0.0, minimum.two.x, minimum.two.noise}},
      lowest_at_(minimum.two.x[k]) {}

double ProfilePath::edge() const {
  const Variable& parameter = problem_.parameters()[static_cast<std::size_t>(k_)];
  const double from = minimum_.two.x[k_];
  return up_ ? parameter.upper - from : from - parameter.lower;
}

double ProfilePath::at(double distance) const {
  const Variable& parameter = problem_.parameters()[static_cast<std::size_t>(k_)];
  const double value = minimum_.two.x[k_] + (up_ ? distance : -distance);
  return std::clamp(value, parameter.lower, parameter.upper);
}

const ProfilePoint& ProfilePath::nearest(double distance) const {
  return *std::ranges::min_element(points_, {}, [distance](const ProfilePoint& point) {
    return std::abs(point.distance - distance);
  });
}

StageOne ProfilePath::start_of(const ProfilePoint& start, bool held) const {
  const Index n_1 = problem_.model().tables().n_1();
  VectorXd x = start.x;
  Index linear = n_1;
  if (held) {
    const Index after = x.size() - k_ - 1;
    x.segment(k_, after) = start.x.tail(after);
    x.conservativeResize(x.size() - 1);
    if (k_ < n_1) --linear;
  }
  StageOne one;
  one.xi1 = x.head(linear);
  one.xi2 = x.tail(x.size() - linear);
  one.noise = start.noise;
  return one;
}

std::optional<ProfilePoint> ProfilePath::refit(double distance, const ProfilePoint& start,
                                               SecondStage method) {
  const std::string& name = problem_.parameters()[static_cast<std::size_t>(k_)].name;
  const double value = at(distance);
  FitOptions options = refit_options(problem_, method);
  ProfilePoint from = start;
  from.x[k_] = value;
  // A parameter that is alone can't be held, as nothing would be left to fit: two bounds a few
  // roundings apart do it.
  const bool held = problem_.parameters().size() > 1;
  if (held) {
    options.fixed[name] = value;
    options.knowledge.erase(name);
  } else {
    options.bounds[name] = {value, value + 1e-15 * (std::abs(value) + distance)};
  }
  const Problem problem(model_, options);
  const std::optional<ProfileMinimum> best =
      find_minimum(problem, measurements_, start_of(from, held), pool_);
  if (!best) return {};
  const StageTwo& two = best->two;
  double cost = best->cost;
  if (held) cost += known_cost(problem_.options(), name, value);
  if (minimum_.cost - cost > deficit_) {
    deficit_ = minimum_.cost - cost;
    lowest_at_ = value;
  }
  ProfilePoint point{distance, std::sqrt(2.0 * std::max(0.0, cost - minimum_.cost)), from.x,
                     two.noise};
  if (held) {
    point.x.head(k_) = two.x.head(k_);
    point.x.tail(two.x.size() - k_) = two.x.tail(two.x.size() - k_);
  }
  return point;
}

ProfilePoint ProfilePath::predict(double distance) const {
  const ProfilePoint& first = nearest(distance);
  ProfilePoint predicted = first;
  const ProfilePoint* second = nullptr;
  for (const ProfilePoint& point : points_) {
    if (point.distance == first.distance) continue;
    if (second == nullptr ||
        std::abs(point.distance - distance) < std::abs(second->distance - distance)) {
      second = &point;
    }
  }
  if (second != nullptr) {
    const double share = (distance - first.distance) / (first.distance - second->distance);
    predicted.x += share * (first.x - second->x);
  }
  return predicted;
}

std::optional<ProfilePoint> ProfilePath::evaluate(double distance) {
  const SecondStage method = minimum_.two.method;
  const SecondStage other =
      method == SecondStage::joint ? SecondStage::projected : SecondStage::joint;
  std::optional<ProfilePoint> point = refit(distance, predict(distance), method);
  if (!point) point = refit(distance, nearest(distance), other);
  if (!point) point = refit(distance, nearest(distance), method);
  if (point) points_.push_back(*point);
  return point;
}

ProfilePath::End ProfilePath::walk(const ProfileReach& reach) {
  const double edge = this->edge();
  const double side = up_ ? 1.0 : -1.0;
  const End at_bound{at(edge), IntervalEnd::bound};
  const End open{side * infinity, IntervalEnd::open};
  if (edge <= 0) return at_bound;
  if (!std::isfinite(reach.root)) return std::isfinite(edge) ? at_bound : open;

  Bracket bracket(reach.root);
  double distance = std::min(reach.first, edge);
  double blocked = infinity;  // the least distance at which there is no fit
  int failures = 0;
  for (int refits = 0; refits < most_refits && failures <= most_failures; ++refits) {
    const std::optional<ProfilePoint> point = evaluate(distance);
    if (!point) {
      ++failures;
      blocked = distance;
      distance = 0.5 * (bracket.low() + blocked);
      continue;
    }
    if (std::abs(point->root - reach.root) <= root_tolerance * reach.root) {
      return {at(distance), IntervalEnd::crossed};
    }
    bracket.add(distance, point->root);
    if (!bracket.closed()) {
      if (distance >= edge) return at_bound;
      if (distance >= reach.limit) return open;
    } else if (bracket.width() <= width_tolerance * bracket.high() ||
               at(bracket.low()) == at(bracket.high())) {
      return {at(bracket.high()), IntervalEnd::crossed};
    }
    distance = std::min({bracket.next(), edge, std::max(reach.limit, distance)});
    if (distance >= blocked) distance = 0.5 * (bracket.low() + blocked);
  }
  return {not_a_number, IntervalEnd::failed};
}

}  // namespace sepcal
