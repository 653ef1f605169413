// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/probe.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "option_spelling.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {
namespace {

using Eigen::VectorXd;

/// One column a header, NaN until a row is set.
std::vector<CorrectedColumn> empty_columns(const std::vector<std::string>& headers,
                                           std::size_t rows) {
  std::vector<CorrectedColumn> columns;
  for (const std::string& header : headers) {
    columns.push_back({header, std::vector(rows, std::numeric_limits<double>::quiet_NaN())});
  }
  return columns;
}

class FiveHole final : public Probe {
 public:
  FiveHole(double k_alpha, double k_beta, const std::array<double, 3>& lever_arm)
      : setup_{k_alpha, k_beta, {lever_arm[0], lever_arm[1], lever_arm[2]}}, model_(setup_) {
    for (const auto& [name, k] : {std::pair{"k_alpha", k_alpha}, std::pair{"k_beta", k_beta}}) {
      if (std::isfinite(k) && k > 0) continue;
      throw Error(fmt::format("{} is {}; give the ports' sensitivity in 1/rad, above zero",
                              spell_option(name), k));
    }
    if (!setup_.lever_arm.allFinite()) {
      throw Error(spell_option("lever_arm") + " is not finite; give X,Y,Z in metres");
    }
  }

  std::string_view name() const override { return "five-hole"; }
  std::string_view app() const override { return "sepcal-pitot"; }
  const BlockModel& model() const override { return model_; }

  std::map<std::string, std::vector<double>> settings() const override {
    const auto& arm = setup_.lever_arm;
    return {{"k_alpha", {setup_.k_alpha}},
            {"k_beta", {setup_.k_beta}},
            {"lever_arm", {arm[0], arm[1], arm[2]}}};
  }

  ProbeRecord prepare(const Flight& flight, bool drop_invalid) const override {
    const bool lever_arm = setup_.lever_arm.cwiseAbs().maxCoeff() > 0;
    return prepare_five_hole(flight, {.lever_arm = lever_arm, .drop_invalid = drop_invalid});
  }

  ProbeReadings read(const Flight& flight, bool drop_invalid) const override {
    return read_five_hole(flight, drop_invalid);
  }

  std::vector<std::string> corrected_headers() const override {
    return {"airspeed_cal_mps", "alpha_cal_rad", "beta_cal_rad"};
  }

  /// Eq. 36, and the air's direction turned into body axes by C(eps): alpha = atan2(w, u),
  /// beta = asin(v / V) at the probe.
  std::vector<CorrectedColumn> correct(const ProbeReadings& readings,
                                       const VectorXd& values) const override {
    const auto pt = readings.record.column("pt");
    const auto ps = readings.record.column("ps");
    const auto dpa = readings.record.column("dpa");
    const auto dpb = readings.record.column("dpb");
    const auto rho = readings.record.column("rho");
    const Vec<double, 5> xi2 = values.tail<5>();
    auto columns = empty_columns(corrected_headers(), pt.size());
    for (std::size_t i = 0; i < pt.size(); ++i) {
      if (!readings.valid[i]) continue;
      const double pressure = pt[i] - ps[i];
      const auto angles = FiveHoleProbe::flow_angles<double, double>(
          dpa[i] / (setup_.k_alpha * pressure), dpb[i] / (setup_.k_beta * pressure), xi2);
      const auto air = FiveHoleProbe::air_direction<double>(angles[0], angles[1], xi2[4]);
      columns[0].values[i] = (1.0 + values[0]) * std::sqrt(2.0 * pressure / rho[i]) + values[1];
      columns[1].values[i] = std::atan2(air[2], air[0]);
      columns[2].values[i] = std::asin(std::clamp(air[1], -1.0, 1.0));
    }
    return columns;
  }

 private:
  FiveHoleProbe setup_;
  StaticModel<FiveHoleProbe> model_;
};

class KnownFieldMagnetometer final : public Probe {
 public:
  explicit KnownFieldMagnetometer(const std::optional<std::array<double, 3>>& field)
      : field_(field), model_(Magnetometer{}) {}

