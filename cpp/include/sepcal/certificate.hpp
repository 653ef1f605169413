// SPDX-License-Identifier: BSD-3-Clause
// What can be proven of a fit's cost, J = 1/2 |R^-1/2 (z - A(xi2) xi1 - b(xi2))|^2 with R held and
// its ln|R| left out: how far below that of one xi2 it can be anywhere in a box (Sun &
// Gebre-Egziabher, Eqs. 7 to 13, and what holds in the place of Eq. 7), and that a fit has found
// its global minimum. By interval arithmetic through the model that is fitted (enclosure.hpp): no
// rounding, no sample and no solver is trusted. docs/method.md has the derivations.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// Of bound_cost(). Where xi1 is not bounded the errors are infinite and `lower` is zero.
struct CostBound {
  double cost = 0.0;  // J(xi2p), least over xi1

  /// The paper's (Eq. 13): E = N/2 l_2^2 (L_A^2 l_1^2 + L_b^2), and what Eq. 7 concludes from it,
  /// J* >= J(xi2p) - E. Eq. 8 squares the triangle inequality term by term, which it doesn't allow:
  /// this is NOT a bound.
  double paper_error = 0.0;
  double paper_lower = 0.0;
  double l_1 = 0.0;  // of |xi1|
  double l_2 = 0.0;  // of |xi2 - xi2p|
  double l_a = 0.0;  // Lipschitz constant of a sample's A over the box, weighted by R^-1/2
  double l_b = 0.0;  // of its b

  /// What holds: J* >= max(0, sqrt J(xi2p) - sqrt E')^2, E' a bound of
  /// 1/2 |R^-1/2 ([A(xi2) - A(xi2p)] xi1 + b(xi2) - b(xi2p))|^2 within the boxes. Proven.
  double joint_error = 0.0;  // E'
  double lower = 0.0;
};

struct CostBoundOptions {
  /// Boxes in the parameters' units, instead of the model's bounds. xi2's must be finite. Where
  /// xi1's are not, they are proven, if they can be, of all xi1 with a cost of at most J(xi2p).
  std::map<std::string, Interval> bounds = {};
  /// Standard deviation of every output; empty: 1.
  std::map<std::string, double> noise = {};
};

/// How far the least cost in the box may be below that at xi2p (n_2, within it). Throws Error where
/// the model can't be enclosed or a nonlinear parameter has no bounds.
CostBound bound_cost(const BlockModel& model, const Record& record, const Eigen::VectorXd& xi2p,
                     const CostBoundOptions& options = {});

enum class Certified {
  global,        // no point of the box has a cost lower than the fit's by more than the tolerance
  elsewhere,     // a lower one was found
  not_certified  // the boxes ran out, or nothing could be proven
};

/// "global", "elsewhere", "not_certified".
std::string_view to_string(Certified status);

struct Certificate {
  Certified status = Certified::not_certified;
  double cost = 0.0;   // J at the fit, rounded upwards
  double lower = 0.0;  // proven: no xi within the bounds has less
  /// Where the minimum may be: of each nonlinear parameter the range of all boxes that are left.
  std::map<std::string, Interval> region = {};
  std::size_t boxes = 0;  // that were bounded
  /// Of a lower one: the parameters and the cost there, rounded upwards.
  std::map<std::string, double> better = {};
  double better_cost = not_a_number;
  std::string message = {};  // one line
};

struct CertificateOptions {
  double tolerance = 1e-6;    // of the cost
  std::size_t boxes = 20000;  // at most; time and memory grow with them
  int threads = 0;            // the caller's included; 0: one a core
};

/// Branch and bound over the box of the nonlinear parameters that the fit has free, with R and the
/// fixed ones as the fit has them. It serves for one or two of them; three take many boxes, and
/// more are refused. `fitted_with`: the options of the fit. Throws Error for a fit of another
/// model, of other rows or bounds, of a loss or with priors, a model that can't be enclosed, a
/// parameter without bounds, and more than three nonlinear ones that are free.
Certificate certify(const BlockModel& model, const Record& record, const Fit& fit,
                    const FitOptions& fitted_with = {}, const CertificateOptions& options = {});

template <SeparableModel M>
Certificate certify(const M& model, const Record& record, const Fit& fit,
                    const FitOptions& fitted_with = {}, const CertificateOptions& options = {}) {
  return certify(StaticModel<M>(model), record, fit, fitted_with, options);
}

template <SeparableModel M>
CostBound bound_cost(const M& model, const Record& record, const Eigen::VectorXd& xi2p,
                     const CostBoundOptions& options = {}) {
  return bound_cost(StaticModel<M>(model), record, xi2p, options);
}

}  // namespace sepcal
