// SPDX-License-Identifier: BSD-3-Clause
// The parts of a simulated flight that do not depend on the sensor.
#include "simulation/simulated_flight.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <ostream>

#include "base/stop.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace simulation;  // this room's own

namespace {

template <class Choice>
Choice find_choice(std::string_view what, std::string_view name,
                   std::initializer_list<std::pair<std::string_view, Choice>> choices) {
  std::string known;
  for (const auto& [text, choice] : choices) {
    if (text == name) return choice;
    known += (known.empty() ? "" : ", ") + std::string(text);
  }
  throw Error(std::string(what) + " '" + std::string(name) + "' is unknown; known: " + known);
}

}  // namespace

Excitation find_excitation(std::string_view name) {
  using enum Excitation;
  return find_choice<Excitation>("excitation", name,
                                 {{"rich", rich}, {"poor", poor}, {"third", third}});
}

NoiseKind find_noise_kind(std::string_view name) {
  using enum NoiseKind;
  return find_choice<NoiseKind>("noise", name,
                                {{"white", white}, {"ar", ar}, {"pink", pink}, {"bursty", bursty}});
}

const std::vector<double>& SimulatedFlight::column(std::string_view name) const {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const SimulatedColumn& c) { return c.name == name; });
  if (found != columns.end()) return found->values;
  std::string there;
  for (const auto& c : columns) there += (there.empty() ? "" : ", ") + c.name;
  throw Error("simulated flight: column '" + std::string(name) + "' is missing; it has: " + there);
}

void write_csv(const SimulatedFlight& flight, std::ostream& out) {
  for (const auto& column : flight.columns) out << column.name << ',';
  out << "maneuver\n";
  for (std::size_t row = 0; row < flight.rows() && out; ++row) {
    base::heed_stop();
    std::string line;
    for (const auto& column : flight.columns) {
      line += format_number(column.values[row]) + ',';
    }
    out << line << flight.maneuver[row] << '\n';
  }
}

namespace simulation {

Moving step(Moving x) {
  if (x.value <= 0.0) return 0.0;
  if (x.value >= 1.0) return 1.0;
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

Moving ramp(Moving x) {
  if (x.value <= 0.0) return 0.0;
  if (x.value >= 1.0) return x - 0.5;
  return x * x * x * x * (2.5 + x * (x - 3.0));
}

Moving window(Moving x, double edge) { return step(x / edge) - step((x - (1.0 - edge)) / edge); }

Eigen::Matrix3d Attitude::body_to_ned() const {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return AngleAxisd(yaw.value, Vector3d::UnitZ()).toRotationMatrix() *
         AngleAxisd(pitch.value, Vector3d::UnitY()).toRotationMatrix() *
         AngleAxisd(roll.value, Vector3d::UnitX()).toRotationMatrix();
}

Eigen::Vector3d Attitude::body_rates() const {
  const double sin_roll = std::sin(roll.value);
  const double cos_roll = std::cos(roll.value);
  const double level_yaw_rate = yaw.rate * std::cos(pitch.value);
  return {roll.rate - yaw.rate * std::sin(pitch.value),
          pitch.rate * cos_roll + level_yaw_rate * sin_roll,
          level_yaw_rate * cos_roll - pitch.rate * sin_roll};
}

Air standard_air(double altitude) {
  constexpr double sea_level_temperature = 288.15;  // [K]
  constexpr double sea_level_pressure = 101325.0;   // [Pa]
  constexpr double lapse_rate = 0.0065;             // [K/m]
  constexpr double gas_constant = 287.05287;        // [J/(kg K)]
  if (!(altitude >= -2000.0 && altitude <= 11000.0)) {
    throw Error("altitude: " + format_number(altitude) +
                " m is outside the simulated atmosphere; stay within -2000 m to 11000 m");
  }
  const double temperature = sea_level_temperature - lapse_rate * altitude;
  const double pressure =
      sea_level_pressure *
      std::pow(temperature / sea_level_temperature, standard_gravity / (gas_constant * lapse_rate));
  return {pressure, temperature, pressure / (gas_constant * temperature)};
}

std::vector<double> sample_times(double begin, double end, const SimulationOptions& options) {
  constexpr double highest_rate = 10'000.0;      // [Hz]
  constexpr std::size_t most_rows = 10'000'000;  // 2 GB of columns
  if (options.rows > most_rows) {
    throw Error("rows: " + std::to_string(options.rows) + " is too many; choose at most " +
                std::to_string(most_rows));
  }
  if (!(options.rate > 0.0 && options.rate <= highest_rate)) {
    throw Error("rate: " + format_number(options.rate) +
                " Hz can't be sampled; choose above 0 and at most " + format_number(highest_rate));
  }
  // Divide last: at 50 Hz row 1 is then 380.02, not 380.02000000000004.
  const double span = end - begin;
  const bool full = options.rows == 0;
  std::vector<double> times(full ? static_cast<std::size_t>(span * options.rate) + 1
                                 : options.rows);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto row = static_cast<double>(k);
    times[k] = full ? (begin * options.rate + row) / options.rate
                    : begin + span * row / static_cast<double>(options.rows);
  }
  return times;
}

void check_parameters(const std::string& source, const std::map<std::string, double>& parameters,
                      const std::map<std::string, double>& defaults) {
  std::string known;
  for (const auto& [name, value] : defaults) known += (known.empty() ? "" : ", ") + name;
  for (const auto& [name, value] : parameters) {
    if (!defaults.contains(name)) {
      throw Error(source + ": parameter '" + name + "' is unknown; the parameters are: " + known);
    }
    if (!std::isfinite(value)) throw Error(source + ": parameter '" + name + "' must be finite");
    if (name.starts_with("lambda_") && value <= -1.0) {
      throw Error(source + ": scale error " + name + " = " + format_number(value) +
                  " leaves no signal; choose it above -1");
    }
  }
  for (const auto& [name, value] : defaults) {
    if (!parameters.contains(name)) {
      throw Error(source + ": parameter '" + name + "' is missing; the parameters are: " + known);
    }
  }
}

void check_values(const std::string& source, std::string_view what, std::span<const double> values,
                  double lowest) {
  for (const double value : values) {
    if (std::isfinite(value) && value >= lowest) continue;
    throw Error(source + ": " + std::string(what) + " " + format_number(value) + " must be finite" +
                (std::isfinite(lowest) ? " and at least " + format_number(lowest) : ""));
  }
}

SimulatedFlight open_flight(std::initializer_list<std::string_view> names, std::size_t rows) {
  SimulatedFlight flight;
  for (const auto name : names) {
    flight.columns.push_back({std::string(name), {}});
    flight.columns.back().values.reserve(rows);
  }
  flight.maneuver.reserve(rows);
  return flight;
}

void append_row(SimulatedFlight& flight, std::string_view maneuver,
                std::initializer_list<double> values) {
  auto column = flight.columns.begin();
  for (const double value : values) (column++)->values.push_back(value);
  flight.maneuver.emplace_back(maneuver);
}

double wander(double time, int course) {
  const double pace = 1.0 + 0.19 * course;
  return (std::sin(2.0 * pi * pace * time / 25.0 + 1.7 * course) +
          std::sin(2.0 * pi * pace * time / 11.9 + 0.6 * course * course) +
          std::sin(2.0 * pi * pace * time / 7.3 + 2.9 * course)) /
         3.0;
}

std::string format_number(double value) {
  std::array<char, 32> text;  // a double needs at most 24
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

}  // namespace simulation
}  // namespace sepcal
