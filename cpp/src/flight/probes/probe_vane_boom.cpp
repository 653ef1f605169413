// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "flight/probes/corrected_air.hpp"
#include "flight/probes/plausible_scales.hpp"
#include "flight/probes/restatements.hpp"
#include "flight/probes/shipped.hpp"
#include "flight/probes/vane_boom_columns.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/models/vane_boom.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

class BoomWithVanes final : public Probe {
 public:
  explicit BoomWithVanes(const std::array<double, 3>& lever_arm)
      : setup_{{lever_arm[0], lever_arm[1], lever_arm[2]}}, model_(setup_) {
    if (!setup_.lever_arm.allFinite()) {
      throw OptionError({Option{"lever_arm"}, " is not finite; give X,Y,Z in metres"});
    }
  }

  std::string_view name() const override { return shipped_vane_boom.name; }
  std::string_view app() const override { return "sepcal-pitot"; }
  const BlockModel& model() const override { return model_; }
  std::span<const ProbeQuantity> quantities() const override { return vane_boom_quantities(); }

  std::map<std::string, std::vector<double>> settings() const override {
    const auto& arm = setup_.lever_arm;
    return {{"lever_arm", {arm[0], arm[1], arm[2]}}};
  }

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    return prepare_vane_boom(flight, setup_.lever_arm.cwiseAbs().maxCoeff() > 0, log);
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    return read_vane_boom(flight, log);
  }

  std::vector<std::string> corrected_headers() const override { return corrected_air_headers; }

  std::vector<CorrectedColumn> correct(const ProbeReadings& readings, const Eigen::VectorXd& values,
                                       const ReadingEffects& effects) const override {
    const auto airspeed = readings.record.column("airspeed");
    const auto alpha = readings.record.column("alpha");
    const auto beta = readings.record.column("beta");
    const auto rho = readings.record.column("rho");
    return correct_air<VaneBoom::Air>(readings, values, effects, [&](std::size_t i) {
      const double offset = 2.0 * effects.at("pressure_offset.s", i) / rho[i];
      return AirAsRead{std::sqrt(std::max(0.0, airspeed[i] * airspeed[i] + offset)), alpha[i],
                       beta[i]};
    });
  }

  void judge(Fit& fit) const override { judge_scales(fit, std::array{Scale{"lambda_va", 0.0}}); }

  std::vector<Restatement> restate(const Fit& fit) const override {
    const auto wind = restate_wind(fit);
    return wind ? std::vector{*wind} : std::vector<Restatement>();
  }

 private:
  VaneBoom setup_;
  StaticModel<VaneBoom> model_;
};

}  // namespace

std::unique_ptr<const Probe> vane_boom_probe(const std::array<double, 3>& lever_arm) {
  return std::make_unique<const BoomWithVanes>(lever_arm);
}

namespace probes {

const Shipped shipped_vane_boom{
    .name = "vane-boom", .words = "boom with vanes", .make = [](const Settings& settings) {
      return vane_boom_probe(three_numbers(settings, "lever_arm"));
    }};

}  // namespace probes

}  // namespace sepcal