  std::string_view name() const override { return "magnetometer"; }
  std::string_view app() const override { return "sepcal-mag"; }
  const BlockModel& model() const override { return model_; }

  std::map<std::string, std::vector<double>> settings() const override {
    if (!field_) return {};
    return {{"field", {field_->begin(), field_->end()}}};
  }

  ProbeRecord prepare(const Flight& flight, bool drop_invalid) const override {
    return prepare_magnetometer(flight, {.field = field_, .drop_invalid = drop_invalid});
  }

  ProbeReadings read(const Flight& flight, bool drop_invalid) const override {
    return read_magnetometer(flight, drop_invalid);
  }

  std::vector<std::string> corrected_headers() const override {
    return {"mx_cal_ut", "my_cal_ut", "mz_cal_ut"};
  }

  /// h = C^-1 (m - n), the field in body axes.
  std::vector<CorrectedColumn> correct(const ProbeReadings& readings,
                                       const VectorXd& values) const override {
    const Eigen::Matrix3d CC = Magnetometer::soft_iron_and_misalignment<double>(values.tail<6>());
    const Eigen::Vector3d scale = values.head<3>().array() + 1.0;
    const Eigen::FullPivLU<Eigen::Matrix3d> C(CC * scale.asDiagonal());
    if (!C.isInvertible()) {
      throw Error(
          "the calibration's matrix C is singular, so it can't be applied; fit it on more "
          "attitudes");
    }
    const Eigen::Vector3d n = values.segment<3>(3);
    const std::array m{readings.record.column("mx"), readings.record.column("my"),
                       readings.record.column("mz")};
    auto columns = empty_columns(corrected_headers(), m[0].size());
    for (std::size_t i = 0; i < m[0].size(); ++i) {
      if (!readings.valid[i]) continue;
      const Eigen::Vector3d h = C.solve(Eigen::Vector3d(m[0][i], m[1][i], m[2][i]) - n);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        columns[axis].values[i] = h[static_cast<Eigen::Index>(axis)];
      }
    }
    return columns;
  }

 private:
  std::optional<std::array<double, 3>> field_;
  StaticModel<Magnetometer> model_;
};

/// A setting of `length` numbers. Throws Error where it is missing or of another length.
template <std::size_t length>
std::array<double, length> setting(const std::map<std::string, std::vector<double>>& settings,
                                   const std::string& name) {
  const auto at = settings.find(name);
  if (at == settings.end() || at->second.size() != length) {
    throw Error(fmt::format("option '{}' needs {} number{}", name, length, length == 1 ? "" : "s"));
  }
  std::array<double, length> values{};
  std::ranges::copy(at->second, values.begin());
  return values;
}

}  // namespace

std::unique_ptr<const Probe> five_hole_probe(double k_alpha, double k_beta,
                                             const std::array<double, 3>& lever_arm) {
  return std::make_unique<const FiveHole>(k_alpha, k_beta, lever_arm);
}

std::unique_ptr<const Probe> magnetometer_probe(const std::optional<std::array<double, 3>>& field) {
  return std::make_unique<const KnownFieldMagnetometer>(field);
}

std::unique_ptr<const Probe> make_probe(
    std::string_view name, const std::map<std::string, std::vector<double>>& settings) {
  if (name == "five-hole") {
    return five_hole_probe(setting<1>(settings, "k_alpha")[0], setting<1>(settings, "k_beta")[0],
                           setting<3>(settings, "lever_arm"));
  }
  if (name == "magnetometer") {
    if (!settings.contains("field")) return magnetometer_probe(std::nullopt);
    return magnetometer_probe(setting<3>(settings, "field"));
  }
  throw Error(fmt::format("there is no model '{}'; known: five-hole, magnetometer", name));
}

}  // namespace sepcal
