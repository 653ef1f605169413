// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/suspect_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>

#include "flight/checks/excursions.hpp"
#include "flight/checks/turns.hpp"
#include "flight/probes/sequence.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::checks {
namespace {

using files::UnitKind;
using numerics::select_quantile;

constexpr std::size_t fewest_rows = 20;  // of which what is usual can be told

RowList without(const RowList& rows, const RowList& others) {
  RowList left;
  std::ranges::set_difference(rows, others, std::back_inserter(left));
  return left;
}

/// What people write where there is no reading: nines alone, or the end of an integer's range.
bool is_known_code(double value) {
  const double size = std::abs(value);
  for (const double bits : {16.0, 24.0, 32.0}) {
    const double end = std::exp2(bits);
    for (const double code : {end - 1, end - 2, end / 2, end / 2 - 1}) {
      if (size == code) return true;
    }
  }
  constexpr std::array fractions{1.0, 10.0, 100.0, 1000.0};
  return size >= 99 && std::ranges::any_of(fractions, [size](double fraction) {
           const double digits = std::round(size * fraction);
           if (std::abs(size * fraction - digits) > 1e-9 * digits) return false;
           const double power = std::round(std::log10(digits + 1));
           return digits + 1 == std::pow(10.0, power);
         });
}

/// What most values are: between the tenth part that is least and the tenth that is largest.
struct Body {
  double low = 0.0;
  double high = 0.0;

  double range() const { return high - low; }

  bool is_beyond(double value, double ranges) const {
    return value < low - ranges * range() || value > high + ranges * range();
  }
};

/// A code lies beyond what is read, on its own side of zero: 999 is a motor's least pulse.
bool is_code_of(const Body& body, double value) {
  return is_known_code(value) && (value < 0 ? value < body.low : value > body.high);
}

std::optional<Body> find_body(std::span<const double> values) {
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite),
                       [](double value) { return std::isfinite(value); });
  if (finite.size() < fewest_rows) return std::nullopt;
  return Body{select_quantile(finite, 0.1), select_quantile(finite, 0.9)};
}

/// Few levels: what is set in steps, of which one far off may be as good as the others. A code is
/// one that people know there, and beyond all that is set.
bool is_beyond_steps(std::span<const double> values, const Body& body, double code) {
  constexpr std::size_t few = 10;
  std::set<double> levels;
  for (const double value : values) {
    if (std::isfinite(value) && value != code && !body.is_beyond(value, 3)) levels.insert(value);
    if (levels.size() >= few) return true;
  }
  const double least = *levels.begin();
  const double largest = *levels.rbegin();
  const double span = std::max({largest - least, std::abs(least), std::abs(largest)});
  return is_code_of(body, code) && (code < least - 3 * span || code > largest + 3 * span);
}

/// Whether the value comes again and again and goes at once. One that no rule knows must not stay:
/// it could be where the vehicle stood, or a limit.
bool comes_and_goes(const RowList& rows, std::size_t length, const Body& body, double code,
                    const Manner& manner) {
  if (is_code_of(body, code)) return true;
  constexpr std::size_t brief = 3;
  const bool may_stay = manner.flows && !(manner.rests && code == 0);
  const std::vector<Segment> runs = find_runs_of(rows);
  if (runs.size() < 2 && (!may_stay || rows.size() <= brief)) return false;
  return std::ranges::all_of(runs, [&](const Segment& run) {
    const bool at_end = run.first == 0 || run.last == length;
    return run.rows() <= brief || (may_stay && !at_end);
  });
}

/// Whether more than a few readings lie beyond it: then it is one of them, 99.9 among 95 to 120.
bool is_within_readings(std::span<const double> values, double code, std::size_t few) {
  const auto lies_beyond = [code](double value) {
    return std::isfinite(value) && !is_known_code(value) &&
           (code < 0 ? value < code : value > code);
  };
  return std::ranges::count_if(values, lies_beyond) > static_cast<std::ptrdiff_t>(few);
}

/// Values that stand for none where they are far from all others: what people know as a code, and
/// others where these are few.
std::vector<double> find_far_values(std::span<const double> values, const Body& body) {
  constexpr std::size_t most = 3;
  std::set<double> codes;
  std::set<double> others;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (body.is_beyond(value, 1) && is_code_of(body, value)) codes.insert(value);
    if (body.is_beyond(value, 3) && others.size() <= most) others.insert(value);
  }
  std::erase_if(codes, [&](double code) { return is_within_readings(values, code, most); });
  if (codes.size() > most) return {};
  if (others.size() <= most) codes.merge(others);
  return {codes.begin(), codes.end()};
}

