// SPDX-License-Identifier: BSD-3-Clause
// A model of one's own with effects by name, put together at run time: an accelerometer on a tilt
// table. Every linear parameter and every input is a port. Exits 1 where the truth is missed.
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <sepcal/fit_with_effects.hpp>
#include <sepcal/sepcal.hpp>
#include <string>
#include <vector>
using namespace sepcal;
namespace {

/// f = s g sin(theta + delta) + b: scale, zero of the table and bias.
struct TiltTable {
  static constexpr std::array inputs{Quantity{"theta", "rad"}};
  static constexpr std::array outputs{Quantity{"f", "m/s^2"}};
  static constexpr std::array linear{Quantity{"s", "1"}, Quantity{"b", "m/s^2"}};
  static constexpr std::array nonlinear{Quantity{"delta", "rad", -0.5, 0.5}};
  template <class U, class X>
  Affine<X, 1, 2> at(const Vec<U, 1>& u, const Vec<X, 1>& xi2) const {
    Affine<X, 1, 2> z{.b = Vec<X, 1>::Zero()};
    z.A << 9.80665 * sin(u[0] + xi2[0]), X(1.0);
    return z;
  }
};

/// In order: the bias's slope with temperature, and the table's creep.
const std::map<std::string, double> truth{{"b[temp_degc].s", 0.02}, {"theta[time].s", 1e-4}};

/// Two turns of the table while the laboratory warms up, read with 0.01 m/s^2 of noise.
Record turn(std::size_t rows) {
  std::mt19937_64 generator(10);
  std::normal_distribution noise(0.0, 0.01);
  std::vector<double> time;
  std::vector<double> temperature;
  std::vector<double> theta;
  std::vector<double> reading;
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i);
    time.push_back(t);
    temperature.push_back(20.0 + 5.0 * (1.0 - std::exp(-t / 150.0)));
    theta.push_back(4.0 * 3.141592653589793 * t / static_cast<double>(rows));
    const double tilt = theta.back() + 0.05 + truth.at("theta[time].s") * t;
    reading.push_back(1.02 * 9.80665 * std::sin(tilt) + 0.1 +
                      truth.at("b[temp_degc].s") * temperature.back() + noise(generator));
  }
  Record record;
  record.add("time", time).add("temp_degc", temperature);
  return record.add("theta", theta).add("f", reading);
}

}  // namespace

int main() {
  const Record record = turn(400);

  std::vector<EffectSetting> effects{{.name = "b[temp_degc]"}, {.name = "theta[time]"}};
  const auto table = block_model(TiltTable{});
  const Fit fit = fit_with_effects(table, plain_kit(table->tables()), effects, record);

  for (const Parameter& p : fit.parameters) {
    std::printf("%-15s %9.6f +- %.6f %s\n", p.name.c_str(), p.value, p.standard_error,
                p.unit.c_str());
  }
  for (const EffectSetting& setting : effects) {
    std::printf("%s is about %.3f\n", setting.name.c_str(), setting.centre.value());
  }
  bool found = fit.status == FitStatus::converged;
  for (const auto& [name, value] : truth) {
    found = found && std::abs(fit[name].value - value) < 4.0 * fit[name].standard_error;
  }
  return found ? 0 : 1;
}
