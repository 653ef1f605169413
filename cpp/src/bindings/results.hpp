// SPDX-License-Identifier: BSD-3-Clause
// Results as Python has them, where that is more than a C++ struct: points by their parameters'
// names, and a result with the page that the apps print of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/intervals.hpp"
#include "sepcal/flight/stepwise.hpp"
#include "sepcal/flight/track.hpp"

namespace sepcal::bindings {

/// What print() shows.
struct Page {
  std::string text;
  std::string explained;  // as with --explain
};

/// print() ends the last line itself.
inline std::string without_last_end(std::string page) {
  page.pop_back();
  return page;
}

template <class... Result>
Page page_of(const Result&... result) {
  return {without_last_end(to_text(result..., Detail::brief)),
          without_last_end(to_text(result..., Detail::explained))};
}

/// What a class in Python finds by [name]. Raises KeyError listing the names.
template <class Thing>
const Thing& find_named(const std::vector<Thing>& things, const std::string& name,
                        const std::string& what, const std::string& there) {
  const auto found = std::ranges::find(things, name, &Thing::name);
  if (found != things.end()) return *found;
  std::string names;
  for (const Thing& thing : things) names += (names.empty() ? "" : ", ") + thing.name;
  throw py::key_error("there is no " + what + " '" + name + "'; " + there + ": " +
                      (names.empty() ? "none" : names));
}

struct NamedMinimum {
  std::vector<OutputValue> xi2;
  double trace_r = 0.0;
};

struct NamedStageOne {
  Eigen::MatrixXd samples;  // S x n_2
  std::vector<OutputValue> best;
  std::vector<NamedMinimum> minima;
  StageOne rest;  // without its samples
};

/// sepcal.Fit
struct FittedModel {
  Fit fit;
  NamedStageOne stage_one;
  std::vector<EffectSetting> effects;
  Page page;
};

FittedModel fitted_model(Fit fit, std::vector<EffectSetting> effects, Page page);

/// sepcal.Comparison
struct Compared {
  Comparison comparison;
  std::string json;
  Page page;
};

inline Compared compared(Comparison comparison) {
  Page page = page_of(comparison);
  std::string json = to_json(comparison);
  return {std::move(comparison), std::move(json), std::move(page)};
}

/// sepcal.EffectFinding
struct FoundEffect {
  EffectFinding finding;
  std::string sentence;
};

/// sepcal.Diagnosis
struct Diagnosed {
  FlightDiagnosis diagnosis;
  std::vector<FoundEffect> effects;  // the diagnosis' own have gone there
  std::string sentence;
  std::string json;
  Page page;
};

inline Diagnosed diagnosed(FlightDiagnosis diagnosis) {
  Diagnosed result{.diagnosis = {},
                   .effects = {},
                   .sentence = verdict_sentence(diagnosis),
                   .json = to_json(diagnosis),
                   .page = page_of(diagnosis)};
  std::vector<EffectFinding> findings = std::move(diagnosis.diagnosis.effects);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    result.effects.push_back({std::move(findings[i]), std::move(diagnosis.sentences[i])});
  }
  result.diagnosis = std::move(diagnosis);
  return result;
}

/// With as many threads as the fit had.
inline DiagnosisOptions with_threads(DiagnosisOptions options, int threads) {
  options.threads = threads;
  return options;
}

inline StepwiseOptions stepwise_options(std::optional<std::size_t> most,
                                        DiagnosisOptions diagnosis) {
  StepwiseOptions options{.diagnosis = std::move(diagnosis)};
  options.most = most.value_or(options.most);
  return options;
}

/// What sepcal.Stepwise is made from.
template <class Fitted>
struct Stepped {
  Fitted fitted;
  std::vector<StepwiseStep> steps;
  StepwiseEnd end;
  std::string reason;
  Diagnosed last;
  std::string json;
  Page page;
};

template <class Fitted>
Stepped<Fitted> stepped(Fitted fitted, Stepwise course, std::string json, Page page) {
  return {std::move(fitted),        std::move(course.steps),           course.end,
          std::move(course.reason), diagnosed(std::move(course.last)), std::move(json),
          std::move(page)};
}

template <class Fitted>
void define_stepped(py::module_& module, const char* name) {
  using Self = Stepped<Fitted>;
  py::class_<Self>(module, name)
      .def_readonly("fitted", &Self::fitted)
      .def_readonly("steps", &Self::steps)
      .def_readonly("end", &Self::end)
      .def_readonly("reason", &Self::reason)
      .def_readonly("last", &Self::last)
      .def_readonly("json", &Self::json)
      .def_property_readonly("text", [](const Self& self) { return self.page.text; })
      .def_property_readonly("explained", [](const Self& self) { return self.page.explained; });
}

/// sepcal.Track
struct Tracked {
  Track track;
  std::vector<std::string> outputs;
};

/// sepcal.Track of a flight, its rows those of the flight, and notes.
using Tracking = std::pair<Tracked, std::vector<std::string>>;

inline Tracking tracking(TrackedFlight tracked) {
  Tracked result{std::move(tracked.track), {}};
  result.track.rows = std::move(tracked.flight_rows);
  for (const Variable& output : tracked.outputs) result.outputs.push_back(output.name);
  return {std::move(result), std::move(tracked.notes)};
}

/// sepcal.Intervals
struct FoundIntervals {
  double level = 0.0;
  std::vector<ProfileInterval> parameters;
  std::vector<std::string> notes;
  std::string json;
  Page page;
};

inline FoundIntervals found_intervals(FlightIntervals found) {
  Page page = page_of(found);
  std::string json = to_json(found);
  return {found.level, std::move(found.parameters), std::move(found.notes), std::move(json),
          std::move(page)};
}

/// sepcal.FlightCheck
struct Checked {
  FlightCheck check;
  std::string json;
  std::string text;
};

inline Checked checked(FlightCheck check) {
  std::string json = to_json(check);
  std::string text = without_last_end(to_text(check));
  return {std::move(check), std::move(json), std::move(text)};
}

/// An effect that is put into the measurements, {name: sizes}; None: none is.
using Injected = std::optional<std::pair<std::string, std::vector<double>>>;

}  // namespace sepcal::bindings
