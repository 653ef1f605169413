// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/frequency/fit_in_band.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/thread_pool.hpp"
#include "estimation/covariance.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// A model whose rows were computed before: input k of output j is its column of parameter k.
class KnownRows final : public BlockModel {
 public:
  explicit KnownRows(const Tables& of) : BlockModel(tables_like(of)) {}

  static std::string input_name(const Tables& of, Index output, Index parameter) {
    return of.outputs[static_cast<std::size_t>(output)].name + "/" +
           of.linear[static_cast<std::size_t>(parameter)].name;
  }

  void evaluate(const Block& block, const double* /*xi2*/, const double* /*xi1*/, Carry* /*carry*/,
                Eigen::Ref<MatrixXd> rows) const override {
    const auto n = static_cast<Index>(block.rows);
    rows.setZero();
    std::size_t input = 0;
    for (Index j = 0; j < tables().n_z(); ++j) {
      for (Index k = 0; k < tables().n_1(); ++k, ++input) {
        rows.col(k).segment(j * n, n) = Eigen::Map<const VectorXd>(block.inputs[input], n);
      }
    }
  }

 private:
  static Tables tables_like(const Tables& of) {
    Tables tables{{}, of.outputs, of.linear, {}};
    for (Index j = 0; j < of.n_z(); ++j) {
      for (Index k = 0; k < of.n_1(); ++k) tables.inputs.emplace_back(input_name(of, j, k), "");
    }
    return tables;
  }
};

/// What one output's columns are over the band: a row a frequency, segment after segment.
struct Spectrum {
  MatrixXcd A;   // frequencies x n_1
  VectorXcd z;   // frequencies
  VectorXd A_0;  // n_1, of the constant's row; zeros where there is no constant
  double z_0 = 0.0;
};

/// Where the frequencies are.
struct Grid {
  std::vector<double> frequencies;  // Hz, segment after segment
  std::vector<double> seconds;      // how long the segment of each lasts
  std::vector<std::size_t> segment;
  double total = 0.0;  // s, of all segments
};

bool is_constant(const VectorXd& column) {
  constexpr double rounding = 1e-12;
  const double largest = column.cwiseAbs().maxCoeff();
  return largest > 0.0 && column.maxCoeff() - column.minCoeff() <= rounding * largest;
}

std::span<const double> time_of(const Record& record, const Segment& segment) {
  return record.column("time").subspan(segment.first, segment.rows());
}

Grid lay_grid(const Record& record, const Band& band) {
  Grid grid;
  for (std::size_t s = 0; s < record.segments().size(); ++s) {
    const double seconds = duration_of(time_of(record, record.segments()[s]));
    for (const double frequency : frequencies_of(band, seconds)) {
      grid.frequencies.push_back(frequency);
      grid.seconds.push_back(seconds);
      grid.segment.push_back(s);
    }
    grid.total += seconds;
  }
  return grid;
}

/// `rows`: [A | z] of one output in the record's rows. `is_held` says which parameters are no
/// unknowns.
Spectrum transform(const MatrixXd& rows, const std::vector<bool>& is_held, const Record& record,
                   const Grid& grid) {
  const Index n = rows.cols() - 1;
  MatrixXcd all(static_cast<Index>(grid.frequencies.size()), n + 1);
  Index offset = 0;
  std::size_t at = 0;
  for (std::size_t s = 0; s < record.segments().size(); ++s) {
    const std::span<const double> time = time_of(record, record.segments()[s]);
    const auto N = static_cast<Index>(time.size());
    std::size_t end = at;
    while (end < grid.segment.size() && grid.segment[end] == s) ++end;
    all.middleRows(static_cast<Index>(at), static_cast<Index>(end - at)) =
        fourier_transform(without_line(rows.middleRows(offset, N), time), time,
                          std::span(grid.frequencies).subspan(at, end - at));
    offset += N;
    at = end;
  }
  Spectrum spectrum{all.leftCols(n), all.col(n), VectorXd::Zero(n), 0.0};
  for (Index k = 0; k < n; ++k) {
    if (!is_constant(rows.col(k))) continue;
    spectrum.A.col(k).setZero();  // its rounding is no information
    if (is_held[static_cast<std::size_t>(k)]) continue;
    const VectorXd mean = rows.colwise().mean() * std::sqrt(static_cast<double>(rows.rows()));
    spectrum.A_0 = mean.head(n);
    spectrum.z_0 = mean[n];
  }
  return spectrum;
}

