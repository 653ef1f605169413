// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/plausible_readings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/escaping.hpp"
#include "flight/probes/ellipsoid.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::probes {
namespace {

struct Range {
  double low;
  double high;

  bool contains(double value) const { return low <= value && value <= high; }
};

struct QuantityRange {
  std::string_view quantity;
  Range range;  // in the unit used inside
  std::string_view unit;
};

constexpr std::array quantity_ranges{
    QuantityRange{"roll", {-6.3, 6.3}, "rad"}, QuantityRange{"pitch", {-1.6, 1.6}, "rad"},
    QuantityRange{"yaw", {-6.3, 6.3}, "rad"},  QuantityRange{"temp", {150, 400}, "K"},
    QuantityRange{"p", {-10, 10}, "rad/s"},    QuantityRange{"q", {-10, 10}, "rad/s"},
    QuantityRange{"r", {-10, 10}, "rad/s"},    QuantityRange{"rho", {0.02, 2}, "kg/m^3"},
    QuantityRange{"ps", {5e3, 1.2e5}, "Pa"},
};

constexpr Range dynamic_pressures{1, 5e4};  // [Pa]: airspeeds of 1 to 290 m/s at sea level
constexpr Range port_ratios{1e-3, 5};       // of the largest and the usual |dpa| / (pt - ps)
constexpr Range true_fields{5, 200};        // [uT]: the Earth's is 22 to 67
constexpr Range read_fields{5, 400};        // [uT]: iron near the sensor adds to it

using Field = std::array<std::string_view, 3>;
constexpr Field true_field_in_body{"hx", "hy", "hz"};
constexpr Field true_field_in_navigation{"bn", "be", "bd"};
constexpr Field read_field{"mx", "my", "mz"};

/// "; if it is in hpa or torr, --map ps_hpa=ps_pa reads it so": the units of its kind that would
/// put both values in the range.
std::string suggest_units(std::span<const Reading> readings, const Range& range, double smallest,
                          double largest) {
  std::vector<std::string_view> units;
  if (readings.front().relabel) {
    for (const files::Unit& unit : files::known_units(*readings.front().relabel)) {
      if (range.contains(unit.convert(smallest)) && range.contains(unit.convert(largest))) {
        units.push_back(unit.suffix);
      }
    }
  }
  if (units.empty()) return "; check its unit";
  std::vector<std::string> pairs;
  for (const Reading& reading : readings) {
    pairs.push_back(fmt::format("{}_{}={}", reading.header.substr(0, reading.header.rfind('_')),
                                units.front(),
                                reading.logged.empty() ? reading.header : reading.logged));
  }
  return fmt::format("; if it is in {}, --map {} reads it so{}", fmt::join(units, " or "),
                     base::in_shell(fmt::format("{}", fmt::join(pairs, ","))),
                     units.size() > 1 ? fmt::format(" for {}", units.front()) : "");
}

/// A direction a row, as long as what shows it.
struct Pointer {
  std::vector<double> north;
  std::vector<double> east;
  double shortest = 0.0;  // that is looked at
};

/// Where the velocity points, or else the field that is read, about its mean for hard iron: the
/// heading but for what is constant. Nothing where neither is in use.
std::optional<Pointer> find_pointer(const FindReading& find) {
  constexpr double slow = 3.0;  // m/s
  auto north = find("vn");
  auto east = find("ve");
  if (north && east) return Pointer{std::move(north->values), std::move(east->values), slow};
  north = find("mx");
  east = find("my");  // against the turn
  if (!north || !east) return std::nullopt;
  const auto about_mean = [](std::vector<double>& values, double sign) {
    double sum = 0.0;
    double count = 0.0;
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      sum += value;
      ++count;
    }
    for (double& value : values) value = sign * (value - sum / count);
  };
  about_mean(north->values, 1.0);
  about_mean(east->values, -1.0);
  return Pointer{std::move(north->values), std::move(east->values)};
}

/// How nearly a yaw in this unit [rad] turns with it, from 0 to 1; 0 where there are few rows.
double follow(const Pointer& pointer, std::span<const double> yaw, double unit) {
  constexpr std::size_t fewest = 20;
  std::complex<double> sum = 0.0;
  std::size_t rows = 0;
  for (std::size_t row = 0; row < yaw.size(); ++row) {
    const double north = pointer.north[row];
    const double east = pointer.east[row];
    if (!(std::hypot(north, east) > pointer.shortest)) continue;
    sum += std::polar(1.0, unit * yaw[row] - std::atan2(east, north));
    ++rows;
  }
  return rows < fewest ? 0.0 : std::abs(sum) / static_cast<double>(rows);
}