void find_sentinels(std::span<const double> values, const Manner& manner, SuspectRows& found) {
  const auto body = find_body(values);
  if (!body) return;
  for (const double code : find_far_values(values, *body)) {
    RowList rows;
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] == code) rows.push_back(row);
    }
    const bool within_turn = manner.turn > 0 && std::abs(code) <= manner.turn;
    if (within_turn || 10 * rows.size() > values.size()) continue;
    if (!is_beyond_steps(values, *body, code)) continue;
    if (!comes_and_goes(rows, values.size(), *body, code, manner)) continue;
    found.sentinels = join(found.sentinels, rows);
    found.codes.push_back(code);
  }
}

/// A run of equal values within a stretch, and the jump at its end; 0 where the stretch ends.
struct Run {
  std::size_t first = 0;
  std::size_t last = 0;
  double jump = 0.0;

  std::size_t rows() const { return last - first; }
};

std::vector<Run> find_runs_in(std::span<const double> values,
                              const std::vector<Segment>& stretches) {
  std::vector<Run> runs;
  for (const Segment& stretch : stretches) {
    for (std::size_t i = stretch.first; i < stretch.last;) {
      std::size_t end = i + 1;
      while (end < stretch.last && values[end] == values[i]) ++end;
      const double jump = end < stretch.last ? values[end] - values[i] : 0.0;
      if (std::isfinite(values[i])) runs.push_back({i, end, std::isfinite(jump) ? jump : 0.0});
      i = end;
    }
  }
  return runs;
}

/// Whether what is beside `runs[at]` shows that the column can't stand still: it has noise, so that
/// its jumps grow and shrink by turns, by more than a step (NaN: there are none) and by more than
/// digits do; or it catches up at once when the run is over.
bool stood_still_by_force(const std::vector<Run>& runs, std::size_t at, double step) {
  constexpr std::size_t reach = 30;
  const double least = std::isfinite(step) ? 2.5 * step : 0.0;
  std::vector<double> jumps;
  std::vector<double> changes;
  std::size_t turns = 0;
  const auto look = [&](std::size_t first, std::size_t last) {
    double before = 0.0;
    for (std::size_t k = first; k < last; ++k) {
      jumps.push_back(std::abs(runs[k].jump));
      if (k == first) continue;
      const double change = runs[k].jump - runs[k - 1].jump;
      changes.push_back(std::abs(change));
      if (change * before < 0 && std::abs(change) > least && std::abs(before) > least) ++turns;
      before = change;
    }
  };
  look(at < reach ? 0 : at - reach, at == 0 ? 0 : at - 1);
  look(at + 1, std::min(at + 1 + reach, runs.size()));
  if (changes.size() < 10) return false;
  const double digits = 0.02 * select_quantile(jumps, 0.5);
  const bool noisy = 5 * turns > 2 * changes.size() && select_quantile(changes, 0.5) > digits;
  return noisy || std::abs(runs[at].jump) > 6 * select_quantile(jumps, 0.85);
}

/// Far longer than the column keeps a value elsewhere. Values at zero or at an end of what it
/// reads may be rest or a limit, and a slow column on steps keeps one until the next is reached.
RowList find_frozen(std::span<const double> values, const std::vector<Segment>& stretches) {
  constexpr std::size_t fewest_runs = 50;
  constexpr std::size_t shortest = 30;  // rows
  constexpr std::size_t most = 5;       // times; what stands still oftener does so by itself
  const std::vector<Run> runs = find_runs_in(values, stretches);
  if (runs.size() < fewest_runs) return {};
  std::vector<double> lengths;
  std::vector<double> jumps;
  double least = infinity;
  double largest = -infinity;
  for (const Run& run : runs) {
    lengths.push_back(static_cast<double>(run.rows()));
    if (run.jump != 0) jumps.push_back(std::abs(run.jump));
    least = std::min(least, values[run.first]);
    largest = std::max(largest, values[run.first]);
  }
  if (std::ranges::max(lengths) < shortest) return {};
  double longest_usual = 12 * select_quantile(lengths, 0.98);
  double longest_else = 1.0;  // a column that rests now and then does so for all sorts of times
  for (const double length : lengths) {
    if (length < longest_usual) longest_else = std::max(longest_else, length);
  }
  longest_usual = std::max(longest_usual, 4 * longest_else);
  const double step = probes::find_sequence(values, stretches).step;
  const bool on_steps = std::isfinite(step) && select_quantile(jumps, 0.5) < 2.5 * step;
  RowList rows;
  std::size_t times = 0;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Run& run = runs[k];
    const double value = values[run.first];
    if (run.rows() < shortest || static_cast<double>(run.rows()) < longest_usual) continue;
    if (value == 0 || value == least || value == largest) continue;
    if (on_steps && std::abs(run.jump) < 5 * step) continue;
    if (!stood_still_by_force(runs, k, step)) continue;
    ++times;
    for (std::size_t row = run.first; row < run.last; ++row) rows.push_back(row);
  }
  return times > most || 2 * rows.size() > values.size() ? RowList() : rows;
}

