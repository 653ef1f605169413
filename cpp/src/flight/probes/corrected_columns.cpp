// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/corrected_columns.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace probes;  // this room's own

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

constexpr std::array axes{"x", "y", "z"};
constexpr std::array field_names{"hx", "hy", "hz"};
constexpr std::array field_rate{"hx_dot", "hy_dot", "hz_dot"};

void check_invertible(const Matrix3d& C) {
  if (Eigen::FullPivLU<Matrix3d>(C).isInvertible()) return;
  throw Error(
      "the calibration's matrix C is singular, so it can't be applied; fit it on more attitudes");
}

/// C with what the effects add to it in a row.
Matrix3d matrix_at(const Matrix3d& C, const ReadingEffects& effects, std::size_t row) {
  Matrix3d result = C;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Index>(i);
    result(axis, axis) +=
        effects.at("scale.s", row) + effects.at(std::string("axis_scale.") + axes[i], row);
  }
  return result;
}

/// dh/dt = -w x h, row by row as a matrix that takes h: known where the body rates are.
std::optional<std::array<std::span<const double>, 3>> body_rates(const Record& record) {
  if (!record.has("p") || !record.has("q") || !record.has("r")) return std::nullopt;
  return std::array{record.column("p"), record.column("q"), record.column("r")};
}

Matrix3d turning(const std::array<std::span<const double>, 3>& w, std::size_t row) {
  Matrix3d minus_cross;
  minus_cross << 0, w[2][row], -w[1][row],  //
      -w[2][row], 0, w[0][row],             //
      w[1][row], -w[0][row], 0;
  return minus_cross;
}

/// Rates of a field given at the rows of a record, within its segments: from the body rates, or by
/// differences.
void fill_rates(const Record& record, const MatrixXd& h, MatrixXd& rates) {
  rates.setZero(h.rows(), 3);
  if (const auto w = body_rates(record)) {
    for (Index i = 0; i < h.rows(); ++i) {
      rates.row(i) = (turning(*w, static_cast<std::size_t>(i)) * h.row(i).transpose()).transpose();
    }
    return;
  }
  const auto time = record.column("time");
  for (const Segment& segment : record.segments()) {
    if (segment.rows() < 2) continue;
    const auto part = time.subspan(segment.first, segment.rows());
    for (Index axis = 0; axis < 3; ++axis) {
      const double* values = h.col(axis).data() + segment.first;
      const NaturalSpline spline({part.begin(), part.end()}, {values, values + segment.rows()});
      std::size_t near = 0;
      for (std::size_t i = 0; i < segment.rows(); ++i) {
        rates(static_cast<Index>(segment.first + i), axis) = spline.at(part[i], near).slope;
      }
    }
  }
}

/// The place of an input among three names, or 3.
std::size_t place_in(const std::array<const char*, 3>& names, const std::string& input) {
  return static_cast<std::size_t>(std::ranges::find(names, input) - names.begin());
}

bool reads_rates(const ReadingEffects& effects) {
  return std::ranges::any_of(effects.terms, [](const ReadingEffects::Term& term) {
    return std::ranges::any_of(term.model->tables().inputs, [](const Variable& input) {
      return place_in(field_rate, input.name) < 3;
    });
  });
}

/// A term's share in the readings at the field h (rows x 3), and by the field (rows x 9: output by
/// output); its rate's part in that only where the body rates are known.
void add_term(const ReadingEffects::Term& term, const Record& record, const MatrixXd& h,
              const MatrixXd& rates, MatrixXd& share, MatrixXd& by_field) {
  const Index rows = h.rows();
  std::vector<const double*> inputs;
  std::vector<int> moving;
  std::vector<std::pair<bool, Index>> axis_of;  // whether of the rate, and which
  for (const Variable& input : term.model->tables().inputs) {
    const std::size_t axis = place_in(field_names, input.name);
    const std::size_t of_rate = place_in(field_rate, input.name);
    if (axis == 3 && of_rate == 3) {
      inputs.push_back(record.column(input.name).data());
      continue;
    }
    moving.push_back(static_cast<int>(inputs.size()));
    const auto at = static_cast<Index>(std::min(axis, of_rate));
    axis_of.emplace_back(axis == 3, at);
    inputs.push_back(axis == 3 ? rates.col(at).data() : h.col(at).data());
  }
  const Block block{inputs, static_cast<std::size_t>(rows), 0, true};
  const Index n_1 = term.xi1.size();
  MatrixXd values(3 * rows, n_1 + 1);
  term.model->evaluate(block, values_of(term.xi2), nullptr, nullptr, values);
  share += (values.leftCols(n_1) * term.xi1 + values.col(n_1)).reshaped(rows, 3);
  if (moving.empty()) return;
  MatrixXd slopes(3 * rows, static_cast<Index>(moving.size()));
  term.model->input_tangent(block, values_of(term.xi2), values_of(term.xi1), moving, slopes);
  const auto w = body_rates(record);
  for (std::size_t k = 0; k < axis_of.size(); ++k) {
    const auto [is_rate, axis] = axis_of[k];
    if (is_rate && !w) continue;
    for (Index i = 0; i < rows; ++i) {
      const auto row = static_cast<std::size_t>(i);
      Eigen::RowVector3d by_h = Eigen::RowVector3d::Unit(axis);
      if (is_rate && w) by_h = turning(*w, row).row(axis);
      for (Index output = 0; output < 3; ++output) {
        by_field.row(i).segment<3>(3 * output) +=
            slopes(output * rows + i, static_cast<Index>(k)) * by_h;
      }
    }
  }
}

}  // namespace

