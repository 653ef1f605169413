// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/quaternion_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "flight/files/headers.hpp"

namespace sepcal::logs {
namespace {

constexpr std::array quaternion{"qw", "qx", "qy", "qz"};
constexpr std::array euler_angles{"roll", "pitch", "yaw"};

}  // namespace

void convert_quaternion(Flight& flight, std::vector<std::string>& notes) {
  const auto is_there = [&](const char* header) { return flight.find(header) != nullptr; };
  const auto is_logged = [&](const char* angle) {
    return files::find_quantity(flight, angle, files::UnitKind::angle).has_value();
  };
  if (flight.is_mapped() || !std::ranges::all_of(quaternion, is_there)) return;
  if (std::ranges::any_of(euler_angles, is_logged)) return;
  std::array<std::span<const double>, 4> q;
  std::ranges::transform(quaternion, q.begin(),
                         [&](const char* part) { return flight.find(part)->values; });
  std::array<std::vector<double>, 3> euler;
  euler.fill(std::vector<double>(flight.rows(), std::numeric_limits<double>::quiet_NaN()));
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    const double length =
        std::hypot(std::hypot(q[0][row], q[1][row]), std::hypot(q[2][row], q[3][row]));
    if (!(length > 0.0) || !std::isfinite(length)) continue;
    const double w = q[0][row] / length;
    const double x = q[1][row] / length;
    const double y = q[2][row] / length;
    const double z = q[3][row] / length;
    euler[0][row] = std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
    euler[1][row] = std::asin(std::clamp(2.0 * (w * y - x * z), -1.0, 1.0));
    euler[2][row] = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
  }
  std::optional<Flight::Cell> no_length;
  const auto bad = std::ranges::find_if_not(euler[0], [](double v) { return std::isfinite(v); });
  if (bad != euler[0].end()) {
    no_length = Flight::Cell{static_cast<std::size_t>(bad - euler[0].begin()),
                             "no angle: qw to qz are no rotation"};
  }
  for (const char* header : quaternion) flight.drop(header);
  for (std::size_t k = 0; k < euler_angles.size(); ++k) {
    const auto owned = std::make_shared<const std::vector<double>>(std::move(euler[k]));
    flight.view(fmt::format("{}_rad", euler_angles[k]), *owned, owned, no_length);
  }
  notes.push_back(fmt::format(
      "{}: roll, pitch and yaw are from the quaternion qw, qx, qy, qz, body to north-east-down",
      flight.name()));
}

}  // namespace sepcal::logs