double turn_in(const files::Unit& unit) { return 2 * std::numbers::pi / unit.convert(1.0); }

}  // namespace

Manner manner_of(std::string_view quantity, const files::Unit& unit) {
  Manner manner;
  const bool answers_the_stick = quantity == "dpa" || quantity == "dpb";
  manner.flows = unit.kind != UnitKind::rate && !answers_the_stick;
  manner.rests = unit.kind == UnitKind::speed || quantity == "dp";
  if (unit.kind == UnitKind::angle) manner.turn = turn_in(unit);
  constexpr std::array set{"elevator", "aileron", "rudder", "throttle", "thrust"};
  manner.may_be_set = std::ranges::find(set, quantity) != set.end();
  return manner;
}

Manner manner_of_channel(std::string_view header) {
  const std::size_t split = header.rfind('_');
  if (split == std::string_view::npos) return {.may_be_set = true};
  const std::string_view suffix = header.substr(split + 1);
  const auto is_in = [suffix](UnitKind kind) { return files::find_unit(kind, suffix) != nullptr; };
  Manner manner;
  if (const files::Unit* angle = files::find_unit(UnitKind::angle, suffix)) {
    manner.turn = turn_in(*angle);
  }
  manner.rests = is_in(UnitKind::speed);
  constexpr std::array flowing{UnitKind::length,      UnitKind::speed,   UnitKind::pressure,
                               UnitKind::temperature, UnitKind::density, UnitKind::mass};
  manner.flows = std::ranges::any_of(flowing, is_in);
  manner.may_be_set = !manner.flows;
  return manner;
}

void SuspectRows::freeze(const RowList& rows) {
  for (RowList* const others : {&sentinels, &spikes, &bursts}) *others = without(*others, rows);
  frozen = join(frozen, rows);
}

RowList SuspectRows::all() const { return join(join(sentinels, spikes), join(bursts, frozen)); }

SuspectRows find_suspect_rows(std::span<const double> values, const std::vector<Segment>& stretches,
                              const Manner& manner) {
  SuspectRows found;
  find_sentinels(values, manner, found);
  found.frozen = find_frozen(values, stretches);
  if (manner.may_be_set) return found;
  std::vector<double> readings(values.begin(), values.end());
  for (const std::size_t row : found.sentinels) readings[row] = not_a_number;
  if (manner.turn > 0) unwrap(readings, manner.turn);
  const Excursions excursions = find_excursions(readings, stretches, manner);
  found.spikes = without(excursions.spikes, found.frozen);
  found.bursts = without(excursions.bursts, found.frozen);
  found.farthest_spike = excursions.farthest_spike;
  found.spike_share = excursions.spike_share;
  found.farthest_burst = excursions.farthest_burst;
  return found;
}

RowList join(const RowList& one, const RowList& other) {
  RowList rows;
  std::ranges::set_union(one, other, std::back_inserter(rows));
  return rows;
}

std::vector<Segment> find_runs_of(const RowList& rows) {
  std::vector<Segment> runs;
  for (const std::size_t row : rows) {
    if (runs.empty() || runs.back().last != row) runs.push_back({"", row, row});
    runs.back().last = row + 1;
  }
  return runs;
}

bool is_constant(std::span<const double> values) {
  if (values.size() < fewest_rows || !std::isfinite(values.front())) return false;
  return std::ranges::all_of(values, [&](double value) { return value == values.front(); });
}

}  // namespace sepcal::checks
