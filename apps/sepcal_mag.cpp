// SPDX-License-Identifier: BSD-3-Clause
// sepcal-mag: calibrates three-axis magnetometers.
#include "instrument.hpp"
#include "option_values.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/truth.hpp"

namespace sepcal::app {
namespace {

class Magnetometer final : public Instrument {
 public:
  std::string app() const override { return "sepcal-mag"; }
  std::string summary() const override {
    return "Calibrates a three-axis magnetometer against a known field.";
  }
  std::vector<std::string> models() const override { return {"magnetometer"}; }

  void add_probe_options(CLI::App& fit) override {
    fit.add_option("--field", field_, "the Earth's field, north, east, down [uT]")
        ->type_name("N,E,D");
    fit.add_option("--field-strength", strength_, "the field's strength alone [uT]; not there yet")
        ->type_name("F");
  }

  std::shared_ptr<const Probe> probe(const Flight& /*flight*/) const override {
    if (!strength_.empty()) {
      throw Error(
          "--field-strength is not there yet: this version needs the attitude and "
          "--field N,E,D, or the logged field hx_ut, hy_ut, hz_ut");
    }
    if (field_.empty()) return magnetometer_probe(std::nullopt);
    return magnetometer_probe(
        parse_triple("--field", field_, "19.7,-1.4,49.4 (north, east, down in uT)"));
  }

  Simulation simulate(const std::string& truth, const std::string& source,
                      const SimulationOptions& options) const override {
    const MagnetometerTruth magnetometer =
        truth.empty() ? MagnetometerTruth{} : parse_magnetometer_truth(truth, source);
    return {simulate_magnetometer(magnetometer, options), to_json(magnetometer)};
  }

 private:
  std::string field_;
  std::string strength_;
};

}  // namespace
}  // namespace sepcal::app

int main(int argc, char** argv) {
  sepcal::app::Magnetometer magnetometer;
  return sepcal::app::run(magnetometer, argc, argv);
}
