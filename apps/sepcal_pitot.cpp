// SPDX-License-Identifier: BSD-3-Clause
// sepcal-pitot: calibrates air data probes.
#include <fmt/format.h>

#include <algorithm>

#include "instrument.hpp"
#include "option_values.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/truth.hpp"

namespace sepcal::app {
namespace {

class Pitot final : public Instrument {
 public:
  std::string app() const override { return "sepcal-pitot"; }
  std::string summary() const override {
    return "Calibrates a five-hole Pitot probe in flight against the inertial velocity.";
  }
  std::vector<std::string> models() const override { return {"five-hole"}; }

  void add_probe_options(CLI::App& fit) override {
    fit.add_option("--probe", probe_, "five-hole (default where dpa_* is logged)")
        ->type_name("NAME");
    fit.add_option("--k-alpha", k_alpha_, "sensitivity of the angle-of-attack ports [1/rad]")
        ->type_name("K");
    fit.add_option("--k-beta", k_beta_, "sensitivity of the sideslip ports [1/rad]")
        ->type_name("K");
    fit.add_option("--lever-arm", lever_arm_,
                   "velocity's reference point to probe, body axes [m] (default 0,0,0)")
        ->type_name("X,Y,Z");
  }

  std::shared_ptr<const Probe> probe(const Flight& flight) const override {
    check_probe(flight);
    if (!k_alpha_ || !k_beta_) {
      throw Error(
          "a five-hole probe needs --k-alpha K and --k-beta K, the ports' sensitivities in "
          "1/rad (from the probe's data sheet or a wind tunnel)");
    }
    return five_hole_probe(
        *k_alpha_, *k_beta_,
        parse_triple("--lever-arm", lever_arm_, "0.35,0,-0.02 (forward, right, down in m)"));
  }

  Simulation simulate(const std::string& truth, const std::string& source,
                      const SimulationOptions& options) const override {
    const FiveHoleTruth five_hole =
        truth.empty() ? FiveHoleTruth{} : parse_five_hole_truth(truth, source);
    return {simulate_five_hole(five_hole, options), to_json(five_hole)};
  }

 private:
  void check_probe(const Flight& flight) const {
    if (probe_ == "five-hole") return;
    if (!probe_.empty() && probe_ != "pitot-static") {
      throw Error(fmt::format("--probe {} is unknown; known: five-hole", probe_));
    }
    if (probe_.empty() && std::ranges::any_of(flight.columns(), [](const Flight::Column& column) {
          return column.header.starts_with("dpa_");
        })) {
      return;
    }
    throw Error(
        fmt::format("{}: {}; this version calibrates five-hole probes, which need pt_pa, ps_pa, "
                    "dpa_pa and dpb_pa ({})",
                    flight.name(),
                    probe_.empty() ? "there is no column dpa_*, so this is no five-hole probe"
                                   : "--probe pitot-static is not there yet",
                    flight.list_columns()));
  }

  std::string probe_;
  std::optional<double> k_alpha_;
  std::optional<double> k_beta_;
  std::string lever_arm_ = "0,0,0";
};

}  // namespace
}  // namespace sepcal::app

int main(int argc, char** argv) {
  sepcal::app::Pitot pitot;
  return sepcal::app::run(pitot, argc, argv);
}
