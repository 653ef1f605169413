// SPDX-License-Identifier: BSD-3-Clause
#include "flight/subjects/own_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "flight/catalogue/effect_makers.hpp"

namespace sepcal::subjects {
namespace {

using catalogue::any_driver;
using catalogue::EffectRow;
using catalogue::EffectTable;
using catalogue::PortRow;

/// What is one in every row, which a constant of an output is a share of.
Variable one() { return {"one", "1", -infinity, infinity, 1.0}; }

PortRow row_of_parameter(const Variable& parameter) {
  return {.port = {.name = parameter.name,
                   .unit = parameter.unit,
                   .components = {{.name = "s", .linear = parameter.name}}},
          .sentence = parameter.name + " changes",
          .forms = {{any_driver, parameter.name + " + s x"}},
          .curves = {{"", "{}^2"}}};
}

PortRow row_of_input(const Variable& input) {
  return {.port = {.name = input.name,
                   .unit = input.unit,
                   .components = {{.name = "s", .input = input.name}},
                   .constant_is_own = false},
          .sentence = input.name + " is off, changing",
          .forms = {{any_driver, input.name + " + s x"}},
          .curves = {{"", "{}^2"}}};
}

PortRow row_of_output(const Variable& output, int place) {
  return {.port = {.name = output.name + "_bias",
                   .unit = output.unit,
                   .components = {{.name = "s", .shares = {{place, one()}}}}},
          .sentence = "the zero of " + output.name + " changes",
          .forms = {{any_driver, output.name + " = model + s x"}}};
}

EffectRow constant_row(const PortRow& row, const Variable& output) {
  return {.entry = {row.port.name, output.name + " = model + s", "none", output.unit},
          .sentence = "the zero of " + output.name + " is off",
          .maker = catalogue::lacking_constant_on(row.port)};
}

EffectRow delay_row(const std::string& name, const std::string& equation,
                    const std::string& sentence, Delay::Kind kind,
                    const std::vector<std::string>& inputs = {}) {
  EffectRow row{.entry = {name, equation, "none", "s"},
                .sentence = sentence,
                .channels = {"time"},
                .maker = catalogue::in_time(kind, catalogue::longest_offset, inputs)};
  const bool is_lag = kind == Delay::Kind::outputs_lagging || kind == Delay::Kind::inputs_lagging;
  if (is_lag) row.plausible = {{"tau", {0.0, catalogue::longest_offset}}};
  return row;
}

std::array<EffectRow, 2> delays_of_outputs() {
  return {delay_row("time_offset", "outputs late by tau", "the outputs are late",
                    Delay::Kind::outputs_late),
          delay_row("lag", "tau dz/dt + z = z0", "the outputs lag", Delay::Kind::outputs_lagging)};
}

std::array<EffectRow, 2> delays_of(const std::string& input) {
  return {delay_row(input + "_late", input + " late by tau", input + " is late",
                    Delay::Kind::inputs_late, {input}),
          delay_row(input + "_lag", fmt::format("tau d{0}/dt + {0} = {0}0", input), input + " lags",
                    Delay::Kind::inputs_lagging, {input})};
}

}  // namespace

EffectTable own_effects(const LaidModel& laid) {
  const Tables& tables = laid.model->tables();
  const bool has_state = !laid.initial_states.empty();
  EffectTable table;
  const auto is_free = [&](const std::string& name) {  // no effect is called so, and one can be
    return can_name(name) && table.find_port(name) == nullptr;
  };
  for (const Variable& parameter : std::span(tables.linear).first(laid.varying)) {
    if (is_free(parameter.name)) table.ports.push_back(row_of_parameter(parameter));
  }
  std::vector<std::string> inputs;
  for (const Variable& input : tables.inputs) {
    if (input.name == "time") continue;
    if (can_name(input.name)) inputs.push_back(input.name);
    if (is_free(input.name)) table.ports.push_back(row_of_input(input));
  }
  for (int j = 0; j < tables.n_z(); ++j) {
    const Variable& output = tables.outputs[static_cast<std::size_t>(j)];
    table.measured.push_back(output.name);
    if (!is_free(output.name + "_bias")) continue;
    table.ports.push_back(row_of_output(output, j));
    table.effects.push_back(constant_row(table.ports.back(), output));
  }
  if (!has_state) std::ranges::copy(delays_of_outputs(), std::back_inserter(table.effects));
  if (has_state || inputs.size() > 1) {
    for (const std::string& input : inputs) {
      std::ranges::copy(delays_of(input), std::back_inserter(table.effects));
    }
  }
  table.state_drivers = std::move(inputs);
  return table;
}

}  // namespace sepcal::subjects
