// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/rivals/alonso_shuster.hpp"

#include <ceres/jet.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "estimation/covariance.hpp"
#include "model/soft_iron_and_scale.hpp"
#include "numerics/symmetric.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/rivals/two_step_problems.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"

namespace sepcal::rivals {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Readings = Eigen::Matrix3Xd;

constexpr double least_singular_value = 1e-10;  // of the largest, columns of unit length
constexpr Index bias_alone = 3;
constexpr Index complete = 9;

/// What theta says: a perfect sensor at first.
struct Sensor {
  explicit Sensor(Index n) : theta(VectorXd::Zero(n)) {}

  VectorXd theta;
  Vector3d c = Vector3d::Zero();
  Matrix3d squared_gains = Matrix3d::Identity();  // (I + E)^-1

  /// b of (I + D) B = A h + b + noise, squared.
  double bias_square() const { return c.dot(squared_gains * c); }
};

/// Nothing where a squared gain is over 100, or the readings' locus is no ellipsoid.
std::optional<Sensor> sensor_of(const VectorXd& theta) {
  constexpr double least = 0.01;
  Sensor sensor(theta.size());
  sensor.theta = theta;
  sensor.c = theta.head<3>();
  if (theta.size() == bias_alone) return sensor;
  const Matrix3d E = numerics::symmetric(theta.segment<3>(3), theta.tail<3>());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(Matrix3d::Identity() + E);
  if (!(axes.eigenvalues()[0] > least)) return std::nullopt;
  sensor.squared_gains = axes.eigenvectors() * axes.eigenvalues().cwiseInverse().asDiagonal() *
                         axes.eigenvectors().transpose();
  return sensor;
}

RowVectorXd row_of(const Vector3d& B, Index n) {
  RowVectorXd L(n);
  L.head<3>() = 2.0 * B.transpose();
  if (n == complete)
    L.tail<6>() << -B.cwiseAbs2().transpose(), -2.0 * B[0] * B[1], -2.0 * B[0] * B[2],
        -2.0 * B[1] * B[2];
  return L;
}

/// Everything that the record says, reduced with given weights: the centred measurements and the
/// equation of the means.
struct Reduced {
  MatrixXd R;             // n x n, R'R the information of the centred measurements
  VectorXd estimate;      // theta-tilde
  RowVectorXd mean_row;   // of L
  double mean_z = 0.0;    // of z - mu
  double spread = 0.0;    // sigma-bar: standard deviation of the equation of the means
  double left = 0.0;      // squares that theta-tilde leaves of the centred measurements
  bool finite = false;    // nothing overflowed
  bool complete = false;  // they determine theta-tilde
};

/// Both steps' equations about a theta: J step = r.
struct Equations {
  MatrixXd J;  // (n + 1) x n
  VectorXd r;  // n + 1
};

class TwoStep {
 public:
  TwoStep(Readings readings, VectorXd strengths, const AlonsoShusterOptions& options)
      : readings_(std::move(readings)),
        strengths_(std::move(strengths)),
        options_(options),
        n_(options.bias_alone ? bias_alone : complete) {}

  AlonsoShusterFit run() const;

 private:
  /// Of v: 4 y'Sigma y + 2 tr Sigma^2, y = (I + D) B - b, |y|^2 = |B|^2 - L theta + |b|^2.
  VectorXd variances(const Sensor& sensor) const;
  /// The first step.
  Reduced centre(const VectorXd& variances) const;
  Equations linearise(const Reduced& reduced, const Sensor& sensor) const;
  /// The second step, from a sensor.
  Sensor refine(AlonsoShusterFit& fit, const Reduced& reduced, Sensor sensor) const;
  /// lambda, alpha, n and their covariance of theta's.
  void state(AlonsoShusterFit& fit, const Sensor& sensor, const MatrixXd& J) const;

