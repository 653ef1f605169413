// SPDX-License-Identifier: BSD-3-Clause
// Which physical effect a fit lacks, as Python sees it.
#include "sepcal/diagnosis.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "results.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

/// {coefficient: one of its numbers, or its unit}
template <class Value>
py::typing::Dict<py::str, Value> by_coefficient(const std::vector<Coefficient>& coefficients,
                                                Value Coefficient::* member) {
  py::typing::Dict<py::str, Value> values;
  for (const Coefficient& one : coefficients) values[py::str(one.name)] = one.*member;
  return values;
}

template <class Value>
void set_by_coefficient(std::vector<Coefficient>& coefficients, Value Coefficient::* member,
                        const py::dict& values) {
  coefficients.resize(values.size());
  std::size_t k = 0;
  for (const auto& [name, value] : values) {
    coefficients[k].name = py::cast<std::string>(name);
    coefficients[k++].*member = py::cast<Value>(value);
  }
}

using Class = BoundStruct<FoundEffect>;

template <class Value>
void add_coefficients(Class& bound, const char* name, Value Coefficient::* member,
                      const char* doc) {
  bound.field(
      name,
      [=](const FoundEffect& self) { return by_coefficient(self.finding.coefficients, member); },
      [=](FoundEffect& self, const py::typing::Dict<py::str, Value>& values) {
        set_by_coefficient(self.finding.coefficients, member, values);
      },
      doc);
}

void define_effect(py::module_& module) {
  Class bound(module, "EffectFinding",
              "What a flight says about one candidate; NaN where a number is undefined.");
  bound.told(&FoundEffect::finding).field("sentence", &FoundEffect::sentence, "In plain words.");
  add_coefficients(bound, "estimate", &Coefficient::estimate,
                   "By coefficient, of one step from the fit, or of a fit.");
  add_coefficients(bound, "standard_error", &Coefficient::standard_error,
                   "In the noise model with the effect, or the fit's.");
  add_coefficients(bound, "unit", &Coefficient::unit, "By coefficient.");
  bound.comparable()
      .finish()
      .def_property_readonly(
          "in_words", [](const FoundEffect& self) { return status_in_words(self.finding); },
          R"(The status as tables show it; "not held out" and "too small" are sure, yet refused.)")
      .def_property_readonly(
          "beside_in_words", [](const FoundEffect& self) { return beside_in_words(self.finding); },
          "What becomes of it beside the first found, as tables show it.");
}

void define_parts(py::module_& module) {
  BoundStruct<Advice>(module, "Advice",
                      "Effects to add, once a fit with them has shown that they can be.")
      .field(
          "effect",
          [](const Advice& self) {
            return self.effect.empty() ? std::nullopt : std::optional(self.effect);
          },
          [](Advice& self, std::optional<std::string> effect) {
            self.effect = std::move(effect).value_or("");
          },
          "None where nothing was found or all was withheld.")
      .field("withheld", &Advice::withheld, "Why not what was found before it: a sentence each.")
      .field(
          "then",
          [](const Advice& self) {
            return self.then.empty() ? std::nullopt : std::optional(self.then);
          },
          [](Advice& self, std::optional<std::string> then) {
            self.then = std::move(then).value_or("");
          },
          "Its partner, to be added after it, where two were found that neither does alone.")
      .comparable()
      .finish();

  BoundStruct<ResidualNoise>(module, "ResidualNoise",
                             "An output's residual; NaN where a number is undefined.")
      .told()
      .finish();

  BoundStruct<Omnibus>(module, "Unexplained",
                       "Offsets of every output and every port by window of the flight, at once.")
      .field("p_value", &Omnibus::p_value, "")
      .field("p_adjusted", &Omnibus::p_adjusted, "After Holm, with the unmeasured causes.")
      .field("significant", &Omnibus::significant, "")
      .field("where", &Omnibus::where, "The port or output whose offsets explain most.")
      .field("windows", &Omnibus::windows, "[(window, how far off it is [sigma]), ...].")
      .comparable()
      .finish();
}

void define_causes(py::module_& module) {
  BoundStruct<UnmeasuredCause>(
      module, "UnmeasuredCause",
      "A cause that no logged channel follows. Rows and cycles a row where there is no time.")
      .told()
      .comparable()
      .finish();

  BoundStruct<DetectionLimit>(module, "DetectionLimit",
                              "The smallest slow effect that the flight would have shown: a "
                              "straight line in time that is found nine times in ten.")
      .told()
      .comparable()
      .finish();

  BoundStruct<ErrorBound>(module, "ErrorBound", "How far an error was let wander.")
      .told()
      .comparable()
      .finish();
}

