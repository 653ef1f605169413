// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/spectral_line.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "numerics/order_statistics.hpp"
#include "numerics/tails.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double sure = -2.0;  // log10 of the tail of an output that shows it

/// Powers at twice the frequencies that are independent, or more: a line between two shows too.
struct Spectrum {
  VectorXd power = {};
  double bin = 1.0;  // places from one independent frequency to the next

  Index first() const { return static_cast<Index>(std::ceil(bin)); }
  Index last() const { return power.size() - 1 - first(); }
  Index strongest() const {
    Index at = 0;
    power.segment(first(), last() - first() + 1).maxCoeff(&at);
    return first() + at;
  }
  double frequency(Index at) const {
    return 0.5 * static_cast<double>(at) / static_cast<double>(power.size() - 1);
  }
  Index place(double frequency) const {
    return static_cast<Index>(std::lround(2.0 * frequency * static_cast<double>(power.size() - 1)));
  }
};

/// `values` are of rows `first`, first + 1, ... of the grid.
Spectrum find_powers(const VectorXd& values, const EvenGrid& grid, Index first) {
  const auto from = static_cast<std::size_t>(first);
  const Index origin = grid.cells[from];
  const Index length = grid.cells[from + static_cast<std::size_t>(values.size()) - 1] - origin + 1;
  Index padded = 64;
  while (padded < 2 * length) padded *= 2;
  VectorXd cells = VectorXd::Zero(padded);
  for (Index i = 0; i < values.size(); ++i) {
    cells[grid.cells[from + static_cast<std::size_t>(i)] - origin] = values[i];
  }
  Eigen::FFT<double> fft;
  Eigen::VectorXcd transformed;
  fft.fwd(transformed, cells);
  return {transformed.head(padded / 2 + 1).cwiseAbs2(),
          static_cast<double>(padded) / static_cast<double>(length)};
}

/// log10 of the tail of the power at a place over the mean of its neighbours', two to seven
/// frequencies away; 0 where half of them are missing. `outputs`: whose powers are summed.
double log10_stands_out(const Spectrum& spectrum, Index at, double outputs) {
  double sum = 0.0;
  double neighbours = 0.0;
  for (const int away : {-7, -6, -5, -4, -3, -2, 2, 3, 4, 5, 6, 7}) {
    const Index k = at + static_cast<Index>(std::lround(away * spectrum.bin));
    if (k < spectrum.first() || k > spectrum.last()) continue;
    sum += spectrum.power[k];
    ++neighbours;
  }
  if (neighbours < 6.0 || !(sum > 0.0)) return 0.0;
  return numerics::log10_f_tail(spectrum.power[at] * neighbours / sum, 2.0 * outputs,
                                2.0 * outputs * neighbours);
}

/// Where a wave of that frequency has the most power for its length.
Window find_strongest(const MatrixXd& white, const EvenGrid& grid, const SpectralLine& line) {
  const double turn = 2.0 * std::numbers::pi * line.frequency;
  Window strongest;
  double most = 0.0;
  for (const Window& window : nested_windows()) {
    const Index first = row_of(window.first, white.rows());
    const Index last = row_of(window.last, white.rows());
    double power = 0.0;
    for (const std::size_t j : line.outputs) {
      std::complex<double> sum;
      for (Index row = first; row < last; ++row) {
        const auto cell = static_cast<double>(grid.cells[static_cast<std::size_t>(row)]);
        sum += std::polar(white(row, static_cast<Index>(j)), -turn * cell);
      }
      power += std::norm(sum) / static_cast<double>(last - first);
    }
    if (!(power > most)) continue;
    most = power;
    strongest = window;
  }
  return strongest;
}

}  // namespace

EvenGrid place_on_grid(const std::vector<double>& time) {
  constexpr double longest_gap = 64.0;
  EvenGrid grid;
  if (time.size() < 2) return grid;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) intervals.push_back(time[i] - time[i - 1]);
  const double usual = numerics::upper_median(intervals);
  grid.interval = usual > 0.0 ? usual : 1.0;
  grid.cells.push_back(0);
  double at = 0.0;
  for (const double interval : intervals) {
    at += interval > 0.0 ? std::min(interval / grid.interval, longest_gap) : 1.0;
    grid.cells.push_back(std::max(grid.cells.back() + 1, static_cast<Index>(std::lround(at))));
  }
  return grid;
}

SpectralLine find_line(const MatrixXd& white, const EvenGrid& grid) {
  SpectralLine line;
  const Index outputs = white.cols();
  std::vector<Spectrum> spectra;
  Spectrum sum;
  for (Index j = 0; j < outputs; ++j) {
    const VectorXd unit = white.col(j).normalized();
    spectra.push_back(find_powers(unit, grid, 0));
    if (j == 0) sum = spectra.front();
    if (j > 0) sum.power += spectra.back().power;
  }
  Index place = sum.strongest();
  double least = log10_stands_out(sum, place, static_cast<double>(outputs));
  if (outputs > 1) {
    for (const Spectrum& own : spectra) {
      const double tail = log10_stands_out(own, own.strongest(), 1.0);
      if (!(tail < least)) continue;
      least = tail;
      place = own.strongest();
    }
  }
  if (!(least < 0.0)) return line;
  const double sets = outputs > 1 ? static_cast<double>(outputs) + 1.0 : 1.0;
  const double tried = sets * static_cast<double>(white.rows());  // of two places a frequency
  line.p_value = std::min(1.0, tried * std::pow(10.0, least));
  line.frequency = sum.frequency(place);
  std::vector<double> tails;
  for (const Spectrum& own : spectra) tails.push_back(log10_stands_out(own, place, 1.0));
  const double surest = *std::ranges::min_element(tails);
  for (std::size_t j = 0; j < tails.size(); ++j) {
    if (tails[j] < sure || tails[j] == surest) line.outputs.push_back(j);
  }
  line.strongest = find_strongest(white, grid, line);
  return line;
}

bool swings_as_inputs(const SpectralLine& line, const MatrixXd& slopes, const EvenGrid& grid) {
  constexpr double near = 7.0;         // independent frequencies: as far as neighbours reach
  constexpr double least_share = 0.2;  // of the slope's power about its mean
  const auto rows = static_cast<Index>(grid.cells.size());
  for (const auto slope : slopes.colwise()) {
    for (const std::size_t j : line.outputs) {
      const VectorXd of_output = slope.segment(static_cast<Index>(j) * rows, rows);
      const Spectrum own = find_powers(of_output.array() - of_output.mean(), grid, 0);
      const Index place = own.place(line.frequency);
      const auto reach = static_cast<Index>(std::lround(near * own.bin));
      const Index from = std::max<Index>(0, place - reach);
      const Index to = std::min(own.power.size() - 1, place + reach);
      const double share = own.power.segment(from, to - from + 1).sum() / own.power.sum();
      if (share > least_share) return true;
    }
  }
  return false;
}

double strongest_frequency(const VectorXd& values, const EvenGrid& grid, Index first) {
  if (values.size() < 8) return not_a_number;
  const Spectrum spectrum = find_powers(values, grid, first);
  const Index at = spectrum.strongest();
  const double share = spectrum.power[at] * spectrum.bin / spectrum.power.sum();
  const auto rows = static_cast<double>(values.size());
  const bool stands_out = rows * std::pow(std::max(0.0, 1.0 - share), 0.5 * rows - 1.0) < 0.01;
  return stands_out ? spectrum.frequency(at) : not_a_number;
}

}  // namespace sepcal::diagnosis
