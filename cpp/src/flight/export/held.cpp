// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/held.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <ranges>
#include <utility>

#include "flight/catalogue/effect_channels.hpp"
#include "flight/export/bodies.hpp"
#include "flight/export/exporter.hpp"
#include "flight/export/polar.hpp"
#include "flight/export/symmetric_magnetometer.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"

namespace sepcal::exporting {
namespace {

constexpr const char* constant_offset = "pressure_offset";  // Pa

/// A column that an autopilot compensates the motors by.
struct MotorColumn {
  std::string_view header;
  Motor motor;
  double unit;
};
constexpr std::array motor_columns{MotorColumn{"current_a", Motor::current, 1.0},
                                   MotorColumn{"throttle", Motor::throttle, 1.0},
                                   MotorColumn{"throttle_1", Motor::throttle, 1.0},
                                   MotorColumn{"throttle_pct", Motor::throttle, 0.01}};

bool acts_on_reading(const Calibration& calibration, const EffectSetting& setting) {
  if (calibration.options.own_effects.contains(setting.name)) return true;
  return !catalogue::acts_on_the_world(calibration.probe->effects(),
                                       parse_effect_name(setting.name));
}

/// The column of bias[current_a] and its like; nullptr for any other effect.
const MotorColumn* motor_of(const Calibration& calibration, const EffectSetting& setting) {
  if (calibration.options.own_effects.contains(setting.name)) return nullptr;
  const EffectName name = parse_effect_name(setting.name);
  const bool straight = name.shape == EffectName::Shape::power && name.number == 1;
  if (name.port != "bias" || !straight) return nullptr;
  const auto* const found = std::ranges::find(motor_columns, name.base, &MotorColumn::header);
  return found == motor_columns.end() ? nullptr : found;
}

/// Whether it is the constant by which the tube's pressure is off.
bool is_zero_of_tube(const Calibration& calibration, const EffectSetting& setting) {
  return setting.name == constant_offset && !calibration.options.own_effects.contains(setting.name);
}

}  // namespace

void forget_ranges(std::string_view prefix, FitOptions& fit) {
  const auto erase = [prefix](auto& map) {
    std::erase_if(map, [prefix](const auto& entry) { return entry.first.starts_with(prefix); });
  };
  erase(fit.bounds);
  erase(fit.prior);
  erase(fit.start);
  erase(fit.sampling_distribution);
}

void forget(std::string_view prefix, FitOptions& fit) {
  forget_ranges(prefix, fit);
  std::erase_if(fit.fix, [&](const auto& entry) { return entry.first.starts_with(prefix); });
}

void keep_known(const Tables& model, CalibrationOptions& options) {
  std::vector<std::string> parameters;
  for (const Variable& one : model.parameters()) parameters.push_back(one.name);
  const auto is_foreign = [&](const auto& entry) {
    const bool of_effect = std::ranges::any_of(options.effects, [&](const EffectSetting& effect) {
      return entry.first.starts_with(effect.name + ".");
    });
    return !of_effect && std::ranges::find(parameters, entry.first) == parameters.end();
  };
  std::erase_if(options.fit.bounds, is_foreign);
  std::erase_if(options.fit.fix, is_foreign);
  std::erase_if(options.fit.prior, is_foreign);
  std::erase_if(options.fit.start, is_foreign);
  std::erase_if(options.fit.sampling_distribution, is_foreign);
}

void check_held(const Calibration& calibration, ExportTarget target) {
  std::vector<std::string> homeless;
  const EffectSetting* motor = nullptr;
  for (const EffectSetting& setting : calibration.options.effects) {
    if (!acts_on_reading(calibration, setting)) continue;
    if (is_zero_of_tube(calibration, setting)) continue;
    const bool held = is_magnetometer(calibration) && motor_of(calibration, setting) != nullptr;
    if (held && motor == nullptr) {
      motor = &setting;
    } else {
      homeless.push_back(setting.name);
    }
  }
  if (homeless.empty()) return;
  std::string holds = "a scale and an offset of the pressure, both constant";
  if (is_magnetometer(calibration)) {
    holds = motor == nullptr
                ? "constants, and beside them bias[current_a] or bias[throttle]"
                : fmt::format("constants and one effect, and {} is there already", motor->name);
  }
  OptionError::Message message{fmt::format("{} can't hold {}: it holds {};",
                                           target == ExportTarget::px4 ? "PX4" : "ArduPilot",
                                           fmt::join(homeless, ", "), holds)};
  for (const std::string& name : homeless) {
    message.emplace_back(" ");
    message.emplace_back(Option{"without"});
    message.emplace_back(" " + name);
  }
  message.emplace_back(" fits the rest anew and says what is lost");
  throw OptionError(std::move(message));
}

std::vector<std::string> effects_on_the_world(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const EffectSetting& setting : calibration.options.effects) {
    if (!acts_on_reading(calibration, setting)) names.push_back(setting.name);
  }
  return names;
}

bool is_of_known_field(const Calibration& calibration) {
  return exporter_of(calibration).of_known_field;
}

std::vector<std::string> motor_effects(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const EffectSetting& setting : calibration.options.effects) {
    if (motor_of(calibration, setting) != nullptr) names.push_back(setting.name);
  }
  return names;
}

CalibrationOptions options_without(const Calibration& base, const std::vector<std::string>& effects,
                                   const FitProgress& progress) {
  CalibrationOptions options = verbs::options_from(base, {}, progress);
  for (const std::string& name : effects) {
    std::erase_if(options.effects, [&](const EffectSetting& one) { return one.name == name; });
    options.own_effects.erase(name);
    forget(name + ".", options.fit);
  }
  return options;
}

HeldField held_field(const Calibration& calibration) {
  const Eigen::VectorXd values = own_values(calibration);
  HeldField held;
  if (is_of_known_field(calibration)) {
    held.W = SymmetricMagnetometer::matrix(values).inverse();
    held.n = values.segment<3>(6);
  } else {
    const Vec<double, 9> xi2 = values.head<9>();
    const Eigen::Matrix3d C = AttitudeIndependentMagnetometer::soft_iron_and_scale<double>(xi2);
    held.W = polar(C.inverse()).symmetric;
    held.n = xi2.tail<3>();
  }
  for (const EffectSetting& setting : calibration.options.effects) {
    const MotorColumn* const motor = motor_of(calibration, setting);
    if (motor == nullptr) continue;
    const auto s = [&](const char* axis) {
      return calibration.fit[setting.name + "." + axis].value;
    };
    const Eigen::Vector3d per_column(s("x"), s("y"), s("z"));
    held.n -= per_column * (setting.centre.value_or(0.0) + setting.mean.value_or(0.0));
    held.kappa = per_column / motor->unit;
    held.motor = motor->motor;
    held.column = motor->header;
    held.unit = motor->unit;
  }
  return held;
}

}  // namespace sepcal::exporting
