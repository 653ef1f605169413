// SPDX-License-Identifier: BSD-3-Clause
// sepcal-pitot: calibrates air data probes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "flight/files/headers.hpp"
#include "instrument.hpp"
#include "option_values.hpp"
#include "programs.hpp"
#include "sepcal/detail/simulation/truth.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

class Pitot final : public Instrument {
 public:
  std::string app() const override { return "sepcal-pitot"; }
  std::string summary() const override {
    return "Calibrates a five-hole probe, a boom with vanes or a Pitot-static tube in flight "
           "against the velocity.";
  }
  std::vector<std::string> models() const override {
    return {"five-hole", "vane-boom", "pitot-static"};
  }

  void add_probe_options(CLI::App& fit) override {
    fit.add_option("--probe", probe_,
                   "five-hole (default where dpa_* is logged), vane-boom (where alpha_* and beta_* "
                   "are) or pitot-static")
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
    const std::string kind = kind_of(flight);
    if (kind == "pitot-static") {
      refuse_five_hole_options(flight);
      return pitot_static_probe();
    }
    if (kind == "vane-boom") {
      refuse_sensitivities(flight);
      return vane_boom_probe(lever_arm());
    }
    if (!k_alpha_ || !k_beta_) {
      throw Error(
          "a five-hole probe needs --k-alpha K and --k-beta K, the ports' sensitivities in "
          "1/rad (from the probe's data sheet or a wind tunnel)");
    }
    return five_hole_probe(*k_alpha_, *k_beta_, lever_arm());
  }

  void add_simulation_options(CLI::App& simulate) override {
    simulate.add_option("--probe", probe_, "five-hole (the default) or pitot-static")
        ->type_name("NAME");
  }

  Simulation simulate(const SimulationOrder& order) const override {
    const std::string truth = order.truth.empty() ? "{}" : order.truth;
    if (probe_ == "pitot-static") {
      return fly(parse_pitot_static_truth(truth, order.source), simulate_pitot_static, order);
    }
    if (probe_.empty() || probe_ == "five-hole") {
      return fly(parse_five_hole_truth(truth, order.source), simulate_five_hole, order);
    }
    if (is_known(probe_)) {
      throw Error(
          fmt::format("--probe {} can't be simulated; these can: five-hole, pitot-static", probe_));
    }
    throw Error(fmt::format("--probe {} is unknown; known: five-hole, pitot-static", probe_));
  }

 private:
  bool is_known(const std::string& probe) const {
    const auto known = models();
    return std::ranges::find(known, probe) != known.end();
  }

  std::string kind_of(const Flight& flight) const {
    if (is_known(probe_)) return probe_;
    if (!probe_.empty()) {
      throw Error(
          fmt::format("--probe {} is unknown; known: {}", probe_, fmt::join(models(), ", ")));
    }
    const auto logs = [&](std::string_view beginning) {
      return std::ranges::any_of(flight.columns(), [&](const Flight::Column& column) {
        return column.header.starts_with(beginning);
      });
    };
    if (logs("dpa_")) return "five-hole";
    return logs("alpha_") && logs("beta_") ? "vane-boom" : "pitot-static";
  }

  std::array<double, 3> lever_arm() const {
    return parse_triple("--lever-arm", lever_arm_.empty() ? "0,0,0" : lever_arm_,
                        "0.35,0,-0.02 (forward, right, down in m)");
  }

  void refuse_sensitivities(const Flight& flight) const {
    if (!k_alpha_ && !k_beta_) return;
    throw Error(fmt::format(
        "{}: {}, so this is a boom with vanes: --k-alpha and --k-beta are for a five-hole probe; "
        "leave them out, or log dpa_pa and dpb_pa ({})",
        flight.name(),
        probe_.empty() ? "there are columns alpha_* and beta_* and no dpa_*"
                       : "--probe is vane-boom",
        flight.list_columns()));
  }

  void refuse_five_hole_options(const Flight& flight) const {
    if (!k_alpha_ && !k_beta_ && lever_arm_.empty()) return;
    std::vector<std::string> headers;
    for (const Flight::Column& column : flight.columns()) headers.push_back(column.logged_header());
    throw OptionError(files::around(
        fmt::format(
            "{}: {}, so this is a Pitot-static tube: --k-alpha, --k-beta and --lever-arm are for a "
            "five-hole probe, the last for a boom with vanes too; leave them out, or log dpa_pa "
            "and dpb_pa",
            flight.name(), probe_.empty() ? "there is no column dpa_*" : "--probe is pitot-static"),
        probe_.empty() ? files::ask_for_near_miss("dpa", files::UnitKind::pressure, headers)
                       : OptionError::Message{},
        fmt::format(" ({})", flight.list_columns())));
  }

  std::string probe_;
  std::optional<double> k_alpha_;
  std::optional<double> k_beta_;
  std::string lever_arm_;
};

}  // namespace

int run_pitot(const std::string& called, int argc, char** argv) {
  Pitot pitot;
  return run(pitot, called, argc, argv);
}

std::string pitot_table() {
  Pitot instrument;
  return table_of(instrument, "sepcal pitot");
}

}  // namespace sepcal::app
