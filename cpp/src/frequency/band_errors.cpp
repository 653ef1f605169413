// SPDX-License-Identifier: BSD-3-Clause
#include "frequency/band_errors.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "estimation/covariance.hpp"

namespace sepcal::frequency {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The share of a noise's value at one frequency that another has, of rows that last `seconds`.
double shared(double apart, double seconds) {
  const double x = std::numbers::pi * apart * seconds;
  return std::abs(x) < 1e-9 ? 1.0 : std::sin(x) / x;
}

/// Variances of the residual's parts, smoothed over frequency.
class ResidualSpectrum {
 public:
  /// `squares`: |e|^2 / 2 without bias, by frequency.
  ResidualSpectrum(const Grid& grid, VectorXd squares)
      : grid_(grid), squares_(std::move(squares)) {}

  VectorXd level() const { return VectorXd::Constant(squares_.size(), squares_.mean()); }

  /// Over nine independent frequencies.
  VectorXd smoothed() const {
    const double reach = 4.5 / grid_.total;
    VectorXd smoothed(squares_.size());
    for (Index m = 0; m < squares_.size(); ++m) smoothed[m] = mean_about(at(m), reach);
    return smoothed;
  }

  /// Of smoothed values, at the band's low end.
  double lowest(const VectorXd& smoothed) const {
    const auto first = std::ranges::min_element(grid_.frequencies);
    return smoothed[first - grid_.frequencies.begin()];
  }

 private:
  double at(Index m) const { return grid_.frequencies[static_cast<std::size_t>(m)]; }

  double mean_about(double frequency, double reach) const {
    double sum = 0.0;
    double count = 0.0;
    for (Index m = 0; m < squares_.size(); ++m) {
      if (std::abs(at(m) - frequency) > reach) continue;
      sum += squares_[m];
      ++count;
    }
    return count > 0.0 ? sum / count : level()[0];
  }

  const Grid& grid_;
  VectorXd squares_;
};

/// The middle of the sandwich of one output: covariance of A' e, k x k.
MatrixXd score_covariance(const MatrixXcd& A, const VectorXd& A_0, const VectorXd& variances,
                          double at_zero, const Grid& grid) {
  constexpr double farthest = 30.0;  // independent frequencies
  MatrixXd middle = at_zero * A_0 * A_0.transpose();
  for (Index m = 0; m < A.rows(); ++m) {
    for (Index n = m; n < A.rows(); ++n) {
      const auto first = static_cast<std::size_t>(m);
      const auto second = static_cast<std::size_t>(n);
      const double seconds = grid.seconds[first];
      const double apart = grid.frequencies[second] - grid.frequencies[first];
      if (grid.segment[first] != grid.segment[second] || apart * seconds > farthest) break;
      const double share = shared(apart, seconds);
      if (std::abs(share) < 1e-9) continue;
      const MatrixXd one =
          share * std::sqrt(variances[m] * variances[n]) * (A.row(m).adjoint() * A.row(n)).real();
      middle += m == n ? one : MatrixXd(one + one.transpose());
    }
  }
  return middle;
}

/// The fit's covariances by the residual's spectrum, in the place of those of independent rows.
class BandErrors {
 public:
  BandErrors(const std::vector<BandTangent>& outputs, const Grid& grid, const FitOptions& options)
      : outputs_(outputs), grid_(grid), options_(options) {}

  void put_into(Fit& fit) const {
    std::vector<Index> inside;
    for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
      if (std::isfinite(fit.parameters[k].standard_error)) inside.push_back(static_cast<Index>(k));
    }
    if (inside.empty()) return;
    const auto count = static_cast<Index>(inside.size());
    VectorXd prior = VectorXd::Zero(count);
    for (Index k = 0; k < count; ++k) {
      const auto known = options_.prior.find(
          fit.parameters[static_cast<std::size_t>(inside[static_cast<std::size_t>(k)])].name);
      if (known != options_.prior.end()) {
        prior[k] = 1.0 / std::pow(known->second.standard_deviation, 2);
      }
    }
    MatrixXd information = prior.asDiagonal();
    for (std::size_t j = 0; j < outputs_.size(); ++j) {
      const MatrixXcd A = outputs_[j].J(Eigen::all, inside);
      const VectorXd A_0 = outputs_[j].J_0(inside);
      information +=
          ((A.adjoint() * A).real() + A_0 * A_0.transpose()) / std::pow(fit.noise[j].value, 2);
    }
    const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    const MatrixXd inverse = scaled.ldlt().solve(MatrixXd::Identity(count, count));
    const MatrixXd bread = scale.asDiagonal() * inverse * scale.asDiagonal();
    MatrixXd white = prior.asDiagonal();
    MatrixXd coloured = white;
    for (std::size_t j = 0; j < outputs_.size(); ++j) {
      add_output(fit, j, inside, bread, white, coloured);
    }
    give(fit, inside, bread * white * bread, bread * coloured * bread);
  }

