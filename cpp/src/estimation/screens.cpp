// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/screens.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "estimation/minima.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/symmetric.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Sums over the record of what belongs to A and what belongs to b.
struct Sums {
  double square_a = 0.0;  // |A|^2
  double square_b = 0.0;
  double slope_a = 0.0;  // |dA/dxi2|^2
  double slope_b = 0.0;
  MatrixXd curvature_a;  // n_2 x n_2: second derivatives, summed over all entries
  MatrixXd curvature_b;
};

/// The tangent D of blocks at one xi2 for several xi1: D is affine in xi1, so dA_p/dxi2 = D(e_p) -
/// D(0), and db/dxi2 = D(0).
class Tangents {
 public:
  Tangents(const BlockModel& model, const model::Measurements& measurements)
      : model_(model), measurements_(measurements) {}

  const BlockModel& model() const { return model_; }
  Index n_1() const { return model_.tables().n_1(); }
  Index n_2() const { return model_.tables().n_2(); }

  /// visit(block, rows): [A | D | b] of every block at xi2, one for each column of `xi1` (n_1 x m).
  template <class Visit>
  void for_each_block(const VectorXd& xi2, const MatrixXd& xi1, const Visit& visit) const {
    std::vector<const double*> pointers;
    std::vector<MatrixXd> rows(static_cast<std::size_t>(xi1.cols()));
    for (const auto& chunk : measurements_.chunks()) {
      std::vector<std::unique_ptr<Carry>> carries;
      for (Index m = 0; m < xi1.cols(); ++m) carries.push_back(model_.new_carry());
      for (const model::Measurements::Range& range : chunk) {
        const Block block = measurements_.block(range, pointers);
        const auto height = static_cast<Index>(range.rows) * model_.tables().n_z();
        for (std::size_t m = 0; m < rows.size(); ++m) {
          rows[m].resize(height, n_1() + n_2() + 1);
          const VectorXd linear = xi1.col(static_cast<Index>(m));
          model_.evaluate(block, values_of(xi2), values_of(linear), carries[m].get(), rows[m]);
        }
        visit(block, rows);
      }
      measurements_.release(chunk);
    }
  }

 private:
  const BlockModel& model_;
  const model::Measurements& measurements_;
};

/// Columns of xi1: zero and, for A's part, every unit vector.
MatrixXd unit_vectors(Index n_1) {
  MatrixXd xi1 = MatrixXd::Zero(n_1, n_1 + 1);
  xi1.rightCols(n_1).setIdentity();
  return xi1;
}

/// Columns of xi1: zero and ones; what D(ones) has more than D(0) is the sum of all dA_p/dxi2.
MatrixXd zero_and_ones(Index n_1) {
  MatrixXd xi1 = MatrixXd::Zero(n_1, 2);
  xi1.col(1).setOnes();
  return xi1;
}

/// The sum of dA/dxi2 over all entries, then that of db/dxi2 (n_2 x 2).
MatrixXd summed_slopes(const Tangents& tangents, const VectorXd& xi2) {
  MatrixXd sums = MatrixXd::Zero(tangents.n_2(), 2);
  tangents.for_each_block(
      xi2, zero_and_ones(tangents.n_1()), [&](const Block&, const std::vector<MatrixXd>& rows) {
        const auto slopes = [&](std::size_t m) -> VectorXd {
          return rows[m].middleCols(tangents.n_1(), tangents.n_2()).colwise().sum();
        };
        sums.col(0) += slopes(1) - slopes(0);
        sums.col(1) += slopes(0);
      });
  return sums;
}

/// Second derivatives as central differences of the first, for models that don't know them.
void difference_slopes(const Tangents& tangents, const VectorXd& xi2, const VectorXd& widths,
                       Sums& sums) {
  constexpr double step = 1e-4;  // of the widths: an error of 1e-8 of the third derivative's part
  for (Index k = 0; k < xi2.size(); ++k) {
    VectorXd above = xi2;
    VectorXd below = xi2;
    above[k] += step * widths[k];
    below[k] -= step * widths[k];
    const MatrixXd slope =
        (summed_slopes(tangents, above) - summed_slopes(tangents, below)) / (above[k] - below[k]);
    sums.curvature_a.col(k) = slope.col(0);
    sums.curvature_b.col(k) = slope.col(1);
  }
}

Sums sum_over_record(const Tangents& tangents, const VectorXd& xi2, const VectorXd& widths) {
  const Index n_1 = tangents.n_1();
  const Index n_2 = tangents.n_2();
  Sums sums;
  MatrixXd curvature_zero = MatrixXd::Zero(n_2, n_2);
  MatrixXd curvature_ones = MatrixXd::Zero(n_2, n_2);
  const VectorXd zero = VectorXd::Zero(n_1);
  const VectorXd ones = VectorXd::Ones(n_1);
  bool known = true;
  tangents.for_each_block(xi2, unit_vectors(n_1),
                          [&](const Block& block, const std::vector<MatrixXd>& rows) {
                            sums.square_a += rows[0].leftCols(n_1).squaredNorm();
                            sums.square_b += rows[0].rightCols<1>().squaredNorm();
                            const auto D_0 = rows[0].middleCols(n_1, n_2);
                            sums.slope_b += D_0.squaredNorm();
                            for (std::size_t p = 1; p < rows.size(); ++p) {
                              sums.slope_a += (rows[p].middleCols(n_1, n_2) - D_0).squaredNorm();
                            }
                            known = known &&
                                    tangents.model().add_second_derivatives(
                                        block, values_of(xi2), values_of(zero), curvature_zero) &&
                                    tangents.model().add_second_derivatives(
                                        block, values_of(xi2), values_of(ones), curvature_ones);
                          });
  sums.curvature_a = curvature_ones - curvature_zero;
  sums.curvature_b = curvature_zero;
  if (!known) difference_slopes(tangents, xi2, widths, sums);
  return sums;
}

