// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/flow_angles.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>

#include "base/escaping.hpp"
#include "flight/probes/air_columns.hpp"
#include "sepcal/detail/rotation.hpp"
#include "sepcal/models/pitot_static.hpp"

namespace sepcal::checks {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr Index unknowns = 8;  // W (3), s, s_alpha, b_alpha, s_beta, b_beta
constexpr Index of_alpha = 4;
constexpr Index of_beta = 6;

/// What the probe reads of the air in a row.
struct FlowAir {
  double speed = 0.0;  // m/s
  double alpha = 0.0;  // rad
  double beta = 0.0;
};

/// The readings of a five-hole probe or of a boom.
class FlowReadings {
 public:
  FlowReadings(const Log& log, const Settings& settings)
      : pressures_(log.find_all({"pt", "ps", "dpa", "dpb"})),
        vanes_(log.find_all({"alpha", "beta"})),
        airspeed_(log.find("airspeed")),
        dp_(log.find("dp")),
        rho_(log.find("rho")) {
    const auto set = [&](const char* name) {
      const auto found = settings.find(name);
      return found == settings.end() || found->second.empty() ? 0.0 : found->second.front();
    };
    k_alpha_ = set("k_alpha");
    k_beta_ = set("k_beta");
  }

  bool are_there() const {
    return (!pressures_.empty() && k_alpha_ > 0 && k_beta_ > 0) ||
           (!vanes_.empty() && (airspeed_ != nullptr || dp_ != nullptr));
  }

  const LoggedColumn& alpha() const { return pressures_.empty() ? *vanes_[0] : *pressures_[2]; }
  const LoggedColumn& beta() const { return pressures_.empty() ? *vanes_[1] : *pressures_[3]; }

  FlowAir at(std::size_t row) const {
    const double density = rho_ == nullptr ? PitotStatic::sea_level_density : rho_->values[row];
    if (!pressures_.empty()) {
      const double pressure = pressures_[0]->values[row] - pressures_[1]->values[row];
      return {std::sqrt(2.0 * pressure / density),
              pressures_[2]->values[row] / (k_alpha_ * pressure),
              pressures_[3]->values[row] / (k_beta_ * pressure)};
    }
    const double speed =
        airspeed_ != nullptr ? airspeed_->values[row] : std::sqrt(2.0 * dp_->values[row] / density);
    return {speed, vanes_[0]->values[row], vanes_[1]->values[row]};
  }

 private:
  std::vector<const LoggedColumn*> pressures_;
  std::vector<const LoggedColumn*> vanes_;
  const LoggedColumn* airspeed_;
  const LoggedColumn* dp_;
  const LoggedColumn* rho_;
  double k_alpha_ = 0.0;
  double k_beta_ = 0.0;
};

/// The slopes of both angles as read, 1 where they read right, and their standard errors.
struct FlowSlopes {
  double alpha = 0.0;
  double beta = 0.0;
  double alpha_error = 0.0;
  double beta_error = 0.0;
};

std::optional<FlowSlopes> find_slopes(const Log& log, const FlowReadings& readings) {
  const auto velocity = log.find_all({"vn", "ve", "vd"});
  const auto attitude = log.find_all({"roll", "pitch", "yaw"});
  if (velocity.empty() || attitude.empty() || !readings.are_there()) return std::nullopt;
  Eigen::Matrix<double, unknowns, unknowns> normal =
      Eigen::Matrix<double, unknowns, unknowns>::Zero();
  Eigen::Matrix<double, unknowns, 1> right = Eigen::Matrix<double, unknowns, 1>::Zero();
  double square = 0.0;
  double rows = 0.0;
  for (std::size_t row = 0; row < log.flight().rows(); ++row) {
    const FlowAir air = readings.at(row);
    const Vector3d V(velocity[0]->values[row], velocity[1]->values[row], velocity[2]->values[row]);
    const Eigen::Matrix3d R =
        body_to_ned(attitude[0]->values[row], attitude[1]->values[row], attitude[2]->values[row]);
    if (!std::isfinite(air.speed + air.alpha + air.beta) || !V.allFinite() || !R.allFinite()) {
      continue;
    }
    Eigen::Matrix<double, 3, unknowns> columns;
    columns.leftCols<3>().setIdentity();
    columns.col(3) = air.speed * R.col(0);
    columns.col(of_alpha) = air.speed * air.alpha * R.col(2);
    columns.col(of_alpha + 1) = air.speed * R.col(2);
    columns.col(of_beta) = air.speed * air.beta * R.col(1);
    columns.col(of_beta + 1) = air.speed * R.col(1);
    normal += columns.transpose() * columns;
    right += columns.transpose() * V;
    square += V.squaredNorm();
    rows += 3.0;
  }
  constexpr double fewest = 100.0;
  if (rows < fewest) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix<double, unknowns, unknowns>> factor(normal);
  if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
  const Eigen::Matrix<double, unknowns, 1> x = factor.solve(right);
  const double variance = std::max(0.0, square - right.dot(x)) / (rows - unknowns);
  const Eigen::Matrix<double, unknowns, unknowns> inverse =
      factor.solve(Eigen::Matrix<double, unknowns, unknowns>::Identity());
  const auto error = [&](Index i) { return std::sqrt(variance * inverse(i, i)) / std::abs(x[3]); };
  return FlowSlopes{x[of_alpha] / x[3], x[of_beta] / x[3], error(of_alpha), error(of_beta)};
}

void note_sign(const Log& log, const LoggedColumn& column, const char* angle, double slope,
               double error, std::vector<LogNote>& notes) {
  constexpr double least = -0.4;  // of a sensor that reads half of the angle, turned
  constexpr double certain = 15;  // standard errors: errors that wander count for much
  if (!(slope < least) || !(slope < -certain * error)) return;
  LogNote note = note_on(log, "axes", Concern::wrong, {column.header()});
  note.found = fmt::format("{} runs against the {} that velocity and attitude show (slope {:.2f})",
                           column.header(), angle, slope);
  note.effect = "its scale ends at a bound, and the angles are wrong";
  note.predicts = Predicted::bound;
  note.advice =
      fmt::format("--map {} turns its sign",
                  base::in_shell(fmt::format("{}=-{}", column.header(), column.log_header())));
  notes.push_back(std::move(note));
}

}  // namespace

void check_flow_angles(const Log& log, const Settings& settings, std::vector<LogNote>& notes) {
  const FlowReadings readings(log, settings);
  const auto slopes = find_slopes(log, readings);
  if (!slopes) return;
  note_sign(log, readings.alpha(), "angle of attack", slopes->alpha, slopes->alpha_error, notes);
  note_sign(log, readings.beta(), "sideslip", slopes->beta, slopes->beta_error, notes);
}

}  // namespace sepcal::checks
