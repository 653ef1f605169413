// SPDX-License-Identifier: BSD-3-Clause
// The effects that are at work in a simulated flight: their names read, their sizes given out to
// their parameters, their sum at each place where they enter. What an entry does there is the
// simulators' business. Nothing is shared with the effects that a fit knows.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/simulation/simulate.hpp"
#include "simulation/hidden_driver.hpp"

namespace sepcal::simulation {

/// An entry of a probe's catalogue. `driver` is "*" for one of the user's choice in brackets, else
/// what drives an effect with a name of its own: "" or e.g. "step(time)".
struct KnownEffect {
  std::string_view name;
  std::string_view port;  // where it enters
  std::string_view driver;
  std::string_view components;  // separated by blanks
};

struct Alias {
  std::string_view name;
  std::string_view effect;
};

inline constexpr Alias air_data_aliases[] = {{"wind_shear", "wind[altitude_m]"},
                                             {"wind_drift", "wind[time]"},
                                             {"propwash", "pressure_offset[throttle]"}};

/// What a probe can have hidden in its flights.
struct HiddenCatalogue {
  std::string_view probe;
  std::span<const KnownEffect> effects;
  std::span<const Alias> aliases;
};

class HiddenEffects {
 public:
  /// Nothing is hidden.
  HiddenEffects() = default;

  /// The effects of `chosen`, and those that `parameters` has values of ("wind[time].n"). Throws
  /// Error, opened by `source`, for an unknown name, driver or parameter, an effect chosen twice, a
  /// number of sizes that doesn't fit, and for a size that isn't finite.
  HiddenEffects(const HiddenCatalogue& catalogue, const std::vector<SizedEffect>& chosen,
                const std::map<std::string, double>& parameters, const Sources& sources,
                const std::string& source);

  bool has(std::string_view port) const;

  /// The sum of what enters at a port, with its coefficients; `component` counts from 0.
  double sum(std::string_view port, const Moment& now, std::size_t component = 0) const;

  /// Components 0, 1, 2.
  Eigen::Vector3d sum_vector(std::string_view port, const Moment& now) const;

  /// The sum at the record's first row: of what doesn't change with time.
  double constant(std::string_view port, std::size_t component = 0) const;

  /// A spline runs over the `base`-th source, so its range matters.
  bool has_spline_over(std::size_t base) const;

  const std::vector<std::string>& names() const { return names_; }

  /// Every effect's parameters by name: components, then the shape.
  const std::map<std::string, double>& parameters() const { return parameters_; }

 private:
  struct Term {
    std::string_view port;
    Driver driver;
    std::vector<std::function<double(const Moment&)>> components;
  };

  void add(const HiddenCatalogue& catalogue, const SizedEffect& chosen,
           const std::map<std::string, double>& given, const Sources& sources);

  Moment first_;
  std::vector<Term> terms_;
  std::vector<std::string> names_;
  std::map<std::string, double> parameters_;
};

/// Puts down in the flight what was true, by name: `parameters` and the hidden effects'.
void record_truth(SimulatedFlight& flight, const std::map<std::string, double>& parameters,
                  const HiddenEffects& hidden);

/// Parameters of the probe's own, without those of hidden effects, which have a dot in their names.
std::map<std::string, double> without_effects(const std::map<std::string, double>& parameters);

}  // namespace sepcal::simulation
