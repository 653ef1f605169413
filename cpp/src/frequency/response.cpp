// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/frequency/response.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "base/name_list.hpp"
#include "base/short_number.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using base::short_number;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double periods = 2.0;  // of the band's low end in a window, at least

double longest_segment(const Record& record) {
  double longest = 0.0;
  for (const Segment& segment : record.segments()) {
    longest = std::max(longest, duration_of(time_of(record, segment)));
  }
  return longest;
}

double choose_window(const Record& record, const ResponseOptions& options) {
  const double longest = longest_segment(record);
  const double least = periods / options.band.low;
  const double window = options.window > 0.0 ? options.window : std::max(longest / 5.0, least);
  constexpr double rounding = 1e-9;
  if (window < least * (1.0 - rounding)) {
    throw Error("a window of " + short_number(window) + " s holds less than two periods of " +
                short_number(options.band.low) + " Hz; take one of " + short_number(least) +
                " s or more, or a higher band");
  }
  if (window > longest * (1.0 + rounding)) {
    throw Error("no segment is as long as a window of " + short_number(window) +
                " s: the longest has " + short_number(longest) +
                " s; take a shorter window, of two periods of a higher band's low end");
  }
  return window;
}

void check_asked(const Record& record, const std::vector<std::string>& inputs,
                 const std::string& output, const ResponseOptions& options) {
  check_band(options.band);
  if (inputs.empty()) throw Error("no input is named; a response is of an output to an input");
  if (!(options.level > 0.0 && options.level < 1.0)) {
    throw Error("level is " + short_number(options.level) + "; give a share within 0 and 1, 0.95");
  }
  if (!(options.window >= 0.0) || !std::isfinite(options.window)) {
    throw Error("window is " + short_number(options.window) +
                " s; give a time above 0, or 0 for one that is chosen");
  }
  record.column("time");
  record.column(output);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    record.column(inputs[i]);
    if (inputs[i] == output) {
      throw Error("'" + output + "' is input and output at once; name another column for one");
    }
    if (std::find(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(i), inputs[i]) !=
        inputs.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw Error("the input '" + inputs[i] + "' is named twice; leave one out");
    }
  }
}

/// Hann's weights, of unit mean square.
VectorXd taper(Index rows) {
  VectorXd weights(rows);
  for (Index k = 0; k < rows; ++k) {
    const double at = (static_cast<double>(k) + 0.5) / static_cast<double>(rows);
    weights[k] = std::sqrt(8.0 / 3.0) * std::pow(std::sin(std::numbers::pi * at), 2);
  }
  return weights;
}

/// Averages of products: the last of the columns is the output.
class Spectra {
 public:
  Spectra(std::vector<double> frequencies, Index columns)
      : frequencies_(std::move(frequencies)),
        sums_(frequencies_.size(), MatrixXcd::Zero(columns, columns)) {}

  void add(const MatrixXd& rows, std::span<const double> time) {
    const MatrixXd tapered = taper(rows.rows()).asDiagonal() * without_line(rows, time);
    const MatrixXcd X = fourier_transform(tapered, time, frequencies_);
    for (Index m = 0; m < X.rows(); ++m) {
      sums_[static_cast<std::size_t>(m)] += X.row(m).adjoint() * X.row(m);
    }
    ++windows_;
  }

  const std::vector<double>& frequencies() const { return frequencies_; }
  int windows() const { return windows_; }
  MatrixXcd average(std::size_t m) const { return sums_[m] / static_cast<double>(windows_); }

 private:
  std::vector<double> frequencies_;
  std::vector<MatrixXcd> sums_;
  int windows_ = 0;
};

/// What the windows of one stretch are worth: neighbours share half of their rows. Welch 1967.
double worth(int windows) {
  if (windows == 0) return 0.0;
  constexpr double shared = 1.0 / 36.0;  // (sum of w_k w_{k+N/2} / sum of w_k^2)^2 of Hann's
  const double K = windows;
  return K / (1.0 + 2.0 * shared * (K - 1.0) / K);
}

/// The quantile of F with 2 and `freedom` degrees.
double f_quantile(double level, double freedom) {
  return 0.5 * freedom * (std::pow(1.0 - level, -2.0 / freedom) - 1.0);
}

MatrixXd gather(const Record& record, const std::vector<std::string>& names, std::size_t first,
                std::size_t rows) {
  MatrixXd values(static_cast<Index>(rows), static_cast<Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto column = record.column(names[i]).subspan(first, rows);
    values.col(static_cast<Index>(i)) = Eigen::Map<const VectorXd>(column.data(), values.rows());
  }
  return values;
}

