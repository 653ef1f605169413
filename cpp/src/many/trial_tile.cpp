// SPDX-License-Identifier: BSD-3-Clause
#include "many/trial_tile.hpp"

#include <algorithm>
#include <cmath>

namespace sepcal::many {
namespace {

using Eigen::Index;

constexpr double same_sum = 1e-9;            // of squares, by rounding, as a refinement has it
constexpr double no_noise = 1e-9;            // of z: what is left is rounding, or nearly
constexpr std::size_t first_cache = 32'768;  // bytes

std::size_t to_size(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

TrialTile::TrialTile(const estimation::Problem& problem, const TrialDesign& design)
    : design_(design),
      width_(design.model().lane_width()),
      n_1_(to_size(design.model().tables().n_1())),
      n_(n_1_ + to_size(design.model().tables().n_2())),
      n_z_(design.outputs()),
      columns_(n_ + 1),
      kit_(*lanes::lane_kit_of(width_)),
      given_noise_(problem.noise()),
      z_squares_(width_, 0.0) {
  panels_.resize(n_z_);
  const std::size_t a_row = n_z_ * columns_ * width_ * sizeof(double);
  panel_ = std::min(std::max(first_cache / a_row, most_lane_rows), design.rows());
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

bool TrialTile::load(std::size_t lane, std::size_t trial) {
  z_squares_[lane] = design_.gather(trial, z_.data() + lane, width_);
  return std::isfinite(z_squares_[lane]);
}

void TrialTile::factor() {
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
      panels_[j] = lanes::stack_panel(kit_, columns_, next_.data() + j * place(columns_, 0),
                                      rows_.data() + j * columns_ * stride, trials.rows);
    }
    // Whether lanes were safe, is_sound() tells of each by itself.
    lanes::absorb_panels(kit_, panels_, trials.rows);
  }
}

bool TrialTile::is_sound(std::size_t lane) const {
  for (std::size_t j = 0; j < n_z_; ++j) {
    for (std::size_t k = 0; k < columns_; ++k) {
      const double length = std::abs(next_[j * place(columns_, 0) + place(k, k) + lane]);
      if (length != 0.0 && !(length > 1e-100 && length < 1e100)) return false;
    }
  }
  return true;
}

bool TrialTile::is_downhill(std::size_t lane) const {
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
  return given_noise_.size() > 0 ? after <= before * (1.0 + same_sum) : product <= 1.0 + same_sum;
}

bool TrialTile::take(std::size_t lane) {
  for (std::size_t i = lane; i < next_.size(); i += width_) factors_[i] = next_[i];
  for (std::size_t i = lane; i < tried_.size(); i += width_) x_[i] = tried_[i];
  return take_noise(lane);
}

bool TrialTile::take_noise(std::size_t lane) {
  const auto rows = static_cast<double>(design_.rows());
  const double smallest = no_noise * no_noise * z_squares_[lane];
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

void TrialTile::whiten() {
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
    if (j > 0) absorb(whole_.data(), rows_.data(), columns_);
  }
}

/// The factor of a step: whole_, with rows below it where a lane is damped.
const double* TrialTile::damp(const std::vector<double>& damping) {
  if (std::ranges::none_of(damping, [](double x) { return x > 0.0; })) return whole_.data();
  damped_ = whole_;
  const std::size_t stride = n_ * width_;
  std::fill_n(rows_.begin(), columns_ * stride, 0.0);
  for (std::size_t lane = 0; lane < width_; ++lane) {
    for (std::size_t k = 0; k < n_ && damping[lane] > 0.0; ++k) {
      double square = 0.0;
      for (std::size_t i = 0; i <= k; ++i) square += whole(i, k, lane) * whole(i, k, lane);
      rows_[k * stride + k * width_ + lane] = std::sqrt(damping[lane] * square);
    }
  }
  absorb(damped_.data(), rows_.data(), n_);
  return damped_.data();
}

void TrialTile::solve(const std::vector<double>& damping) {
  const double* const factor = damp(damping);
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

void TrialTile::describe(std::size_t lane, TrialEnd& end) const {
  const auto n = static_cast<Index>(n_);
  end.z_square = z_squares_[lane];
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
}

}  // namespace sepcal::many
