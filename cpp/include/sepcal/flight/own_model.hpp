// SPDX-License-Identifier: BSD-3-Clause
// A model of your own as a probe, which every verb then takes: its tables say what it reads of a
// log, where effects may enter and what they are called.
//
//   const auto wire = own_model("hot-wire", HotWire{});       // or a BlockModel
//   const Calibration base = calibrate(wire, read_csv("tunnel.csv"));
//   const FlightDiagnosis found = diagnose(base, flight);
//   const Calibration better = add(base, flight, "A[temp_degc]");
//   const Calibration read = read_calibration("better.json", wire);
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

/// The model as a probe called `name`, as its JSON calls it.
///
/// A log has a column for the time, every input and every output: "v_mps" for v [m/s], in any unit
/// that is known for it, or "v" alone, in the table's unit; of any other unit, say "V", "u_v" or
/// "u". The names of the log's other columns are channels, which may drive effects.
///
/// Effects: every linear parameter and every input is a port, and so is the zero of every output,
/// as `z_bias`; `z_bias` alone is a constant. The others are delays: `time_offset` and `lag` of all
/// outputs and, of each of several inputs u, `u_late` and `u_lag`. Inputs drive effects too, by
/// their names.
///
/// A correction gives what the model makes of the inputs, an output a column: "z_fit_mps".
///
/// Throws Error where the name is empty or one that ships, and for a model that carries a state
/// from row to row, which is given as what lays it along a record.
std::shared_ptr<const Probe> own_model(std::string name, std::shared_ptr<const BlockModel> model,
                                       ModelSource source = {});

/// A model with a state, laid along a record.
struct LaidModel {
  std::shared_ptr<const BlockModel> model;
  std::vector<std::string> initial_states;  // "theta_0" of "theta_0", "theta_0[turn]"
  std::size_t varying = 0;                  // so many of the linear parameters, the first, may vary
  TrajectoryOptions options = {};           // how it was laid
};

/// Lays it; without a record along any, each of whose segments begins at one initial state.
using LaidAlong = std::function<LaidModel(const Record*)>;

/// The same of a model with a state (own_state_model.hpp makes it of a StateModel), along each
/// flight: an initial state a segment, which other flights estimate anew, all else held. Ports are
/// the inputs, the linear parameters of the outputs and the outputs' zeros; inputs may be late or
/// lag.
std::shared_ptr<const Probe> own_model(std::string name, const LaidAlong& lay,
                                       ModelSource source = {});

template <SeparableModel M>
std::shared_ptr<const Probe> own_model(std::string name, M model) {
  return own_model(std::move(name), block_model(std::move(model)));
}

}  // namespace sepcal
