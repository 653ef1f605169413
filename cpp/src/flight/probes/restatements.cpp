// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/restatements.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace sepcal::probes {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;

constexpr double one_knot = 1852.0 / 3600.0;  // m/s

/// Of a direction to, or along, (north, east), from north over east, [0, turn).
double bearing(double north, double east, double turn) {
  const double degrees = std::atan2(east, north) * 180.0 / std::numbers::pi;
  const double within = std::fmod(degrees + 360.0, turn);
  return within < turn ? within : 0.0;
}

struct Ellipse {
  double along = 0.0;   // m/s, half of the long axis
  double across = 0.0;  // m/s, half of the short one
  double axis = 0.0;    // deg, the long one's bearing
};

/// That holds a normal point in 95 %: two degrees of freedom.
std::optional<Ellipse> ellipse_of(const Matrix2d& covariance) {
  if (!covariance.allFinite()) return std::nullopt;
  const double square = -2.0 * std::log(0.05);
  const Eigen::SelfAdjointEigenSolver<Matrix2d> axes(covariance);
  const Vector2d variances = axes.eigenvalues().cwiseMax(0.0);
  const Vector2d longest = axes.eigenvectors().col(1);
  return Ellipse{.along = std::sqrt(square * variances[1]),
                 .across = std::sqrt(square * variances[0]),
                 .axis = bearing(longest[0], longest[1], 180.0)};
}

std::string row_of(const Matrix3d& A, Index row) {
  return fmt::format("{:.6g} {:.6g} {:.6g}", A(row, 0), A(row, 1), A(row, 2));
}

}  // namespace

std::optional<Restatement> restate_wind(const Fit& fit) {
  const auto place = [&](const char* name) {
    return static_cast<Index>(std::ranges::find(fit.parameters, name, &Parameter::name) -
                              fit.parameters.begin());
  };
  const Parameter& north = fit["w_n"];
  const Parameter& east = fit["w_e"];
  if (north.fixed && east.fixed) return std::nullopt;
  if (north.at_bound || east.at_bound) return std::nullopt;  // a bound is no wind
  const double speed = std::hypot(north.value, east.value);
  const double from = bearing(-north.value, -east.value, 360.0);
  Restatement wind{.name = "wind",
                   .sentence = fmt::format("from {:.0f} deg, {:.1f} kt", from, speed / one_knot),
                   .numbers = {{"from_deg", {from}}, {"speed_mps", {speed}}}};
  const std::vector<Index> both{place("w_n"), place("w_e")};
  if (const auto ellipse = ellipse_of(fit.covariance(both, both))) {
    wind.sentence += fmt::format(
        "; 95 % within an ellipse of +-{:.2g} by +-{:.2g} kt, the long axis along {:.0f} deg",
        ellipse->along / one_knot, ellipse->across / one_knot, ellipse->axis);
    wind.numbers["ellipse_mps"] = {ellipse->along, ellipse->across};
    wind.numbers["ellipse_axis_deg"] = {ellipse->axis};
  }
  return wind;
}

std::optional<Restatement> restate_correction(const Matrix3d& C, const Eigen::Vector3d& b) {
  const Matrix3d A = C.inverse();
  if (!A.allFinite()) return std::nullopt;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = A;
  return Restatement{
      .name = "correction",
      .sentence = fmt::format("h = A (m - b), A = [{}; {}; {}], b = [{:.6g} {:.6g} {:.6g}] uT",
                              row_of(A, 0), row_of(A, 1), row_of(A, 2), b[0], b[1], b[2]),
      .numbers = {{"A", {rows.data(), rows.data() + rows.size()}},
                  {"b_ut", {b.data(), b.data() + b.size()}}}};
}

Restatement restate_mounting(const std::array<double, 3>& angles) {
  const auto [roll, pitch, yaw] = angles;
  return {
      .name = "mounting",
      .sentence = fmt::format("the sensor is turned by roll {:.6g}, pitch {:.6g}, yaw {:.6g} deg",
                              roll, pitch, yaw),
      .numbers = {{"angles_deg", {roll, pitch, yaw}}}};
}

Restatement restate_ratio(double lambda, double bias) {
  const double factor = (1.0 + lambda) * (1.0 + lambda);
  return {.name = "airspeed_ratio",
          .sentence = fmt::format(
              "ARSPD_RATIO times {:.4f}; it holds a scale alone, without b_va {:.2g} m/s", factor,
              bias),
          .numbers = {{"factor", {factor}}}};
}

}  // namespace sepcal::probes
