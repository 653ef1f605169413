// SPDX-License-Identifier: BSD-3-Clause
// A random time-varying linear system, and what its outputs say of its states and noises by brute
// force: every x(k), y(k) is a linear function of one Gaussian vector (x0, w, v), which is
// conditioned on the outputs at once. No recursion, nothing of sepcal.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "draws.hpp"

namespace sepcal::test {

struct RandomSystem {
  static constexpr int n = 3;    // states
  static constexpr int m = 2;    // outputs
  static constexpr int n_w = 2;  // noises
  static constexpr int n_u = 1;  // inputs
  static constexpr int samples = 7;

  struct Sample {
    Eigen::Matrix<double, n, n> Phi;
    Eigen::Matrix<double, n, n_u> Psi;
    Eigen::Matrix<double, n, n_w> Gamma;
    Eigen::Matrix<double, n_w, n_w> Q;  // full
    Eigen::Matrix<double, m, n> C;
    Eigen::Matrix<double, m, n_u> D;
    Eigen::Matrix<double, m, m> R;  // full
    Eigen::Vector<double, n_u> u;
    Eigen::Vector<double, m> y;
  };

  std::vector<Sample> at;
  Eigen::Vector<double, n> x0;
  Eigen::Matrix<double, n, n> P0;

  explicit RandomSystem(std::uint64_t seed) {
    Draws draws(seed);
    const auto covariance = [&draws](int size) {
      const Eigen::MatrixXd root = draws.normal_matrix(size, size + 1);
      return Eigen::MatrixXd(root * root.transpose() / size);
    };
    x0 = draws.normal_matrix(n, 1);
    P0 = covariance(n);
    for (int k = 0; k < samples; ++k) {
      at.push_back({draws.normal_matrix(n, n), draws.normal_matrix(n, n_u),
                    draws.normal_matrix(n, n_w), covariance(n_w), draws.normal_matrix(m, n),
                    draws.normal_matrix(m, n_u), covariance(m), draws.normal_matrix(n_u, 1),
                    2.0 * draws.normal_matrix(m, 1)});
    }
  }

  /// The same with outputs that were not measured.
  void lose(int k, int output) {
    at[static_cast<std::size_t>(k)].y[output] = std::numeric_limits<double>::quiet_NaN();
  }
};

struct Gaussian {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

class Conditioning {
 public:
  explicit Conditioning(const RandomSystem& system) : system_(system) {
    constexpr int n = RandomSystem::n;
    constexpr int n_w = RandomSystem::n_w;
    constexpr int m = RandomSystem::m;
    constexpr int N = RandomSystem::samples;
    dimension_ = n + N * (n_w + m);
    Sigma_ = Eigen::MatrixXd::Zero(dimension_, dimension_);
    Sigma_.topLeftCorner(n, n) = system.P0;
    Eigen::VectorXd offset = system.x0;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Identity(n, dimension_);
    for (int k = 0; k < N; ++k) {
      const auto& sample = system.at[static_cast<std::size_t>(k)];
      const int w = n + k * (n_w + m);
      Sigma_.block(w, w, n_w, n_w) = sample.Q;
      Sigma_.block(w + n_w, w + n_w, m, m) = sample.R;
      states_.push_back({offset, rows});
      Affine noise{Eigen::VectorXd::Zero(n_w), Eigen::MatrixXd::Zero(n_w, dimension_)};
      noise.rows.middleCols(w, n_w).setIdentity();
      noises_.push_back(noise);
      Affine output{sample.C * offset + sample.D * sample.u, sample.C * rows};
      output.rows.middleCols(w + n_w, m) += Eigen::MatrixXd::Identity(m, m);
      outputs_.push_back(output);
      offset = (sample.Phi * offset + sample.Psi * sample.u).eval();
      rows = (sample.Phi * rows + sample.Gamma * noise.rows).eval();
    }
  }

  /// x(k) given y(0) ... y(until); until = -1: given nothing.
  Gaussian state(int k, int until) const { return given(states_[index(k)], until); }
  Gaussian noise(int k, int until) const { return given(noises_[index(k)], until); }

  /// -ln of the joint density of all outputs that were measured.
  double minus_log_density() const {
    const Affine all = measured(RandomSystem::samples - 1);
    const Eigen::MatrixXd Lambda = all.rows * Sigma_ * all.rows.transpose();
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(Lambda);
    return 0.5 * (all.offset.dot(ldlt.solve(all.offset)) + ldlt.vectorD().array().log().sum() +
                  static_cast<double>(Lambda.rows()) * std::log(2.0 * std::numbers::pi));
  }

 private:
  struct Affine {  // offset + rows (x0 - mean, w, v)
    Eigen::VectorXd offset;
    Eigen::MatrixXd rows;
  };

  static std::size_t index(int k) { return static_cast<std::size_t>(k); }

  /// y - its mean, and its rows, of the outputs that were measured up to `until`.
  Affine measured(int until) const {
    Affine all{Eigen::VectorXd(0), Eigen::MatrixXd(0, dimension_)};
    for (int k = 0; k <= until; ++k) {
      for (int j = 0; j < RandomSystem::m; ++j) {
        const double y = system_.at[index(k)].y[j];
        if (std::isnan(y)) continue;
        const Eigen::Index row = all.offset.size();
        all.offset.conservativeResize(row + 1);
        all.rows.conservativeResize(row + 1, dimension_);
        all.offset[row] = y - outputs_[index(k)].offset[j];
        all.rows.row(row) = outputs_[index(k)].rows.row(j);
      }
    }
    return all;
  }

  Gaussian given(const Affine& wanted, int until) const {
    const Affine all = measured(until);
    const Eigen::MatrixXd cross = wanted.rows * Sigma_ * all.rows.transpose();
    const Eigen::MatrixXd own = wanted.rows * Sigma_ * wanted.rows.transpose();
    if (all.offset.size() == 0) return {wanted.offset, own};
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(all.rows * Sigma_ * all.rows.transpose());
    return {wanted.offset + cross * ldlt.solve(all.offset),
            own - cross * ldlt.solve(cross.transpose())};
  }

  RandomSystem system_;
  Eigen::Index dimension_ = 0;
  Eigen::MatrixXd Sigma_;
  std::vector<Affine> states_;
  std::vector<Affine> noises_;
  std::vector<Affine> outputs_;
};

}  // namespace sepcal::test
