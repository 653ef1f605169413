// SPDX-License-Identifier: BSD-3-Clause
// A sum of squares by a formula, where a compressed record would stand: what searches do with a
// cost is then known in closed form.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <limits>
#include <memory>

#include "estimation/objective.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal::test {

/// z = s + x u + y u^2: xi2 of two parameters within [-2, 2], for formulas of one or two.
struct Plane {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"s", "1"}};
  static constexpr std::array nonlinear{Quantity{"x", "1", -2, 2}, Quantity{"y", "1", -2, 2}};
  template <class U, class X>
  Affine<X, 1, 1> at(const Vec<U, 1>& u, const Vec<X, 2>& xi2) const {
    Affine<X, 1, 1> z;
    z.A << X(1.0);
    z.b << xi2[0] * u[0] + xi2[1] * u[0] * u[0];
    return z;
  }
};

/// A record of five rows, which an objective must have and a formula does not ask.
class Unasked {
 public:
  Unasked() : model_(block_model(Plane{})), pool_(1) {
    record_.add("u", {1.0, 2.0, 3.0, 4.0, 5.0}).add("z", {0.0, 0.0, 0.0, 0.0, 0.0});
    measurements_ = std::make_unique<model::Measurements>(*model_, record_);
    sweep_ = std::make_unique<model::Sweep>(*model_, *measurements_, pool_);
  }
  const model::Sweep& sweep() const { return *sweep_; }
  const BlockModel& model() const { return *model_; }

 private:
  std::shared_ptr<const BlockModel> model_;
  Record record_;
  base::ThreadPool pool_;
  std::unique_ptr<model::Measurements> measurements_;
  std::unique_ptr<model::Sweep> sweep_;
};

/// r(x) (m) and its Jacobian (m x n); false where they are not finite.
using Residual =
    std::function<bool(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J)>;

class FormulaObjective final : public estimation::Objective {
 public:
  FormulaObjective(const Unasked& unasked, int m, int n, Residual residual)
      : estimation::Objective(unasked.sweep(), Eigen::VectorXd::Ones(1)),
        m_(m),
        n_(n),
        residual_(std::move(residual)) {}

  int parameters() const override { return n_; }
  double square(const Eigen::VectorXd& x) override {
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    return linearise(x, r, J) ? r.squaredNorm() : std::numeric_limits<double>::infinity();
  }
  bool linearise(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) override {
    r.resize(m_);
    J.resize(m_, n_);
    return residual_(x, r, J);
  }

 private:
  int m_;
  int n_;
  Residual residual_;
};

}  // namespace sepcal::test
