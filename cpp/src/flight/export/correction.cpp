// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/correction.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/escaping.hpp"
#include "flight/catalogue/effect_channels.hpp"
#include "flight/export/driver_names.hpp"
#include "sepcal/natural_spline.hpp"
#include "sepcal/option_error.hpp"

namespace sepcal::exporting {
namespace {

using Shape = EffectName::Shape;

[[noreturn]] void refuse(const std::string& effect, const std::string& why) {
  throw OptionError({fmt::format("{} can't be exported: {}; ", effect, why), Option{"without"},
                     fmt::format(" {} fits the rest anew and says what is lost", effect)});
}

constexpr const char* of_time = "it follows the time since that flight began, which no other has";
constexpr const char* of_moments = "it needs what is read at other moments";

/// Effects with a physics of their own that can't go on board, and why.
const std::map<std::string, const char*, std::less<>>& stranded() {
  static const std::map<std::string, const char*, std::less<>> effects{
      {"bias_step", of_time},
      {"warm_up", of_time},
      {"icing_ramp", of_time},
      {"water_blockage", of_time},
      {"time_offset", of_moments},
      {"clock_drift", of_time},
      {"sensor_lag", of_moments},
      {"pneumatic_lag", of_moments},
      {"eddy_currents", "it needs the rate at which the field changes"}};
  return effects;
}

class Description {
 public:
  Description(const Calibration& calibration, const Dialect& dialect)
      : calibration_(calibration), dialect_(dialect) {}

  Correction make() {
    const auto& table = catalogue::effect_table(calibration_.probe->name());
    for (const EffectSetting& setting : calibration_.options.effects) {
      const EffectName name = parse_effect_name(setting.name);
      const bool catalogued =
          table.find_effect(name.text) != nullptr || table.find_port(name.port) != nullptr;
      if (!catalogued || calibration_.options.own_effects.contains(setting.name)) {
        refuse(setting.name, "it is of your own making, and its code is not the calibration's");
      }
      if (catalogue::acts_on_the_world(table, name)) {
        result_.left_to_others.push_back(setting.name);
        continue;
      }
      ++number_;
      if (table.find_effect(name.text) != nullptr) {
        add_physics(setting);
      } else {
        add_driven(setting, name, *table.find_port(name.port));
      }
    }
    return std::move(result_);
  }

 private:
  double value(const std::string& parameter) const { return calibration_.fit[parameter].value; }

  /// The channel as an expression; what isn't at hand becomes an argument.
  std::string channel(const std::string& name, const std::vector<double>& trial = {}) {
    const auto& readings = names_of_readings(calibration_.probe->name());
    if (const auto found = readings.find(name); found != readings.end()) return found->second;
    const KnownChannel* const known = find_known(name);
    const auto there = std::ranges::find_if(result_.drivers, [&](const Driver& one) {
      return one.channel == name || (known != nullptr && one.argument == known->argument);
    });
    if (there != result_.drivers.end()) return there->argument;
    Driver driver{.channel = name, .argument = identifier(name), .comment = "as it was logged"};
    driver.trial = trial.empty() ? std::vector{0.5, 0.2, 2.0} : trial;
    if (known != nullptr) {
      driver.argument = known->argument;
      driver.comment = known->unit;
      driver.is_state = true;
      driver.trial = {known->trial.begin(), known->trial.end()};
    }
    const auto same = [&](const Driver& other) { return other.argument == driver.argument; };
    while (std::ranges::any_of(result_.drivers, same)) driver.argument += "_in";
    result_.drivers.push_back(driver);
    return driver.argument;
  }

  std::string constant(const std::string& name, std::vector<double> values,
                       const std::string& comment) {
    result_.constants.push_back({name, std::move(values), 0, comment});
    return dialect_.constant(name);
  }

  std::string local(const std::string& expression, const std::string& comment) {
    const std::string name = fmt::format("x_{}", number_);
    result_.statements.push_back(fmt::format("const double {} = {}; /* {} */", name, expression,
                                             base::in_c_comment(comment)));
    return name;
  }

  void share(const std::string& target, const std::string& expression) {
    std::string& sum = result_.shares[target];
    sum += (sum.empty() ? "" : " + ") + expression;
  }

