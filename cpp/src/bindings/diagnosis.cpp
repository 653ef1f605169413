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

void add_structure(Class& bound, const char* name, double Structure::* member, const char* doc) {
  bound.field(
      name, [=](const FoundEffect& self) { return self.finding.structure.*member; },
      [=](FoundEffect& self, double value) { self.finding.structure.*member = value; }, doc);
}

void define_effect(py::module_& module) {
  constexpr auto of = &FoundEffect::finding;
  using Finding = EffectFinding;
  Class bound(module, "EffectFinding",
              "What a flight says about one candidate; NaN where a number is undefined.");
  bound.field("name", of, &Finding::name, "What add() takes.")
      .field("sentence", &FoundEffect::sentence, "In plain words.")
      .field("drivers", of, &Finding::drivers, "Channels.");
  add_coefficients(bound, "estimate", &Coefficient::estimate,
                   "By coefficient, of one step from the fit, or of a fit.");
  add_coefficients(bound, "standard_error", &Coefficient::standard_error,
                   "In the noise model with the effect, or the fit's.");
  add_coefficients(bound, "unit", &Coefficient::unit, "By coefficient.");
  bound.field("is_fitted", of, &Finding::is_fitted, "The estimates are those of a fit with it.")
      .field("shapes", of, &Finding::shapes, R"(Of a scan: {"bias_step.t0": 41.2}.)")
      .field("p_value", of, &Finding::p_value, "For itself, corrected for its scan.")
      .field("log10_p", of, &Finding::log10_p, "Of the same, which may be too small for a float.")
      .field("p_adjusted", of, &Finding::p_adjusted, "After Holm: for the verdict.")
      .field("p_listed", of, &Finding::p_listed, "After Benjamini & Hochberg: for the list.")
      .field("outputs", of, &Finding::outputs,
             "That it can reach: all where they share parameters.");
  add_structure(bound, "partial_f", &Structure::partial_f,
                "As stepwise regression has it, residuals taken for white; sums of squares over "
                "`outputs`, each in units of its RMSE in the fit.");
  add_structure(bound, "sse", &Structure::sse, "Without it.");
  add_structure(bound, "sse_reduction", &Structure::sse_reduction,
                "By orthogonal functions: what it takes of sse.");
  add_structure(bound, "pse", &Structure::pse, "Predicted square error, SSE/N + 2 s2max p/N.");
  add_structure(bound, "pse_without", &Structure::pse_without, "The same without it.");
  bound
      .field("predicted_drop", of, &Finding::predicted_drop,
             "Of the RMSE over these outputs, 1 - after / before.")
      .field("held_out_gain", of, &Finding::held_out_gain, "The same on rows left out.")
      .field("held_out_before", of, &Finding::held_out_before, "RMSE of rows left out.")
      .field("held_out_after", of, &Finding::held_out_after, "The same with it.")
      .field("held_out_passed", of, &Finding::held_out_passed,
             "The mean gain of a block exceeds its standard error.")
      .field("share_after_selection", of, &Finding::share_after_selection,
             "Of the estimates, allowing for the effect's choice.")
      .field("held_out_interleaved", of, &Finding::held_out_interleaved,
             "Blocks in between, not whole segments, were left out.")
      .field("held_out_refitted", of, &Finding::held_out_refitted,
             "By real fits with it and without, not by one step.")
      .field("excuse", of, &Finding::excuse,
             "How many times too far noise would have to wander to look like it.")
      .field("visibility", of, &Finding::visibility,
             "Below 0.05 the flight can't show at least a part of it.")
      .field("absorbed_by", of, &Finding::absorbed_by, "How far ignoring it shifts each parameter.")
      .field("status", of, &Finding::status,
             R"("found", "slow_change", "undecided", "not_seen", "cannot_be_seen".)")
      .field("beside", of, &Finding::beside,
             R"(The first found: "equivalent", "fades", "counts"; "untried" of others.)")
      .comparable()
      .finish()
      .def_property_readonly(
          "in_words", [](const FoundEffect& self) { return status_in_words(self.finding); },
          R"(The status as tables show it; "not held out" and "too small" are sure, yet refused.)")
      .def_property_readonly(
          "beside_in_words", [](const FoundEffect& self) { return beside_in_words(self.finding); },
          "What becomes of it beside the first found, as tables show it.");
}

