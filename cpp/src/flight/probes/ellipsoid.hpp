// SPDX-License-Identifier: BSD-3-Clause
// The linear first step for a magnetometer of which only the field's strength is known: its
// readings lie on the ellipsoid (m - n)' S^-1 (m - n) = 1, S = F^2 C C'. Fitted algebraically in
// one pass; model::split_shape() makes scale factors and soft iron of it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

#include "sepcal/flight/flight.hpp"

namespace sepcal::probes {

struct Ellipsoid {
  Eigen::Vector3d centre;
  Eigen::Matrix3d shape;  // S, symmetric and positive definite; its eigenvalues: half-axes squared

  /// Radius of the sphere of the same volume.
  double radius() const;

  /// Longest over shortest half-axis.
  double elongation() const;
};

struct Sphere {
  Eigen::Vector3d centre;
  double radius = 0.0;
};

/// Three coordinates, a value a point each.
using Points = std::array<std::span<const double>, 3>;

/// The middle and the half-widths of the points' box. At least one point.
struct PointBox {
  Eigen::Vector3d middle;
  Eigen::Vector3d half_width;
};
PointBox box_of(const Points& points);

/// x'Qx + 2 q'x + c = 0 with tr Q = 3, by linear least squares. Nothing where the points leave the
/// nine coefficients open (condition over 1e8, columns of unit length), or lie on a surface that is
/// no ellipsoid.
std::optional<Ellipsoid> fit_ellipsoid(const Points& points);

/// Of the ellipsoid of the flight's readings mx, my, mz [uT, or the log's counts under that
/// header]; rows that lack one are left out. Throws Error where they lie on none.
double radius_of_readings(const Flight& flight);

/// |x|^2 = 2 n'x + c by linear least squares. Nothing where the points leave that open, or no
/// radius is real.
std::optional<Sphere> fit_sphere(const Points& points);

/// How well an ellipsoid is what the points show: y = S^-1/2 (m - n) has unit length on it.
struct Coverage {
  double roughness = 0.0;  // rms of |y| - 1
  double one_sided = 0.0;  // |mean of y / |y||: 0 all round the centre, 1 from one side
  double thinnest = 0.0;  // least mean square of y / |y| along an axis: 1/3 all round, 0 in a plane
};
Coverage judge_coverage(const Points& points, const Ellipsoid& ellipsoid);

}  // namespace sepcal::probes