 private:
  void add_output(const Fit& fit, std::size_t j, const std::vector<Index>& inside,
                  const MatrixXd& bread, MatrixXd& white, MatrixXd& coloured) const {
    const BandTangent& of = outputs_[j];
    const double noise = fit.noise[j].value;
    const VectorXcd& residual = of.residual;
    const MatrixXcd A = of.J(Eigen::all, inside);
    VectorXd squares(residual.size());
    for (Index m = 0; m < squares.size(); ++m) {
      const auto at = static_cast<std::size_t>(m);
      const double leverage = 0.5 * (A.row(m) * bread * A.row(m).adjoint()).real().value() /
                              (noise * noise) * closeness(at);
      squares[m] = 0.5 * std::norm(residual[m]) / std::max(1.0 - leverage, 0.05);
    }
    const ResidualSpectrum spectrum(grid_, std::move(squares));
    const bool given = !options_.noise.empty();
    const VectorXd level =
        given ? VectorXd::Constant(residual.size(), noise * noise) : spectrum.level();
    const VectorXd smoothed = spectrum.smoothed();
    const VectorXd A_0 = of.J_0(inside);
    const double weight = std::pow(noise, -4);
    white += weight * score_covariance(A, A_0, level, level[0], grid_);
    coloured += weight * score_covariance(A, A_0, smoothed, spectrum.lowest(smoothed), grid_);
  }

  /// How many of the frequencies stand where one would be independent of its neighbours.
  double closeness(std::size_t m) const {
    const std::size_t next =
        m + 1 < grid_.segment.size() && grid_.segment[m + 1] == grid_.segment[m] ? m + 1 : m - 1;
    const double apart = std::abs(grid_.frequencies[next] - grid_.frequencies[m]);
    return std::max(1.0, 1.0 / (apart * grid_.seconds[m]));
  }

  void give(Fit& fit, const std::vector<Index>& inside, const MatrixXd& white,
            const MatrixXd& coloured) const {
    const auto n = static_cast<Index>(fit.parameters.size());
    fit.covariance_white = estimation::spread(white, inside, n);
    fit.covariance_noise_model =
        options_.coloured_errors ? estimation::spread(coloured, inside, n) : fit.covariance_white;
    fit.covariance = fit.covariance_noise_model;
    fit.correlation = estimation::correlation_of(fit.covariance);
    for (Index k = 0; k < n; ++k) {
      Parameter& parameter = fit.parameters[static_cast<std::size_t>(k)];
      parameter.standard_error = std::sqrt(fit.covariance(k, k));
      parameter.standard_error_white = std::sqrt(fit.covariance_white(k, k));
      parameter.standard_error_noise_model = std::sqrt(fit.covariance_noise_model(k, k));
    }
  }

  const std::vector<BandTangent>& outputs_;
  const Grid& grid_;
  const FitOptions& options_;
};

}  // namespace

void Grid::add(const std::vector<double>& of_segment, double lasts) {
  frequencies.insert(frequencies.end(), of_segment.begin(), of_segment.end());
  seconds.insert(seconds.end(), of_segment.size(), lasts);
  segment.insert(segment.end(), of_segment.size(), segments++);
  if (!of_segment.empty()) total += lasts;
}

void put_band_errors(const std::vector<BandTangent>& outputs, const Grid& grid,
                     const FitOptions& options, Fit& fit) {
  BandErrors(outputs, grid, options).put_into(fit);
}

}  // namespace sepcal::frequency
