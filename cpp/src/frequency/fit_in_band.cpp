// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/frequency/fit_in_band.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/thread_pool.hpp"
#include "frequency/band_errors.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace frequency;  // this room's own

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

bool is_constant(const VectorXd& column) {
  constexpr double rounding = 1e-12;
  const double largest = column.cwiseAbs().maxCoeff();
  return largest > 0.0 && column.maxCoeff() - column.minCoeff() <= rounding * largest;
}

Grid lay_grid(const Record& record, const Band& band) {
  std::vector<double> seconds;
  for (const Segment& segment : record.segments()) {
    seconds.push_back(duration_of(time_of(record, segment)));
  }
  const auto frequencies = frequencies_of(band, seconds);
  Grid grid;
  for (std::size_t s = 0; s < seconds.size(); ++s) grid.add(frequencies[s], seconds[s]);
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
    if (end == at) {  // too short for the band
      offset += N;
      continue;
    }
    const std::span<const double> frequencies = std::span(grid.frequencies).subspan(at, end - at);
    // Without its line in time first a large trim would leave its rounding.
    const MatrixXcd X =
        fourier_transform(without_line(rows.middleRows(offset, N), time), time, frequencies);
    all.middleRows(static_cast<Index>(at), static_cast<Index>(end - at)) =
        without_ends(X, time, frequencies);
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
  const VectorXd values = found.values();
  std::vector<BandTangent> tangents;
  for (const Spectrum& of : spectra) {
    tangents.push_back({of.A, of.A_0, of.z - of.A * values.cast<std::complex<double>>()});
  }
  put_band_errors(tangents, grid, asked, found);
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const VectorXd residual = rows[j].rightCols<1>() - rows[j].leftCols(values.size()) * values;
    found.rmse[j].value = std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
    if (asked.noise.empty()) found.noise[j].value = found.rmse[j].value;
  }
  found.rows = record.rows();
  return found;
}

}  // namespace sepcal