void define_parts(py::module_& module) {
  BoundStruct<Advice>(module, "Advice", "What to add, once a fit with it has shown that it can be.")
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
      .comparable()
      .finish();

  BoundStruct<ResidualNoise>(module, "ResidualNoise",
                             "An output's residual; NaN where a number is undefined.")
      .field("output", &ResidualNoise::output, "")
      .field("unit", &ResidualNoise::unit, "")
      .field("rmse", &ResidualNoise::rmse, "")
      .field("lag_one", &ResidualNoise::lag_one, "Correlation of neighbouring rows.")
      .field("ljung_box_p", &ResidualNoise::ljung_box_p,
             "Of 20 lags: small where the residual is not white.")
      .field("noise", &ResidualNoise::noise, "Its NoiseModel.")
      .field("floor", &ResidualNoise::floor, "What no model of the past predicts better.")
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
      .field("kind", &UnmeasuredCause::kind, R"("common_cause" or "spectral_line".)")
      .field(
          "sentence", [](const UnmeasuredCause& self) { return describe(self); },
          [](UnmeasuredCause&, const std::string&) {}, "In plain words.")
      .field("outputs", &UnmeasuredCause::outputs, "That show it.")
      .field("p_value", &UnmeasuredCause::p_value, "For itself.")
      .field("p_adjusted", &UnmeasuredCause::p_adjusted, "After Holm: for the verdict.")
      .field("all_along", &UnmeasuredCause::all_along, "Strongest over the whole flight.")
      .field("first_s", &UnmeasuredCause::first_s, "Of the rows where it is strongest [s].")
      .field("last_s", &UnmeasuredCause::last_s, "")
      .field("frequency_hz", &UnmeasuredCause::frequency, "NaN where none stands out.")
      .comparable()
      .finish();

  BoundStruct<DetectionLimit>(module, "DetectionLimit",
                              "The smallest slow effect that the flight would have shown: a "
                              "straight line in time that is found nine times in ten.")
      .field("port", &DetectionLimit::port, "")
      .field("size", &DetectionLimit::size, "Change over the whole flight.")
      .field("unit", &DetectionLimit::unit, "")
      .comparable()
      .finish();

  BoundStruct<ErrorBound>(module, "ErrorBound", "How far an error was let wander.")
      .field("name", &ErrorBound::name, "As `error_budget` of diagnose() takes it.")
      .field("size", &ErrorBound::size, "Standard deviation of each component, at most.")
      .field("unit", &ErrorBound::unit, "")
      .comparable()
      .finish();
}

void define_work(py::module_& module) {
  BoundStruct<DiagnosisWork>(module, "DiagnosisWork", "What a diagnosis did.")
      .field("screened", &DiagnosisWork::screened, "Candidates.")
      .field("tested", &DiagnosisWork::tested, "By likelihood ratios, their noise estimated anew.")
      .field("calibrated", &DiagnosisWork::calibrated, "By draws of the noise.")
      .field("drawn", &DiagnosisWork::drawn, "These draws, of each noise.")
      .field("refitted", &DiagnosisWork::refitted, "Models with a candidate that were fitted.")
      .field("tried_on_some_rows", &DiagnosisWork::tried_on_some_rows,
             "The same to 400 rows, where a fit is far off.")
      .comparable()
      .finish();

  BoundStruct<Injection>(module, "Injection",
                         "An effect that was put into the measurements, to see whether it would "
                         "have been found.")
      .field("effect", &Injection::effect, "")
      .field("sizes", &Injection::sizes, "Of its coefficients.")
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
  using Step = StepwiseStep;
  constexpr auto promised = &Step::promised;
  BoundStruct<Step> bound(
      module, "StepwiseStep",
      "An effect that was added: what it promised and what came of it; NaN where undefined.\n\n"
      "The RMSE is over `outputs`, of the rows that are fitted, in their unit; where these have "
      "different ones in units of each one's own before. partial_f, pse and pse_without are those "
      "of EffectFinding.");
  bound.field("effect", promised, &EffectFinding::name, "")
      .field("outputs", promised, &EffectFinding::outputs, "That it can reach.")
      .field("p_adjusted", promised, &EffectFinding::p_adjusted, "");
  const auto as_structured = [&](const char* name, double Structure::* member) {
    bound.field(
        name, [=](const Step& self) { return self.promised.structure.*member; },
        [=](Step& self, double value) { self.promised.structure.*member = value; }, "");
  };
  as_structured("partial_f", &Structure::partial_f);
  as_structured("pse", &Structure::pse);
  as_structured("pse_without", &Structure::pse_without);
  bound
      .field("held_out_gain", promised, &EffectFinding::held_out_gain,
             "Promised, on rows left out.")
      .field("predicted_drop", promised, &EffectFinding::predicted_drop,
             "Promised, of the RMSE: 1 - after / before.")
      .field(
          "found_drop", &Step::found_drop, [](Step&, double) {}, "")
      .field("rmse_before", &Step::rmse_before, "")
      .field("rmse_after", &Step::rmse_after, "")
      .field("as_good", &Step::as_good, "What would have done as well in its place.")
      .field("dropped", &Step::dropped, "What was added before and counts no more beside it.")
      .comparable()
      .finish();
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
