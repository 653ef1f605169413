// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/hidden_effects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "sepcal/error.hpp"
#include "sepcal/flight/csv.hpp"
#include "simulation/simulated_flight.hpp"

namespace sepcal::simulation {
namespace {

/// "wind[time]" to "wind" and "time"; a name without brackets has no driver.
struct Split {
  std::string_view name;
  std::string_view driver;
  bool brackets = false;
};

Split split_name(std::string_view effect) {
  const std::size_t open = effect.find('[');
  if (open == std::string_view::npos || !effect.ends_with(']') || effect.size() < open + 3) {
    return {effect, "", false};
  }
  return {effect.substr(0, open), effect.substr(open + 1, effect.size() - open - 2), true};
}

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ' ') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

const KnownEffect& find_effect(const HiddenCatalogue& catalogue, const std::string& effect) {
  const Split split = split_name(effect);
  for (const KnownEffect& known : catalogue.effects) {
    if (known.name == split.name && (known.driver == "*") == split.brackets) return known;
  }
  std::vector<std::string> names;
  for (const KnownEffect& known : catalogue.effects) {
    names.push_back(std::string(known.name) + (known.driver == "*" ? "[DRIVER]" : ""));
  }
  for (const Alias& alias : catalogue.aliases) names.emplace_back(alias.name);
  throw Error(fmt::format("'{}' is no effect of the simulated {}; it has: {}", effect,
                          catalogue.probe, fmt::join(names, ", ")));
}

std::string resolve_alias(const HiddenCatalogue& catalogue, const std::string& name) {
  const auto found = std::ranges::find(catalogue.aliases, name, &Alias::name);
  return found == catalogue.aliases.end() ? name : std::string(found->effect);
}

/// The sizes of the coefficients, then the shape where there is one, one each of `names`.
std::vector<double> give_out(const SizedEffect& chosen, const std::vector<std::string>& names,
                             bool has_shape, double default_shape) {
  const std::size_t coefficients = names.size() - (has_shape ? 1 : 0);
  std::vector<double> values = chosen.sizes;
  if (values.size() == 1) values.resize(coefficients, values.front());
  if (has_shape && values.size() == coefficients) values.push_back(default_shape);
  if (values.size() == names.size()) return values;
  throw Error(fmt::format("{} is given {} sizes; give one for all, or one each of {}{}",
                          chosen.name, chosen.sizes.size(), fmt::join(names, ", "),
                          has_shape ? " (the last may be left out)" : ""));
}

/// The values among a truth's parameters, one each of `names`.
std::vector<double> look_up(const std::vector<std::string>& names,
                            const std::map<std::string, double>& given, bool has_shape,
                            double default_shape) {
  std::vector<double> values;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = given.find(names[i]);
    if (found != given.end()) {
      values.push_back(found->second);
    } else if (has_shape && i + 1 == names.size()) {
      values.push_back(default_shape);
    } else {
      throw Error(fmt::format("parameter '{}' is missing; the effect needs: {}", names[i],
                              fmt::join(names, ", ")));
    }
  }
  return values;
}

}  // namespace

HiddenEffects::HiddenEffects(const HiddenCatalogue& catalogue,
                             const std::vector<SizedEffect>& chosen,
                             const std::map<std::string, double>& parameters,
                             const Sources& sources, const std::string& source)
    : first_(sources.rows.front()) {
  try {
    for (const SizedEffect& effect : chosen) add(catalogue, effect, parameters, sources);
    for (const auto& [name, value] : parameters) {
      const std::size_t dot = name.rfind('.');
      if (dot == std::string::npos) continue;
      const std::string effect = resolve_alias(catalogue, name.substr(0, dot));
      if (std::ranges::find(names_, effect) == names_.end())
        add(catalogue, {effect}, parameters, sources);
      if (!parameters_.contains(name)) {
        throw Error(fmt::format("parameter '{}' is unknown; the hidden effects have: {}", name,
                                fmt::join(std::views::keys(parameters_), ", ")));
      }
    }
  } catch (const Error& error) {
    throw_within(source + ": ", error);
  }
}

void HiddenEffects::add(const HiddenCatalogue& catalogue, const SizedEffect& chosen,
                        const std::map<std::string, double>& given, const Sources& sources) {
  const std::string name = resolve_alias(catalogue, chosen.name);
  if (std::ranges::find(names_, name) != names_.end()) {
    throw Error(fmt::format("{} is hidden twice; name it once", name));
  }
  const KnownEffect& known = find_effect(catalogue, name);
  const bool free = known.driver == "*";
  const Driver driver = parse_driver(name, free ? split_name(name).driver : known.driver, sources);

  const std::vector<std::string> suffixes = coefficient_suffixes(name, driver, sources);
  const std::vector<std::string> components = split_words(known.components);
  std::vector<std::string> names;
  for (const std::string& component : components) {
    for (const std::string& suffix : suffixes) {
      names.push_back(fmt::format("{}.{}{}", name, component, suffix));
    }
  }
  const std::string_view shape = shape_parameter(driver.form);
  if (!shape.empty()) names.push_back(fmt::format("{}.{}", name, shape));

  const double fallback = default_shape(driver.form, sources);
  const std::vector<double> values = chosen.sizes.empty()
                                         ? look_up(names, given, !shape.empty(), fallback)
                                         : give_out(chosen, names, !shape.empty(), fallback);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!std::isfinite(values[i])) throw Error(fmt::format("{} must be finite", names[i]));
    parameters_[names[i]] = values[i];
  }
  Term term{known.port, driver, {}};
  for (std::size_t i = 0; i < components.size(); ++i) {
    const std::span coefficients(values.data() + i * suffixes.size(), suffixes.size());
    term.components.push_back(drive(name, driver, sources, coefficients, values.back()));
  }
  terms_.push_back(std::move(term));
  names_.push_back(name);
}

bool HiddenEffects::has(std::string_view port) const {
  return std::ranges::find(terms_, port, &Term::port) != terms_.end();
}

double HiddenEffects::sum(std::string_view port, const Moment& now, std::size_t component) const {
  double sum = 0.0;
  for (const Term& term : terms_) {
    if (term.port == port) sum += term.components[component](now);
  }
  return sum;
}

Eigen::Vector3d HiddenEffects::sum_vector(std::string_view port, const Moment& now) const {
  return {sum(port, now, 0), sum(port, now, 1), sum(port, now, 2)};
}

double HiddenEffects::constant(std::string_view port, std::size_t component) const {
  return sum(port, first_, component);
}

bool HiddenEffects::has_spline_over(std::size_t base) const {
  return std::ranges::any_of(terms_, [base](const Term& term) {
    return term.driver.form == Driver::Form::spline && term.driver.base == base;
  });
}

void record_truth(SimulatedFlight& flight, const std::map<std::string, double>& parameters,
                  const HiddenEffects& hidden) {
  flight.truth = without_effects(parameters);
  flight.truth.insert(hidden.parameters().begin(), hidden.parameters().end());
  flight.effects = hidden.names();
}

std::map<std::string, double> without_effects(const std::map<std::string, double>& parameters) {
  std::map<std::string, double> own = parameters;
  std::erase_if(own, [](const auto& entry) { return entry.first.find('.') != std::string::npos; });
  return own;
}

}  // namespace sepcal::simulation
