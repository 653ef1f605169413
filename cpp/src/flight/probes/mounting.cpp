// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/mounting.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "sepcal/detail/rotation.hpp"
#include "sepcal/error.hpp"

namespace sepcal::probes {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180.0;

using Columns = std::array<std::span<const double>, 3>;

/// Products of readings m and the field h about their means: nothing is copied of a log that may be
/// longer than memory.
struct Products {
  double rows = 0.0;
  Matrix3d hh = Matrix3d::Zero();
  Matrix3d mh = Matrix3d::Zero();
  double mm = 0.0;
};

Columns columns_of(const Record& record, const std::array<const char*, 3>& names) {
  return {record.column(names[0]), record.column(names[1]), record.column(names[2])};
}

Vector3d vector_at(const Columns& columns, std::size_t row) {
  return {columns[0][row], columns[1][row], columns[2][row]};
}

Products multiply(const Record& record) {
  const Columns read = columns_of(record, {"mx", "my", "mz"});
  const Columns truth = columns_of(record, {"hx", "hy", "hz"});
  Vector3d mean_m = Vector3d::Zero();
  Vector3d mean_h = Vector3d::Zero();
  Products products;
  const auto visit = [&](const auto& add) {
    for (const Segment& segment : record.segments()) {
      for (std::size_t row = segment.first; row < segment.last; ++row) {
        add(vector_at(read, row), vector_at(truth, row));
      }
    }
  };
  visit([&](const Vector3d& m, const Vector3d& h) {
    products.rows += 1.0;
    mean_m += (m - mean_m) / products.rows;
    mean_h += (h - mean_h) / products.rows;
  });
  visit([&](const Vector3d& m, const Vector3d& h) {
    products.hh += (h - mean_h) * (h - mean_h).transpose();
    products.mh += (m - mean_m) * (h - mean_h).transpose();
    products.mm += (m - mean_m).squaredNorm();
  });
  return products;
}

/// The nearest orthogonal matrix; `proper`: a rotation, whatever the sign of A's determinant.
Matrix3d nearest_turn(const Matrix3d& A, bool proper) {
  const Eigen::JacobiSVD<Matrix3d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d& U = svd.matrixU();
  const Matrix3d& V = svd.matrixV();
  Vector3d signs = Vector3d::Ones();
  if (proper && (U * V.transpose()).determinant() < 0) signs[2] = -1.0;
  return U * signs.asDiagonal() * V.transpose();
}

/// -0 is 0.
Angles to_a_tenth(Angles angles) {
  for (double& angle : angles) angle = std::round(10.0 * angle) / 10.0 + 0.0;
  return angles;
}

}  // namespace

Matrix3d turn_by(const Angles& angles) {
  return body_to_ned(angles[0] * degree, angles[1] * degree, angles[2] * degree);
}

Angles angles_of_quaternion(const std::array<double, 4>& quaternion) {
  const auto [w, x, y, z] = quaternion;
  const double length = std::hypot(std::hypot(w, x), std::hypot(y, z));
  constexpr double off = 0.01;
  if (!(std::abs(length - 1.0) <= off)) {
    throw Error(fmt::format(
        "mounting {:g},{:g},{:g},{:g}: a quaternion w,x,y,z is of length one, and this one of "
        "{:.3g}; give three numbers for angles in degrees",
        w, x, y, z, length));
  }
  Angles angles = angles_of(Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix());
  for (double& angle : angles) angle += 0.0;  // -0 is 0
  return angles;
}

Angles angles_of(const Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)) / degree,
          -std::asin(std::clamp(R(2, 0), -1.0, 1.0)) / degree,
          std::atan2(R(1, 0), R(0, 0)) / degree};
}

std::string name_angles(const Angles& angles) {
  return fmt::format("{:.6g},{:.6g},{:.6g}", angles[0], angles[1], angles[2]);
}

std::optional<FoundMounting> find_mounting(const Record& record) {
  constexpr double all_round = 0.01;  // of the largest spread: the least that tells nine entries
  const auto [rows, hh, mh, mm] = multiply(record);
  const Vector3d sizes = Eigen::SelfAdjointEigenSolver<Matrix3d>(hh).eigenvalues();
  if (!(sizes[1] > all_round * sizes[2])) return std::nullopt;
  const bool in_a_plane = !(sizes[0] > all_round * sizes[2]);
  Matrix3d A;
  FoundMounting found;
  if (in_a_plane) {
    const Matrix3d turn = nearest_turn(mh, true);
    A = turn * ((turn.transpose() * mh).trace() / hh.trace());
  } else {
    A = hh.ldlt().solve(mh.transpose()).transpose();
    found.mirrored = A.determinant() < 0;
  }
  const Matrix3d R = nearest_turn(A, true).transpose();
  found.angles = to_a_tenth(angles_of(R));
  found.turn = Eigen::AngleAxisd(R).angle() / degree;
  const double squares = mm - 2.0 * (A.transpose() * mh).trace() + (A * hh * A.transpose()).trace();
  found.rmse = std::sqrt(std::max(0.0, squares) / (3.0 * rows));
  return found;
}

}  // namespace sepcal::probes