/// |dX/dxi2| l_2 / |X|; zero where X does not depend on xi2, b = 0 among others.
double ratio(double slope_square, double square, double l_2) {
  return slope_square == 0.0 ? 0.0 : std::sqrt(slope_square / square) * l_2;
}

/// The smallest eigenvalue of the second derivatives, in units of the widths, which don't touch
/// its sign; zero below 1e-8 of the largest, which rounding and differences leave.
double smallest_curvature(const MatrixXd& curvature, const VectorXd& widths) {
  if (!curvature.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const MatrixXd scaled = widths.asDiagonal() * curvature * widths.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(numerics::symmetric_part(scaled),
                                                       Eigen::EigenvaluesOnly);
  const VectorXd& values = solver.eigenvalues();
  constexpr double rounding = 1e-8;
  const bool is_zero = std::abs(values[0]) <= rounding * values.cwiseAbs().maxCoeff();
  return is_zero ? 0.0 : values[0];
}

/// How far the solution may lie from xi2: given, or to the farthest corner of the bounds.
double reach(const Screens& screens, const VectorXd& xi2, const numerics::Box& box) {
  if (screens.l_2 > 0.0) return screens.l_2;
  return (box.upper - xi2).cwiseMax(xi2 - box.lower).norm();
}

void check_reach(const Screens& screens, const std::vector<Variable>& parameters) {
  for (const Variable& parameter : parameters) {
    if (screens.l_2 > 0.0 || std::isfinite(parameter.upper - parameter.lower)) continue;
    throw Error("nonlinear parameter '" + parameter.name +
                "' has no finite bounds, from which the screens' l_2 would follow; give it bounds "
                "or give l_2");
  }
}

std::string short_number(double value) {
  constexpr int digits = 3;
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

/// Three digits, no less than `value`.
std::string at_least(double value) {
  constexpr double half_a_digit = 1.005;
  return short_number(half_a_digit * value);
}

}  // namespace

ScreenResults screen(const Problem& problem, const Screens& screens,
                     const model::Measurements& measurements, const MatrixXd& samples,
                     base::ThreadPool& pool) {
  check_reach(screens, problem.nonlinear());
  const Tangents tangents(problem.model(), measurements);
  const VectorXd widths = half_widths(problem);
  const numerics::Box box = problem.nonlinear_box();
  const Index count = samples.cols();
  ScreenResults results{VectorXd(count), VectorXd(count), VectorXd(count), VectorXd(count),
                        Eigen::Array<bool, Eigen::Dynamic, 1>(count)};
  pool.for_each(static_cast<std::size_t>(count), [&](std::size_t task) {
    const auto s = static_cast<Index>(task);
    const VectorXd xi2 = samples.col(s);
    const Sums sums = sum_over_record(tangents, xi2, widths);
    const double l_2 = reach(screens, xi2, box);
    results.ratio_a[s] = ratio(sums.slope_a, sums.square_a, l_2);
    results.ratio_b[s] = ratio(sums.slope_b, sums.square_b, l_2);
    results.curvature_a[s] = smallest_curvature(sums.curvature_a, widths);
    results.curvature_b[s] = smallest_curvature(sums.curvature_b, widths);
    const bool convex = (sums.slope_a == 0.0 || results.curvature_a[s] > 0.0) &&
                        (sums.slope_b == 0.0 || results.curvature_b[s] > 0.0);
    results.accepted[s] = results.ratio_a[s] <= screens.t_1 && results.ratio_b[s] <= screens.t_2 &&
                          (convex || !screens.convex);
  });
  return results;
}

void check_some_accepted(const Screens& screens, const ScreenResults& results,
                         const VectorXd& trace_r) {
  Index nearest = -1;
  double least_excess = infinity;
  bool any_ratio_met = false;
  for (Index s = 0; s < trace_r.size(); ++s) {
    if (!std::isfinite(trace_r[s])) continue;
    if (results.accepted[s]) return;
    const double excess =
        std::max(results.ratio_a[s] / screens.t_1, results.ratio_b[s] / screens.t_2);
    any_ratio_met = any_ratio_met || excess <= 1.0;
    if (excess < least_excess) {
      least_excess = excess;
      nearest = s;
    }
  }
  std::string way_out;
  const auto loosen = [&](const char* name, double value, double threshold) {
    if (value <= threshold) return;
    way_out += (way_out.empty() ? "loosen " : " and ") + std::string(name) + " to at least " +
               at_least(value);
  };
  if (!any_ratio_met && nearest >= 0) {
    loosen("t_1", results.ratio_a[nearest], screens.t_1);
    loosen("t_2", results.ratio_b[nearest], screens.t_2);
  } else {
    way_out = "those that meet Eq. 17 are not convex by Eq. 18; don't ask for convex";
  }
  throw Error("the screens reject all " + std::to_string(trace_r.size()) +
              " samples of the nonlinear parameters (t_1 = " + short_number(screens.t_1) +
              ", t_2 = " + short_number(screens.t_2) + "): " + way_out);
}

}  // namespace sepcal::estimation
