// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/residual_colour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "noise/noise_autocovariance.hpp"
#include "noise/noise_order.hpp"
#include "noise/noise_room.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Schwarz's criterion: under white noise AIC would take chance for colour in one fit of six.
double criterion(double minus_two_log_likelihood, double parameters, Index rows) {
  return minus_two_log_likelihood + parameters * std::log(static_cast<double>(rows));
}

/// -2 ln L of white noise at its best sigma; with a free level, of the differences.
double white_likelihood(const VectorXd& e, const std::vector<Segment>& segments, bool free_level) {
  const Whitener whitener({.free_level = free_level}, segments);
  MatrixXd y = e;
  whitener.apply(y);
  const auto n = static_cast<double>(whitener.informative_rows());
  return n * (std::log(2.0 * std::numbers::pi * y.squaredNorm() / n) + 1.0) +
         whitener.log_determinant();
}

constexpr Index fewest_rows = 30;

/// A column for the level of each run, of unit length.
MatrixXd levels_of(const std::vector<Segment>& runs, Index rows) {
  MatrixXd levels = MatrixXd::Zero(rows, static_cast<Index>(runs.size()));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto length = static_cast<Index>(runs[i].rows());
    levels.col(static_cast<Index>(i))
        .segment(static_cast<Index>(runs[i].first), length)
        .setConstant(1.0 / std::sqrt(static_cast<double>(length)));
  }
  return levels;
}

