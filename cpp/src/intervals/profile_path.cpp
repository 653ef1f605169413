// SPDX-License-Identifier: BSD-3-Clause
#include "intervals/profile_path.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "numerics/crossing_bracket.hpp"

namespace sepcal::intervals {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double settled = 1e-5;           // of J: it moves an end by 1e-5 of the interval at most
constexpr double root_tolerance = 1e-9;    // |root - height| / height
constexpr double width_tolerance = 1e-12;  // of a bracket, relative: the profile jumps there
constexpr int most_refits = 80;
constexpr int most_failures = 8;

/// The options of a refit: begun from a neighbour, by the fit's own method, R settled. Where it
/// does not within `noise_updates`, find_minimum() goes on.
FitOptions refit_options(const estimation::Problem& problem, SecondStage method) {
  constexpr int noise_updates = 20;
  FitOptions options = problem.options();
  options.second_stage = method;
  options.noise_tolerance = std::min(options.noise_tolerance, FitOptions{}.noise_tolerance);
  options.noise_iterations = noise_updates;
  options.progress = {};
  return options;
}

/// What the prior of the parameter adds to J while it is held.
double prior_cost(const FitOptions& options, const std::string& name, double value) {
  const auto prior = options.prior.find(name);
  if (prior == options.prior.end()) return 0.0;
  const double r = (value - prior->second.mean) / prior->second.standard_deviation;
  return 0.5 * r * r;
}

/// Whether gains that go on shrinking as the last two did are far from settled after the rounds
/// left.
bool goes_on_gaining(double before, double gain, int rounds_left) {
  constexpr double benefit_of_the_doubt = 3.0;
  constexpr double much = 1e-2;  // of J: less comes of a flat valley, where gains are uneven
  if (!std::isfinite(before) || !(gain > much)) return false;
  const double shrinks = std::log(std::max(1.0, before / gain));
  return std::log(gain / settled) > benefit_of_the_doubt * rounds_left * shrinks;
}

/// Whether a point lies on the height, as near as refits come to their minima in a flat valley:
/// that shows where one doesn't converge, or where many of them get no nearer.
bool is_on(const ProfilePoint& point, double height, int refits) {
  constexpr int many = 20;
  const double exact = root_tolerance * height;
  const bool flat = !point.converged || refits >= many;
  return std::abs(point.root - height) <= (flat ? std::max(exact, settled / height) : exact);
}

/// The share of a step from `x` at which it meets the first bound of the box.
double share_within(const numerics::Box& box, const VectorXd& x, const VectorXd& step) {
  double share = 1.0;
  for (Index k = 0; k < x.size(); ++k) {
    if (step[k] == 0.0) continue;
    const double bound = step[k] < 0 ? box.lower[k] : box.upper[k];
    share = std::min(share, std::max(0.0, (bound - x[k]) / step[k]));
  }
  return share;
}

}  // namespace

std::optional<estimation::StageTwo> find_minimum(const estimation::Problem& problem,
                                                 const model::Measurements& measurements,
                                                 StageOne start, const estimation::Attempt& attempt,
                                                 base::ThreadPool& pool) {
  constexpr int most_rounds = 15;
  const Index n_1 = problem.model().tables().n_1();
  double before = infinity;
  double gain = infinity;
  for (int round = 0; round < most_rounds; ++round) {
    estimation::StageTwo now =
        estimation::run_stage_two(problem, measurements, start, {attempt}, pool);
    if (!std::isfinite(now.cost)) return {};
    if (now.converged() || std::abs(now.cost - before) < settled) return now;
    const double gain_before = std::exchange(gain, before - now.cost);
    if (goes_on_gaining(gain_before, gain, most_rounds - round - 1)) return {};
    before = now.cost;
    start.xi1 = now.x.head(n_1);
    start.xi2 = now.x.tail(now.x.size() - n_1);
    start.noise = now.noise;
  }
  return {};
}

ProfilePath::ProfilePath(const BlockModel& model, const estimation::Problem& problem,
                         const model::Measurements& measurements,
                         const estimation::StageTwo& minimum, Index k, bool up)
    : model_(model),
      problem_(problem),
      measurements_(measurements),
      minimum_(minimum),
      k_(k),
      up_(up),
      points_{{0.0, 0.0, true, minimum.x, minimum.noise}},
      lowest_at_(minimum.x[k]) {}

double ProfilePath::edge() const {
  const Variable& parameter = problem_.parameters()[static_cast<std::size_t>(k_)];
  const double from = minimum_.x[k_];
  return up_ ? parameter.upper - from : from - parameter.lower;
}

