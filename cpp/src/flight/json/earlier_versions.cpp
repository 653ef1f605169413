// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/earlier_versions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "sepcal/error.hpp"
#include "sepcal/flight/calibration.hpp"
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

void convert_earlier(Json& root) {
  Json& version = root.at("schema_version");
  Json& options = root.at("options");
  if (version == 1) {
    add_later_options(options);
    rename(options, "priors", "sampling_distribution");
    rename(options, "knowledge", "prior");
  }
  if (version != schema_version) {
    rename(options, "stage_one", "stage_one_segments");
    rename(options, "stage_two", "stage_two_segments");
    rename(root.at("stage_two"), "method", "second_stage");
  }
  version = schema_version;
}

void check_version(const Json& version, int first, const std::string& source) {
  for (int one = first; one <= schema_version; ++one) {
    if (version == one) return;
  }
  const bool is_later =
      version.is_number_unsigned() && version.get<std::uint64_t>() > schema_version;
  throw Error(fmt::format(
      "{} has schema version {}, this sepcal reads {} to {}; {}fit the flight "
      "again",
      source, describe(version), first, schema_version, is_later ? "update sepcal or " : ""));
}

}  // namespace sepcal::json