  Readings readings_;
  VectorXd strengths_;
  const AlonsoShusterOptions& options_;
  Index n_;
};

VectorXd TwoStep::variances(const Sensor& sensor) const {
  const double square = options_.noise * options_.noise;
  VectorXd variances(readings_.cols());
  for (Index k = 0; k < variances.size(); ++k) {
    const Vector3d B = readings_.col(k);
    const double corrected =
        B.squaredNorm() - row_of(B, n_).dot(sensor.theta) + sensor.bias_square();
    variances[k] = 4.0 * square * corrected + 6.0 * square * square;
  }
  return variances;
}

Reduced TwoStep::centre(const VectorXd& variances) const {
  const double mu = (options_.mean_as_printed ? -3.0 : 3.0) * options_.noise * options_.noise;
  Reduced centred;
  centred.mean_row = RowVectorXd::Zero(n_);
  const double information = variances.cwiseInverse().sum();
  for (Index k = 0; k < variances.size(); ++k) {
    const double share = 1.0 / (variances[k] * information);
    const Vector3d B = readings_.col(k);
    centred.mean_row += share * row_of(B, n_);
    centred.mean_z += share * (B.squaredNorm() - strengths_[k] * strengths_[k] - mu);
  }
  centred.spread = 1.0 / std::sqrt(information);
  TriangularFactor factor(static_cast<int>(n_ + 1));
  constexpr Index block = 256;
  for (Index first = 0; first < variances.size(); first += block) {
    const Index count = std::min(block, variances.size() - first);
    MatrixXd rows(count, n_ + 1);
    for (Index i = 0; i < count; ++i) {
      const Vector3d B = readings_.col(first + i);
      const double F = strengths_[first + i];
      rows.row(i) << row_of(B, n_) - centred.mean_row,
          B.squaredNorm() - F * F - mu - centred.mean_z;
      rows.row(i) /= std::sqrt(variances[first + i]);
    }
    factor.absorb(rows);
  }
  centred.finite = factor.all_finite();
  if (!centred.finite) return centred;
  centred.R = factor.matrix().topLeftCorner(n_, n_);
  const TriangularSolution solution = solve_triangular(centred.R, factor.matrix().col(n_).head(n_));
  centred.estimate = solution.x;
  centred.left = remaining_square(factor);
  centred.complete = factor.rank(static_cast<int>(n_), least_singular_value) == n_;
  return centred;
}

Equations TwoStep::linearise(const Reduced& reduced, const Sensor& sensor) const {
  const Vector3d w = sensor.squared_gains * sensor.c;  // d|b|^2 = 2 w'dc - w'dE w
  Equations equations{MatrixXd(n_ + 1, n_), VectorXd(n_ + 1)};
  equations.J << reduced.R, (reduced.mean_row - row_of(w, n_)) / reduced.spread;
  equations.r << reduced.R * (reduced.estimate - sensor.theta),
      (reduced.mean_z - reduced.mean_row.dot(sensor.theta) + sensor.bias_square()) / reduced.spread;
  return equations;
}

Sensor TwoStep::refine(AlonsoShusterFit& fit, const Reduced& reduced, Sensor sensor) const {
  constexpr double small_step = 1e-14;  // of the squared step in standard errors
  constexpr int most_halvings = 30;     // of a step that would leave the sensors
  Equations here = linearise(reduced, sensor);
  fit.converged = false;
  for (int i = 0; i < options_.iterations && !fit.converged; ++i) {
    ++fit.iterations;
    VectorXd step = here.J.householderQr().solve(here.r);
    fit.converged = (here.J * step).squaredNorm() < small_step;
    auto next = sensor_of(sensor.theta + step);
    for (int halving = 0; !next && halving < most_halvings; ++halving) {
      step *= 0.5;
      next = sensor_of(sensor.theta + step);
    }
    if (!next) break;
    sensor = *next;
    here = linearise(reduced, sensor);
  }
  if (!fit.converged) {
    fit.message = "the second step did not converge within " + std::to_string(options_.iterations) +
                  " iterations; cover more of the sphere";
  }
  fit.cost = 0.5 * (here.r.squaredNorm() + reduced.left);
  state(fit, sensor, here.J);
  return sensor;
}

/// theta of (lambda, alpha, n).
template <class X>
Vec<X, 9> theta_of(const Vec<X, 9>& xi) {
  const auto [Q, c] = quadric_of(xi);  // Q = I + E
  Vec<X, 9> theta;
  theta << c, Q(0, 0) - 1.0, Q(1, 1) - 1.0, Q(2, 2) - 1.0, Q(0, 1), Q(0, 2), Q(1, 2);
  return theta;
}

void TwoStep::state(AlonsoShusterFit& fit, const Sensor& sensor, const MatrixXd& J) const {
  fit.theta = sensor.theta;
  fit.shape = sensor.squared_gains;
  fit.bias = fit.shape * sensor.c;
  const MatrixXd root = J.householderQr().matrixQR().topRows(n_).triangularView<Eigen::Upper>();
  const MatrixXd covariance = estimation::inverse_of_square(root);
  if (n_ == bias_alone) {
    fit.estimates = fit.bias;
    fit.covariance = covariance;
  } else {
    const auto split = model::split_shape(fit.shape);
    fit.estimates.tail<3>() = fit.bias;
    if (split) {
      fit.estimates << split->scale.array() - 1.0, split->soft_iron, fit.bias;
      using Dual = ceres::Jet<double, 9>;
      Vec<Dual, 9> xi;
      for (int k = 0; k < 9; ++k) xi[k] = Dual(fit.estimates[k], k);
      const Vec<Dual, 9> by = theta_of(xi);
      Eigen::Matrix<double, 9, 9> slopes;
      for (int k = 0; k < 9; ++k) slopes.row(k) = by[k].v.transpose();
      const Eigen::Matrix<double, 9, 9> back = slopes.inverse();
      fit.covariance = back * covariance * back.transpose();
    } else {
      fit.message = "soft iron too strong for a unit diagonal: scale factors are not defined";
    }
  }
  fit.standard_errors = fit.covariance.diagonal().cwiseSqrt();
}

/// Whether rows J see less than all columns.
bool leaves_open(const MatrixXd& J) {
  TriangularFactor factor(static_cast<int>(J.cols()));
  MatrixXd rows = J;
  factor.absorb(rows);
  return factor.rank(static_cast<int>(J.cols()), least_singular_value) < J.cols();
}

/// Of n parameters, nothing known yet.
AlonsoShusterFit unknown(Index n) {
  AlonsoShusterFit fit;
  const auto& table = AttitudeIndependentMagnetometer::nonlinear;
  for (Index k = complete - n; k < complete; ++k) {
    fit.names.emplace_back(table[static_cast<std::size_t>(k)].name);
  }
  fit.estimates = fit.standard_errors = VectorXd::Constant(n, not_a_number);
  fit.covariance = MatrixXd::Constant(n, n, not_a_number);
  fit.theta = VectorXd::Constant(n, not_a_number);
  fit.bias = Vector3d::Constant(not_a_number);
  fit.shape = Matrix3d::Constant(not_a_number);
  fit.cost = not_a_number;
  return fit;
}

AlonsoShusterFit TwoStep::run() const {
  AlonsoShusterFit fit = unknown(n_);
  Sensor sensor(n_);
  for (int turn = 0; turn <= options_.reweightings; ++turn) {
    const Reduced reduced = centre(variances(sensor));
    if (!reduced.finite) throw Error("the squares of the readings overflow; give them in uT");
    fit.centred = reduced.estimate;
    if (const auto centred = sensor_of(reduced.estimate); centred && reduced.complete) {
      sensor = *centred;
    }
    if (leaves_open(linearise(reduced, sensor).J)) {
      fit.message = "the readings leave parameters open; cover more of the sphere";
      break;
    }
    fit.message.clear();
    sensor = refine(fit, reduced, std::move(sensor));
    if (!fit.converged) break;
  }
  return fit;
}

}  // namespace

