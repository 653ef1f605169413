// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrated_flight.hpp"
#include "coloured_covariance.hpp"
#include "residual_channels.hpp"
#include "sepcal/measurements.hpp"
#include "sweep.hpp"
#include "thread_pool.hpp"
#include "worst_windows.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t spans_without_labels = 10;

/// Rows of the residual matrix that belong together, without a gap.
using Stretch = Segment;

struct Part {
  std::string name;
  std::vector<Stretch> stretches;
};

/// One part a label, in order of first appearance.
std::vector<Part> parts_by_label(const std::vector<Stretch>& stretches) {
  std::vector<Part> parts;
  for (const Stretch& stretch : stretches) {
    const auto same = std::ranges::find(parts, stretch.label, &Part::name);
    if (same == parts.end()) {
      parts.push_back({stretch.label, {stretch}});
    } else {
      same->stretches.push_back(stretch);
    }
  }
  return parts;
}

/// Spans of equal length over the rows, cut again where a segment ends.
std::vector<Part> parts_by_time(const std::vector<Stretch>& stretches,
                                const std::vector<double>& time) {
  std::vector<Part> parts;
  const std::size_t rows = time.size();
  const std::size_t count = std::min(spans_without_labels, rows);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = rows * i / count;
    const std::size_t last = rows * (i + 1) / count;
    Part part{fmt::format("{:.6g}:{:.6g}", time[first], time[last - 1]), {}};
    for (const Stretch& stretch : stretches) {
      const Stretch shared{"", std::max(first, stretch.first), std::min(last, stretch.last)};
      if (shared.first < shared.last) part.stretches.push_back(shared);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Sums of one output over stretches; lag-one correlation is about the common mean.
Misfit measure(const Part& part, const MatrixXd& residuals, Index output,
               const Variable& quantity) {
  Misfit misfit{.segment = part.name, .output = quantity.name, .unit = quantity.unit};
  const auto r = residuals.col(output);
  double sum = 0.0;
  double square = 0.0;
  for (const Stretch& stretch : part.stretches) {
    const auto values =
        r.segment(static_cast<Index>(stretch.first), static_cast<Index>(stretch.rows()));
    sum += values.sum();
    square += values.squaredNorm();
    misfit.rows += stretch.rows();
  }
  const auto rows = static_cast<double>(misfit.rows);
  misfit.mean = sum / rows;
  misfit.rmse = std::sqrt(square / rows);
  double product = 0.0;
  for (const Stretch& stretch : part.stretches) {
    const auto n = static_cast<Index>(stretch.rows());
    const auto centred =
        (r.segment(static_cast<Index>(stretch.first), n).array() - misfit.mean).eval();
    product += (centred.head(n - 1) * centred.tail(n - 1)).sum();
  }
  const double variance = square - rows * misfit.mean * misfit.mean;
  misfit.lag_one = misfit.rows > 2 && variance > 0 ? product / variance : undefined;
  return misfit;
}

}  // namespace

Comparison compare(const Calibration& calibration, const Flight& flight) {
  const Probe& probe = *calibration.probe;
  const EffectiveFlight effective = prepare_calibrated(calibration, flight);
  const Record& record = effective.prepared.record;
  const Measurements measurements(*effective.model, record);
  ThreadPool pool(calibration.options.fit.threads);
  const Sweep sweep(*effective.model, measurements, pool);

  Comparison result;
  result.model = probe.name();
  result.flight = {flight.name(), flight.sha256(), flight.rows(), measurements.rows()};
  result.status = calibration.fit.status;
  result.message = calibration.fit.message;
  result.notes = effective.prepared.notes;
  result.residuals = sweep.residuals(calibration.fit.xi1(), calibration.fit.xi2());
  const auto time = record.column("time");
  for (const Segment& segment : record.segments()) {
    const auto part = time.subspan(segment.first, segment.rows());
    result.time.insert(result.time.end(), part.begin(), part.end());
  }

  // Residual rows stand in the record's order, segment after segment.
  const std::vector<Stretch> stretches = join_segments(record.segments());
  std::vector<Part> parts = parts_by_label(stretches);
  if (parts.size() < 2) parts = parts_by_time(stretches, result.time);
  const auto& outputs = probe.model().tables().outputs;
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    result.overall.push_back(
        measure({"", stretches}, result.residuals, static_cast<Index>(j), outputs[j]));
  }
  for (const Part& part : parts) {
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      result.where.push_back(measure(part, result.residuals, static_cast<Index>(j), outputs[j]));
    }
  }
  result.channels = compare_channels(record, probe.model().tables(), result.residuals, pool);
  result.windows =
      find_worst_windows(result.time, result.residuals, result.overall, calibration.fit.noise);
  return result;
}

}  // namespace sepcal