/// Real parts, imaginary parts, the constants' row.
Record record_of(const Tables& tables, const std::vector<Spectrum>& spectra) {
  const auto stack = [](const VectorXcd& over, double last) {
    std::vector<double> values;
    for (const auto& value : over) values.push_back(value.real());
    for (const auto& value : over) values.push_back(value.imag());
    values.push_back(last);
    return values;
  };
  Record record;
  for (Index j = 0; j < tables.n_z(); ++j) {
    const Spectrum& of = spectra[static_cast<std::size_t>(j)];
    record.add(tables.outputs[static_cast<std::size_t>(j)].name, stack(of.z, of.z_0));
    for (Index k = 0; k < tables.n_1(); ++k) {
      record.add(KnownRows::input_name(tables, j, k), stack(of.A.col(k), of.A_0[k]));
    }
  }
  return record;
}

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
  BandErrors(const std::vector<Spectrum>& spectra, const Grid& grid, const FitOptions& options)
      : spectra_(spectra), grid_(grid), options_(options) {}

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
    for (std::size_t j = 0; j < spectra_.size(); ++j) {
      const MatrixXcd A = spectra_[j].A(Eigen::all, inside);
      const VectorXd A_0 = spectra_[j].A_0(inside);
      information +=
          ((A.adjoint() * A).real() + A_0 * A_0.transpose()) / std::pow(fit.noise[j].value, 2);
    }
    const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    const MatrixXd inverse = scaled.ldlt().solve(MatrixXd::Identity(count, count));
    const MatrixXd bread = scale.asDiagonal() * inverse * scale.asDiagonal();
    MatrixXd white = prior.asDiagonal();
    MatrixXd coloured = white;
    for (std::size_t j = 0; j < spectra_.size(); ++j) {
      add_output(fit, j, inside, bread, white, coloured);
    }
    give(fit, inside, bread * white * bread, bread * coloured * bread);
  }

 private:
  void add_output(const Fit& fit, std::size_t j, const std::vector<Index>& inside,
                  const MatrixXd& bread, MatrixXd& white, MatrixXd& coloured) const {
    const Spectrum& of = spectra_[j];
    const double noise = fit.noise[j].value;
    const VectorXcd residual = of.z - of.A * fit.values().cast<std::complex<double>>();
    const MatrixXcd A = of.A(Eigen::all, inside);
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
    const VectorXd A_0 = of.A_0(inside);
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

  const std::vector<Spectrum>& spectra_;
  const Grid& grid_;
  const FitOptions& options_;
};

void check_asked(const BlockModel& model, const Record& record, const FitOptions& options) {
  if (model.tables().n_2() > 0 || model.tables().n_1() == 0) {
    throw Error("complete linear models alone are fitted over a band; '" +
                (model.tables().n_2() > 0 ? model.tables().nonlinear.front().name
                                          : std::string("a model without parameters")) +
                "' isn't linear: fit it in time");
  }
  if (!record.has("time")) throw Error("column 'time' is missing, which a band of Hz needs");
  if (options.loss != Loss::squares) {
    throw Error(
        "over a band residuals are sums over all rows, of which no one is an outlier; "
        "leave the loss out, or fit in time");
  }
}

}  // namespace

Fit fit_in_band(const BlockModel& model, const Record& all, const Band& band,
                const FitOptions& asked) {
  check_asked(model, all, asked);
  FitOptions options = asked;
  const Record record = all.select(options.stage_two_segments);
  options.stage_one_segments.clear();
  options.stage_two_segments.clear();
  options.coloured_errors = false;  // of rows in time; BandErrors has them
  const Tables& tables = model.tables();
  std::vector<bool> is_held;
  for (const Variable& parameter : tables.linear) {
    is_held.push_back(options.fix.contains(parameter.name));
  }
  base::ThreadPool pool(options.threads);
  const model::Measurements measurements(model, record);
  const model::Sweep sweep(model, measurements, pool);
  const VectorXd none;
  const std::vector<MatrixXd> rows = sweep.tangent_rows(VectorXd::Zero(tables.n_1()), none);
  const Grid grid = lay_grid(record, band);
  std::vector<Spectrum> spectra;
  for (const MatrixXd& one : rows) spectra.push_back(transform(one, is_held, record, grid));

  Fit found = fit(KnownRows(tables), record_of(tables, spectra), options);
  BandErrors(spectra, grid, asked).put_into(found);
  const VectorXd values = found.values();
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const VectorXd residual = rows[j].rightCols<1>() - rows[j].leftCols(values.size()) * values;
    found.rmse[j].value = std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
    if (asked.noise.empty()) found.noise[j].value = found.rmse[j].value;
  }
  found.rows = record.rows();
  return found;
}

}  // namespace sepcal
