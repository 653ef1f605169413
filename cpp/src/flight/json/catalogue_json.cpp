// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/output_values.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {

using namespace json;  // this room's own

Json json::write_catalogue(const std::vector<std::string>& models) {
  Json effects = Json::array();
  for (const std::string& model : models) {
    for (const CataloguedEffect& effect : effect_catalogue(model)) {
      effects.push_back({{"model", model},
                         {"name", effect.name},
                         {"equation", effect.equation},
                         {"drivers", effect.drivers},
                         {"unit", effect.unit}});
    }
  }
  return effects;
}

std::string catalogue_json(const std::vector<std::string>& models) {
  return text_of({{"schema_version", schema_version}, {"effects", write_catalogue(models)}});
}

}  // namespace sepcal
