// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "flight/probes/corrected_air.hpp"
#include "flight/probes/plausible_scales.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "flight/probes/restatements.hpp"
#include "flight/probes/shipped.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

using Eigen::VectorXd;

class FiveHole final : public Probe {
 public:
  FiveHole(double k_alpha, double k_beta, const std::array<double, 3>& lever_arm)
      : setup_{k_alpha, k_beta, {lever_arm[0], lever_arm[1], lever_arm[2]}}, model_(setup_) {
    for (const auto& [name, k] : {std::pair{"k_alpha", k_alpha}, std::pair{"k_beta", k_beta}}) {
      if (std::isfinite(k) && k > 0) continue;
      throw OptionError(
          {Option{name},
           fmt::format(" is {}; give the ports' sensitivity in 1/rad, above zero", k)});
    }
    if (!setup_.lever_arm.allFinite()) {
      throw OptionError({Option{"lever_arm"}, " is not finite; give X,Y,Z in metres"});
    }
  }

  std::string_view name() const override { return shipped_five_hole.name; }
  std::string_view app() const override { return "sepcal-pitot"; }
  const BlockModel& model() const override { return model_; }
  std::span<const ProbeQuantity> quantities() const override { return five_hole_quantities(); }

  std::map<std::string, std::vector<double>> settings() const override {
    const auto& arm = setup_.lever_arm;
    return {{"k_alpha", {setup_.k_alpha}},
            {"k_beta", {setup_.k_beta}},
            {"lever_arm", {arm[0], arm[1], arm[2]}}};
  }

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    const bool lever_arm = setup_.lever_arm.cwiseAbs().maxCoeff() > 0;
    return prepare_five_hole(
        flight,
        {.lever_arm = lever_arm, .log = log, .k_alpha = setup_.k_alpha, .k_beta = setup_.k_beta});
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    return read_five_hole(flight, log);
  }

  std::vector<std::string> corrected_headers() const override { return corrected_air_headers; }

  std::vector<CorrectedColumn> correct(const ProbeReadings& readings, const VectorXd& values,
                                       const ReadingEffects& effects) const override {
    const auto pt = readings.record.column("pt");
    const auto ps = readings.record.column("ps");
    const auto dpa = readings.record.column("dpa");
    const auto dpb = readings.record.column("dpb");
    const auto rho = readings.record.column("rho");
    return correct_air<FiveHoleProbe::Air>(readings, values, effects, [&](std::size_t i) {
      const double pressure = pt[i] - ps[i];
      return AirAsRead{
          std::sqrt(std::max(0.0, 2.0 * (pressure + effects.at("pressure_offset.s", i)) / rho[i])),
          dpa[i] / (setup_.k_alpha * pressure), dpb[i] / (setup_.k_beta * pressure)};
    });
  }

  void judge(Fit& fit) const override { judge_scales(fit, std::array{Scale{"lambda_va", 0.0}}); }

  std::vector<Restatement> restate(const Fit& fit) const override {
    const auto wind = restate_wind(fit);
    return wind ? std::vector{*wind} : std::vector<Restatement>();
  }

 private:
  FiveHoleProbe setup_;
  StaticModel<FiveHoleProbe> model_;
};

}  // namespace

std::unique_ptr<const Probe> five_hole_probe(double k_alpha, double k_beta,
                                             const std::array<double, 3>& lever_arm) {
  return std::make_unique<const FiveHole>(k_alpha, k_beta, lever_arm);
}

namespace probes {

const Shipped shipped_five_hole{
    .name = "five-hole", .words = "five-hole probe", .make = [](const Settings& settings) {
      return five_hole_probe(one_number(settings, "k_alpha"), one_number(settings, "k_beta"),
                             three_numbers(settings, "lever_arm"));
    }};

}  // namespace probes

}  // namespace sepcal
