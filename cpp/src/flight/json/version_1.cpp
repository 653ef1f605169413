// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/version_1.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "sepcal/options.hpp"

namespace sepcal::json {
namespace {

void rename(Json& options, const char* before, const char* now) {
  Json value = std::move(options.at(before));
  options.erase(before);
  options[now] = std::move(value);
}

/// The first files lack these, all of them; their fits had the defaults.
void add_later_options(Json& options) {
  constexpr std::array later{"knowledge", "search", "jacobian", "loss", "loss_width"};
  const auto is_there = [&](const char* name) { return options.contains(name); };
  if (std::ranges::any_of(later, is_there)) return;
  const FitOptions defaults;
  options["knowledge"] = Json::object();
  options["search"] = to_string(defaults.search);
  options["jacobian"] = to_string(defaults.jacobian);
  options["loss"] = to_string(defaults.loss);
  options["loss_width"] = defaults.loss_width;
}

}  // namespace

void convert_version_1(Json& options) {
  add_later_options(options);
  rename(options, "priors", "sampling_distribution");
  rename(options, "knowledge", "prior");
}

}  // namespace sepcal::json
