// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/ellipsoid.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "flight/files/headers.hpp"
#include "numerics/symmetric.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"

namespace sepcal::probes {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double largest_condition = 1e8;

/// Coordinates about the middle of the points, in half-widths of their box: of order one.
struct Scaling {
  Vector3d middle;
  double length = 1.0;

  explicit Scaling(const Points& points) {
    const PointBox box = box_of(points);
    middle = box.middle;
    const double widest = box.half_width.maxCoeff();
    if (widest > 0) length = widest;
  }
  Vector3d operator()(const Points& points, std::size_t i) const {
    return (Vector3d(points[0][i], points[1][i], points[2][i]) - middle) / length;
  }
};

/// Minimises |regressors x + target| over the points, row_of(x) giving [regressors, target] of a
/// point. Nothing where x is left open.
template <int n, class RowOf>
std::optional<Eigen::Vector<double, n>> regress(const Points& points, const Scaling& scaling,
                                                const RowOf& row_of) {
  constexpr std::size_t block = 256;
  TriangularFactor factor(n + 1);
  MatrixXd rows;
  for (std::size_t first = 0; first < points[0].size(); first += block) {
    const std::size_t count = std::min(block, points[0].size() - first);
    rows.resize(static_cast<Index>(count), n + 1);
    for (std::size_t i = 0; i < count; ++i) {
      rows.row(static_cast<Index>(i)) = row_of(scaling(points, first + i));
    }
    factor.absorb(rows);
  }
  if (!factor.all_finite() || !(factor.condition(n) < largest_condition)) return std::nullopt;
  const MatrixXd& T = factor.matrix();
  return -T.topLeftCorner<n, n>().template triangularView<Eigen::Upper>().solve(
      T.col(n).template head<n>());
}

}  // namespace

double Ellipsoid::radius() const { return std::pow(shape.determinant(), 1.0 / 6.0); }

double Ellipsoid::elongation() const {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(shape, Eigen::EigenvaluesOnly);
  return std::sqrt(axes.eigenvalues()[2] / axes.eigenvalues()[0]);
}

PointBox box_of(const Points& points) {
  PointBox box;
  for (Index axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::ranges::minmax(points[static_cast<std::size_t>(axis)]);
    box.middle[axis] = 0.5 * (low + high);
    box.half_width[axis] = 0.5 * (high - low);
  }
  return box;
}

std::optional<Ellipsoid> fit_ellipsoid(const Points& points) {
  const Scaling scaling(points);
  const auto x = regress<9>(points, scaling, [](const Vector3d& p) {
    return Eigen::RowVector<double, 10>{{p[0] * p[0] - p[2] * p[2], p[1] * p[1] - p[2] * p[2],
                                         2 * p[0] * p[1], 2 * p[0] * p[2], 2 * p[1] * p[2],
                                         2 * p[0], 2 * p[1], 2 * p[2], 1.0, p.squaredNorm()}};
  });
  if (!x) return std::nullopt;
  const Vector3d a(1 + (*x)[0], 1 + (*x)[1], 1 - (*x)[0] - (*x)[1]);
  const Matrix3d Q = numerics::symmetric(a, x->segment<3>(2));
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(Q, Eigen::EigenvaluesOnly);
  if (!(axes.eigenvalues()[0] > 1e-6 * axes.eigenvalues()[2])) return std::nullopt;
  const Matrix3d Q_inverse = Q.inverse();
  const Vector3d centre = -Q_inverse * x->segment<3>(5);
  const double square = centre.dot(Q * centre) - (*x)[8];
  if (!(square > 0)) return std::nullopt;
  return Ellipsoid{scaling.middle + scaling.length * centre,
                   scaling.length * scaling.length * square * Q_inverse};
}

std::optional<Sphere> fit_sphere(const Points& points) {
  const Scaling scaling(points);
  const auto x = regress<4>(points, scaling, [](const Vector3d& p) {
    return Eigen::RowVector<double, 5>{{2 * p[0], 2 * p[1], 2 * p[2], 1.0, p.squaredNorm()}};
  });
  if (!x) return std::nullopt;
  const Vector3d centre = -x->head<3>();
  const double square = centre.squaredNorm() - (*x)[3];
  if (!(square > 0)) return std::nullopt;
  return Sphere{scaling.middle + scaling.length * centre, scaling.length * std::sqrt(square)};
}

double radius_of_readings(const Flight& flight) {
  std::array<std::vector<double>, 3> columns;
  constexpr std::array names{"mx", "my", "mz"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns[axis] = files::read_quantity(flight, names[axis], files::UnitKind::field);
    if (!columns[axis].empty()) continue;
    std::vector<std::string> headers;
    for (const Flight::Column& column : flight.columns()) headers.push_back(column.logged_header());
    throw OptionError(files::around(
        flight.name() + ": ", files::describe_missing(names[axis], files::UnitKind::field, headers),
        "; " + flight.list_columns()));
  }
  std::array<std::vector<double>, 3> readings;
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    if (!std::isfinite(columns[0][row] + columns[1][row] + columns[2][row])) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) readings[axis].push_back(columns[axis][row]);
  }
  const auto ellipsoid =
      readings[0].empty() ? std::nullopt : fit_ellipsoid({readings[0], readings[1], readings[2]});
  if (ellipsoid) return ellipsoid->radius();
  throw OptionError({flight.name() +
                         ": the readings lie on no ellipsoid, whose mean radius would be "
                         "the field's strength: turn the sensor all round, or give ",
                     Option{"field_strength"}, " as a number in uT"});
}

Coverage judge_coverage(const Points& points, const Ellipsoid& ellipsoid) {
  const Matrix3d root = Eigen::LLT<Matrix3d>(ellipsoid.shape).matrixL();
  const auto rows = static_cast<double>(points[0].size());
  double square = 0.0;
  Vector3d sum = Vector3d::Zero();
  Matrix3d moments = Matrix3d::Zero();
  for (std::size_t i = 0; i < points[0].size(); ++i) {
    const Vector3d m(points[0][i], points[1][i], points[2][i]);
    const Vector3d y = root.triangularView<Eigen::Lower>().solve(m - ellipsoid.centre);
    const double length = y.norm();
    square += (length - 1.0) * (length - 1.0);
    sum += y / length;
    moments += y * y.transpose() / (length * length);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(moments / rows, Eigen::EigenvaluesOnly);
  return {std::sqrt(square / rows), sum.norm() / rows, axes.eigenvalues()[0]};
}

}  // namespace sepcal::probes
