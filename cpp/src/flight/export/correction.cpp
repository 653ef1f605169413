// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/correction.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/escaping.hpp"
#include "flight/catalogue/effect_channels.hpp"
#include "flight/export/bodies.hpp"
#include "flight/export/driver_names.hpp"
#include "flight/export/driver_origin.hpp"
#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/error.hpp"

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

/// A channel less its origin, as an expression in the function's body.
struct Followed {
  std::string expression;
  double origin = 0.0;
  bool is_computed = false;  // of several readings

  std::string whole() const { return whole_of(expression, origin); }
};

class Description {
 public:
  Description(const Calibration& calibration, const Dialect& dialect)
      : calibration_(calibration),
        dialect_(dialect),
        turned_(mounting_of(calibration).value_or(Mounting{}) != Mounting{}) {}

  Correction make() {
    find_origins();
    const auto& table = calibration_.probe->effects();
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

  /// The channel; what isn't at hand becomes an argument.
  Followed follow(const std::string& name, const std::vector<double>& trial = {}) {
    Followed followed = at_hand(name).value_or(Followed{});
    if (!followed.expression.empty()) {
      guard(name, followed);
      return followed;
    }
    const auto& driver = driver_of(name, trial);
    Followed argument{driver.argument, driver.origin};
    guard(name, argument);
    return argument;
  }

  /// A channel that is a reading, or follows from some.
  std::optional<Followed> at_hand(const std::string& name) {
    const Exporter& exporter = exporter_of(calibration_);
    const bool is_total = name == "pt" || name == "pt_pa";
    if (dialect_.is_single() && exporter.by_difference && is_total) {
      const Driver& ps = driver_of("ps", {});
      return Followed{fmt::format("({} + pt_less_ps_pa)", ps.argument), ps.origin, true};
    }
    const auto readings = names_of_readings(exporter, dialect_.is_single());
    const auto found = readings.find(name);
    if (found == readings.end()) return std::nullopt;
    const std::string_view axes = "xyz";
    if (turned_ && name.size() == 2 && name[0] == 'm') {
      const auto i = axes.find(name[1]);
      return Followed{fmt::format("({0}[{1}][0] * m_ut[0] + {0}[{1}][1] * m_ut[1] + "
                                  "{0}[{1}][2] * m_ut[2])",
                                  dialect_.constant("turn"), i),
                      0.0, true};
    }
    return Followed{found->second, 0.0, found->second.ends_with("_read")};
  }

  const Driver& driver_of(const std::string& name, const std::vector<double>& trial) {
    const KnownChannel* const known = find_known(name);
    const auto there = std::ranges::find_if(result_.drivers, [&](const Driver& one) {
      return one.channel == name || (known != nullptr && one.known == known->argument);
    });
    if (there != result_.drivers.end()) return *there;
    Driver driver{.channel = name, .argument = identifier(name), .comment = "as it was logged"};
    driver.trial = trial.empty() ? std::vector{0.5, 0.2, 2.0} : trial;
    if (known != nullptr) {
      driver.argument = driver.known = known->argument;
      driver.comment = known->unit;
      driver.is_state = true;
      driver.trial = {known->trial.begin(), known->trial.end()};
    }
    if (const Interval* const range = range_of(name)) {
      const double span = range->upper - range->lower;
      driver.trial = {range->lower + 0.30902 * span, range->lower + 0.84721 * span,
                      range->lower + 0.14590 * span};  // where no round threshold lies
    }
    if (const auto origin = origins_.find(canonical(name)); origin != origins_.end()) {
      driver.origin = origin->second;
      if (driver.origin != 0.0) driver.argument += origin_suffix;
    }
    const auto same = [&](const Driver& other) { return other.argument == driver.argument; };
    while (std::ranges::any_of(result_.drivers, same)) driver.argument += "_in";
    result_.drivers.push_back(driver);
    return result_.drivers.back();
  }

  /// Where the fit saw the channel; nullptr where the calibration does not say.
  const Interval* range_of(const std::string& name) const {
    const auto found = calibration_.driver_ranges.find(name);
    return found == calibration_.driver_ranges.end() ? nullptr : &found->second;
  }

  void guard(const std::string& name, const Followed& followed) {
    const auto same = [&](const auto& one) { return one.channel == name; };
    if (std::ranges::any_of(result_.guards, same)) return;
    const Interval* const range = range_of(name);
    if (range != nullptr && range->lower < range->upper) {
      result_.guards.push_back({.channel = name,
                                .expression = followed.expression,
                                .origin = followed.origin,
                                .range = *range,
                                .is_computed = followed.is_computed});
      return;
    }
    const std::string why =
        range == nullptr
            ? "over which values the fit saw it is not known"
            : fmt::format("on the flight that was fitted it was constant, {:.6g}", range->lower);
    const std::string line = fmt::format("{} is not guarded: {}", name, why);
    if (std::ranges::find(result_.unguarded, line) == result_.unguarded.end()) {
      result_.unguarded.push_back(line);
    }
  }

  /// One name for what is one argument.
  static std::string canonical(const std::string& name) {
    if (name == "pt" || name == "pt_pa") return "ps_pa";
    const KnownChannel* const known = find_known(name);
    return known != nullptr ? std::string(known->argument) : name;
  }

  /// Where each driver is counted from, so that a float holds it.
  void find_origins() {
    if (!dialect_.is_single()) return;
    const auto readings = names_of_readings(exporter_of(calibration_), true);
    for (const EffectSetting& setting : calibration_.options.effects) {
      const EffectName name = parse_effect_name(setting.name);
      const bool is_counted = name.shape == Shape::power || name.shape == Shape::product ||
                              name.shape == Shape::spline || name.shape == Shape::levels;
      const auto& table = calibration_.probe->effects();
      if (!is_counted || catalogue::acts_on_the_world(table, name)) continue;
      for (const std::string& channel : driver_channels(name)) {
        if (channel == "time" || readings.contains(channel)) continue;
        const Interval* const range = range_of(channel);
        if (range == nullptr) {
          throw OptionError(
              {fmt::format("{}: over which values the fit saw it is not in the calibration, and a "
                           "header in float takes that; fit the flight again, give it after the "
                           "calibration, or leave out ",
                           channel),
               Option{"single"}});
        }
        origins_.try_emplace(canonical(channel), origin_of(*range));
      }
    }
  }

  std::string constant(const std::string& name, std::vector<double> values,
                       const std::string& comment) {
    result_.constants.push_back({name, std::move(values), 0, comment});
    return dialect_.constant(name);
  }

  std::string local(const std::string& expression, const std::string& comment) {
    return named(fmt::format("x_{}", number_), expression, comment);
  }

  std::string named(const std::string& name, const std::string& expression,
                    const std::string& comment) {
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
    const std::string d = follow(name.base).whole();
    const std::string n = constant(fmt::format("n_{}", number_),
                                   {value(setting.name + ".exponent")}, setting.name + ", 1");
    return local(fmt::format("{0} > 0.0 ? pow({0}, {1}) : 0.0", d, n), setting.name);
  }

  /// (d - centre)^k - mean, d a channel or a product of channels.
  std::string power(const EffectSetting& setting, const EffectName& name) {
    if (name.shape == Shape::product) return product(setting, name);
    const double centre = setting.centre.value_or(0.0);
    const double mean = setting.mean.value_or(0.0);
    const double reach = std::max(1.0, 0.1 * std::abs(centre));
    const Followed d =
        follow(name.base, {centre + 0.5 * reach, centre - reach, centre + 2.0 * reach});
    if (centre == 0.0 && d.origin != 0.0) {
      return local(about_origin(setting, d, name.number, mean), setting.name);
    }
    const std::string one = less_centre(setting, d.expression, centre - d.origin);
    const std::vector<std::string> factors(static_cast<std::size_t>(name.number), one);
    return local(less_mean(setting, fmt::format("{}", fmt::join(factors, " * ")), mean),
                 setting.name);
  }

  std::string less_centre(const EffectSetting& setting, const std::string& d, double centre) {
    if (centre == 0.0) return d;
    return fmt::format("({} - {})", d,
                       constant(fmt::format("centre_{}", number_), {centre},
                                setting.name + ": where its driver counts from"));
  }

  std::string less_mean(const EffectSetting& setting, const std::string& x, double mean) {
    if (mean == 0.0) return x;
    return x + " - " +
           constant(fmt::format("mean_{}", number_), {mean},
                    setting.name + ": of its driver's power on the flight");
  }

  /// (origin + d)^k - mean as a polynomial of d, so that no large number is taken from another.
  std::string about_origin(const EffectSetting& setting, const Followed& d, int power,
                           double mean) {
    std::vector<double> c = powers_about(d.origin, power);
    c.front() -= mean;
    return horner(constant(fmt::format("powers_{}", number_), c,
                           setting.name + ": coefficients of its driver's powers, lowest first"),
                  0, static_cast<std::size_t>(power), d.expression);
  }

  std::string product(const EffectSetting& setting, const EffectName& name) {
    const double centre = setting.centre.value_or(0.0);
    const double mean = setting.mean.value_or(0.0);
    std::vector<Followed> followed;
    for (const ChannelFactor& factor : name.factors) followed.push_back(follow(factor.channel));
    const auto is_far = [](const Followed& one) { return one.origin != 0.0; };
    if (std::ranges::any_of(followed, is_far)) {
      return product_about_origins(setting, name, followed, centre + mean);
    }
    std::vector<std::string> factors;
    for (std::size_t i = 0; i < followed.size(); ++i) {
      const ChannelFactor& factor = name.factors[i];
      const std::string& one = followed[i].expression;
      for (int k = 0; k < factor.power; ++k) {
        factors.push_back(factor.absolute ? fmt::format("fabs({})", one) : one);
      }
    }
    const std::string d = fmt::format("{}", fmt::join(factors, " * "));
    return local(less_mean(setting, less_centre(setting, d, centre), mean), setting.name);
  }

  /// A product less its value at the origins, step by step: with f = F + e each factor's value at
  /// its origin and what it changes, fg - FG = (f - F) g + F (g - G).
  std::string product_about_origins(const EffectSetting& setting, const EffectName& name,
                                    const std::vector<Followed>& followed, double less) {
    double at_origins = 1.0;
    std::string change;
    for (std::size_t i = 0; i < followed.size(); ++i) {
      const ChannelFactor& factor = name.factors[i];
      const std::string of = fmt::format("{}_{}", number_, i + 1);
      const double origin = factor.absolute ? std::abs(followed[i].origin) : followed[i].origin;
      std::vector<double> c = powers_about(origin, factor.power);
      const double there = c.front();
      c.front() = 0.0;
      const std::string e = named(
          fmt::format("x_{}", of),
          horner(constant("powers_" + of, c, setting.name + ": coefficients of a factor's powers"),
                 0, static_cast<std::size_t>(factor.power), argument_of(factor, followed[i])),
          factor.channel);
      change = change.empty() ? e
                              : fmt::format("({}) * ({} + {}) + {} * {}", change, e,
                                            number_text(there), number_text(at_origins), e);
      at_origins *= there;
    }
    return local(fmt::format("{} + {}", change,
                             constant(fmt::format("mean_{}", number_), {at_origins - less},
                                      setting.name + ": its driver at the origins, less its mean")),
                 setting.name);
  }

  /// A factor's channel less its origin; |channel| less |origin|.
  static std::string argument_of(const ChannelFactor& factor, const Followed& d) {
    if (!factor.absolute) return d.expression;
    if (d.origin == 0.0) return fmt::format("fabs({})", d.expression);
    const std::string g = fmt::format("{}{}", d.origin < 0.0 ? "-" : "", d.expression);
    const std::string origin = number_text(std::abs(d.origin));
    return fmt::format("({0} >= -{1} ? {0} : -2.0 * {1} - ({0}))", g, origin);
  }

  /// A natural spline for every component: the sum of its functions less their means.
  void add_spline(const EffectSetting& setting, const EffectName& name,
                  const std::vector<std::string>& components) {
    result_.has_splines = true;
    const std::vector<double>& knots = setting.knots;
    const double first = knots.front();
    const double span = knots.back() - first;
    const Followed d =
        follow(name.base, {first + 0.3 * span, first + 0.85 * span, first - 0.1 * span});
    const std::string k =
        constant(fmt::format("knots_{}", number_), less(knots, d.origin), setting.name);
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
                "{}({}, {}, {}, {}, {})", dialect_.own("spline"), d.expression, knots.size(), k,
                constant("values_" + of, values, said),
                constant("curvatures_" + of, curvatures,
                         fmt::format("{}.{}, second derivatives there", setting.name, component))));
    }
  }

  static std::vector<double> less(std::vector<double> values, double origin) {
    for (double& value : values) value -= origin;
    return values;
  }

  /// For every component the constant of the level that the channel is on.
  void add_levels(const EffectSetting& setting, const EffectName& name,
                  const std::vector<std::string>& components) {
    const std::vector<double>& from = name.thresholds;
    const Followed d = follow(name.base, {from.front() - 1.0, from.front(), from.back() + 1.0});
    const std::string limits =
        constant(fmt::format("from_{}", number_), less(from, d.origin), setting.name);
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
        value = fmt::format("{} >= {} ? {} : {}", d.expression, element(limits, from.size(), j),
                            element(s, from.size(), j), value);
      }
      share(name.port + "." + component, fmt::format("({})", value));
    }
  }

  void add_physics(const EffectSetting& setting) {
    const auto why = stranded().find(setting.name);
    if (why != stranded().end()) refuse(setting.name, why->second);
    if (setting.name == "cubic_nonlinearity") {
      result_.is_cubic = true;
      add_cubic();
    } else if (setting.name == "pressure_offset") {
      add_coefficients(setting, setting.name, {"s"}, "");
    } else if (setting.name == "density_error") {
      const std::string x =
          local(fmt::format("0.5 / {}", follow("temperature").whole()), setting.name);
      add_coefficients(setting, std::string(exporter_of(calibration_).density_scales), {"s"}, x);
    } else if (setting.name == "compressibility") {
      const std::string x = local(compressible(), setting.name);
      add_coefficients(setting, "airspeed_scale", {"s"}, x);
    } else if (setting.name == "angle_loss") {
      follow("alpha");
      follow("beta");
      const std::string along = local("cos(alpha_read) * cos(beta_read)", setting.name);
      add_coefficients(setting, "airspeed_scale", {"s"}, fmt::format("(1.0 - {0} * {0})", along));
    } else if (setting.name == "upwash" || setting.name == "sidewash") {
      const bool up = setting.name == "upwash";
      const std::string x = local(
          fmt::format("{} / sqrt(2.0 * pressure / rho_kgpm3)", follow(up ? "q" : "p").whole()),
          setting.name);
      add_coefficients(setting, up ? "alpha_offset" : "beta_offset", {"k"}, x);
    } else {
      refuse(setting.name, "its correction is not written for a vehicle");
    }
  }

  /// The airspeed of compressible air over that of incompressible air, less one. In float what is
  /// taken from one is computed without it.
  std::string compressible() {
    const std::string ps = follow("ps").whole();
    follow("rho");
    const std::string share = dialect_.is_single()
                                  ? fmt::format("expm1(2.0 / 7.0 * log1p(pressure / {}))", ps)
                                  : fmt::format("(pow(pressure / {} + 1.0, 2.0 / 7.0) - 1.0)", ps);
    return fmt::format(
        "sqrt(1.4 * {} / rho_kgpm3) * sqrt(5.0 * {}) / sqrt(2.0 * pressure / rho_kgpm3) - 1.0", ps,
        share);
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
  bool turned_;  // the sensor, against the body's axes in which a fit has its readings
  std::map<std::string, double> origins_;  // by canonical()
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