/// How fast a yaw turns, as a multiple of the rate r; NaN where that is not in use.
double compare_with_rate(std::span<const double> yaw, const FindReading& find) {
  const auto time = find("time");
  const auto rate = find("r");
  if (!time || !rate) return std::nan("");
  double both = 0.0;
  double rate_alone = 0.0;
  for (std::size_t row = 1; row < yaw.size(); ++row) {
    const double turned = rate->values[row] * (time->values[row] - time->values[row - 1]);
    both += turned * (yaw[row] - yaw[row - 1]);
    rate_alone += turned * turned;
  }
  return both / rate_alone;
}

/// Whether a yaw begins within a turn and goes on beyond it without a jump, as fast as aircraft
/// turn: degrees would have turned over, or be faster.
bool goes_on_slowly(std::span<const double> yaw, const FindReading& find) {
  constexpr std::size_t fewest = 20;
  constexpr double fastest = 1.5;  // [rad/s], but for a twentieth of the rows
  const auto time = find("time");
  if (!time || yaw.size() < fewest || !(std::abs(yaw.front()) < 2.0 * std::numbers::pi)) {
    return false;
  }
  std::vector<double> rates;
  for (std::size_t row = 1; row < yaw.size(); ++row) {
    const double step = std::abs(yaw[row] - yaw[row - 1]);
    if (!(step < std::numbers::pi)) return false;
    rates.push_back(step / (time->values[row] - time->values[row - 1]));
  }
  const auto high = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() * 19 / 20);
  std::ranges::nth_element(rates, high);
  return *high < fastest;
}

/// Whether a yaw beyond a turn is in radians all the same, and counts the turns: as such it turns
/// with the course or the field, or as fast as r says, and as degrees it doesn't. Where none of
/// these is in use, it goes on slowly.
bool is_unwrapped(const Reading& yaw, const FindReading& find) {
  constexpr double of_degree = std::numbers::pi / 180.0;
  constexpr double closely = 0.7;
  constexpr double nearly = 3.0;
  if (const auto pointer = find_pointer(find)) {
    const double in_radians = follow(*pointer, yaw.values, 1.0);
    const double in_degrees = follow(*pointer, yaw.values, of_degree);
    if (std::max(in_radians, in_degrees) > closely) return in_radians > in_degrees;
  }
  const double turns = compare_with_rate(yaw.values, find);
  if (std::isnan(turns)) return goes_on_slowly(yaw.values, find);
  return turns > 1.0 / nearly && turns < nearly;
}

void check_range(const QuantityRange& entry, const FindReading& find,
                 std::vector<Implausible>& found) {
  const auto reading = find(entry.quantity);
  if (!reading || reading->values.empty()) return;
  const bool counts_turns = entry.unit == "rad" && !reading->relabel;  // as degrees may
  if (counts_turns) return;
  const auto outside = std::ranges::count_if(
      reading->values, [&](double value) { return !entry.range.contains(value); });
  if (outside == 0 || (entry.quantity == "yaw" && is_unwrapped(*reading, find))) return;
  const auto [smallest, largest] = std::ranges::minmax(reading->values);
  found.push_back(
      {{reading->header},
       fmt::format("column '{}' lies outside {:g} to {:g} {} in {} of {} rows (it goes from {:.4g} "
                   "to {:.4g}){}",
                   reading->header, entry.range.low, entry.range.high, entry.unit, outside,
                   reading->values.size(), smallest, largest,
                   suggest_units({&*reading, 1}, entry.range, smallest, largest))});
}

/// Of the ellipsoid that the readings lie on all round, which hard iron does not touch; NaN where
/// they lie on none.
double radius_of(const std::array<Reading, 3>& field) {
  const Points points{field[0].values, field[1].values, field[2].values};
  const auto ellipsoid = fit_ellipsoid(points);
  if (!ellipsoid) return std::nan("");
  const Coverage coverage = judge_coverage(points, *ellipsoid);
  const bool all_round =
      coverage.roughness < 0.2 && coverage.one_sided < 0.5 && coverage.thinnest > 0.05;
  return all_round ? ellipsoid->radius() : std::nan("");
}