double ProfilePath::at(double distance) const {
  const Variable& parameter = problem_.parameters()[static_cast<std::size_t>(k_)];
  const double value = minimum_.x[k_] + (up_ ? distance : -distance);
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
                                               const estimation::Attempt& attempt) {
  const std::string& name = problem_.parameters()[static_cast<std::size_t>(k_)].name;
  const double value = at(distance);
  FitOptions options = refit_options(problem_, attempt.method);
  ProfilePoint from = start;
  from.x[k_] = value;
  // A parameter that is alone can't be held, as nothing would be left to fit: two bounds a few
  // roundings apart do it.
  const bool held = problem_.parameters().size() > 1;
  if (held) {
    options.fix[name] = value;
    options.prior.erase(name);
  } else {
    options.bounds[name] = {value, value + 1e-15 * (std::abs(value) + distance)};
  }
  const estimation::Problem problem(model_, options);
  const std::optional<estimation::StageTwo> best =
      find_minimum(problem, measurements_, start_of(from, held), attempt, pool_);
  if (!best) return {};
  const estimation::StageTwo& two = *best;
  double cost = two.cost;
  if (held) cost += prior_cost(problem_.options(), name, value);
  if (minimum_.cost - cost > deficit_) {
    deficit_ = minimum_.cost - cost;
    lowest_at_ = value;
  }
  ProfilePoint point{distance, std::sqrt(2.0 * std::max(0.0, cost - minimum_.cost)),
                     two.converged(), from.x, two.noise};
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
    const VectorXd step = share * (first.x - second->x);
    predicted.x += share_within(problem_.box(), first.x, step) * step;
  }
  return predicted;
}

std::optional<ProfilePoint> ProfilePath::evaluate(double distance) {
  const FitOptions& options = problem_.options();
  const SecondStage method = minimum_.method;
  const SecondStage other =
      method == SecondStage::joint ? SecondStage::projected : SecondStage::joint;
  std::optional<ProfilePoint> point =
      refit(distance, predict(distance),
            estimation::from_neighbour(options, method, minimum_.hold.has_value()));
  if (!point)
    point = refit(distance, nearest(distance), estimation::from_neighbour(options, other, true));
  if (!point) point = refit(distance, nearest(distance), estimation::within_basin(options, method));
  return point;
}

std::optional<ProfilePoint> ProfilePath::evaluate_within_basin(double distance) {
  return refit(distance, nearest(distance),
               estimation::within_basin(problem_.options(), minimum_.method));
}

ProfilePath::End ProfilePath::walk(const ProfileReach& reach) {
  const double edge = this->edge();
  const double side = up_ ? 1.0 : -1.0;
  End at_bound{at(edge), IntervalEnd::bound};
  End open{side * infinity, IntervalEnd::open};
  if (edge <= 0) return at_bound;
  if (!std::isfinite(reach.root)) return std::isfinite(edge) ? at_bound : open;

  numerics::CrossingBracket bracket(reach.root, reach.first);
  double distance = std::min(reach.first, edge);
  double blocked = infinity;  // the least distance at which there is no fit
  double checked = infinity;  // the bracket's width when its upper end was fitted again
  int failures = 0;
  for (int refits = 0; refits < most_refits && failures <= most_failures; ++refits) {
    std::optional<ProfilePoint> point = evaluate(distance);
    if (!point) {
      ++failures;
      blocked = distance;
      distance = 0.5 * (bracket.low() + blocked);
      continue;
    }
    if (is_on(*point, reach.root, refits)) return {at(distance), IntervalEnd::crossed};
    // A point of another branch would mislead the predictions.
    if (!bracket.leaps_to(distance, point->root)) points_.push_back(*point);
    bracket.add(distance, point->root);
    const auto narrow = [&] {
      return bracket.closed() && (bracket.width() <= width_tolerance * bracket.high() ||
                                  at(bracket.low()) == at(bracket.high()));
    };
    const bool near = bracket.width() <= 0.1 * std::min(checked, bracket.high());
    if (bracket.leaps() && (near || narrow())) {
      checked = bracket.width();
      ++refits;
      point = evaluate_within_basin(bracket.high());
      if (point && point->root <= reach.root) {
        bracket.reopen(point->root);
        checked = infinity;
        points_.push_back(*point);
      }
    }
    if (narrow()) return {at(bracket.high()), IntervalEnd::crossed};
    if (!bracket.closed()) {
      if (bracket.low() >= edge) return at_bound;
      if (bracket.low() >= reach.limit) return open;
    }
    distance = std::min({bracket.next(), edge, std::max(reach.limit, bracket.low())});
    if (distance >= blocked) distance = 0.5 * (bracket.low() + blocked);
  }
  // In a flat valley refits scatter about the height, all of them as near as need be.
  if (bracket.closed() && bracket.width() <= settled * bracket.high()) {
    return {at(bracket.high()), IntervalEnd::crossed};
  }
  return failed(bracket, blocked);
}

ProfilePath::End ProfilePath::failed(const numerics::CrossingBracket& bracket,
                                     double blocked) const {
  const std::string& name = problem_.parameters()[static_cast<std::size_t>(k_)].name;
  End end;
  std::ostringstream message;
  message << (up_ ? "the upper" : "the lower") << " end could not be found: with " << name
          << " held at " << at(bracket.low()) << " the cost is below the interval's height, ";
  if (bracket.closed()) {
    message << "at " << at(bracket.high()) << " above it, and the refits between them don't settle";
  } else if (std::isfinite(blocked)) {
    message << "and at " << at(blocked) << " the other parameters could not be fitted; bound "
            << name << " before it, or hold or bound another parameter";
  } else {
    message << "and it rises too slowly from there; bound " << name;
  }
  end.message = message.str();
  return end;
}

}  // namespace sepcal::intervals