double ReadingEffects::at(const std::string& port_component, std::size_t row) const {
  const auto total = totals.find(port_component);
  return total == totals.end() ? 0.0 : total->second[static_cast<Index>(row)];
}

std::vector<CorrectedColumn> probes::empty_columns(const std::vector<std::string>& headers,
                                                   std::size_t rows) {
  std::vector<CorrectedColumn> columns;
  for (const std::string& header : headers) {
    columns.push_back({header, std::vector(rows, std::numeric_limits<double>::quiet_NaN())});
  }
  return columns;
}

std::vector<CorrectedColumn> probes::correct_field(const ProbeReadings& readings, const Matrix3d& C,
                                                   const Vector3d& n,
                                                   const std::vector<std::string>& headers,
                                                   const ReadingEffects& effects) {
  constexpr int most_steps = 20;
  constexpr double tolerance = 1e-9;  // [uT] of a step
  check_invertible(C);
  const std::array m{readings.record.column("mx"), readings.record.column("my"),
                     readings.record.column("mz")};
  const auto rows = static_cast<Index>(m[0].size());
  MatrixXd h = MatrixXd::Zero(rows, 3);
  MatrixXd rates = MatrixXd::Zero(rows, 3);
  const bool stepwise = !effects.terms.empty();
  const bool with_rates = reads_rates(effects);
  const bool by_differences = with_rates && !body_rates(readings.record);
  std::vector<bool> solved(readings.valid.size(), !stepwise);
  double before = infinity;
  for (int step = 0; step < (stepwise ? most_steps : 1); ++step) {
    MatrixXd changed = h;
    MatrixXd share = MatrixXd::Zero(rows, 3);
    MatrixXd by_field = MatrixXd::Zero(rows, 9);
    if (with_rates) fill_rates(readings.record, h, rates);
    for (const ReadingEffects::Term& term : effects.terms) {
      add_term(term, readings.record, h, rates, share, by_field);
    }
    double longest = 0.0;
    for (Index i = 0; i < rows; ++i) {
      const auto row = static_cast<std::size_t>(i);
      if (!readings.valid[row]) continue;
      const Matrix3d at = matrix_at(C, effects, row);
      Vector3d missing = n + at * h.row(i).transpose() + share.row(i).transpose();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        missing[static_cast<Index>(axis)] +=
            effects.at(std::string("bias.") + axes[axis], row) - m[axis][row];
      }
      const Matrix3d slope = by_field.row(i).reshaped(3, 3).transpose();
      const Vector3d change = (at + slope).partialPivLu().solve(-missing);
      changed.row(i) += change.transpose();
      const double size = change.cwiseAbs().maxCoeff();
      if (stepwise) solved[row] = by_differences || (change.allFinite() && size < tolerance);
      if (!solved[row] || by_differences) longest = std::max(longest, size);
    }
    // A noisy rate by differences doesn't settle, and one row's field is another's rate.
    if (by_differences && step > 1 && longest >= before) break;
    h = changed;
    if (longest < tolerance) break;
    before = longest;
  }
  auto columns = empty_columns(headers, m[0].size());
  for (std::size_t i = 0; i < m[0].size(); ++i) {
    if (!readings.valid[i] || !solved[i]) continue;  // no field gives what was read
    for (std::size_t axis = 0; axis < 3; ++axis) {
      columns[axis].values[i] = h(static_cast<Index>(i), static_cast<Index>(axis));
    }
  }
  return columns;
}

}  // namespace sepcal