/// An orthonormal basis of what of X is orthogonal to `levels`.
MatrixXd orthonormal(MatrixXd X, const MatrixXd& levels) {
  if (X.cols() == 0) return X;
  const VectorXd lengths = X.colwise().norm();
  for (int twice = 0; twice < 2; ++twice) X -= levels * (levels.transpose() * X);
  for (Index k = 0; k < X.cols(); ++k) {
    if (lengths[k] > 0.0) X.col(k) /= lengths[k];
  }
  const MatrixXd square = X.transpose() * X;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(square);
  constexpr double least = 1e-10;
  const Index seen = (parts.eigenvalues().array() > least).count();
  return X * parts.eigenvectors().rightCols(seen) *
         parts.eigenvalues().tail(seen).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

bool is_white(const NoiseModel& noise) { return noise.d == 0.0 && noise.order() == 0; }

std::optional<NoiseModel> find_residual_noise(std::span<const double> e,
                                              const std::vector<Segment>& segments) {
  const VectorXd rows = gather_rows(e, segments);
  const double square = rows.squaredNorm();
  if (rows.size() < fewest_rows || !(square > 0.0)) return std::nullopt;
  const NoiseFit fit = fit_noise(e, segments);
  NoiseModel white{.sigma = std::sqrt(square / static_cast<double>(rows.size()))};
  if (is_white(fit.model)) return white;
  const double coloured =
      criterion(fit.minus_two_log_likelihood, fit.model.order() + 2.0, fit.informative_rows);
  const double plain = criterion(white_likelihood(rows, segments, fit.model.level_is_free()), 1.0,
                                 fit.informative_rows);
  return coloured < plain ? fit.model : white;
}

namespace {

OutputNoise white_noise(double sigma) {
  return {noise::GaussMarkovNoise{.rows = 1.0, .white = 1.0, .sigma = sigma}};
}

/// Whether white sums vary as the rows that were summed do: then these are white as well.
bool is_as_large(const VectorXd& sums, const VectorXd& rows) {
  const auto count = static_cast<double>(sums.size());
  const double ratio =
      sums.squaredNorm() / count / (rows.squaredNorm() / static_cast<double>(rows.size()));
  return std::abs(ratio - 1.0) < 2.5 * std::sqrt(2.0 / count);
}

/// Whether both families are so little likelier than white that no search needs to tell: a scan's
/// gain in -2 ln L falls short of what BIC asks by more than refining it adds.
/// `columns`: [X | e], X orthonormal.
bool is_plainly_white(const VectorXd& e, const MatrixXd& columns, double of_white,
                      const std::vector<Segment>& runs) {
  constexpr double little = 0.35;  // of what one parameter costs
  const double cost = std::log(static_cast<double>(e.size() - columns.cols() + 1));
  const VectorXd gains = noise::scan_gains(e, noise::find_lengths(runs));
  for (Index order = 0; order < gains.size(); ++order) {
    if (!(gains[order] < (static_cast<double>(order) + little) * cost)) return false;
  }
  return of_white - noise::scan_gauss_markov(columns, runs) < little * cost;
}

/// Whether e follows the columns further than a noise allows: ordinary least squares have left of
/// them what generalised ones would take by far.
bool follows_columns(const OutputNoise& noise, const noise::Restricted& restricted,
                     const MatrixXd& basis, const std::vector<Segment>& runs) {
  constexpr double most_excess = 10.0;
  if (basis.cols() == 0) return false;
  OutputNoise unit = noise;
  std::visit([](auto& model) { model.sigma = 1.0; }, unit.model);
  return noise::excess_explained(restricted, covariance_product(unit, 1.0, runs, basis),
                                 basis.rows()) > most_excess;
}

/// find_restricted_noise() of rows that need not be summed.
std::optional<OutputNoise> find_noise_of_rows(const VectorXd& e, const MatrixXd& X,
                                              const std::vector<Segment>& runs) {
  constexpr std::size_t most_levels = 20;
  const auto rows = std::span(e.data(), static_cast<std::size_t>(e.size()));
  if (e.size() < fewest_rows || !(e.squaredNorm() > 0.0)) return std::nullopt;
  if (X.cols() + fewest_rows <= e.size()) {
    const MatrixXd basis = orthonormal(X, MatrixXd(e.size(), 0));
    MatrixXd columns(e.size(), basis.cols() + 1);
    columns << basis, e;
    const noise::GaussMarkovFit white = noise::fit_white_rows(columns);
    if (is_plainly_white(e, columns, white.restricted.minus_two_log_likelihood, runs)) {
      return OutputNoise{white.noise};
    }
  }
  NoiseModel fractional = fit_noise(rows, runs).model;
  const bool free = fractional.level_is_free();
  const MatrixXd levels =
      free && runs.size() <= most_levels ? levels_of(runs, e.size()) : MatrixXd(e.size(), 0);
  const MatrixXd basis = orthonormal(X, levels);
  const Index spent = basis.cols() + levels.cols();
  if (spent + fewest_rows > e.size() || (free && runs.size() > most_levels)) {
    std::optional<NoiseModel> plain = find_residual_noise(rows, runs);
    if (!plain) return std::nullopt;
    const auto n = static_cast<double>(e.size());
    plain->sigma *= std::sqrt(n / std::max(1.0, n - static_cast<double>(basis.cols())));
    return OutputNoise{*plain};
  }
  MatrixXd columns(e.size(), spent + 1);
  columns << levels, basis, e;
  const noise::GaussMarkovFit white = noise::fit_white_rows(columns);
  const noise::GaussMarkovFit gauss_markov = noise::fit_gauss_markov(columns, runs);
  const noise::Restricted of_fraction =
      noise::restricted_likelihood(columns.rightCols(basis.cols() + 1), runs, fractional);
  const Index left = e.size() - spent;
  const double of_white = criterion(white.restricted.minus_two_log_likelihood, 1.0, left);
  constexpr double none = 1e-3;  // of the variance: an AR(1) has no white share to estimate
  const double parameters = gauss_markov.noise.white < none ? 2.0 : 3.0;
  const double of_gauss_markov =
      criterion(gauss_markov.restricted.minus_two_log_likelihood, parameters, left);
  const double of_fractional =
      criterion(of_fraction.minus_two_log_likelihood, fractional.order() + 2.0, left);
  if (!(std::min(of_gauss_markov, of_fractional) < of_white)) return OutputNoise{white.noise};
  const bool is_fractional = of_fractional < of_gauss_markov;
  OutputNoise found = is_fractional ? OutputNoise{fractional} : OutputNoise{gauss_markov.noise};
  if (free ||
      !follows_columns(found, is_fractional ? of_fraction : gauss_markov.restricted, basis, runs)) {
    return found;
  }
  std::optional<OutputNoise> alone = find_noise_of_rows(e, MatrixXd(e.size(), 0), runs);
  if (alone) alone->moves_with_columns = true;
  return alone;
}

}  // namespace

bool is_white(const OutputNoise& noise) {
  if (noise.stride > 1) return false;
  if (const auto* model = std::get_if<NoiseModel>(&noise.model)) return is_white(*model);
  return std::get<noise::GaussMarkovNoise>(noise.model).white == 1.0;
}

double correlation_rows(const OutputNoise& noise) {
  const auto stride = static_cast<double>(noise.stride);
  if (is_white(noise)) return 1.0;
  if (const auto* gauss_markov = std::get_if<noise::GaussMarkovNoise>(&noise.model)) {
    return stride * (gauss_markov->white == 1.0 ? 1.0 : gauss_markov->rows);
  }
  const auto& model = std::get<NoiseModel>(noise.model);
  if (model.level_is_free()) return infinity;
  constexpr Index most = 100'000;
  const double border = std::exp(-1.0);
  for (Index lags = 64; lags <= most; lags *= 4) {
    const VectorXd gamma = noise::find_moments(model.d, model.phi, lags).autocovariance;
    for (Index lag = 1; lag < gamma.size(); ++lag) {
      if (gamma[lag] < border * gamma[0]) return stride * static_cast<double>(lag);
    }
  }
  return infinity;
}

namespace {

/// The noise of sums of as many rows as X and e allow; `find(e, X, runs)` finds it.
template <class Find>
std::optional<OutputNoise> find_noise_of_sums(const VectorXd& e, const MatrixXd& X,
                                              const std::vector<Segment>& runs, const Find& find) {
  const Index held = find_held_rows(e, runs);
  const Index stride = std::max(held, find_slow_rows(X, runs));
  if (stride == 1) return find(e, X, runs);
  const SummedRows sums(e, runs, stride);
  std::optional<OutputNoise> noise =
      find(sums.columns, SummedRows(X, runs, stride).columns, sums.runs);
  if (!noise) return noise;
  if (held == 1 && is_white(*noise) && is_as_large(sums.columns, e)) {
    return white_noise(std::sqrt(e.squaredNorm() / static_cast<double>(e.size() - X.cols())));
  }
  noise->stride = stride;
  noise->held = held;
  return noise;
}

}  // namespace

std::optional<OutputNoise> find_restricted_noise(const VectorXd& e, const MatrixXd& X,
                                                 const std::vector<Segment>& runs) {
  return find_noise_of_sums(e, X, runs, find_noise_of_rows);
}

std::optional<OutputNoise> find_noise_by_itself(const VectorXd& e, const MatrixXd& X,
                                                const std::vector<Segment>& runs) {
  return find_noise_of_sums(
      e, X, runs,
      [](const VectorXd& rows, const MatrixXd& columns, const std::vector<Segment>& of_rows) {
        std::optional<OutputNoise> noise =
            find_noise_of_rows(rows, MatrixXd(rows.size(), 0), of_rows);
        if (noise) {
          noise->moves_with_columns = true;
          const auto count = static_cast<double>(rows.size());
          const double left = std::max(1.0, count - static_cast<double>(columns.cols()));
          std::visit([&](auto& model) { model.sigma *= std::sqrt(count / left); }, noise->model);
        }
        return noise;
      });
}

std::vector<std::optional<OutputNoise>> find_output_noise(const std::vector<MatrixXd>& tangents,
                                                          const std::vector<Index>& columns,
                                                          const MatrixXd& residuals,
                                                          const std::vector<Segment>& runs,
                                                          const VectorXd& rounding,
                                                          base::ThreadPool& pool) {
  std::vector<std::optional<OutputNoise>> models(static_cast<std::size_t>(residuals.cols()));
  pool.for_each(models.size(), [&](std::size_t j) {
    const auto e = residuals.col(static_cast<Index>(j));
    const double rms = e.norm() / std::sqrt(static_cast<double>(e.size()));
    if (rms < rounding[static_cast<Index>(j)]) return;
    models[j] = find_restricted_noise(e, tangents[j](Eigen::all, columns), runs);
  });
  return models;
}

MatrixXd covariance_product(const OutputNoise& noise, double deviation,
                            const std::vector<Segment>& runs, const MatrixXd& X) {
  if (noise.stride > 1) {
    const SummedRows sums(X, runs, noise.stride);
    return covariance_product(OutputNoise{noise.model}, deviation, sums.runs, sums.columns);
  }
  return std::visit(
      [&](auto model) -> MatrixXd {
        model.sigma /= deviation;
        return covariance_product(model, runs, X);
      },
      noise.model);
}

MatrixXd find_score_covariance(std::vector<MatrixXd> tangents, const ScoreNoise& noise,
                               const std::vector<Index>& columns, const MatrixXd& K,
                               base::ThreadPool& pool) {
  std::vector<MatrixXd> parts(tangents.size());
  pool.for_each(parts.size(), [&](std::size_t j) {
    const double deviation = noise.deviations[static_cast<Index>(j)];
    MatrixXd Q = tangents[j](Eigen::all, columns) / deviation;  // whitened, then in K's coordinates
    tangents[j].resize(0, 0);
    K.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(Q);
    if (const std::optional<OutputNoise>& model = noise.models[j]) {
      parts[j] = covariance_product(*model, deviation, noise.runs, Q);
    } else {
      parts[j] = Q.transpose() * Q;
    }
  });
  MatrixXd sum = MatrixXd::Zero(K.cols(), K.cols());
  for (const MatrixXd& part : parts) sum += part;
  return sum;
}

}  // namespace sepcal::estimation
