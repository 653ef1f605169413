// SPDX-License-Identifier: BSD-3-Clause
#include "effects/named_driver.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <ranges>
#include <utility>

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal::effects {
namespace {

using Shape = EffectName::Shape;

constexpr double longest_delay = 0.2;  // [s] of a driver

/// The unit that a header's last part says, or nothing.
std::string unit_of_channel(const std::string& header) {
  static const std::map<std::string, std::string> known{
      {"m", "m"},         {"ft", "ft"},   {"km", "km"},   {"s", "s"},     {"ms", "ms"},
      {"a", "A"},         {"ma", "mA"},   {"v", "V"},     {"mv", "mV"},   {"w", "W"},
      {"degc", "degC"},   {"k", "K"},     {"rad", "rad"}, {"deg", "deg"}, {"radps", "rad/s"},
      {"degps", "deg/s"}, {"mps", "m/s"}, {"kt", "kt"},   {"pa", "Pa"},   {"hpa", "hPa"},
      {"kpa", "kPa"},     {"pct", "%"},   {"us", "us"},   {"rpm", "rpm"}, {"mps2", "m/s^2"},
      {"kgpm3", "kg/m^3"}};
  if (header == "time") return "s";
  if (header == "alpha" || header == "beta") return "rad";
  if (header == "p" || header == "q" || header == "r") return "rad/s";
  const std::size_t split = header.rfind('_');
  if (split == std::string::npos) return "";
  const auto found = known.find(header.substr(split + 1));
  return found == known.end() ? "" : found->second;
}

/// "degC^2", "(deg/s)^2"; of power 1 the unit itself.
std::string power_of(const std::string& unit, int power) {
  if (power <= 1) return unit;
  const bool is_compound = unit.find_first_of("/^ ") != std::string::npos;
  return (is_compound ? "(" + unit + ")" : unit) + "^" + std::to_string(power);
}

/// "1 per rad m"; the port's own unit where that of a factor isn't known.
std::string unit_of_product(const std::string& port_unit, const EffectName& name) {
  std::string units;
  for (const ChannelFactor& factor : name.factors) {
    const std::string unit = unit_of_channel(factor.channel);
    if (unit.empty()) return port_unit;
    units.append(" ").append(power_of(unit, factor.power));
  }
  return port_unit + " per" + units;
}

/// The values of a column in the record's segments.
std::vector<double> selected(const Record& record, const std::string& name) {
  const std::span<const double> column = record.column(name);
  std::vector<double> values;
  for (const Segment& segment : record.segments()) {
    const auto part = column.subspan(segment.first, segment.rows());
    values.insert(values.end(), part.begin(), part.end());
  }
  return values;
}

/// The segments' labels as numbers, in the order of `labels`; -1 for one that isn't there.
void add_label_codes(Record& record, const std::vector<std::string>& labels) {
  std::vector<double> codes(record.length(), -1.0);
  for (const Segment& segment : record.segments()) {
    const auto at = std::ranges::find(labels, segment.label);
    const double code = at == labels.end() ? -1.0 : static_cast<double>(at - labels.begin());
    std::fill(codes.begin() + static_cast<std::ptrdiff_t>(segment.first),
              codes.begin() + static_cast<std::ptrdiff_t>(segment.last), code);
  }
  record.add("maneuver", std::move(codes));
}

std::vector<std::string> labels_of(const Record& record) {
  std::vector<std::string> labels;
  for (const Segment& segment : record.segments()) {
    if (std::ranges::find(labels, segment.label) == labels.end()) labels.push_back(segment.label);
  }
  return labels;
}

void need_channel(const EffectName& name, const std::string& channel, const Record& record) {
  if (record.has(channel)) return;
  const std::vector<std::string> names = record.names();
  const auto begins = [&](const std::string& known) { return known.starts_with(channel + "_"); };
  const auto with_unit = std::ranges::find_if(names, begins);
  const std::string similar = with_unit != names.end()
                                  ? "; did you mean '" + *with_unit + "'?"
                                  : base::ask_for_similar(channel, names, channel.size() / 3);
  throw Error("effect " + name.text + ": there is no channel '" + channel + "'" +
              (similar.empty() ? "; the" : similar + " The") +
              " record has: " + base::list_names(names));
}

/// The product as a column of its own.
void add_product(const EffectName& name, Record& record) {
  if (record.has(name.base)) return;
  for (const std::string& channel : driver_channels(name)) need_channel(name, channel, record);
  record.add(name.base, multiply(name.factors, record));
}

void check_channel(const EffectName& name, const Record& record, bool known) {
  if (name.base == "maneuver") return;
  need_channel(name, name.base, record);
  const std::vector<double> values = selected(record, name.base);
  if (values.empty()) {
    throw Error("effect " + name.text + ": no row has a number of '" + name.base +
                "' and of all that is read beside it");
  }
  const auto is_number = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(values, is_number)) {
    throw Error("effect " + name.text + ": channel '" + name.base +
                "' holds something else than finite numbers");
  }
  const auto [lowest, highest] = std::ranges::minmax(values);
  if (known || lowest < highest) return;
  throw Error("effect " + name.text + ": channel '" + name.base + "' is constant (" +
              std::to_string(lowest) + "), so that this record can't show the effect");
}

/// Of altitude, time and temperature zero is far from any flight: they are taken about their mean
/// before they are raised to a power. Whatever else the header says: imu_temp_degc, oat_degc.
bool has_far_zero(const std::string& base) {
  if (base == "time") return true;
  for (const auto word : std::views::split(base, '_')) {
    const std::string_view name(word.begin(), word.end());
    if (name.starts_with("altitude") || name.starts_with("temp")) return true;
    if (name == "degc" || name == "degf") return true;
  }
  return false;
}

/// Whether the values stay further from zero than they change: nobody has seen the sensor at zero.
bool keep_from_zero(const std::vector<double>& values) {
  const auto [lowest, highest] = std::ranges::minmax(values);
  return std::max(lowest, -highest) > highest - lowest;
}

/// Knots in time, rounded to what a stamp of today, counted from 1970, resolves: the same splines
/// whatever time is counted from.
std::vector<double> resolved(std::vector<double> knots) {
  constexpr double resolution = 0x1p-22;  // [s]
  for (double& knot : knots) knot = std::round(knot / resolution) * resolution;
  return knots;
}

std::vector<double> means_of(const SplineBasis& basis, const std::vector<double>& values) {
  Eigen::RowVectorXd row(basis.functions());
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(basis.functions());
  for (const double value : values) {
    basis.evaluate(value, row);
    sum += row;
  }
  sum /= static_cast<double>(values.size());
  return {sum.begin(), sum.end()};
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

DriverPointer make_spline(const EffectName& name, const Variable& channel,
                          const std::vector<double>& values, const Port& port,
                          EffectSetting& setting) {
  if (setting.knots.empty()) {
    const auto [lowest, highest] = std::ranges::minmax(values);
    setting.knots = even_knots(lowest, highest, name.number);
    if (name.base == "time") setting.knots = resolved(std::move(setting.knots));
    if (has_far_zero(name.base) || (port.constant_is_own && keep_from_zero(values))) {
      setting.means = means_of(SplineBasis(setting.knots), values);
    }
  }
  const bool has_line = std::ranges::find(port.lines, name.base) != port.lines.end();
  return spline_driver(channel, setting.knots, setting.means, has_line);
}

DriverPointer make_levels(const EffectName& name, const Variable& channel,
                          const std::vector<double>& values, const EffectSetting& setting) {
  const auto [lowest, highest] = std::ranges::minmax(values);
  const bool within = lowest < name.thresholds.front() && name.thresholds.back() <= highest;
  if (!setting.known && !within) {
    throw Error("effect " + name.text + ": its thresholds are not within the values of '" +
                name.base + "', " + std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return levels_driver(channel, name.thresholds);
}

DriverPointer make_power(const EffectName& name, const Variable& channel,
                         const std::vector<double>& values, bool about_mean,
                         EffectSetting& setting) {
  if (!setting.centre) {
    setting.centre = has_far_zero(name.base) ? mean_of(values) : 0.0;
    if (about_mean && !has_far_zero(name.base) && keep_from_zero(values)) {
      std::vector<double> powers;
      for (const double value : values) powers.push_back(std::pow(value, name.number));
      setting.mean = mean_of(powers);
    }
  }
  return power_driver(channel, *setting.centre, name.number, setting.mean.value_or(0.0));
}

}  // namespace

std::string coefficient_unit(const std::string& port_unit, const EffectName& name) {
  if (name.shape == Shape::product) return unit_of_product(port_unit, name);
  const std::string channel = unit_of_channel(name.base);
  const bool as_it_is =
      name.shape != Shape::power && name.shape != Shape::ramp && name.shape != Shape::delay;
  if (as_it_is || channel.empty() || name.base == "maneuver") return port_unit;
  return port_unit + " per " + power_of(channel, name.number);
}

DriverPointer make_named_driver(const EffectName& name, const Port& port, EffectSetting& setting,
                                Record& record) {
  if (name.shape == Shape::product) add_product(name, record);
  check_channel(name, record, setting.known);
  if (name.base == "maneuver") {
    if (setting.labels.empty()) setting.labels = labels_of(record);
    if (!record.has("maneuver")) add_label_codes(record, setting.labels);
    return category_driver({"maneuver", ""}, setting.labels);
  }
  const Variable channel(name.base, name.base == "time" ? "s" : "");
  const std::vector<double> values = selected(record, name.base);
  if (name.shape == Shape::levels) return make_levels(name, channel, values, setting);
  if (name.shape == Shape::spline) return make_spline(name, channel, values, port, setting);
  if (name.shape == Shape::exponent) return exponent_driver(channel);
  if (name.shape == Shape::delay) return delay_driver(channel, record, longest_delay);
  if (name.shape == Shape::power || name.shape == Shape::product) {
    return make_power(name, channel, values, port.constant_is_own, setting);
  }
  if (!setting.span) setting.span = {values.front(), values.back()};
  const auto [first, last] = *setting.span;
  if (name.shape == Shape::decay) return decay_driver(channel, first, last);
  return name.shape == Shape::step ? step_driver(channel, first, last)
                                   : ramp_driver(channel, first, last);
}

}  // namespace sepcal::effects
