// SPDX-License-Identifier: BSD-3-Clause
#include "many/trial_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_passes = 40;
constexpr int most_clipped = 3;         // steps in a row: the minimum lies on a bound
constexpr double first_damping = 1e-3;  // of columns of unit length, where a step leads uphill
constexpr double least_damping = 1e-4;  // below, none
constexpr double most_damping = 1e8;
constexpr double rounding = 1e-9;  // of a sum of squares, as a refinement has it
constexpr double last_digit = 1e-12;
constexpr double near_the_end = 1e-6;
constexpr double no_noise = 1e-9;  // of z: what is left is rounding, or nearly

constexpr std::size_t first_cache = 32 * 1024;  // bytes

lanes::LaneKit const& kit_for(const BlockModel& model) {
  return *lanes::lane_kit_of(model.lane_width());
}

std::size_t to_size(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

bool TrialLanes::take(const BlockModel& model) {
  return model.prepared_bytes() > 0 && lanes::lane_kit_of(model.lane_width()) != nullptr &&
         model.tables().n_1() + model.tables().n_2() + 1 <= lanes::most_columns;
}

TrialLanes::TrialLanes(const estimation::Problem& problem, const TrialDesign& design)
    : design_(design),
      kit_(kit_for(design.model())),
      width_(kit_.width),
      n_1_(static_cast<std::size_t>(design.model().tables().n_1())),
      n_(n_1_ + static_cast<std::size_t>(design.model().tables().n_2())),
      n_z_(design.outputs()),
      columns_(n_ + 1),
      lower_(problem.box().lower),
      upper_(problem.box().upper),
      given_noise_(problem.noise()),
      lanes_(width_) {
  absorb_ = kit_.absorb[columns_];
  const std::size_t a_row = columns_ * width_ * sizeof(double);  // of one output
  panel_ = std::clamp<std::size_t>(first_cache / a_row, most_lane_rows, design.rows());
  const std::size_t square = columns_ * columns_ * width_;
  z_.resize(n_z_ * design.rows() * width_);
  x_.resize(n_ * width_);
  tried_.resize(n_ * width_);
  delta_.resize(n_ * width_);
  factors_.resize(n_z_ * square);
  next_.resize(n_z_ * square);
  squares_.resize(n_z_ * width_);
  weights_.resize(n_z_ * width_, 1.0);
  whole_.resize(square);
  damped_.resize(square);
  rows_.resize(std::max(n_z_ * columns_ * panel_ * width_, square));
}

std::vector<std::size_t> TrialLanes::fit(std::size_t first, std::size_t last,
                                         const MatrixXd& starts,
                                         const std::function<void(const TrialEnd&)>& done) {
  std::vector<std::size_t> left;
  std::size_t next = first;
  for (Lane& lane : lanes_) lane.busy = false;
  while (true) {
    bool any = false;
    for (std::size_t lane = 0; lane < width_; ++lane) {
      while (!lanes_[lane].busy && next < last) {
        if (!load(lane, next, starts)) left.push_back(next);
        ++next;
      }
      any = any || lanes_[lane].busy;
    }
    if (!any) return left;
    factor();
    const auto give_up = [&](std::size_t lane) {
      left.push_back(lanes_[lane].trial);
      lanes_[lane].busy = false;
    };
    for (std::size_t lane = 0; lane < width_; ++lane) {
      if (lanes_[lane].busy && !judge(lane)) give_up(lane);
    }
    whiten();
    for (std::size_t lane = 0; lane < width_; ++lane) {
      if (lanes_[lane].busy) measure(lane);
    }
    solve(damp());
    for (std::size_t lane = 0; lane < width_; ++lane) {
      if (!lanes_[lane].busy) continue;
      if (!step(lane)) {
        give_up(lane);
      } else if (lanes_[lane].ending) {
        done(end_of(lane));
        lanes_[lane].busy = false;
      }
    }
  }
}

/// False where there is nothing to fit or to start from.
bool TrialLanes::load(std::size_t lane, std::size_t trial, const MatrixXd& starts) {
  const auto start = starts.col(static_cast<Index>(trial));
  Lane loaded{.trial = trial, .busy = true};
  loaded.z_square = design_.gather(trial, z_.data() + lane, width_);
  if (!std::isfinite(loaded.z_square) || !start.allFinite()) return false;
  for (std::size_t k = 0; k < n_; ++k) {
    const auto at = static_cast<Index>(k);
    tried_[k * width_ + lane] = std::clamp(start[at], lower_[at], upper_[at]);
  }
  lanes_[lane] = loaded;
  return true;
}

/// next_ = one factor of [A | D | r] an output, at tried_.
void TrialLanes::factor() {
  std::ranges::fill(next_, 0.0);
  TrialRows trials;
  trials.xi1 = tried_.data();
  trials.xi2 = tried_.data() + n_1_ * width_;
  trials.z_stride = design_.rows();
  for (std::size_t row = 0; row < design_.rows(); row += panel_) {
    trials.prepared = design_.prepared(row);
    trials.rows = std::min(panel_, design_.rows() - row);
    trials.z = z_.data() + row * width_;
    design_.model().fill_trials(trials, rows_.data());
    const std::size_t stride = trials.rows * width_;
    for (std::size_t j = 0; j < n_z_; ++j) {
      // Whether lanes were safe, is_sound() tells of each by itself.
      absorb_(next_.data() + j * place(columns_, 0), rows_.data() + j * columns_ * stride,
              trials.rows, stride);
    }
  }
}

/// No number that isn't finite, no column whose square underflows or overflows.
bool TrialLanes::is_sound(std::size_t lane) const {
  for (std::size_t j = 0; j < n_z_; ++j) {
    for (std::size_t k = 0; k < columns_; ++k) {
      const double length = std::abs(next_[j * place(columns_, 0) + place(k, k) + lane]);
      if (length != 0.0 && !(length > 1e-100 && length < 1e100)) return false;
    }
  }
  return true;
}

/// Sums of squares of next_ in a lane, against those that are there.
bool TrialLanes::is_downhill(std::size_t lane) const {
  double before = 0.0;
  double after = 0.0;
  double product = 1.0;  // of the ratios: of R's determinant, which an estimated R makes least
  for (std::size_t j = 0; j < n_z_; ++j) {
    double square = 0.0;
    for (std::size_t i = 0; i < columns_; ++i) {
      const double q = next_[j * place(columns_, 0) + place(i, n_) + lane];
      square += q * q;
    }
    const double weight = weights_[j * width_ + lane];
    const double there = squares_[j * width_ + lane];
    after += square * weight * weight;
    before += there * weight * weight;
    product *= square / there;
  }
  return given_noise_.size() > 0 ? after <= before * (1.0 + rounding) : product <= 1.0 + rounding;
}

/// The point that was tried becomes the one that is accepted, or the step before it is damped
/// more. False: nothing comes of this trial.
bool TrialLanes::judge(std::size_t lane) {
  Lane& at = lanes_[lane];
  if (++at.passes > most_passes) return false;
  const bool sound = is_sound(lane);
  if (!at.begun && !sound) return false;
  if (at.begun && (!sound || !is_downhill(lane))) {
    at.damping = std::max(10.0 * at.damping, first_damping);
    return at.damping < most_damping;
  }
  if (at.begun) at.damping = at.damping > 10.0 * least_damping ? 0.1 * at.damping : 0.0;
  for (std::size_t i = lane; i < next_.size(); i += width_) factors_[i] = next_[i];
  for (std::size_t i = lane; i < tried_.size(); i += width_) x_[i] = tried_[i];
  if (!at.begun) at.size_before = std::numeric_limits<double>::infinity();
  at.begun = true;
  return take_noise(lane);
}

/// R at x_ (Eq. 25), or the one that was given.
bool TrialLanes::take_noise(std::size_t lane) {
  const auto rows = static_cast<double>(design_.rows());
  const double smallest = no_noise * no_noise * lanes_[lane].z_square;
  for (std::size_t j = 0; j < n_z_; ++j) {
    double square = 0.0;
    for (std::size_t i = 0; i < columns_; ++i) {
      const double q = factors_[j * place(columns_, 0) + place(i, n_) + lane];
      square += q * q;
    }
    squares_[j * width_ + lane] = square;
    if (!(square > smallest)) return false;
    weights_[j * width_ + lane] = given_noise_.size() > 0
                                      ? 1.0 / given_noise_[static_cast<Index>(j)]
                                      : std::sqrt(rows / square);
  }
  return true;
}

/// whole_ = the factor of all outputs, each over its noise.
void TrialLanes::whiten() {
  for (std::size_t j = 0; j < n_z_; ++j) {
    const double* const own = factors_.data() + j * place(columns_, 0);
    const double* const weight = weights_.data() + j * width_;
    const std::size_t stride = columns_ * width_;
    for (std::size_t i = 0; i < columns_; ++i) {
      for (std::size_t c = 0; c < columns_; ++c) {
        double* const to =
            j == 0 ? whole_.data() + place(i, c) : rows_.data() + c * stride + i * width_;
        for (std::size_t lane = 0; lane < width_; ++lane) {
          to[lane] = c < i ? 0.0 : own[place(i, c) + lane] * weight[lane];
        }
      }
    }
    if (j > 0) absorb_(whole_.data(), rows_.data(), columns_, stride);
  }
}

/// How long Gauss-Newton's step is, and whether it is the last: as short as rounding allows, or so
/// short that the next one will be, as steps shrink by one ratio.
void TrialLanes::measure(std::size_t lane) {
  Lane& at = lanes_[lane];
  if (at.damping > 0.0) return;
  double square = 0.0;
  for (std::size_t i = 0; i < n_; ++i) {
    const double q = whole_[place(i, n_) + lane];
    square += q * q;
  }
  const double size = std::sqrt(square);
  const double left = whole_[place(n_, n_) + lane];
  const double unit = 1.0 + std::sqrt(square + left * left);
  const double ratio = size / at.size_before;
  const bool shrinks = at.free_step && ratio < 0.3 && size < near_the_end * unit;
  at.ending = size <= last_digit * unit ||
              (shrinks && size * ratio / (1.0 - ratio) <= last_digit * unit) ||
              (ratio >= 1.0 && size <= rounding * unit);
  at.size_before = size;
}

/// The factor of a step: whole_, with rows below it where a lane is damped.
const double* TrialLanes::damp() {
  const auto is_damped = [](const Lane& lane) { return lane.busy && lane.damping > 0.0; };
  if (std::ranges::none_of(lanes_, is_damped)) return whole_.data();
  damped_ = whole_;
  const std::size_t stride = n_ * width_;
  std::fill_n(rows_.begin(), columns_ * stride, 0.0);
  for (std::size_t lane = 0; lane < width_; ++lane) {
    if (!is_damped(lanes_[lane])) continue;
    for (std::size_t k = 0; k < n_; ++k) {
      double square = 0.0;
      for (std::size_t i = 0; i <= k; ++i) {
        square += whole_[place(i, k) + lane] * whole_[place(i, k) + lane];
      }
      rows_[k * stride + k * width_ + lane] = std::sqrt(lanes_[lane].damping * square);
    }
  }
  absorb_(damped_.data(), rows_.data(), n_, stride);
  return damped_.data();
}

/// delta_ by back substitution.
void TrialLanes::solve(const double* factor) {
  for (std::size_t k = n_; k-- > 0;) {
    double* const to = delta_.data() + k * width_;
    std::copy_n(factor + place(k, n_), width_, to);
    for (std::size_t i = k + 1; i < n_; ++i) {
      for (std::size_t lane = 0; lane < width_; ++lane) {
        to[lane] -= factor[place(k, i) + lane] * delta_[i * width_ + lane];
      }
    }
    for (std::size_t lane = 0; lane < width_; ++lane) to[lane] /= factor[place(k, k) + lane];
  }
}

/// tried_ = x_ + delta_ within the bounds. False: the trial's minimum seems to lie on one of them,
/// or the record leaves something open.
bool TrialLanes::step(std::size_t lane) {
  Lane& at = lanes_[lane];
  bool clipped = false;
  for (std::size_t k = 0; k < n_; ++k) {
    const std::size_t i = k * width_ + lane;
    const double lower = lower_[static_cast<Index>(k)];
    const double upper = upper_[static_cast<Index>(k)];
    const double aim = x_[i] + delta_[i];
    if (!std::isfinite(aim)) return false;
    tried_[i] = std::clamp(aim, lower, upper);
    clipped = clipped || !(aim > lower && aim < upper);
  }
  at.free_step = !clipped && at.damping == 0.0;
  at.clipped = clipped ? at.clipped + 1 : 0;
  return at.clipped < most_clipped && !(at.ending && clipped);
}

const TrialEnd& TrialLanes::end_of(std::size_t lane) {
  const auto n = static_cast<Index>(n_);
  TrialEnd& end = end_;
  end.trial = lanes_[lane].trial;
  end.z_square = lanes_[lane].z_square;
  end.x.resize(n);
  end.squares.resize(static_cast<Index>(n_z_));
  end.R.setZero(n + 1, n + 1);
  end.lengths.resize(n);
  for (Index k = 0; k < n; ++k) end.x[k] = tried_[to_size(k) * width_ + lane];
  for (Index j = 0; j < end.squares.size(); ++j)
    end.squares[j] = squares_[to_size(j) * width_ + lane];
  for (Index c = 0; c <= n; ++c) {
    for (Index i = 0; i <= c; ++i) end.R(i, c) = whole_[place(to_size(i), to_size(c)) + lane];
  }
  for (Index c = 0; c < n; ++c) {
    double square = 0.0;
    for (std::size_t j = 0; j < n_z_; ++j) {
      for (std::size_t i = 0; i <= to_size(c); ++i) {
        const double q = factors_[j * place(columns_, 0) + place(i, to_size(c)) + lane];
        square += q * q;
      }
    }
    end.lengths[c] = std::sqrt(square);
  }
  return end;
}

}  // namespace sepcal::many