void define_work(py::module_& module) {
  BoundStruct<DiagnosisWork>(module, "DiagnosisWork", "The work of a diagnosis.")
      .told()
      .comparable()
      .finish();

  BoundStruct<Injection>(module, "Injection",
                         "An effect that was put into the measurements, to see whether it would "
                         "have been found.")
      .field("effect", &Injection::effect, "")
      .field("sizes", &Injection::sizes, "Sizes of its coefficients.")
      .field("found", &Injection::found, "Itself, or it would do as well as what was.")
      .field(
          "rank",
          [](const Injection& self) {
            return self.rank == 0 ? std::nullopt : std::optional(self.rank);
          },
          [](Injection& self, std::optional<std::size_t> rank) { self.rank = rank.value_or(0); },
          "From 1, the first where it would do as well; None: the flight can't show it.")
      .field("p_adjusted", &Injection::p_adjusted, "")
      .field(
          "estimate",
          [](const Injection& self) {
            return by_coefficient(self.estimate, &Coefficient::estimate);
          },
          [](Injection& self, const py::typing::Dict<py::str, double>& values) {
            set_by_coefficient(self.estimate, &Coefficient::estimate, values);
          },
          "By coefficient.")
      .finish();
}

void define_steps(py::module_& module) {
  BoundStruct<StepwiseStep> bound(
      module, "StepwiseStep",
      "An effect that was added: what it promised and what came of it; NaN where undefined.\n\n"
      "The RMSE is over `outputs`, of the rows that are fitted, in their unit; where these have "
      "different ones in units of each one's own before. partial_f, pse and pse_without are those "
      "of EffectFinding.");
  bound.told().comparable().finish();
}

}  // namespace

void define_diagnosis(py::module_& module) {
  module.def("parse_sized_effect", [](const std::string& text) {
    SizedEffect sized = parse_sized_effect(text, "--inject");
    return std::pair(std::move(sized.name), std::move(sized.sizes));
  });
  define_effect(module);
  define_parts(module);
  define_causes(module);
  define_work(module);
  define_steps(module);
  constexpr auto whole = &Diagnosed::diagnosis;
  BoundStruct<Diagnosed> bound(module, "Diagnosis",
                               "A verdict and the ranked candidates; NaN where a number is "
                               "undefined.");
  const auto of = [&](const char* name, auto member, const char* doc) {
    using Value = std::decay_t<std::invoke_result_t<decltype(member), Diagnosis&>>;
    bound.field(
        name,
        [=](const Diagnosed& self) -> const Value& { return self.diagnosis.diagnosis.*member; },
        [=](Diagnosed& self, Value value) { self.diagnosis.diagnosis.*member = std::move(value); },
        doc);
  };
  bound.field("model", whole, &FlightDiagnosis::model, "");
  of("verdict", &Diagnosis::verdict,
     R"("adequate", "effect_missing", "slow_change", "unexplained".)");
  bound.field("sentence", &Diagnosed::sentence, "The verdict in one sentence.");
  of("advice", &Diagnosis::advice, "");
  of("pairs", &Diagnosis::pairs,
     "Two causes at once that explain it as well as anything, best first.");
  of("rmse", &Diagnosis::rmse, "Over all outputs, in their unit.");
  of("noise_floor", &Diagnosis::floor, "Innovations alone.");
  of("correlation_time", &Diagnosis::correlation_time,
     "Over which the residual goes together [s].");
  of("error_budget", &Diagnosis::error_budget, "By name: how far errors were let wander.");
  of("work", &Diagnosis::work, "What was done.");
  of("left_undone", &Diagnosis::left_undone, "Steps for which there was no time.");
  of("pse", &Diagnosis::pse,
     R"(What bounds the noise of the effects' pse: "sidpac" var(z)/2, "classic" var(z).)");
  of("rule", &Diagnosis::rule,
     R"(What decided: "verdict", or "partial-f", stepwise regression's.)");
  bound.field("effects", &Diagnosed::effects, "Best first.");
  of("residual", &Diagnosis::residual, "By output.");
  bound.field("where", whole, &FlightDiagnosis::where,
              "By segment and output, as compare() has it.");
  of("unexplained", &Diagnosis::omnibus, "Offsets that no candidate explains.");
  of("unmeasured", &Diagnosis::unmeasured, "Causes that follow no channel, the surest first.");
  of("limits", &Diagnosis::limits, "By port: the smallest slow effect that would have shown.");
  bound
      .field("missing_channels", whole, &FlightDiagnosis::missing_channels,
             "Not logged, and could explain what is left.")
      .field("injected", whole, &FlightDiagnosis::injection, "None where nothing was put in.")
      .field("status", whole, &FlightDiagnosis::status, "Of the calibration, repeated.")
      .field("message", whole, &FlightDiagnosis::message, "")
      .field("notes", whole, &FlightDiagnosis::notes, "One line each, for people.")
      .field("json", &Diagnosed::json, "")
      .field("text", &Diagnosed::page, &Page::text, "What print() shows: the app's page.")
      .field("explained", &Diagnosed::page, &Page::explained,
             "The same with the whole message, as by the apps' --explain.")
      .copied()
      .finish();
}

}  // namespace sepcal::bindings