/// Adds the windows of a segment; returns what they are worth.
double add_segment(const Record& record, const Segment& segment,
                   const std::vector<std::string>& names, double window, Spectra& spectra) {
  const std::span<const double> time = time_of(record, segment);
  const double step = duration_of(time) / static_cast<double>(time.size());
  const auto rows = static_cast<std::size_t>(std::lround(window / step));
  if (rows < 4 || rows > time.size()) return 0.0;
  double independent = 0.0;
  int in_row = 0;
  for (std::size_t first = 0; first + rows <= time.size();
       first += std::max<std::size_t>(1, rows / 2)) {
    const MatrixXd values = gather(record, names, segment.first + first, rows);
    if (!values.allFinite()) {
      independent += worth(in_row);
      in_row = 0;
      continue;
    }
    spectra.add(values, time.subspan(first, rows));
    ++in_row;
  }
  return independent + worth(in_row);
}

void solve(std::size_t m, const MatrixXcd& G, double freedom, double level,
           FrequencyResponse& found) {
  const Index n = G.cols() - 1;
  const auto row = static_cast<Index>(m);
  // G(i, j) = mean of conj(x_i) x_j.
  const MatrixXcd inputs = G.topLeftCorner(n, n);
  const VectorXcd across = G.topRightCorner(n, 1);
  const double output = G(n, n).real();
  const VectorXd scale = inputs.diagonal().real().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const MatrixXcd scaled = scale.asDiagonal() * inputs * scale.asDiagonal();
  const MatrixXcd inverse = scale.asDiagonal() *
                            scaled.ldlt().solve(MatrixXcd::Identity(n, n)).eval() *
                            scale.asDiagonal();
  const VectorXcd H = inverse * across;
  const double left = std::max(0.0, output - (across.adjoint() * H).value().real());
  found.response.row(row) = H.transpose();
  found.coherence_all[row] = output > 0.0 ? 1.0 - left / output : 0.0;
  for (Index i = 0; i < n; ++i) {
    const double open = left * inverse(i, i).real();
    const double square = std::norm(H[i]);
    found.coherence(row, i) = square + open > 0.0 ? square / (square + open) : 0.0;
    const double variance = open / freedom;  // of the complex number
    found.standard_error(row, i) = std::sqrt(0.5 * variance);
    found.radius(row, i) = std::sqrt(variance * f_quantile(level, 2.0 * freedom));
  }
}

}  // namespace

FrequencyResponse frequency_response(const Record& record, const std::vector<std::string>& inputs,
                                     const std::string& output, const ResponseOptions& options) {
  check_asked(record, inputs, output, options);
  const double window = choose_window(record, options);
  std::vector<std::string> names = inputs;
  names.push_back(output);
  const auto n = static_cast<Index>(inputs.size());
  Spectra spectra(frequencies_of(options.band, window), n + 1);
  double averages = 0.0;
  for (const Segment& segment : record.segments()) {
    averages += add_segment(record, segment, names, window, spectra);
  }
  const double freedom = averages - static_cast<double>(n);
  if (!(freedom >= 1.0)) {
    throw Error(std::to_string(spectra.windows()) + " windows of " + short_number(window) +
                " s are worth " + short_number(averages) + " independent ones; " +
                base::list_names(inputs) + " needs " + short_number(static_cast<double>(n) + 1.0) +
                " or more: take shorter windows, or a longer flight");
  }
  FrequencyResponse found;
  found.inputs = inputs;
  found.output = output;
  found.frequencies = spectra.frequencies();
  const auto count = static_cast<Index>(found.frequencies.size());
  found.response.resize(count, n);
  found.coherence.resize(count, n);
  found.coherence_all.resize(count);
  found.standard_error.resize(count, n);
  found.radius.resize(count, n);
  for (std::size_t m = 0; m < found.frequencies.size(); ++m) {
    solve(m, spectra.average(m), freedom, options.level, found);
  }
  found.window = window;
  found.windows = spectra.windows();
  found.averages = averages;
  return found;
}

MagnitudeAndPhase magnitude_and_phase(const FrequencyResponse& of) {
  MagnitudeAndPhase found;
  const MatrixXd none(of.response.rows(), of.response.cols());
  constexpr double whole_turn = 2.0 * std::numbers::pi;
  found.magnitude = of.response.cwiseAbs();
  found.magnitude_low = (found.magnitude - of.radius).cwiseMax(0.0);
  found.magnitude_high = found.magnitude + of.radius;
  found.phase = found.phase_low = found.phase_high = none;
  for (Index i = 0; i < none.cols(); ++i) {
    for (Index m = 0; m < none.rows(); ++m) {
      double phase = std::arg(of.response(m, i));
      if (m > 0) phase -= whole_turn * std::round((phase - found.phase(m - 1, i)) / whole_turn);
      const double share = of.radius(m, i) / found.magnitude(m, i);
      const double half = share < 1.0 ? std::asin(share) : not_a_number;
      found.phase(m, i) = phase;
      found.phase_low(m, i) = phase - half;
      found.phase_high(m, i) = phase + half;
    }
  }
  return found;
}

}  // namespace sepcal
