// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/parameter_values.hpp"
#include "flight/probes/attitude_independent_start.hpp"
#include "flight/probes/corrected_columns.hpp"
#include "flight/probes/ellipsoid.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/probes/plausible_scales.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "flight/probes/restatements.hpp"
#include "flight/probes/shipped.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

class StrengthOnlyMagnetometer final : public Probe {
 public:
  StrengthOnlyMagnetometer(std::optional<double> field_strength, double noise,
                           bool is_of_readings = false)
      : setup_{field_strength.value_or(std::nan("")), noise},
        model_(setup_),
        is_of_readings_(is_of_readings) {
    if (field_strength && (!std::isfinite(*field_strength) || !(*field_strength > 0))) {
      throw OptionError(
          {Option{"field_strength"},
           fmt::format(" is {}; give the field's strength in uT, above zero", *field_strength)});
    }
    if (!std::isfinite(noise) || noise < 0) {
      throw Error(fmt::format("field_noise is {}; give a standard deviation in uT", noise));
    }
  }

  std::string_view name() const override { return shipped_attitude_independent.name; }
  std::string_view app() const override { return "sepcal-mag"; }
  const BlockModel& model() const override { return model_; }
  std::span<const ProbeQuantity> quantities() const override {
    return attitude_independent_quantities();
  }

  std::map<std::string, std::vector<double>> settings() const override {
    std::vector<double> strength;
    if (is_known()) strength.push_back(setup_.field_strength);
    return {{"field_strength", std::move(strength)}, {"field_noise", {setup_.noise}}};
  }

  std::unique_ptr<const Probe> settle(const Flight& flight, const LogChoice& log) const override {
    if (is_known()) return nullptr;
    const double radius = radius_of_readings(read_for(*this, flight, log).flight);
    return std::make_unique<const StrengthOnlyMagnetometer>(radius, setup_.noise, true);
  }

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    ProbeRecord record = prepare_attitude_independent(flight, known(), log);
    if (is_of_readings_) {
      record.notes.push_back(fmt::format(
          "{}: the field's strength is taken for the mean radius of the readings' ellipsoid, "
          "{:.6g} in the log's own unit or counts: scale errors are against that, and the "
          "calibrated field is in the same unit",
          flight.name(), setup_.field_strength));
    }
    return record;
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    ProbeReadings readings = read_magnetometer(flight, log);
    readings.notes.push_back(flight.name() +
                             ": the corrected field is in body axes up to a rotation, which the "
                             "field's strength does not show");
    return readings;
  }

  std::vector<std::string> corrected_headers() const override {
    return {"mx_cal_ut", "my_cal_ut", "mz_cal_ut"};
  }

  /// h = C^-1 (m - n), the field in body axes up to a rotation.
  std::vector<CorrectedColumn> correct(const ProbeReadings& readings, const Eigen::VectorXd& values,
                                       const ReadingEffects& effects) const override {
    const Vec<double, 9> xi2 = values.head<9>();
    return correct_field(readings,
                         AttitudeIndependentMagnetometer::soft_iron_and_scale<double>(xi2),
                         xi2.tail<3>(), corrected_headers(), effects);
  }

  FitOptions complete(const FitOptions& options, const Record& record) const override {
    return start_attitude_independent(options, record, usual_strength(record));
  }

  std::unique_ptr<const Probe> with_noise(double standard_deviation) const override {
    return std::make_unique<const StrengthOnlyMagnetometer>(known(), standard_deviation,
                                                            is_of_readings_);
  }

  void judge(Fit& fit) const override {
    judge_scales(
        fit, std::array{Scale{"lambda_x", 0.0}, Scale{"lambda_y", 0.0}, Scale{"lambda_z", 0.0}});
    judge_attitude_independent(fit, setup_.field_strength);
  }

  std::vector<Restatement> restate(const Fit& fit) const override {
    const Vec<double, 9> xi2 =
        base::in_order(model_.tables().parameters(), fit.by_name()).head<9>();
    const auto correction = restate_correction(
        AttitudeIndependentMagnetometer::soft_iron_and_scale<double>(xi2), xi2.tail<3>());
    return correction ? std::vector{*correction} : std::vector<Restatement>();
  }

 private:
  bool is_known() const { return !std::isnan(setup_.field_strength); }

  double known() const {
    if (is_known()) return setup_.field_strength;
    throw OptionError({Option{"field_strength"},
                       " is to be found in the flight of a fit; give it as a number in uT here"});
  }

  /// In the middle of the record's rows.
  double usual_strength(const Record& record) const {
    if (!record.has("field_change")) return known();
    const auto changes = record.column("field_change");
    std::vector<double> values(changes.begin(), changes.end());
    return setup_.field_strength + numerics::select_quantile(values, 0.5);
  }

  AttitudeIndependentMagnetometer setup_;
  StaticModel<AttitudeIndependentMagnetometer> model_;
  bool is_of_readings_;
};

}  // namespace

std::unique_ptr<const Probe> attitude_independent_probe(std::optional<double> field_strength,
                                                        double noise) {
  return std::make_unique<const StrengthOnlyMagnetometer>(field_strength, noise);
}

namespace probes {

const Shipped shipped_attitude_independent{
    .name = "magnetometer-norm",
    .words = "magnetometer without attitude",
    .make = [](const Settings& settings) {
      const auto given = settings.find("field_strength");
      const bool is_to_be_found = given != settings.end() && given->second.empty();
      const auto strength =
          is_to_be_found ? std::nullopt : std::optional(one_number(settings, "field_strength"));
      return attitude_independent_probe(strength, one_number(settings, "field_noise"));
    }};

}  // namespace probes

}  // namespace sepcal