/// Returns whether the three columns are there.
bool check_field(const Field& names, const Range& range, const FindReading& find,
                 std::vector<Implausible>& found) {
  std::array<Reading, 3> field;
  for (std::size_t axis = 0; axis < field.size(); ++axis) {
    auto reading = find(names[axis]);
    if (!reading || reading->values.empty()) return false;
    field[axis] = std::move(*reading);
  }
  std::vector<double> strengths(field[0].values.size());
  for (std::size_t row = 0; row < strengths.size(); ++row) {
    strengths[row] = std::hypot(field[0].values[row], field[1].values[row], field[2].values[row]);
  }
  const double strength = numerics::upper_median(std::move(strengths));
  if (range.contains(strength)) return true;
  if (names == read_field && range.contains(radius_of(field))) return true;
  const bool given = names == true_field_in_navigation && field[0].header == names[0];
  const std::string whose = given ? "given is"
                                  : fmt::format("of {}, {}, {} is usually", field[0].header,
                                                field[1].header, field[2].header);
  constexpr double nanotesla = 1e3;  // of a uT
  const std::string mend = given && range.contains(strength / nanotesla)
                               ? "; if it is in nT, give a thousandth of it"
                               : suggest_units(field, range, strength, strength);
  std::vector<std::string> headers;
  if (!given) headers = {field[0].header, field[1].header, field[2].header};
  found.push_back(
      {std::move(headers),
       fmt::format("the field {} {:.4g} uT strong, which lies outside {:g} to {:g} uT{}", whose,
                   strength, range.low, range.high, mend)});
  return true;
}

/// pt - ps, or what a plain tube reads of it; nothing where neither is in use.
std::vector<double> find_dynamic_pressure(const FindReading& find,
                                          std::vector<std::string>& headers) {
  if (auto difference = find("dp")) {
    headers = {difference->header};
    return std::move(difference->values);
  }
  auto total = find("pt");
  const auto fixed = find("ps");
  if (!total || !fixed) return {};
  headers = {total->header, fixed->header};
  for (std::size_t row = 0; row < total->values.size(); ++row) {
    total->values[row] -= fixed->values[row];
  }
  return std::move(total->values);
}

void check_ports(std::string_view port, const std::vector<double>& dynamic,
                 const std::string& dynamic_name, const FindReading& find,
                 std::vector<Implausible>& found) {
  const auto reading = find(port);
  if (!reading) return;
  std::vector<double> ratios;
  for (std::size_t row = 0; row < dynamic.size(); ++row) {
    if (dynamic[row] > 0) ratios.push_back(std::abs(reading->values[row]) / dynamic[row]);
  }
  if (ratios.empty()) return;
  const double largest = std::ranges::max(ratios);
  const double usual = numerics::upper_median(std::move(ratios));
  if (largest == 0 || (largest >= port_ratios.low && usual <= port_ratios.high)) return;
  const bool too_large = usual > port_ratios.high;
  found.push_back({{reading->header},
                   fmt::format("column '{}' is out of proportion: it is {} {:.3g} times {}; "
                               "check both units",
                               reading->header, too_large ? "usually" : "at most",
                               too_large ? usual : largest, dynamic_name)});
}

void check_pressures(const FindReading& find, std::vector<Implausible>& found) {
  std::vector<std::string> headers;
  const std::vector<double> dynamic = find_dynamic_pressure(find, headers);
  if (dynamic.empty()) return;
  const std::string name = headers.size() == 1 ? fmt::format("column '{}'", headers[0])
                                               : fmt::format("{} - {}", headers[0], headers[1]);
  const double usual = numerics::upper_median(dynamic);
  if (!dynamic_pressures.contains(usual)) {
    found.push_back(
        {headers,
         fmt::format("{} is usually {:.3g} Pa, which lies outside {:g} to {:g} Pa; check the unit",
                     name, usual, dynamic_pressures.low, dynamic_pressures.high)});
  }
  for (const std::string_view port : {"dpa", "dpb"}) {
    check_ports(port, dynamic, name, find, found);
  }
}

}  // namespace

std::vector<Implausible> find_implausible(const FindReading& find,
                                          std::optional<double> field_strength) {
  std::vector<Implausible> found;
  for (const QuantityRange& entry : quantity_ranges) check_range(entry, find, found);
  check_pressures(find, found);
  // Readings in counts are judged against the strength that is given in the same.
  const bool in_counts = field_strength && !true_fields.contains(*field_strength);
  const double scale = in_counts ? *field_strength / 50.0 : 1.0;
  check_field(read_field, {scale * read_fields.low, scale * read_fields.high}, find, found);
  if (!check_field(true_field_in_navigation, true_fields, find, found)) {
    check_field(true_field_in_body, true_fields, find, found);
  }
  return found;
}

}  // namespace sepcal::probes
