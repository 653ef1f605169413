// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "base/parameter_values.hpp"
#include "flight/probes/corrected_columns.hpp"
#include "flight/probes/plausible_scales.hpp"
#include "flight/probes/restatements.hpp"
#include "sepcal/compiled_models.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

using Eigen::VectorXd;

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

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    return prepare_magnetometer(flight, {.field = field_, .log = log});
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    return read_magnetometer(flight, log);
  }

  std::vector<std::string> corrected_headers() const override {
    return {"mx_cal_ut", "my_cal_ut", "mz_cal_ut"};
  }

  /// h = C^-1 (m - n), the field in body axes.
  std::vector<CorrectedColumn> correct(const ProbeReadings& readings, const VectorXd& values,
                                       const ReadingEffects& effects) const override {
    return correct_field(readings, matrix_of(values), values.segment<3>(3), corrected_headers(),
                         effects);
  }

  void judge(Fit& fit) const override {
    judge_scales(
        fit, std::array{Scale{"lambda_x", 0.0}, Scale{"lambda_y", 0.0}, Scale{"lambda_z", 0.0}});
  }

  std::vector<Restatement> restate(const Fit& fit) const override {
    const VectorXd values = base::in_order(model_.tables().parameters(), fit.by_name());
    const auto correction = restate_correction(matrix_of(values), values.segment<3>(3));
    return correction ? std::vector{*correction} : std::vector<Restatement>();
  }

 private:
  /// C of m = C h + n.
  static Eigen::Matrix3d matrix_of(const VectorXd& values) {
    const Eigen::Vector3d scale = values.head<3>().array() + 1.0;
    return Magnetometer::soft_iron_and_misalignment<double>(values.tail<6>()) * scale.asDiagonal();
  }

  std::optional<std::array<double, 3>> field_;
  StaticModel<Magnetometer> model_;
};

}  // namespace

std::unique_ptr<const Probe> magnetometer_probe(const std::optional<std::array<double, 3>>& field) {
  return std::make_unique<const KnownFieldMagnetometer>(field);
}

}  // namespace sepcal
