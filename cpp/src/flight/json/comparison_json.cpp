// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "flight/json/result_json.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal {

using namespace json;  // this room's own

std::string to_json(const Comparison& comparison) {
  Json root = Json::object();
  root["schema_version"] = schema_version;
  root["model"] = comparison.model;
  root["inputs"] = {{"file", comparison.flight.file},
                    {"sha256", comparison.flight.sha256},
                    {"rows", comparison.flight.rows},
                    {"rows_used", comparison.flight.rows_used}};
  root["status"] = to_string(comparison.status);
  root["message"] = comparison.message;
  root["rmse"] = Json::object();
  root["residual"] = Json::object();
  for (const Misfit& misfit : comparison.overall) {
    root["rmse"][misfit.output] = number(misfit.rmse);
    root["residual"][misfit.output] = {{"lag_one", number(misfit.lag_one)},
                                       {"mean", number(misfit.mean)}};
  }
  root["where"] = write_list(comparison.where);
  root["channels"] = write_list(comparison.channels);
  root["windows"] = write_list(comparison.windows);
  root["validation"] = write_by_name(comparison.validation, &OutputValidation::output);
  for (const ReferenceMisfit& one : comparison.references) {
    Json told = write_fields(one);
    told["time_s"] = std::vector<double>(one.time.begin(), one.time.end());
    told["difference"] = std::vector<double>(one.difference.begin(), one.difference.end());
    root["references"].push_back(std::move(told));
  }
  if (comparison.method == FitMethod::filter_error) {
    root["innovation"] = Json::object();
    for (std::size_t j = 0; j < comparison.sigma.size(); ++j) {
      root["innovation"][comparison.sigma[j].name] = {
          {"lag_one", number(comparison.overall[j].lag_one)},
          {"sigma", number(comparison.sigma[j].value)}};
    }
    root["disturbances"] = Json::array();
    for (const Disturbance& one : comparison.disturbances) {
      root["disturbances"].push_back({{"name", one.noise.name},
                                      {"size", number(one.noise.value)},
                                      {"unit", one.noise.unit},
                                      {"share_beyond", number(one.share_beyond)},
                                      {"rows", one.rows},
                                      {"first_s", number(one.first_s)},
                                      {"last_s", number(one.last_s)},
                                      {"peak", number(one.peak)}});
    }
  }
  return text_of(root);
}

}  // namespace sepcal
