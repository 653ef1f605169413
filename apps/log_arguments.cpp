// SPDX-License-Identifier: BSD-3-Clause
#include "log_arguments.hpp"

#include <fmt/format.h>

#include "option_values.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

constexpr const char* group = "Columns and rows of the log";

CLI::Option* add_list(CLI::App& verb, const std::string& name, std::vector<std::string>& list,
                      const std::string& form, const std::string& description) {
  return verb.add_option(name, list, description)->type_name(form)->delimiter(',')->group(group);
}

CLI::Option* add_time(CLI::App& verb, const std::string& name, std::optional<double>& time,
                      const std::string& description) {
  return verb.add_option(name, time, description)->type_name("S")->group(group);
}

}  // namespace

void LogArguments::add_to(CLI::App& verb) {
  add_list(verb, "--map", map_, "HEADER=COLUMN[,...]",
           "reads the log's column under another header, e.g. airspeed_kt=TAS")
      ->take_all()
      ->allow_extra_args(false);
  add_list(verb, "--ignore", typed_.ignore, "COLUMN[,...]", "as if these columns were not there")
      ->allow_extra_args(false);
  verb.add_flag("--drop-invalid", typed_.drop_invalid,
                "drops rows with a cell that is no number instead of refusing the file")
      ->group(group);
  add_list(verb, "--drop-repeats", typed_.drop_repeats, "COLUMN[,...]",
           "drops the rows between the samples of slow columns that the log holds or interpolates, "
           "e.g. airspeed; of several the slowest counts")
      ->allow_extra_args(false);
  verb.add_option(
          "--where", typed_.where,
          "takes only rows in which this holds, e.g. \"airspeed > 20 and abs(roll_deg) < 45\"")
      ->type_name("CONDITION")
      ->group(group);
  add_time(verb, "--from,--from-time", typed_.from_time, "takes only rows from this time on [s]");
  add_time(verb, "--to,--to-time", typed_.to_time, "takes only rows up to this time [s]");
}

LogChoice LogArguments::over(LogChoice choice) const {
  for (const std::string& text : map_) {
    const auto [header, column] = parse_assignment("--map", text, "HEADER=COLUMN");
    if (column.empty()) throw Error(fmt::format("--map {}: write it as HEADER=COLUMN", text));
    choice.map[header] = column;
  }
  if (!typed_.ignore.empty()) choice.ignore = typed_.ignore;
  if (typed_.drop_invalid) choice.drop_invalid = true;
  if (!typed_.drop_repeats.empty()) choice.drop_repeats = typed_.drop_repeats;
  if (!typed_.where.empty()) choice.where = typed_.where;
  if (typed_.from_time) choice.from_time = typed_.from_time;
  if (typed_.to_time) choice.to_time = typed_.to_time;
  return choice;
}

}  // namespace sepcal::app
