// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/minima.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/sentences.hpp"
#include "base/short_number.hpp"
#include "estimation/refine.hpp"
#include "numerics/basins.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/nearest_points.hpp"
#include "sepcal/detail/identifiability.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The smallest rise of the sum of squares that a record can tell from none: one standard error.
double noticeable_rise(double square, double measurements, double parameters) {
  return square / std::max(1.0, measurements - parameters);
}

/// Whether no point between a and b lies noticeably higher than both.
bool joined(Objective& objective, const Descent& a, const Descent& b, const VectorXd& widths,
            double rise) {
  constexpr double same_point = 1e-6;  // of the widths: not worth a pass over the record
  if ((a.x - b.x).cwiseQuotient(widths).norm() < same_point) return true;
  // Denser towards the ends: a minimum at the edge of the box may lie behind a near, low rise.
  for (const double t : {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98}) {
    const double between = objective.square(a.x + t * (b.x - a.x));
    if (!(between <= std::max(a.square, b.square) + rise)) return false;
  }
  return true;
}

/// The gradient of the sum of squares (half of it) without what bounds hold, in units of the
/// widths.
double slope(Objective& objective, const VectorXd& x, const numerics::Box& box,
             const VectorXd& widths) {
  VectorXd residual;
  MatrixXd jacobian;
  if (!objective.linearise(x, residual, jacobian)) return infinity;
  VectorXd gradient = widths.cwiseProduct(jacobian.transpose() * residual);
  for (Index k = 0; k < x.size(); ++k) {
    const bool held =
        (x[k] <= box.lower[k] && gradient[k] > 0) || (x[k] >= box.upper[k] && gradient[k] < 0);
    if (held) gradient[k] = 0.0;
  }
  return gradient.stableNorm();
}

/// The neighbourhood of a minimum, in which the cost is what its linearisation there says.
class Neighbourhood {
 public:
  Neighbourhood(Objective& objective, const Descent& minimum)
      : x_(minimum.x), known_(objective.linearise(x_, residual_, jacobian_)) {}

  /// Up to the part `alike` of what x lies above the minimum, and `rise`, which the record can't
  /// tell from none.
  bool holds(const VectorXd& x, double square, double rise, double alike) const {
    if (!known_) return false;
    const double predicted = (residual_ + jacobian_ * (x - x_)).squaredNorm();
    const double above = predicted - residual_.squaredNorm();
    return std::abs(square - predicted) <= alike * above + rise;
  }

 private:
  VectorXd x_;
  VectorXd residual_;
  MatrixXd jacobian_;
  bool known_ = false;
};

/// A descent, then its last digits. What the record can't see of the way down, a refinement walks
/// in a step or two; where it finds no minimum, the descent goes on as far as costs can be told
/// apart.
Descent descend_to_last_digits(Objective& objective, const VectorXd& start,
                               const numerics::Box& box, const VectorXd& widths,
                               double measurements, const Descend& descend,
                               const IsKnown& is_known) {
  const double unseen = 0.1 / measurements;  // of the sum of squares
  constexpr double finest = 1e-12;
  Descent descent = descend(start, is_known, std::max(unseen, finest));
  if (descent.left_off || !std::isfinite(descent.square)) return descent;
  Refinement refined = refine(objective, descent.x, box, widths);
  if (!refined.converged && unseen > finest) {
    descent = descend(descent.x, is_known, finest);
    if (descent.left_off || !std::isfinite(descent.square)) return descent;
    refined = refine(objective, descent.x, box, widths);
  }
  // Where residuals are as large as at a minor minimum, steps that take the curvature from the
  // Jacobian alone may lead away before they are seen to grow.
  if (slope(objective, refined.x, box, widths) <= slope(objective, descent.x, box, widths)) {
    descent.x = refined.x;
  }
  descent.square = objective.square(descent.x);
  return descent;
}

/// The samples around each, by which a descent that would end in a known minimum needn't begin.
class SampledSlopes {
 public:
  /// `scaled`: the samples in coordinates of comparable length.
  SampledSlopes(const MatrixXd& samples, const MatrixXd& scaled, const VectorXd& squares)
      : samples_(samples), scaled_(scaled), squares_(squares) {}

  /// Whether a sample and all around it lie about as high as the neighbourhood's linearisation
  /// says. By chance one far away may, not as many as it takes to tell a slope from another.
  bool lead_to(const Neighbourhood& known, Index sample, double measurements, double parameters) {
    constexpr double alike = 0.4;  // samples lie far apart
    const auto holds = [&](Index s) {
      return std::isfinite(squares_[s]) &&
             known.holds(samples_.col(s), squares_[s],
                         noticeable_rise(squares_[s], measurements, parameters), alike);
    };
    const Index count = std::min<Index>(2 * samples_.rows() + 2, samples_.cols() - 1);
    if (!holds(sample)) return false;
    if (!tree_) tree_.emplace(scaled_);
    tree_->find(sample, count, around_);
    return std::ranges::all_of(around_, holds);
  }

 private:
  const MatrixXd& samples_;
  const MatrixXd& scaled_;
  const VectorXd& squares_;
  std::optional<numerics::NearestPoints> tree_ = {};  // most fits ask for none
  std::vector<Index> around_ = {};
};

}  // namespace

