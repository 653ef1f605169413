// SPDX-License-Identifier: BSD-3-Clause
// Calibrations with three effects each, applied on board: the centres of the drivers, a model's
// parameters, rows; out come each row's status and what it was corrected to, in SCALAR.
#include "calibrated.hpp"
#include "compass_parameters.h"
#include "link.hpp"

namespace {

using Scalar = SCALAR;
using target::read;
using target::read_vector;
target::Worst worst;

/// A model's parameters by their names, as this side of the link has them.
template <class M, std::size_t N>
sepcal::Calibrated<M, Scalar> read_parameters(const M& model,
                                              const std::array<std::string_view, N>& names) {
  static_assert(N == M::linear.size() + M::nonlinear.size());
  sepcal::Calibrated<M, Scalar> calibrated{model};
  for (const std::string_view name : names) {
    if (!calibrated.set(name, static_cast<Scalar>(read()))) target::write(-1.0);
  }
  return calibrated;
}

/// An input of a model by its name.
template <class M>
Scalar& input(sepcal::Vec<Scalar, sepcal::Sizes<M>::n_u>& u, std::string_view name) {
  return u[sepcal::place_of(name, M::inputs)];
}

template <class M>
using Inputs = sepcal::Vec<Scalar, sepcal::Sizes<M>::n_u>;

template <class Corrected>
void write_field(const Corrected& corrected) {
  target::write(static_cast<double>(corrected.status));
  target::write_all(corrected.h);
}

constexpr std::array<std::string_view, 24> of_compass{COMPASS_PARAMETERS};

void correct_compass() {
  const double current = read();
  const auto model = target::compass(current, read());
  using M = std::remove_const_t<decltype(model)>;
  const auto board = read_parameters(model, of_compass);
  for (int rows = target::read_count(); rows > 0; --rows) {
    const auto m = read_vector<Scalar, 3>();
    Inputs<M> u = Inputs<M>::Zero();
    input<M>(u, "current_a") = static_cast<Scalar>(read());
    input<M>(u, "temp_degc") = static_cast<Scalar>(read());
    write_field(worst.of([&] { return sepcal::correct(board, m, u); }));
  }
}

constexpr std::array<std::string_view, 16> by_strength{"lambda_x",
                                                       "lambda_y",
                                                       "lambda_z",
                                                       "alpha_xy",
                                                       "alpha_xz",
                                                       "alpha_yz",
                                                       "n_x",
                                                       "n_y",
                                                       "n_z",
                                                       "bias[current_a].x",
                                                       "bias[current_a].y",
                                                       "bias[current_a].z",
                                                       "scale[temp_degc].s",
                                                       "axis_scale[voltage_v].x",
                                                       "axis_scale[voltage_v].y",
                                                       "axis_scale[voltage_v].z"};

void correct_by_strength() {
  const auto of = read_vector<double, 4>();
  const auto model = target::compass_by_strength(of[0], of[1], of[2], of[3]);
  using M = std::remove_const_t<decltype(model)>;
  const auto board = read_parameters(model, by_strength);
  for (int rows = target::read_count(); rows > 0; --rows) {
    Inputs<M> u = Inputs<M>::Zero();
    for (const char* name : {"mx", "my", "mz", "current_a", "temp_degc", "voltage_v"})
      input<M>(u, name) = static_cast<Scalar>(read());
    write_field(worst.of([&] { return sepcal::correct(board, u); }));
  }
}

constexpr std::array<std::string_view, 14> of_probe{"lambda_va",
                                                    "b_va",
                                                    "w_n",
                                                    "w_e",
                                                    "w_d",
                                                    "airspeed_scale[throttle].s",
                                                    "wind[altitude_m].n",
                                                    "wind[altitude_m].e",
                                                    "lambda_alpha",
                                                    "b_alpha",
                                                    "lambda_beta",
                                                    "b_beta",
                                                    "eps_phi",
                                                    "pressure_offset[current_a].s"};

void correct_probe() {
  const auto of = read_vector<double, 5>();
  const auto model = target::air_data_probe(of[0], of[1], of[2], of[3], of[4]);
  using M = std::remove_const_t<decltype(model)>;
  const auto board = read_parameters(model, of_probe);
  for (int rows = target::read_count(); rows > 0; --rows) {
    Inputs<M> u = Inputs<M>::Zero();
    // In float a total pressure has lost the difference that matters: what arrives is pt - ps.
    for (const char* name : {"pt", "dpa", "dpb", "rho", "throttle", "altitude_m", "current_a"})
      input<M>(u, name) = static_cast<Scalar>(read());
    const auto air = worst.of([&] { return sepcal::correct(board, u); });
    target::write(static_cast<double>(air.status));
    target::write_all(sepcal::Vec<Scalar, 3>(air.airspeed, air.alpha, air.beta));
  }
}

constexpr std::array<std::string_view, 8> of_tube{"s_va",
                                                  "c_va",
                                                  "w_n",
                                                  "w_e",
                                                  "w_d",
                                                  "airspeed_scale[throttle].s",
                                                  "airspeed_bias[altitude_m].s",
                                                  "pressure_offset[current_a].s"};

void correct_tube() {
  const auto of = read_vector<double, 3>();
  const auto model = target::tube(of[0], of[1], of[2]);
  using M = std::remove_const_t<decltype(model)>;
  const auto board = read_parameters(model, of_tube);
  for (int rows = target::read_count(); rows > 0; --rows) {
    const auto z = static_cast<Scalar>(read());
    Inputs<M> u = Inputs<M>::Zero();
    for (const char* name : {"rho", "throttle", "altitude_m", "current_a"})
      input<M>(u, name) = static_cast<Scalar>(read());
    const auto corrected = worst.of([&] { return sepcal::correct(board, z, u); });
    target::write(static_cast<double>(corrected.status));
    target::write(static_cast<double>(corrected.airspeed));
  }
}

}  // namespace

void fly() {
  const auto step = [](void (*correct)()) {
    worst = {};
    correct();
    target::write(worst.most());
  };
  step(correct_compass);
  step(correct_by_strength);
  step(correct_probe);
  step(correct_tube);
}
