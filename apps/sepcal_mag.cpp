// SPDX-License-Identifier: BSD-3-Clause
// sepcal-mag: calibrates three-axis magnetometers.
#include <optional>

#include "instrument.hpp"
#include "option_values.hpp"
#include "programs.hpp"
#include "sepcal/detail/simulation/truth.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

class Magnetometer final : public Instrument {
 public:
  std::string app() const override { return "sepcal-mag"; }
  std::string summary() const override {
    return "Calibrates a three-axis magnetometer against a known field, or against its strength.";
  }
  std::vector<std::string> models() const override { return {"magnetometer", "magnetometer-norm"}; }

  void add_probe_options(CLI::App& fit) override {
    add_field(fit);
    fit.add_option("--field-strength", strength_,
                   "its strength alone [uT]: no attitude is needed, and no rotation is seen; auto: "
                   "that of the readings, in their own counts")
        ->type_name("F");
    mounting_option_ =
        fit.add_option("--mounting", mounting_,
                       "how the sensor is turned against the body [deg], as autopilots have it, or "
                       "a quaternion W,X,Y,Z; alone: to be found in the flight")
            ->type_name("ROLL,PITCH,YAW")
            ->expected(0, 1);
  }

  std::shared_ptr<const Probe> probe(const Flight& /*flight*/) const override {
    if (!strength_.empty()) {
      if (is_mounting_given()) {
        throw Error(
            "--mounting is of no use to --field-strength: a strength is the same however the "
            "sensor is turned; leave it out");
      }
      if (!field_.empty()) {
        throw Error(
            "--field and --field-strength contradict each other; keep --field where the attitude "
            "is logged");
      }
      if (strength_ == "auto") return attitude_independent_probe(std::nullopt);
      return attitude_independent_probe(parse_value("--field-strength", strength_));
    }
    std::optional<std::array<double, 3>> field;
    if (!field_.empty()) field = parse_field();
    return magnetometer_probe(field, parse_mounting());
  }

  void add_flight_options(CLI::App& verb) override { add_field(verb); }

  std::shared_ptr<const Probe> probe_for_flight(
      std::shared_ptr<const Probe> fitted) const override {
    if (field_.empty()) return fitted;
    if (fitted->settings().contains("field_strength")) {
      throw Error(
          "--field is of no use to a calibration against the field's strength alone; leave it out");
    }
    auto settings = fitted->settings();
    const std::array<double, 3> field = parse_field();
    settings["field"] = {field.begin(), field.end()};
    return make_probe(fitted->name(), settings);
  }

  void add_simulation_options(CLI::App& /*simulate*/) override {}

  Simulation simulate(const SimulationOrder& order) const override {
    const std::string truth = order.truth.empty() ? "{}" : order.truth;
    return fly(parse_magnetometer_truth(truth, order.source), simulate_magnetometer, order);
  }

 private:
  void add_field(CLI::App& verb) {
    verb.add_option("--field", field_, "the Earth's field, north, east, down [uT]")
        ->type_name("N,E,D");
  }

  std::array<double, 3> parse_field() const {
    return parse_triple("--field", field_, "19.7,-1.4,49.4 (north, east, down in uT)");
  }

  bool is_mounting_given() const {
    return mounting_option_ != nullptr && !mounting_option_->empty();
  }

  /// Nothing where the flight is to show it.
  std::optional<Mounting> parse_mounting() const {
    if (!is_mounting_given()) return Mounting{};
    if (mounting_.empty() || mounting_ == "estimate") return std::nullopt;
    return parse_turn("--mounting", mounting_,
                      "0,0,90 (roll, pitch, yaw in degrees), or a quaternion w,x,y,z, or alone, "
                      "after the flight");
  }

  std::string field_;
  std::string strength_;
  std::string mounting_;
  CLI::Option* mounting_option_ = nullptr;
};

}  // namespace

int run_mag(const std::string& called, int argc, char** argv) {
  Magnetometer magnetometer;
  return run(magnetometer, called, argc, argv);
}

std::string mag_table() {
  Magnetometer instrument;
  return table_of(instrument, "sepcal mag");
}

}  // namespace sepcal::app
