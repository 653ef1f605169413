// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/check_options.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/name_list.hpp"
#include "base/thread_pool.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

/// The variable of that name, or an Error that lists those there are.
const Variable& find(const std::vector<Variable>& variables, const std::string& name,
                     const std::string& what) {
  const auto at = std::ranges::find(variables, name, &Variable::name);
  if (at == variables.end()) {
    std::vector<std::string> names;
    for (const Variable& variable : variables) names.push_back(variable.name);
    const std::string similar = base::ask_for_similar(name, names, name.size() / 2);
    throw Error("there is no " + what + " '" + name + "'" +
                (similar.empty() ? "; the" : similar + " The") +
                " model has: " + base::list_names(variables));
  }
  return *at;
}

void check_at_least(const std::string& option, int value, int least) {
  if (value >= least) return;
  throw OptionError({Option{option}, " is " + std::to_string(value) + "; it must be at least " +
                                         std::to_string(least)});
}

void check_screens(const Screens& screens) {
  if (!(screens.t_1 > 0) || !(screens.t_2 > 0)) {
    throw Error("the screens' t_1 and t_2 must be positive");
  }
  if (!(screens.l_2 >= 0) || !std::isfinite(screens.l_2)) {
    throw Error("the screens' l_2 must be positive, or 0 for the farthest corner of the bounds");
  }
}

void check_bounds(const FitOptions& options, const std::vector<Variable>& parameters) {
  for (const auto& [name, bounds] : options.bounds) {
    find(parameters, name, "parameter");
    if (bounds.lower < bounds.upper) continue;
    throw Error("the bounds of '" + name + "' leave no room; the lower must be below the upper" +
                " (to hold a parameter at a value, fix it)");
  }
}

void check_nonlinear(const FitOptions& options, const std::vector<Variable>& nonlinear) {
  for (const auto& [name, drawn] : options.sampling_distribution) {
    find(nonlinear, name, "nonlinear parameter (only these are sampled)");
  }
  for (const auto& [name, value] : options.start) {
    find(nonlinear, name, "nonlinear parameter (only these have a start)");
    if (!std::isfinite(value)) throw Error("the start of '" + name + "' is not a finite number");
  }
  for (const auto& [name, value] : options.unsampled) {
    find(nonlinear, name, "nonlinear parameter (only these are sampled)");
  }
}

void check_priors(const FitOptions& options, const std::vector<Variable>& parameters) {
  for (const auto& [name, normal] : options.prior) {
    find(parameters, name, "parameter");
    const double sd = normal.standard_deviation;
    if (!std::isfinite(normal.mean) || !(sd > 0) || !std::isfinite(sd)) {
      throw Error("the prior of '" + name +
                  "' must have a finite mean and a positive standard deviation");
    }
    if (options.fix.contains(name)) {
      throw Error("'" + name + "' is fixed, so that its prior has no part; drop one");
    }
  }
}

/// `parameters` with the bounds that hold.
void check_fixed(const FitOptions& options, const std::vector<Variable>& parameters) {
  for (const auto& [name, value] : options.fix) {
    const Variable& parameter = find(parameters, name, "parameter");
    if (!std::isfinite(value) || value < parameter.lower || value > parameter.upper) {
      throw Error("the fixed value of '" + name + "' is outside its bounds; widen them or mend it");
    }
  }
  const bool some_free = std::ranges::any_of(
      parameters, [&](const Variable& parameter) { return !options.fix.contains(parameter.name); });
  if (!some_free) {
    throw Error("every parameter is fixed, so that nothing is left to estimate; free one");
  }
}

void check_noise(const FitOptions& options, const std::vector<Variable>& outputs) {
  for (const auto& [name, sd] : options.noise) {
    find(outputs, name, "output");
    if (!(sd > 0) || !std::isfinite(sd)) {
      throw Error("the noise of output '" + name + "' must be a positive standard deviation");
    }
  }
  if (options.noise.empty()) return;
  for (const Variable& output : outputs) {
    if (options.noise.contains(output.name)) continue;
    throw Error("noise is given, but not for output '" + output.name +
                "'; give it for every output");
  }
}

void check_numbers(const FitOptions& options) {
  check_at_least("samples", options.samples, 0);
  check_at_least("descents", options.descents, 1);
  check_at_least("iterations", options.iterations, 1);
  check_at_least("noise_iterations", options.noise_iterations, 1);
  check_at_least("threads", options.threads, 0);
  if (options.threads > base::most_threads) {
    throw OptionError({Option{"threads"}, " " + std::to_string(options.threads) +
                                              " is too large; take at most " +
                                              std::to_string(base::most_threads)});
  }
  if (!(options.loss_width >= 0) || !std::isfinite(options.loss_width)) {
    throw OptionError({Option{"loss_width"}, " must be positive, or 0 for the loss's own"});
  }
  if (options.loss_width > 0 && options.loss == Loss::squares) {
    throw OptionError({Option{"loss_width"}, " is given without a loss; choose ", Option{"loss"},
                       " huber or cauchy, or leave it out"});
  }
  if (options.hessian != Hessian::fisher && options.method != FitMethod::filter_error) {
    throw OptionError({Option{"hessian"}, " is of filter error alone; leave it out, or choose ",
                       Option{"method"}, " filter-error"});
  }
  if (options.screens) check_screens(*options.screens);
  if (!(options.noise_tolerance > 0)) {
    throw OptionError({Option{"noise_tolerance"}, " must be positive"});
  }
}

}  // namespace

std::vector<Variable> with_bounds(const Tables& tables,
                                  const std::map<std::string, Interval>& bounds) {
  std::vector<Variable> parameters = tables.parameters();
  for (Variable& parameter : parameters) {
    const auto own = bounds.find(parameter.name);
    if (own == bounds.end()) continue;
    parameter.lower = own->second.lower;
    parameter.upper = own->second.upper;
  }
  return parameters;
}

void check_options(const FitOptions& options, const Tables& tables) {
  const std::vector<Variable> parameters = with_bounds(tables, options.bounds);
  check_bounds(options, parameters);
  check_nonlinear(options, tables.nonlinear);
  check_priors(options, parameters);
  check_fixed(options, parameters);
  check_noise(options, tables.outputs);
  check_numbers(options);
}

void refuse_sampling(const FitOptions& options, const std::string& why) {
  const FitOptions by_default;
  const auto refuse = [&](bool is_given, const char* option) {
    if (!is_given) return;
    throw OptionError(
        {Option{option}, " has no part here: this fit samples nothing: " + why + "; leave it out"});
  };
  refuse(options.search != by_default.search, "search");
  refuse(options.samples != by_default.samples && options.samples != 0, "samples");
  refuse(options.sampling != by_default.sampling, "sampling");
  refuse(!options.sampling_distribution.empty(), "sampling_distribution");
  refuse(options.screens.has_value(), "screens");
}

}  // namespace sepcal::estimation
