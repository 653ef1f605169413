// SPDX-License-Identifier: BSD-3-Clause
// What the magnetometers' tables, with attitude and without, have in common.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "flight/catalogue/effect_table.hpp"

namespace sepcal::catalogue {

inline constexpr std::array<const char*, 3> axes{"x", "y", "z"};
inline constexpr double largest_field = 500.0;  // [uT] of a bias

/// `forms` beside the one for any driver.
PortRow bias_row(const Port& bias, std::vector<Form> forms = {});
PortRow scale_row(const Port& scale, const std::string& equation);
PortRow axis_scale_row(const Port& axis_scale, const std::string& equation);

EffectRow bias_step_row(const Port& bias);
EffectRow warm_up_row(const Port& bias);

std::vector<AliasRow> magnetic_aliases();

std::vector<Channel> magnetic_channels();

/// How far a fluxgate or a magnetoresistive sensor wanders, in each of the outputs.
ErrorBound field_bound(std::vector<std::string> outputs);

}  // namespace sepcal::catalogue
