// SPDX-License-Identifier: BSD-3-Clause
#include "many/trial_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/lane_kit.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int most_passes = 40;
constexpr int most_clipped = 3;         // steps in a row: the minimum lies on a bound
constexpr double first_damping = 1e-3;  // of columns of unit length, where a step leads uphill
constexpr double least_damping = 1e-4;  // below, none
constexpr double most_damping = 1e8;

// Sizes of a step over 1 + |r|, in standard errors.
constexpr double last_digit = 1e-12;
constexpr double near_the_end = 1e-6;  // steps shrink by one ratio
constexpr double as_near = 1e-9;       // as rounding allows, where they don't shrink

}  // namespace

bool TrialLanes::take(const BlockModel& model) {
  return model.prepared_bytes() > 0 && lanes::lane_kit_of(model.lane_width()) != nullptr &&
         model.tables().n_1() + model.tables().n_2() + 1 <= lanes::most_columns;
}

TrialLanes::TrialLanes(const estimation::Problem& problem, const TrialDesign& design)
    : tile_(problem, design),
      box_(problem.box()),
      lanes_(tile_.width()),
      damping_(tile_.width(), 0.0) {}

std::vector<std::size_t> TrialLanes::fit(std::size_t first, std::size_t last,
                                         const MatrixXd& starts,
                                         const std::function<void(const TrialEnd&)>& done) {
  std::vector<std::size_t> left;
  std::size_t next = first;
  const auto release = [&](std::size_t lane) {
    lanes_[lane].busy = false;
    damping_[lane] = 0.0;
  };
  while (true) {
    bool any = false;
    for (std::size_t lane = 0; lane < tile_.width(); ++lane) {
      while (!lanes_[lane].busy && next < last) {
        if (!load(lane, next, starts)) left.push_back(next);
        ++next;
      }
      any = any || lanes_[lane].busy;
    }
    if (!any) return left;
    tile_.factor();
    const auto give_up = [&](std::size_t lane) {
      left.push_back(lanes_[lane].trial);
      release(lane);
    };
    for (std::size_t lane = 0; lane < tile_.width(); ++lane) {
      if (lanes_[lane].busy && !judge(lane)) give_up(lane);
    }
    tile_.whiten();
    for (std::size_t lane = 0; lane < tile_.width(); ++lane) {
      if (lanes_[lane].busy) measure(lane);
    }
    tile_.solve(damping_);
    for (std::size_t lane = 0; lane < tile_.width(); ++lane) {
      if (!lanes_[lane].busy) continue;
      if (!step(lane)) {
        give_up(lane);
      } else if (lanes_[lane].ending) {
        end_.trial = lanes_[lane].trial;
        tile_.describe(lane, end_);
        done(end_);
        release(lane);
      }
    }
  }
}

/// False where there is nothing to fit or to start from.
bool TrialLanes::load(std::size_t lane, std::size_t trial, const MatrixXd& starts) {
  const auto start = starts.col(static_cast<Index>(trial));
  if (!tile_.load(lane, trial) || !start.allFinite()) return false;
  for (std::size_t k = 0; k < tile_.parameters(); ++k) {
    const auto at = static_cast<Index>(k);
    tile_.tried(k, lane) = std::clamp(start[at], box_.lower[at], box_.upper[at]);
  }
  constexpr double none = std::numeric_limits<double>::infinity();
  lanes_[lane] = {.trial = trial, .busy = true, .size_before = none};
  return true;
}

/// The point that was tried is taken, or the step to it damped more. False: nothing comes of this
/// trial.
bool TrialLanes::judge(std::size_t lane) {
  Lane& at = lanes_[lane];
  double& damping = damping_[lane];
  if (++at.passes > most_passes) return false;
  const bool sound = tile_.is_sound(lane);
  if (!at.begun && !sound) return false;
  if (at.begun && (!sound || !tile_.is_downhill(lane))) {
    damping = std::max(10.0 * damping, first_damping);
    return damping < most_damping;
  }
  damping = damping > 10.0 * least_damping ? 0.1 * damping : 0.0;
  at.begun = true;
  return tile_.take(lane);
}

/// How long Gauss-Newton's step is, and whether it is the last: as short as rounding allows, or so
/// short that the next one will be, as steps shrink by one ratio.
void TrialLanes::measure(std::size_t lane) {
  Lane& at = lanes_[lane];
  if (damping_[lane] > 0.0) return;
  const std::size_t n = tile_.parameters();
  double square = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double q = tile_.whole(i, n, lane);
    square += q * q;
  }
  const double size = std::sqrt(square);
  const double left = tile_.whole(n, n, lane);
  const double unit = 1.0 + std::sqrt(square + left * left);
  const double ratio = size / at.size_before;
  const bool shrinks = at.free_step && ratio < 0.3 && size < near_the_end * unit;
  at.ending = size <= last_digit * unit ||
              (shrinks && size * ratio / (1.0 - ratio) <= last_digit * unit) ||
              (ratio >= 1.0 && size <= as_near * unit);
  at.size_before = size;
}

/// Tries the step within the bounds. False: the trial's minimum seems to lie on one of them,
/// or the record leaves something open.
bool TrialLanes::step(std::size_t lane) {
  Lane& at = lanes_[lane];
  bool clipped = false;
  for (std::size_t k = 0; k < tile_.parameters(); ++k) {
    const double lower = box_.lower[static_cast<Index>(k)];
    const double upper = box_.upper[static_cast<Index>(k)];
    const double aim = tile_.x(k, lane) + tile_.step(k, lane);
    if (!std::isfinite(aim)) return false;
    tile_.tried(k, lane) = std::clamp(aim, lower, upper);
    clipped = clipped || !(aim > lower && aim < upper);
  }
  at.free_step = !clipped && damping_[lane] == 0.0;
  at.clipped = clipped ? at.clipped + 1 : 0;
  return at.clipped < most_clipped && !(at.ending && clipped);
}

}  // namespace sepcal::many