VectorXd half_widths(const Problem& problem) {
  const std::vector<Variable> parameters = problem.nonlinear();
  VectorXd widths(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < widths.size(); ++k) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    widths[k] = 0.5 * (parameter.upper - parameter.lower);
    const auto drawn = problem.options().sampling_distribution.find(parameter.name);
    if (drawn != problem.options().sampling_distribution.end()) {
      widths[k] = std::min(widths[k], 2.0 * drawn->second.standard_deviation);
    }
    if (!std::isfinite(widths[k])) widths[k] = 1.0;
  }
  return widths;
}

std::vector<Descent> find_minima(Objective& objective, const Problem& problem,
                                 const MatrixXd& samples, const VectorXd& squares,
                                 const MatrixXd& guesses, double measurements,
                                 const Descend& descend) {
  const VectorXd widths = half_widths(problem);
  const MatrixXd scaled = widths.cwiseInverse().asDiagonal() * samples;
  std::vector<numerics::Basin> basins =
      numerics::find_basins(scaled, squares.array().log().matrix());  // depth as a ratio
  basins.resize(std::min(basins.size(), static_cast<std::size_t>(problem.options().descents)));
  const auto n = static_cast<double>(problem.parameters().size());
  SampledSlopes slopes(samples, scaled, squares);
  std::vector<Descent> minima;
  std::vector<Neighbourhood> neighbourhoods;  // theirs
  const auto descend_from = [&](const VectorXd& start) {
    // By chance a point far away may lie as high as a linearisation says, two in a row hardly.
    std::vector<int> held(neighbourhoods.size(), 0);
    const IsKnown is_known = [&](const VectorXd& x, double square) {
      const double rise = noticeable_rise(square, measurements, n);
      bool known = false;
      for (std::size_t i = 0; i < held.size(); ++i) {
        held[i] = neighbourhoods[i].holds(x, square, rise, 0.1) ? held[i] + 1 : 0;
        known = known || held[i] == 2;
      }
      return known;
    };
    Descent descent = descend_to_last_digits(objective, start, problem.nonlinear_box(), widths,
                                             measurements, descend, is_known);
    if (descent.left_off || !std::isfinite(descent.square)) return;
    const auto same = std::ranges::find_if(minima, [&](const Descent& other) {
      const double lower = std::min(descent.square, other.square);
      return joined(objective, descent, other, widths, noticeable_rise(lower, measurements, n));
    });
    if (same == minima.end()) {
      neighbourhoods.emplace_back(objective, descent);
      minima.push_back(std::move(descent));
    } else if (descent.square < same->square) {
      neighbourhoods[static_cast<std::size_t>(same - minima.begin())] =
          Neighbourhood(objective, descent);
      *same = std::move(descent);
    }
  };
  for (const numerics::Basin& basin : basins) {
    const bool known = std::ranges::any_of(neighbourhoods, [&](const Neighbourhood& neighbourhood) {
      return slopes.lead_to(neighbourhood, basin.lowest, measurements, n);
    });
    if (!known) descend_from(samples.col(basin.lowest));
  }
  for (const auto guess : guesses.colwise()) {
    if (std::isfinite(objective.square(guess))) descend_from(guess);
  }
  std::ranges::stable_sort(minima, {}, &Descent::square);
  return minima;
}

std::vector<std::string> describe_flat_directions(Objective& objective, const Problem& problem,
                                                  const VectorXd& xi2, double measurements) {
  VectorXd residual;
  MatrixXd jacobian;
  if (xi2.size() == 0 || !objective.linearise(xi2, residual, jacobian)) return {};
  const double rise = noticeable_rise(objective.square(xi2), measurements,
                                      static_cast<double>(problem.parameters().size()));
  const VectorXd widths = half_widths(problem);
  const Eigen::JacobiSVD<MatrixXd> svd(jacobian * widths.asDiagonal(), Eigen::ComputeFullV);
  const auto& singular = svd.singularValues();
  const double epsilon = 1e-13 * singular[0];
  const auto flat = (singular.array() <= std::max(2.0 * std::sqrt(rise), epsilon)).count();
  const MatrixXd directions = sparsify(svd.matrixV().rightCols(flat));
  std::vector<std::string> names;
  for (const Variable& parameter : problem.nonlinear()) names.push_back(parameter.name);
  std::vector<std::string> texts;
  for (Index i = 0; i < flat; ++i) {
    VectorXd direction = directions.col(i);
    for (double& share : direction) share = std::abs(share) > 0.1 ? share : 0.0;
    texts.push_back(combination_text(widths.cwiseProduct(direction), names));
  }
  return texts;
}

std::string describe_other_minima(const Problem& problem, const std::vector<LocalMinimum>& minima) {
  constexpr double rivals = 2.0;  // in residuals
  const std::vector<Variable> parameters = problem.nonlinear();
  std::string text;
  int more = 0;
  for (std::size_t i = 1; i < minima.size(); ++i) {
    const double ratio = std::sqrt(minima[i].trace_r / minima[0].trace_r);
    if (!(ratio < rivals)) break;
    if (!text.empty()) {
      ++more;
      continue;
    }
    text = "another minimum lies at ";
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const double value = minima[i].xi2[static_cast<Index>(k)];
      text += (k == 0 ? "" : ", ") + parameters[k].name + " " + base::short_number(value);
    }
    text += ratio < 1.005
                ? ", where residuals are as small"
                : ", where residuals are " + base::short_number(ratio) + " times as large";
  }
  if (more > 0) text += ", and " + std::to_string(more) + " more (see stage_one)";
  return base::one_sentence(text);
}

}  // namespace sepcal::estimation
