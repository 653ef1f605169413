// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "flight/json/findings_json.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal {

using namespace json;  // this room's own

namespace {

Json write_values(const std::map<std::string, double>& values) {
  Json object = Json::object();
  for (const auto& [name, value] : values) object[name] = number(value);
  return object;
}

Json write_effect(const EffectFinding& effect, const std::string& sentence) {
  Json estimate = Json::object();
  Json error = Json::object();
  Json unit = Json::object();
  for (const Coefficient& coefficient : effect.coefficients) {
    estimate[coefficient.name] = number(coefficient.estimate);
    error[coefficient.name] = number(coefficient.standard_error);
    unit[coefficient.name] = coefficient.unit;
  }
  return {{"name", effect.name},
          {"sentence", sentence},
          {"drivers", effect.drivers},
          {"estimate", estimate},
          {"standard_error", error},
          {"unit", unit},
          {"shapes", write_values(effect.shapes)},
          {"p_value", number(effect.p_value)},
          {"log10_p", number(effect.log10_p)},
          {"p_adjusted", number(effect.p_adjusted)},
          {"p_listed", number(effect.p_listed)},
          {"share_after_selection", number(effect.share_after_selection)},
          {"outputs", effect.outputs},
          {"partial_f", number(effect.structure.partial_f)},
          {"sse", number(effect.structure.sse)},
          {"sse_reduction", number(effect.structure.sse_reduction)},
          {"pse", number(effect.structure.pse)},
          {"pse_without", number(effect.structure.pse_without)},
          {"predicted_drop", number(effect.predicted_drop)},
          {"held_out_gain", number(effect.held_out_gain)},
          {"held_out_before", number(effect.held_out_before)},
          {"held_out_after", number(effect.held_out_after)},
          {"held_out_passed", effect.held_out_passed},
          {"held_out_interleaved", effect.held_out_interleaved},
          {"held_out_refitted", effect.held_out_refitted},
          {"is_fitted", effect.is_fitted},
          {"excuse", number(effect.excuse)},
          {"visibility", number(effect.visibility)},
          {"absorbed_by", write_values(effect.absorbed_by)},
          {"status", to_string(effect.status)},
          {"beside", to_string(effect.beside)}};
}

Json write_cause(const UnmeasuredCause& cause) {
  return {{"kind", to_string(cause.kind)},
          {"sentence", describe(cause)},
          {"outputs", cause.outputs},
          {"p_value", number(cause.p_value)},
          {"p_adjusted", number(cause.p_adjusted)},
          {"all_along", cause.all_along},
          {"first_s", number(cause.first_s)},
          {"last_s", number(cause.last_s)},
          {"frequency_hz", number(cause.frequency)}};
}

Json write_residual(const ResidualNoise& residual) {
  const NoiseModel& noise = residual.noise;
  const std::vector<double> phi(noise.phi.begin(), noise.phi.end());
  return {{"unit", residual.unit},
          {"rmse", number(residual.rmse)},
          {"lag_one", number(residual.lag_one)},
          {"ljung_box_p", number(residual.ljung_box_p)},
          {"noise", {{"d", noise.d}, {"phi", phi}, {"sigma", noise.sigma}}},
          {"floor", number(residual.floor)}};
}

Json write_injection(const Injection& injection) {
  Json estimate = Json::object();
  for (const Coefficient& coefficient : injection.estimate) {
    estimate[coefficient.name] = number(coefficient.estimate);
  }
  return {{"effect", injection.effect},
          {"sizes", injection.sizes},
          {"found", injection.found},
          {"rank", injection.rank == 0 ? Json() : Json(injection.rank)},
          {"p_adjusted", number(injection.p_adjusted)},
          {"estimate", estimate}};
}

}  // namespace

std::string to_json(const FlightDiagnosis& result) {
  const Diagnosis& diagnosis = result.diagnosis;
  Json root = Json::object();
  root["schema_version"] = schema_version;
  root["model"] = result.model;
  root["inputs"] = {{"file", result.flight.file},
                    {"sha256", result.flight.sha256},
                    {"rows", result.flight.rows},
                    {"rows_used", result.flight.rows_used}};
  root["status"] = to_string(result.status);
  root["message"] = result.message;
  root["verdict"] = to_string(diagnosis.verdict);
  root["sentence"] = verdict_sentence(result);
  root["advice"] = {
      {"effect", diagnosis.advice.effect.empty() ? Json() : Json(diagnosis.advice.effect)},
      {"withheld", diagnosis.advice.withheld}};
  root["pairs"] = diagnosis.pairs;
  root["rmse"] = number(diagnosis.rmse);
  root["noise_floor"] = number(diagnosis.floor);
  root["correlation_time"] = number(diagnosis.correlation_time);
  root["error_budget"] = Json::object();
  for (const ErrorBound& bound : diagnosis.error_budget) {
    root["error_budget"][bound.name] = {{"size", number(bound.size)}, {"unit", bound.unit}};
  }
  root["work"] = {{"screened", diagnosis.work.screened},
                  {"tested", diagnosis.work.tested},
                  {"calibrated", diagnosis.work.calibrated},
                  {"drawn", diagnosis.work.drawn},
                  {"refitted", diagnosis.work.refitted},
                  {"tried_on_some_rows", diagnosis.work.tried_on_some_rows}};
  root["left_undone"] = diagnosis.left_undone;
  root["where"] = Json::array();
  for (const Misfit& misfit : result.where) root["where"].push_back(write_misfit(misfit));
  root["residual"] = Json::object();
  for (const ResidualNoise& residual : diagnosis.residual) {
    root["residual"][residual.output] = write_residual(residual);
  }
  root["pse"] = to_string(diagnosis.pse);
  root["effects"] = Json::array();
  for (std::size_t i = 0; i < diagnosis.effects.size(); ++i) {
    root["effects"].push_back(write_effect(diagnosis.effects[i], result.sentences[i]));
  }
  Json windows = Json::array();
  for (const auto& [window, sigmas] : diagnosis.omnibus.windows) {
    windows.push_back({{"window", window}, {"sigmas", number(sigmas)}});
  }
  root["unexplained"] = {{"p_value", number(diagnosis.omnibus.p_value)},
                         {"p_adjusted", number(diagnosis.omnibus.p_adjusted)},
                         {"significant", diagnosis.omnibus.significant},
                         {"where", diagnosis.omnibus.where},
                         {"windows", windows}};
  root["unmeasured"] = Json::array();
  for (const UnmeasuredCause& cause : diagnosis.unmeasured) {
    root["unmeasured"].push_back(write_cause(cause));
  }
  root["limits"] = Json::object();
  for (const DetectionLimit& limit : diagnosis.limits) {
    root["limits"][limit.port] = {{"size", number(limit.size)}, {"unit", limit.unit}};
  }
  root["missing_channels"] = result.missing_channels;
  if (result.injection) root["injected"] = write_injection(*result.injection);
  return text_of(root);
}

}  // namespace sepcal
