// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "flight/probes/corrected_columns.hpp"
#include "flight/probes/plausible_scales.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "flight/probes/restatements.hpp"
#include "flight/probes/shipped.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

class PitotStaticTube final : public Probe {
 public:
  PitotStaticTube() : model_(PitotStatic{}) {}

  std::string_view name() const override { return shipped_pitot_static.name; }
  std::string_view app() const override { return "sepcal-pitot"; }
  const BlockModel& model() const override { return model_; }
  std::span<const ProbeQuantity> quantities() const override { return pitot_static_quantities(); }
  std::map<std::string, std::vector<double>> settings() const override { return {}; }

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    return prepare_pitot_static(flight, log);
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    return read_pitot_static(flight, log);
  }

  std::vector<std::string> corrected_headers() const override { return {"airspeed_cal_mps"}; }

  /// V = (z - c_va) / s_va, and from what the tube met to the air's speed: the pressure's offset,
  /// then the scale and the bias that effects add.
  std::vector<CorrectedColumn> correct(const ProbeReadings& readings, const Eigen::VectorXd& values,
                                       const ReadingEffects& effects) const override {
    const double s = values[0];
    const double c = values[1];
    if (s == 0.0) {
      throw Error(
          "the calibration's s_va is zero, so that it can't be applied; fit it on a flight with "
          "more than one airspeed");
    }
    const auto airspeed = readings.record.column("airspeed");
    auto columns = empty_columns(corrected_headers(), airspeed.size());
    for (std::size_t i = 0; i < airspeed.size(); ++i) {
      if (!readings.valid[i]) continue;
      double met = (airspeed[i] - c) / s;
      if (const double offset = effects.at("pressure_offset.s", i); offset != 0.0) {
        met = std::sqrt(std::max(0.0, met * met + 2.0 * offset / readings.record.column("rho")[i]));
      }
      columns[0].values[i] =
          met * (1.0 + effects.at("airspeed_scale.s", i)) + effects.at("airspeed_bias.s", i);
    }
    return columns;
  }

  std::map<std::string, double> held() const override { return {{"w_d", 0.0}}; }

  void judge(Fit& fit) const override { judge_scales(fit, std::array{Scale{"s_va", 1.0}}); }

  /// The correction of the reading as in the five-hole probe, V = (1 + lambda_va) z + b_va.
  std::vector<DerivedQuantity> derive(const Fit& fit) const override {
    const double s = fit["s_va"].value;
    const double c = fit["c_va"].value;
    return {{"lambda_va", "1", 1.0 / s - 1.0, {{"s_va", -1.0 / (s * s)}}},
            {"b_va", "m/s", 0.0 - c / s, {{"s_va", c / (s * s)}, {"c_va", -1.0 / s}}}};
  }

  std::vector<Restatement> restate(const Fit& fit) const override {
    std::vector<Restatement> restated;
    if (auto wind = restate_wind(fit)) restated.push_back(std::move(*wind));
    const double s = fit["s_va"].value;
    if (s != 0.0) restated.push_back(restate_ratio(1.0 / s - 1.0, 0.0 - fit["c_va"].value / s));
    return restated;
  }

 private:
  StaticModel<PitotStatic> model_;
};

}  // namespace

std::unique_ptr<const Probe> pitot_static_probe() {
  return std::make_unique<const PitotStaticTube>();
}

namespace probes {

const Shipped shipped_pitot_static{.name = "pitot-static",
                                   .words = "Pitot-static tube",
                                   .make = [](const Settings&) { return pitot_static_probe(); }};

}  // namespace probes

}  // namespace sepcal
