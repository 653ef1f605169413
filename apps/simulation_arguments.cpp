// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_arguments.hpp"

#include "option_values.hpp"

namespace sepcal::app {

void SimulationArguments::add_to(CLI::App& simulate) {
  simulate
      .add_option("--hide", hidden_,
                  "adds a physical effect, e.g. time_offset=0.05; one SIZE goes to every "
                  "component; may be repeated")
      ->type_name("E=SIZE[:SIZE...]")
      ->take_all()
      ->allow_extra_args(false);
  simulate
      .add_option("--excitation", excitation_,
                  "the maneuvers: rich, poor, or third (a magnetometer's third of the sphere)")
      ->type_name("HOW")
      ->capture_default_str();
  simulate.add_option("--noise", noise_, "white, ar, pink or bursty")
      ->type_name("KIND")
      ->capture_default_str();
  add_whole_number(simulate, "--decoys", options_.decoys, "columns that drive nothing");
  add_whole_number(simulate, "--seed", options_.seed, "seed of the noise and the decoys");
  simulate.add_option("--rate", options_.rate, "sampling rate [Hz]")
      ->type_name("HZ")
      ->capture_default_str();
  add_whole_number(simulate, "--rows", options_.rows,
                   "a short flight of N rows with every maneuver; 0: the full flight");
}

SimulationOrder SimulationArguments::resolve() const {
  SimulationOrder order;
  for (const std::string& text : hidden_)
    order.hidden.push_back(parse_sized_effect(text, "--hide"));
  order.options = options_;
  order.options.excitation = find_excitation(excitation_);
  order.options.noise = find_noise_kind(noise_);
  return order;
}

}  // namespace sepcal::app