  /// Coefficients of a driver of one function, on every component of a port; without `x` constants.
  void add_coefficients(const EffectSetting& setting, const std::string& port,
                        const std::vector<std::string>& components, const std::string& x) {
    std::vector<double> values;
    std::string unit;
    for (const std::string& component : components) {
      const Parameter& parameter = calibration_.fit[setting.name + "." + component];
      values.push_back(parameter.value);
      unit = parameter.unit;
    }
    const std::string s = constant(
        fmt::format("s_{}", number_), values,
        fmt::format("{}, {}{}", setting.name, unit, components.size() > 1 ? ", x y z" : ""));
    for (std::size_t i = 0; i < components.size(); ++i) {
      const std::string element = components.size() > 1 ? fmt::format("{}[{}]", s, i) : s;
      share(port + "." + components[i], x.empty() ? element : fmt::format("{} * {}", element, x));
    }
  }

  void add_driven(const EffectSetting& setting, const EffectName& name,
                  const catalogue::PortRow& row) {
    const std::vector<std::string> channels = driver_channels(name);
    if (std::ranges::find(channels, "time") != channels.end()) refuse(setting.name, of_time);
    if (name.base == "maneuver") refuse(setting.name, "it follows that flight's own labels");
    if (name.shape == Shape::delay) refuse(setting.name, of_moments);
    std::vector<std::string> components;
    for (const Port::Component& one : row.port.components) components.push_back(one.name);
    if (name.shape == Shape::spline) {
      add_spline(setting, name, components);
      return;
    }
    if (name.shape == Shape::levels) {
      add_levels(setting, name, components);
      return;
    }
    const std::string x =
        name.shape == Shape::exponent ? exponent(setting, name) : power(setting, name);
    add_coefficients(setting, name.port, components, x);
  }

  std::string exponent(const EffectSetting& setting, const EffectName& name) {
    const std::string d = channel(name.base);
    const std::string n = constant(fmt::format("n_{}", number_),
                                   {value(setting.name + ".exponent")}, setting.name + ", 1");
    return local(fmt::format("{0} > 0.0 ? pow({0}, {1}) : 0.0", d, n), setting.name);
  }

  /// (d - centre)^k - mean, d a channel or a product of channels.
  std::string power(const EffectSetting& setting, const EffectName& name) {
    const double centre = setting.centre.value_or(0.0);
    const double reach = std::max(1.0, 0.1 * std::abs(centre));
    const bool product = name.shape == Shape::product;
    std::string d;
    if (product) {
      std::vector<std::string> factors;
      for (const ChannelFactor& factor : name.factors) {
        const std::string one = channel(factor.channel);
        for (int i = 0; i < factor.power; ++i) {
          factors.push_back(factor.absolute ? fmt::format("fabs({})", one) : one);
        }
      }
      d = fmt::format("{}", fmt::join(factors, " * "));
    } else {
      d = channel(name.base, {centre + 0.5 * reach, centre - reach, centre + 2.0 * reach});
    }
    if (centre != 0.0) {
      d = fmt::format("({} - {})", d,
                      constant(fmt::format("centre_{}", number_), {centre},
                               setting.name + ": where its driver counts from"));
    }
    const std::vector<std::string> factors(static_cast<std::size_t>(product ? 1 : name.number), d);
    std::string x = fmt::format("{}", fmt::join(factors, " * "));
    if (const double mean = setting.mean.value_or(0.0); mean != 0.0) {
      x += " - " + constant(fmt::format("mean_{}", number_), {mean},
                            setting.name + ": of its driver's power on the flight");
    }
    return local(x, setting.name);
  }

  /// A natural spline for every component: the sum of its functions less their means.
  void add_spline(const EffectSetting& setting, const EffectName& name,
                  const std::vector<std::string>& components) {
    result_.has_splines = true;
    const std::vector<double>& knots = setting.knots;
    const double first = knots.front();
    const double span = knots.back() - first;
    const std::string d =
        channel(name.base, {first + 0.3 * span, first + 0.85 * span, first - 0.1 * span});
    const std::string k = constant(fmt::format("knots_{}", number_), knots, setting.name);
    for (const std::string& component : components) {
      std::vector<double> values(knots.size(), 0.0);
      double mean = 0.0;
      std::string unit;
      for (std::size_t j = 1; j < knots.size(); ++j) {
        const Parameter& s =
            calibration_.fit[fmt::format("{}.{}_{}", setting.name, component, j + 1)];
        values[j] = s.value;
        unit = s.unit;
        if (!setting.means.empty()) mean += s.value * setting.means[j - 1];
      }
      const NaturalSpline spline(knots, values);
      std::vector<double> curvatures;
      for (const double knot : knots) curvatures.push_back(spline.at(knot).curvature);
      for (double& one : values) one -= mean;
      const std::string of = fmt::format("{}_{}", component, number_);
      const std::string said = fmt::format("{}.{} at the knots, {}", setting.name, component, unit);
      share(name.port + "." + component,
            fmt::format(
                "{}({}, {}, {}, {}, {})", dialect_.own("spline"), d, knots.size(), k,
                constant("values_" + of, values, said),
                constant("curvatures_" + of, curvatures,
                         fmt::format("{}.{}, second derivatives there", setting.name, component))));
    }
  }

