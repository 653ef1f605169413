// SPDX-License-Identifier: BSD-3-Clause
// Pieces that effects with a physics of their own share.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "sepcal/named_effects.hpp"

namespace sepcal::catalogue {

/// Whether the record has a column that means something: body rates that are zero throughout stand
/// for rates that aren't logged.
bool is_logged(const Record& record, const std::string& name);

/// Throws Error naming the effect and the columns of the record that it needs and that aren't
/// there.
void need_columns(const std::string& effect, const Record& record,
                  std::initializer_list<const char*> names);

/// An effect that is another one under its own name: "bias_step" is bias[step(time)]. Parameters
/// are named by the alias.
EffectKit::Maker renamed(std::string name, std::string means, Port port);

/// The alias of `port[column]` with the one column whose header begins with `prefix`.
std::function<std::string(const Record&)> by_column(std::string alias, std::string port,
                                                    std::string prefix);

/// An effect in time with the one parameter `name`.tau, within +-bound [s].
EffectKit::Maker in_time(const std::string& name, Delay::Kind kind, double bound,
                         const std::vector<std::string>& inputs = {});

}  // namespace sepcal::catalogue
