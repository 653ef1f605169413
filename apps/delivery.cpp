// SPDX-License-Identifier: BSD-3-Clause
#include "delivery.hpp"

#include <filesystem>
#include <utility>

namespace sepcal::app {

int exit_code(FitStatus status) {
  switch (status) {
    case FitStatus::converged:
      return 0;
    case FitStatus::not_identifiable:
      return 4;
    default:
      return 5;
  }
}

bool is_there(const std::string& file) {
  std::error_code ignored;
  return !file.empty() && std::filesystem::exists(file, ignored);
}

void give(bool json, const std::string& told, const std::string& page) {
  if (json) {
    print(told);
  } else {
    show(page);
  }
}

void deliver_residuals(const ResidualTable& table, const std::string& output, OutputFile& target) {
  tell_notes(table.notes);
  write_csv(table, target);
  target.commit();
  show(base::page("wrote {}: {} rows, of which {} were used\n", output, table.rows(),
                  table.rows_used()));
}

Delivery::Delivery(Wishes wishes, const std::vector<std::string>& inputs)
    : wishes_(std::move(wishes)) {
  if (wishes_.output.empty()) return;
  for (const std::string& input : inputs) check_not_input(wishes_.output, input);
  file_.emplace(wishes_.output);
}

void Delivery::deliver(const std::string& json, const std::string& page) {
  if (file_) {
    file_->write(json);
    file_->commit();
  }
  give(wishes_.json, json, page);
  if (file_ && !wishes_.json) show(base::page("wrote {}\n", wishes_.output));
}

}  // namespace sepcal::app
