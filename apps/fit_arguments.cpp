// SPDX-License-Identifier: BSD-3-Clause
#include "fit_arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "base/thread_pool.hpp"
#include "option_values.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

template <class Value>
void refuse_repeated(const std::string& option, const std::map<std::string, Value>& given,
                     const std::string& name) {
  if (given.contains(name))
    throw Error(fmt::format("{} {} is given twice; keep one", option, name));
}

void add_repeated(CLI::App& fit, const std::string& name, std::vector<std::string>& texts,
                  const std::string& form, const std::string& description) {
  fit.add_option(name, texts, description + "; may be repeated")
      ->type_name(form)
      ->take_all()
      ->allow_extra_args(false);
}

Interval parse_interval(const std::string& name, const std::string& text) {
  const std::vector<std::string> ends = split(text, ',');
  if (ends.size() != 2) {
    throw Error(fmt::format("--bounds {}={}: write it as NAME=LO,HI", name, text));
  }
  const std::string option = "--bounds " + name;
  return {parse_value(option, ends[0]), parse_value(option, ends[1])};
}

template <NamedChoice T>
void add_choice(CLI::App& fit, const std::string& name, std::string& text,
                const std::string& description) {
  fit.add_option(name, text,
                 fmt::format("{}: {}", description, fmt::join(ChoiceNames<T>::names, ", ")))
      ->type_name("HOW")
      ->capture_default_str();
}

std::map<std::string, Normal> parse_priors(const std::vector<std::string>& texts) {
  std::map<std::string, Normal> priors;
  for (const std::string& text : texts) {
    const auto [name, value] = parse_assignment("--prior", text, "NAME=MEAN:SD");
    refuse_repeated("--prior", priors, name);
    const std::vector<std::string> numbers = split(value, ':');
    if (numbers.size() != 2) {
      throw Error(fmt::format("--prior {}: write it as NAME=MEAN:SD", text));
    }
    const std::string option = "--prior " + name;
    priors[name] = {parse_value(option, numbers[0]), parse_value(option, numbers[1])};
  }
  return priors;
}

}  // namespace

void FitArguments::add_to(CLI::App& fit) {
  FitOptions& engine = options_.fit;
  add_repeated(fit, "--effect", effects_, "E", "adds a physical effect to the model");
  fit.add_option("--stage-one-segments", engine.stage_one_segments,
                 "maneuvers or times that stage one uses, e.g. wind_circle_1,510.9:530")
      ->type_name("SEGMENTS");
  fit.add_option("--stage-two-segments", engine.stage_two_segments, "the same for stage two")
      ->type_name("SEGMENTS");
  add_repeated(fit, "--bounds", bounds_, "NAME=LO,HI", "bounds in the parameter's unit");
  add_repeated(fit, "--fix", fixed_, "NAME=VALUE", "holds a parameter at a value");
  add_repeated(fit, "--free", options_.free, "NAME", "frees a parameter that is held by default");
  add_repeated(fit, "--prior", priors_, "NAME=MEAN:SD",
               "a normal prior: what is known of a parameter beforehand");
  add_repeated(fit, "--noise", noise_, "OUTPUT=SD",
               "holds an output's noise at a standard deviation");
  add_whole_number(fit, "--samples", engine.samples, "samples of stage one");
  add_choice<Sampling>(fit, "--sampling", sampling_, "how samples are spread");
  add_choice<Search>(fit, "--search", search_, "how stage one looks for minima");
  add_whole_number(fit, "--seed", engine.seed, "seed of the samples");
  add_choice<SecondStage>(fit, "--second-stage", second_stage_, "what stage two is over");
  add_choice<ProjectedJacobian>(fit, "--jacobian", jacobian_, "of a projected stage two");
  add_choice<Loss>(fit, "--loss", loss_,
                   "what a residual costs; huber and cauchy forgive outliers");
  fit.add_option("--loss-width", engine.loss_width,
                 "where the loss begins to forgive, in noise standard deviations; 0: 1.345 for "
                 "huber, 2.385 for cauchy")
      ->type_name("K")
      ->capture_default_str();
  fit.add_option("--noise-tolerance", engine.noise_tolerance,
                 "relative change of R at which R and the parameters have settled")
      ->type_name("T")
      ->capture_default_str();
  add_whole_number(fit, "--threads", engine.threads, "threads; 0: one a core", base::most_threads);
  log_.add_to(fit);
}

CalibrationOptions FitArguments::resolve() const {
  CalibrationOptions options = options_;
  options.log = log_.over({});
  FitOptions& engine = options.fit;
  for (const std::string& text : effects_) {
    for (const std::string& name : split_effects(text)) options.effects.push_back({.name = name});
  }
  for (const std::string& text : bounds_) {
    const auto [name, interval] = parse_assignment("--bounds", text, "NAME=LO,HI");
    refuse_repeated("--bounds", engine.bounds, name);
    engine.bounds[name] = parse_interval(name, interval);
  }
  for (const std::string& text : fixed_) {
    const auto [name, value] = parse_assignment("--fix", text, "NAME=VALUE");
    refuse_repeated("--fix", engine.fix, name);
    engine.fix[name] = parse_value("--fix " + name, value);
    if (engine.bounds.contains(name)) {
      throw Error(fmt::format("--fix {0} and --bounds {0} contradict each other; keep one", name));
    }
  }
  for (const std::string& text : noise_) {
    const auto [name, value] = parse_assignment("--noise", text, "OUTPUT=SD");
    refuse_repeated("--noise", engine.noise, name);
    engine.noise[name] = parse_value("--noise " + name, value);
  }
  engine.prior = parse_priors(priors_);
  engine.second_stage = choice_of<SecondStage>("--second-stage", second_stage_);
  engine.jacobian = choice_of<ProjectedJacobian>("--jacobian", jacobian_);
  engine.loss = choice_of<Loss>("--loss", loss_);
  engine.search = choice_of<Search>("--search", search_);
  engine.sampling = choice_of<Sampling>("--sampling", sampling_);
  return options;
}

}  // namespace sepcal::app