AlonsoShusterFit fit_alonso_shuster(const Record& record, double field_strength,
                                    const AlonsoShusterOptions& options) {
  if (!(field_strength > 0.0) || !std::isfinite(field_strength)) {
    throw Error("the field's strength must be above zero and finite");
  }
  if (!(options.noise > 0.0) || !std::isfinite(options.noise)) {
    throw Error("the noise of the readings must be above zero and finite");
  }
  if (options.reweightings < 0) throw Error("reweightings must not be negative");
  if (options.iterations < 1) throw Error("iterations must be at least 1");
  const Record rows = record.select(options.segments);
  const auto count = static_cast<Index>(rows.rows());
  const Index n = options.bias_alone ? bias_alone : complete;
  if (count < n + 1) {
    throw Error("the record has " + std::to_string(count) + " rows; TWOSTEP needs at least " +
                std::to_string(n + 1));
  }
  Readings readings(3, count);
  VectorXd strengths = VectorXd::Constant(count, field_strength);
  Index at = 0;
  const bool changes = rows.has("field_change");
  const std::array columns{rows.column("mx"), rows.column("my"), rows.column("mz")};
  for (const Segment& segment : rows.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row, ++at) {
      for (Index axis = 0; axis < 3; ++axis) {
        readings(axis, at) = columns[static_cast<std::size_t>(axis)][row];
      }
      if (changes) strengths[at] += rows.column("field_change")[row];
    }
  }
  if (!readings.allFinite() || !strengths.allFinite()) {
    throw Error("a reading is not finite; leave out such rows");
  }
  if (!(strengths.minCoeff() > 0.0)) {
    throw Error("field_change makes a row's field strength zero or less");
  }
  return TwoStep(std::move(readings), std::move(strengths), options).run();
}

}  // namespace sepcal::rivals
