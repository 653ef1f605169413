// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/omnibus.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parts_of_record.hpp"
#include "diagnosis/block_jackknife.hpp"
#include "diagnosis/held_out.hpp"
#include "diagnosis/projection.hpp"
#include "numerics/tails.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// By label where there are a few, else even windows of at least ten correlation times.
std::vector<base::Part> cut_windows(const CandidateRoom& room, double correlation) {
  constexpr std::size_t fewest = 3;
  constexpr std::size_t most = 20;
  const RowLayout& layout = room.fit().layout;
  std::vector<base::Part> windows = base::parts_by_label(layout.segments);
  if (windows.size() >= fewest && windows.size() <= most) return windows;
  const double wanted = std::floor(static_cast<double>(layout.rows) / (10.0 * correlation));
  const double count = std::clamp(wanted, 4.0, static_cast<double>(most));
  Record rows = room.record();
  rows.cut(room.rows());
  return base::parts_by_time(layout.segments, base::gather_time(rows),
                             static_cast<std::size_t>(count));
}

/// The window of each row; -1 where there is none.
std::vector<int> find_windows(const RowLayout& layout, const std::vector<base::Part>& windows) {
  std::vector<int> found(static_cast<std::size_t>(layout.rows), -1);
  for (std::size_t w = 0; w < windows.size(); ++w) {
    for (const Segment& stretch : windows[w].stretches) {
      std::fill(found.begin() + static_cast<std::ptrdiff_t>(stretch.first),
                found.begin() + static_cast<std::ptrdiff_t>(stretch.last), static_cast<int>(w));
    }
  }
  return found;
}

/// Each column restricted to each of `count` windows.
Columns by_window(const RowLayout& layout, const Columns& columns,
                  const std::vector<int>& window_of_row, Index count) {
  const auto windows = std::make_shared<const std::vector<int>>(window_of_row);
  return {columns.cols() * count,
          [columns, windows, count, N = layout.rows](Index first, Eigen::Ref<MatrixXd> rows) {
            const MatrixXd made = columns.rows(first, rows.rows());
            rows.setZero();
            for (Index i = 0; i < rows.rows(); ++i) {
              const int w = (*windows)[static_cast<std::size_t>((first + i) % N)];
              if (w < 0) continue;
              for (Index k = 0; k < made.cols(); ++k) rows(i, k * count + w) = made(i, k);
            }
          }};
}

struct Offsets {
  std::string where;
  Columns basis;  // orthonormal, beyond the tangent
  Columns parts;
};

/// The columns that are not all but within the tangent.
std::vector<Index> find_seen(const TangentBasis& tangent, const Columns& columns) {
  VectorXd whole = VectorXd::Zero(columns.cols());
  VectorXd left = VectorXd::Zero(columns.cols());
  const Columns beyond = remove_tangent(tangent, columns);
  for_each_panel(tangent.fit().layout, [&](Index first, Index rows) {
    whole += columns.rows(first, rows).colwise().squaredNorm();
    left += beyond.rows(first, rows).colwise().squaredNorm();
  });
  std::vector<Index> seen;
  for (Index k = 0; k < columns.cols(); ++k) {
    if (std::sqrt(left[k]) > 0.05 * std::sqrt(whole[k])) seen.push_back(k);
  }
  return seen;
}

std::vector<Offsets> find_offsets(CandidateRoom& room, const EffectKit& kit,
                                  const NullHypothesis& null,
                                  const std::vector<base::Part>& windows) {
  const RowLayout& layout = room.fit().layout;
  const std::vector<int> window_of_row = find_windows(layout, windows);
  std::vector<Offsets> sets;
  const auto count = static_cast<Index>(windows.size());
  const auto add = [&](const std::string& where, const Columns& parts) {
    const std::vector<Index> seen = find_seen(null.basis, parts);
    if (!seen.empty()) sets.push_back({where, span_beyond(null.basis, select(parts, seen)), parts});
  };
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const Columns offset(
        1, [own = layout.first(j), N = layout.rows](Index first, Eigen::Ref<MatrixXd> rows) {
          rows.setConstant(first / N == own / N ? 1.0 : 0.0);
        });
    add(layout.outputs[j].name, by_window(layout, offset, window_of_row, count));
  }
  MatrixXd within = MatrixXd::Zero(layout.rows, count);  // a column a window
  for (Index i = 0; i < layout.rows; ++i) {
    const int w = window_of_row[static_cast<std::size_t>(i)];
    if (w >= 0) within(i, w) = 1.0;
  }
  for (const Port& port : kit.ports) {
    try {
      room.open(port);
    } catch (const Error&) {
      continue;  // the record doesn't log what the port needs
    }
    const MatrixXd* columns = room.columns_of(port.name);
    add(port.name, columns == nullptr ? room.drive(port, within)
                                      : by_window(layout, view(*columns), window_of_row, count));
  }
  return sets;
}

/// How far each window is off, in its own standard errors: the larger of its columns'.
std::vector<std::pair<std::string, double>> describe_windows(
    const RowLayout& layout, const NullHypothesis& null, const Offsets& offsets,
    const std::vector<base::Part>& windows) {
  std::vector<std::pair<std::string, double>> described;
  const auto count = static_cast<Index>(windows.size());
  for (Index w = 0; w < count; ++w) {
    double furthest = 0.0;
    for (Index k = w; k < offsets.parts.cols(); k += count) {
      MatrixXd white = select(offsets.parts, {k}).dense(layout);
      null.whiten(white);
      white = remove_span(null.white_basis, white);
      const double norm = white.norm();
      if (!(norm > 0)) continue;
      furthest = std::max(furthest, std::abs(white.col(0).dot(null.white_residual)) / norm);
    }
    described.emplace_back(windows[static_cast<std::size_t>(w)].name, furthest);
  }
  return described;
}