  /// For every component the constant of the level that the channel is on.
  void add_levels(const EffectSetting& setting, const EffectName& name,
                  const std::vector<std::string>& components) {
    const std::vector<double>& from = name.thresholds;
    const std::string d = channel(name.base, {from.front() - 1.0, from.front(), from.back() + 1.0});
    const std::string limits = constant(fmt::format("from_{}", number_), from, setting.name);
    const auto element = [](const std::string& array, std::size_t size, std::size_t j) {
      return size > 1 ? fmt::format("{}[{}]", array, j) : array;
    };
    for (const std::string& component : components) {
      std::vector<double> values;
      std::string unit;
      for (std::size_t j = 0; j < from.size(); ++j) {
        const Parameter& s =
            calibration_.fit[fmt::format("{}.{}_{}", setting.name, component, j + 2)];
        values.push_back(s.value);
        unit = s.unit;
      }
      const std::string s =
          constant(fmt::format("level_{}_{}", component, number_), values,
                   fmt::format("{}.{} from there on, {}", setting.name, component, unit));
      std::string value = "0.0";
      for (std::size_t j = 0; j < from.size(); ++j) {
        value = fmt::format("{} >= {} ? {} : {}", d, element(limits, from.size(), j),
                            element(s, from.size(), j), value);
      }
      share(name.port + "." + component, fmt::format("({})", value));
    }
  }

  void add_physics(const EffectSetting& setting) {
    const auto why = stranded().find(setting.name);
    if (why != stranded().end()) refuse(setting.name, why->second);
    const bool five_hole = calibration_.probe->name() == "five-hole";
    if (setting.name == "cubic_nonlinearity") {
      result_.is_cubic = true;
      add_cubic();
    } else if (setting.name == "pressure_offset") {
      add_coefficients(setting, setting.name, {"s"}, "");
    } else if (setting.name == "density_error") {
      const std::string x = local(fmt::format("0.5 / {}", channel("temperature")), setting.name);
      add_coefficients(setting, five_hole ? "reading_scale" : "airspeed_scale", {"s"}, x);
    } else if (setting.name == "compressibility") {
      const std::string x = local(
          "sqrt(1.4 * ps_pa / rho_kgpm3) * sqrt(5.0 * (pow(pressure / ps_pa + 1.0, 2.0 / 7.0) - "
          "1.0)) / sqrt(2.0 * pressure / rho_kgpm3) - 1.0",
          setting.name);
      add_coefficients(setting, "airspeed_scale", {"s"}, x);
    } else if (setting.name == "angle_loss") {
      const std::string along = local("cos(alpha_read) * cos(beta_read)", setting.name);
      add_coefficients(setting, "airspeed_scale", {"s"}, fmt::format("(1.0 - {0} * {0})", along));
    } else if (setting.name == "upwash" || setting.name == "sidewash") {
      const bool up = setting.name == "upwash";
      const std::string x =
          local(fmt::format("{} / sqrt(2.0 * pressure / rho_kgpm3)", channel(up ? "q" : "p")),
                setting.name);
      add_coefficients(setting, up ? "alpha_offset" : "beta_offset", {"k"}, x);
    } else {
      refuse(setting.name, "its correction is not written for a vehicle");
    }
  }

  void add_cubic() {
    for (const char* part : {"d", "c"}) {
      std::vector<double> values;
      std::string unit;
      for (const char* axis : {"x", "y", "z"}) {
        const Parameter& one =
            calibration_.fit[fmt::format("cubic_nonlinearity.{}_{}", part, axis)];
        values.push_back(one.value);
        unit = one.unit;
      }
      constant(
          fmt::format("cubic_{}", part), values,
          fmt::format("cubic_nonlinearity: {} h^{}, {}, x y z", part, *part == 'd' ? 3 : 2, unit));
    }
  }

  const Calibration& calibration_;
  const Dialect& dialect_;
  Correction result_;
  int number_ = 0;  // of the effect
};

}  // namespace

std::string Correction::added(const std::string& port_component) const {
  const auto found = shares.find(port_component);
  return found == shares.end() ? "" : " + " + found->second;
}

Correction describe_correction(const Calibration& calibration, const Dialect& dialect) {
  return Description(calibration, dialect).make();
}

}  // namespace sepcal::exporting
