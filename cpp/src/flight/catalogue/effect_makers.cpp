// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_makers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::catalogue {

bool is_logged(const Record& record, const std::string& name) {
  if (!record.has(name)) return false;
  if (name != "p" && name != "q" && name != "r") return true;
  return std::ranges::any_of(record.column(name), [](double rate) { return rate != 0.0; });
}

void need_columns(const std::string& effect, const Record& record,
                  std::initializer_list<const char*> names) {
  std::vector<std::string> missing;
  for (const char* name : names) {
    if (!is_logged(record, name)) missing.emplace_back(name);
  }
  if (missing.empty()) return;
  throw Error(fmt::format("effect {} needs {}, which the flight doesn't log", effect,
                          fmt::join(missing, ", ")));
}

EffectKit::Maker renamed(std::string name, std::string means, Port port) {
  return [name = std::move(name), means = std::move(means), port = std::move(port)](
             const BlockModel& model, EffectSetting& setting, Record& record) {
    return make_named(name, parse_effect_name(means), port, model, setting, record);
  };
}

std::function<std::string(const Record&)> by_column(std::string alias, std::string port,
                                                    std::string prefix) {
  return [alias = std::move(alias), port = std::move(port),
          prefix = std::move(prefix)](const Record& record) {
    std::vector<std::string> fitting;
    for (const std::string& name : record.names()) {
      if (name.starts_with(prefix)) fitting.push_back(name);
    }
    if (fitting.size() == 1) return fmt::format("{}[{}]", port, fitting.front());
    throw Error(fitting.empty()
                    ? fmt::format("effect {} needs a column {}*, which the flight doesn't log",
                                  alias, prefix)
                    : fmt::format("effect {} could be driven by {}; write {}[COLUMN]", alias,
                                  fmt::join(fitting, ", "), port));
  };
}

EffectKit::Maker in_time(const std::string& name, Delay::Kind kind, double bound,
                         const std::vector<std::string>& inputs) {
  return [=](const BlockModel& /*model*/, EffectSetting& /*setting*/, Record& record) {
    for (const std::string& input : inputs) need_columns(name, record, {input.c_str()});
    Effect effect{.name = name};
    effect.delays.push_back({kind, Variable(name + ".tau", "s", -bound, bound), inputs});
    return effect;
  };
}

}  // namespace sepcal::catalogue