/// The norm of what is measured about its means, in the layout's units.
double all_that_varies(const RowLayout& layout) {
  double sum = 0.0;
  for (const UsedOutput& output : layout.outputs) {
    sum += static_cast<double>(layout.rows) * output.variance / (output.scale * output.scale);
  }
  return std::sqrt(sum);
}

/// The point that a standard normal variable exceeds with that probability.
double upper_normal_point(double probability) {
  double low = -10.0;
  double high = 40.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(middle / std::numbers::sqrt2) > probability ? low : high) = middle;
  }
  return low;
}

}  // namespace

Omnibus test_for_structure(CandidateRoom& room, const EffectKit& kit, const NullHypothesis& null,
                           const InstrumentNoise* instruments, const InputNoise* inputs,
                           const DiagnosisOptions& options, base::ThreadPool& pool) {
  const RowLayout& layout = room.fit().layout;
  const std::vector<base::Part> windows =
      cut_windows(room, correlation_rows(layout, null.residual));
  const std::vector<Offsets> sets = find_offsets(room, kit, null, windows);
  const double correction = std::log10(static_cast<double>(std::max<std::size_t>(1, sets.size())));
  const double significant = std::log10(options.unexplained_below);
  std::vector<double> log10_p(sets.size(), 0.0);  // of each set
  if (instruments != nullptr) {
    std::vector<Columns> bases;
    for (const Offsets& set : sets) bases.push_back(set.basis);
    const std::vector<InstrumentTail> tails = instruments->tails(bases);
    for (std::size_t i = 0; i < sets.size(); ++i) log10_p[i] = correction + tails[i].log10_p;
  }
  if (instruments == nullptr || !instruments->knows_the_noise()) {
    pool.for_each(sets.size(), [&](std::size_t i) {
      if (instruments != nullptr && log10_p[i] > significant) return;
      const NoiseTest::Ratios ratios = null.test->compare(sets[i].basis);
      const auto freedom = static_cast<int>(sets[i].basis.cols());
      double free = correction + NoiseTest::tails(ratios, freedom).log10_p();
      if (free < significant) {
        const NoiseTest::Drawing drawing{
            .draws = options.simulations, .seed = options.seed + i, .smooth = true};
        base::ThreadPool alone(1);
        free = correction + null.test->calibrate(ratios, sets[i].basis, drawing, alone).log10_p();
      }
      log10_p[i] = instruments == nullptr ? free : std::max(log10_p[i], free);
    });
  }
  Omnibus result;
  double least = 0.0;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (room.follows_path() && log10_p[i] < least) {  // noise is common to all outputs there
      const double doubted = log10_block_tail(null, sets[i].basis.dense(layout));
      log10_p[i] = std::max(log10_p[i], correction + doubted);
    }
    if (inputs != nullptr && log10_p[i] < least) {
      log10_p[i] /= inputs->inflation(sets[i].basis.dense(layout));
    }
    if (!(log10_p[i] < least)) continue;
    least = log10_p[i];
    result.where = sets[i].where;
    result.windows = describe_windows(layout, null, sets[i], windows);
  }
  result.p_value = std::pow(10.0, least);
  return result;
}

std::vector<DetectionLimit> find_limits(CandidateRoom& room, const EffectKit& kit,
                                        const NullHypothesis& null,
                                        const InstrumentNoise* instruments, double significance,
                                        std::size_t candidates) {
  std::vector<DetectionLimit> limits;
  if (!room.record().has("time")) return limits;
  const RowLayout& layout = room.fit().layout;
  const auto time = room.record().column("time");
  VectorXd ramp(layout.rows);
  Index at = 0;
  for (const Segment& segment : room.rows()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) ramp[at++] = time[row];
  }
  const double span = ramp.maxCoeff() - ramp.minCoeff();
  if (!(span > 0)) return limits;
  ramp = (ramp.array() - ramp.mean()) / span;
  const auto tests = static_cast<double>(std::max<std::size_t>(1, candidates));
  const double sigmas = upper_normal_point(0.5 * significance / tests) + upper_normal_point(0.1);
  for (const Port& port : kit.ports) {
    try {
      room.open(port);
    } catch (const Error&) {
      continue;
    }
    const MatrixXd columns = room.drive(port, ramp).dense(layout);
    VectorXd seen;  // standard errors of a line of size 1, in each component
    if (instruments != nullptr) {
      seen = instruments->sigmas(remove_tangent(null.basis, columns));
    } else {
      MatrixXd white = columns;
      null.whiten(white);
      seen = remove_span(null.white_basis, white).colwise().norm();
    }
    constexpr double unseen = 1e-6;  // of a column: rounding
    double size = 0.0;
    for (Index k = 0; k < columns.cols(); ++k) {
      const double norm = columns.col(k).norm();
      double own = seen[k] > unseen * norm ? sigmas / seen[k] : infinity;
      if (own * norm > all_that_varies(layout)) own = infinity;
      size = std::max(size, own);
    }
    limits.push_back({port.name, port.unit, size});
  }
  return limits;
}

}  // namespace sepcal::diagnosis
