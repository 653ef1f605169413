// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "flight/json/result_json.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal {

using namespace json;  // this room's own

namespace {

Json write_effect(const EffectFinding& effect, const std::string& sentence) {
  Json object = {{"name", effect.name},
                 {"sentence", sentence},
                 {"drivers", effect.drivers},
                 {"estimate", Json::object()},
                 {"standard_error", Json::object()},
                 {"unit", Json::object()}};
  for (const Coefficient& coefficient : effect.coefficients) {
    object["estimate"][coefficient.name] = number(coefficient.estimate);
    object["standard_error"][coefficient.name] = number(coefficient.standard_error);
    object["unit"][coefficient.name] = coefficient.unit;
  }
  write_fields(effect, object);
  return object;
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
      {"withheld", diagnosis.advice.withheld},
      {"then", diagnosis.advice.then.empty() ? Json() : Json(diagnosis.advice.then)}};
  root["pairs"] = diagnosis.pairs;
  root["rmse"] = number(diagnosis.rmse);
  root["noise_floor"] = number(diagnosis.floor);
  root["correlation_time"] = number(diagnosis.correlation_time);
  root["error_budget"] = write_by_name(diagnosis.error_budget, &ErrorBound::name);
  root["work"] = write_fields(diagnosis.work);
  root["left_undone"] = diagnosis.left_undone;
  root["where"] = write_list(result.where);
  root["residual"] = write_by_name(diagnosis.residual, &ResidualNoise::output);
  root["pse"] = to_string(diagnosis.pse);
  root["rule"] = to_string(diagnosis.rule);
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
  root["unmeasured"] = write_list(diagnosis.unmeasured);
  root["limits"] = write_by_name(diagnosis.limits, &DetectionLimit::port);
  root["missing_channels"] = result.missing_channels;
  if (result.injection) root["injected"] = write_injection(*result.injection);
  return text_of(root);
}

}  // namespace sepcal
