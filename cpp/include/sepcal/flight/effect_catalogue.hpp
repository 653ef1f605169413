// SPDX-License-Identifier: BSD-3-Clause
// The physical effects that a probe's model may lack: what each adds, what drives it, in which
// unit.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sepcal {

struct CataloguedEffect {
  std::string name;      // as `port[driver]`, or a name of its own
  std::string equation;  // what joins the model
  std::string drivers;   // the columns it needs
  std::string unit;      // of its coefficient, per unit of the driver where it has one
};

/// The catalogue of a model by its Probe::name(); empty for another name.
std::span<const CataloguedEffect> effect_catalogue(std::string_view model);

}  // namespace sepcal
