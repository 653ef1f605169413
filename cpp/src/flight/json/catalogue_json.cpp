// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/output_values.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/effect_catalogue.hpp"

namespace sepcal {

using namespace json;  // this room's own

std::string catalogue_json(const std::vector<std::string>& models) {
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
  const Json root{{"schema_version", schema_version}, {"effects", effects}};
  return text_of(root);
}

}  // namespace sepcal
