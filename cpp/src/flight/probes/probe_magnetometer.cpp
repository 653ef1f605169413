// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/parameter_values.hpp"
#include "flight/probes/corrected_columns.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/probes/mounting.hpp"
#include "flight/probes/plausible_scales.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "flight/probes/restatements.hpp"
#include "flight/probes/shipped.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/error.hpp"
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
  KnownFieldMagnetometer(const std::optional<std::array<double, 3>>& field,
                         const std::optional<Mounting>& mounting)
      : field_(field), mounting_(mounting), model_(Magnetometer{}) {}

  std::string_view name() const override { return shipped_magnetometer.name; }
  std::string_view app() const override { return "sepcal-mag"; }
  const BlockModel& model() const override { return model_; }
  std::span<const ProbeQuantity> quantities() const override { return magnetometer_quantities(); }

  std::map<std::string, std::vector<double>> settings() const override {
    std::map<std::string, std::vector<double>> settings;
    if (field_) settings["field"] = {field_->begin(), field_->end()};
    if (!mounting_) {
      settings["mounting"] = {};
    } else if (is_turned()) {
      settings["mounting"] = {mounting_->begin(), mounting_->end()};
    }
    return settings;
  }

  std::unique_ptr<const Probe> settle(const Flight& flight, const LogChoice& log) const override {
    if (mounting_) return nullptr;
    const ReadFlight read = read_for(*this, flight, log);
    const auto found =
        find_mounting(prepare_magnetometer(read.flight, {.field = field_, .log = log}).record);
    if (!found) {
      throw OptionError({flight.name() +
                             ": the field hardly turns about the sensor, which does not "
                             "show how it is mounted; give ",
                         Option{"mounting"}, " its roll, pitch and yaw in degrees"});
    }
    if (found->mirrored) {
      throw OptionError({flight.name() + ": the readings mirror the field, as with one axis of the "
                                         "wrong sign, which no ",
                         Option{"mounting"}, " turns right; change the sign of that column"});
    }
    return std::make_unique<const KnownFieldMagnetometer>(field_, found->angles);
  }

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    return prepare_magnetometer(flight, {.field = field_, .log = log, .mounting = known()});
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    return read_magnetometer(flight, log, known());
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

  /// Of a sensor that is turned further than a misalignment goes: how to say so.
  std::string suggest(const Fit& fit, const Record& record) const override {
    constexpr double far_better = 1.5;  // of the error, the present fit's over that turned
    constexpr double far_turned = 5.0;  // [deg]
    constexpr double no_misalignment = 15.0;
    const auto found = is_turned() ? std::nullopt : find_mounting(record);
    if (!found || found->mirrored || found->turn < far_turned) return {};
    double squares = 0.0;
    for (const OutputValue& output : fit.rmse) squares += output.value * output.value;
    const double rmse = std::sqrt(squares / static_cast<double>(fit.rmse.size()));
    const std::string way_out =
        fmt::format("give --mounting {} (roll, pitch, yaw), or --mounting alone to have it found",
                    name_angles(found->angles));
    if (rmse > far_better * found->rmse) {
      return fmt::format(
          "the readings fit a sensor that is turned by {:.0f} deg: {:.3g} uT would be left of "
          "{:.3g}; {}",
          found->turn, found->rmse, rmse, way_out);
    }
    if (found->turn < no_misalignment) return {};
    return fmt::format(
        "the sensor is turned by {:.0f} deg against the attitude's axes, which eta and lambda "
        "stand for here; {}",
        found->turn, way_out);
  }

  /// Of the readings as they are, whichever way they are turned.
  std::vector<Restatement> restate(const Fit& fit) const override {
    const VectorXd values = base::in_order(model_.tables().parameters(), fit.by_name());
    const Eigen::Matrix3d turn = turn_by(known());
    std::vector<Restatement> restated;
    if (is_turned()) restated.push_back(restate_mounting(known()));
    auto correction = restate_correction(turn.transpose() * matrix_of(values),
                                         turn.transpose() * values.segment<3>(3));
    if (correction) restated.push_back(*std::move(correction));
    return restated;
  }

 private:
  bool is_turned() const { return mounting_ && *mounting_ != Mounting{}; }

  const Mounting& known() const {
    if (mounting_) return *mounting_;
    throw OptionError({Option{"mounting"},
                       " is to be found in the flight of a fit; give its roll, pitch and yaw in "
                       "degrees here"});
  }

  /// C of m = C h + n.
  static Eigen::Matrix3d matrix_of(const VectorXd& values) {
    const Eigen::Vector3d scale = values.head<3>().array() + 1.0;
    return Magnetometer::soft_iron_and_misalignment<double>(values.tail<6>()) * scale.asDiagonal();
  }

  std::optional<std::array<double, 3>> field_;
  std::optional<Mounting> mounting_;  // none: not found yet
  StaticModel<Magnetometer> model_;
};

}  // namespace

std::unique_ptr<const Probe> magnetometer_probe(const std::optional<std::array<double, 3>>& field,
                                                const std::optional<Mounting>& mounting) {
  return std::make_unique<const KnownFieldMagnetometer>(field, mounting);
}

namespace probes {

static std::unique_ptr<const Probe> make_magnetometer(const Settings& settings) {
  std::optional<std::array<double, 3>> field;
  if (settings.contains("field")) field = three_numbers(settings, "field");
  if (!settings.contains("mounting")) return magnetometer_probe(field);
  if (settings.at("mounting").empty()) return magnetometer_probe(field, std::nullopt);
  return magnetometer_probe(field, three_numbers(settings, "mounting"));
}

const Shipped shipped_magnetometer{
    .name = "magnetometer", .words = "magnetometer", .make = make_magnetometer};

}  // namespace probes

}  // namespace sepcal
