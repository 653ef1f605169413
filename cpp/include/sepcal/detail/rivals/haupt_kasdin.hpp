// SPDX-License-Identifier: BSD-3-Clause
// The two-step estimator of Haupt, Kasdin, Keiser & Parkinson (J. Guid. Control Dyn. 19, 1996), as
// Sun & Gebre-Egziabher, Sec. III.B, have it: states y = f(xi) in which the measurements are
// linear,
//   z = H y + b + v        first step: linear least squares (Eqs. 28-30)
//   y-hat = f(xi) + e      second step: a nonlinear fit to the first one's estimate (Eqs. 31, 32)
// weighted by the first step's information H' R^-1 H. Eq. 32 asks for the inverse of P_y, which
// does not exist where columns of H repeat one another, as in the paper's own Eq. 28; the
// information does, and is the same where both do.
#pragma once

#include <ceres/jet.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/rivals/single_stage.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal::rivals {

/// y = f(xi): what the first step's p states are of the n parameters.
class ChangeOfVariables {
 public:
  ChangeOfVariables() = default;
  ChangeOfVariables(const ChangeOfVariables&) = delete;
  ChangeOfVariables& operator=(const ChangeOfVariables&) = delete;
  virtual ~ChangeOfVariables() = default;

  virtual const std::vector<Variable>& parameters() const = 0;          // n
  virtual Eigen::VectorXd at(const Eigen::VectorXd& xi) const = 0;      // p
  virtual Eigen::MatrixXd slopes(const Eigen::VectorXd& xi) const = 0;  // p x n, df/dxi
};

/// Both steps in a struct:
///   inputs, outputs, states, parameters   tables
///   rows(u)      an Affine<double, n_z, p>: H and b of a sample
///   states_at(xi)  f, a template in xi's number type
template <class P>
class StaticChange final : public ChangeOfVariables {
 public:
  explicit StaticChange(P problem)
      : problem_(std::move(problem)), parameters_(P::parameters.begin(), P::parameters.end()) {}

  const std::vector<Variable>& parameters() const override { return parameters_; }

  Eigen::VectorXd at(const Eigen::VectorXd& xi) const override {
    return problem_.states_at(Vec<double, n>(xi));
  }

  Eigen::MatrixXd slopes(const Eigen::VectorXd& xi) const override {
    using Dual = ceres::Jet<double, n>;
    Vec<Dual, n> x;
    for (int k = 0; k < n; ++k) x[k] = Dual(xi[k], k);
    const Vec<Dual, p> y = problem_.states_at(x);
    Eigen::MatrixXd slopes(p, n);
    for (int i = 0; i < p; ++i) slopes.row(i) = y[i].v.transpose();
    return slopes;
  }

 private:
  static constexpr int n = static_cast<int>(P::parameters.size());
  static constexpr int p = static_cast<int>(P::states.size());

  P problem_;
  std::vector<Variable> parameters_;
};

/// The first step as a model whose parameters, all linear, are the states.
template <class P>
struct FirstStepModel {
  static constexpr auto inputs = P::inputs;
  static constexpr auto outputs = P::outputs;
  static constexpr auto linear = P::states;
  static constexpr std::array<Quantity, 0> nonlinear{};

  P problem;

  auto at(const Vec<double, static_cast<int>(P::inputs.size())>& u,
          const Vec<double, 0>& /*xi2*/) const {
    return problem.rows(u);
  }
};

struct HauptKasdinOptions {
  /// Of parameters, instead of the table's.
  std::map<std::string, Interval> bounds = {};
  std::map<std::string, double> noise = {};     // of every output; empty: R is estimated
  std::string segments = {};                    // as in Record::select(); empty: all
  Solver solver = Solver::levenberg_marquardt;  // of the second step
  int evaluations = 1000;
  int threads = 0;
};

struct FirstStep {
  std::vector<std::string> names;  // p
  Eigen::VectorXd states;          // p, of least norm in columns of unit length where H is singular
  Eigen::MatrixXd information;     // p x p, H' R^-1 H
  int rank = 0;                    // of H
  double condition = 0.0;          // of H, columns of unit length; infinite where one is zero
  std::vector<OutputValue> noise;  // standard deviations
};

struct HauptKasdinFit {
  FirstStep first;
  bool converged = false;           // as the second step's solver says
  std::vector<std::string> names;   // n
  Eigen::VectorXd estimates;        // n
  Eigen::VectorXd standard_errors;  // n; NaN where the states leave parameters open
  Eigen::MatrixXd covariance;       // n x n, (F' H' R^-1 H F)^-1, F = df/dxi at the estimates
  double cost = 0.0;                // of Eq. 32
  int evaluations = 0;
};

/// `first_step`: a model without nonlinear parameters, whose linear ones are the states. `start`:
/// of the second step, by name; parameters not named begin at zero. Throws Error for a model with
/// nonlinear parameters, another number of states, and misuse as fit() does.
HauptKasdinFit fit_haupt_kasdin(const BlockModel& first_step, const Record& record,
                                const ChangeOfVariables& change,
                                const std::map<std::string, double>& start,
                                const HauptKasdinOptions& options = {});

template <class P>
HauptKasdinFit fit_haupt_kasdin(const P& problem, const Record& record,
                                const std::map<std::string, double>& start,
                                const HauptKasdinOptions& options = {}) {
  return fit_haupt_kasdin(StaticModel<FirstStepModel<P>>(FirstStepModel<P>{problem}), record,
                          StaticChange<P>(problem), start, options);
}

}  // namespace sepcal::rivals
