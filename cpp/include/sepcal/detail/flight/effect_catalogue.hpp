// SPDX-License-Identifier: BSD-3-Clause
// The physical effects that a probe's model may lack: what each adds, what drives it, in which
// unit.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

class Probe;

struct CataloguedEffect {
  std::string name;      // as `port[driver]`, or a name of its own
  std::string equation;  // what joins the model
  std::string drivers;   // the columns it needs
  std::string unit;      // of its coefficient, per unit of the driver where it has one
};

/// The catalogue of a model by its Probe::name(), of trajectories "path" or "aircraft"; empty for
/// another name.
std::span<const CataloguedEffect> effect_catalogue(std::string_view model);

/// The catalogue of a probe, a model of your own (own_model.hpp) too.
std::vector<CataloguedEffect> effect_catalogue(const Probe& probe);

/// The catalogue of a model as the table that the apps print.
std::string catalogue_text(std::string_view model);

/// The catalogues of several models as one JSON object.
std::string catalogue_json(const std::vector<std::string>& models);

}  // namespace sepcal
