// SPDX-License-Identifier: BSD-3-Clause
// Files that are no text table, by how they begin.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sepcal/error.hpp"

namespace sepcal::files {

/// "Parquet": what a file that begins so is; nothing where it may be a text table.
std::optional<std::string> find_foreign_form(std::string_view first_bytes);

/// Thrown for such a file, with what a reader needs who knows it.
class ForeignFile : public Error {
 public:
  ForeignFile(const std::string& file, std::string form);
  const std::string& form() const { return form_; }

 private:
  std::string form_;
};

}  // namespace sepcal::files
