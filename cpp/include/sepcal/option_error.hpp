// SPDX-License-Identifier: BSD-3-Clause
// Errors that name options. An option is typed as `drop_invalid` in code and as `--drop-invalid` on
// a command line; whoever shows such an error to a user spells it as that user types it.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "sepcal/error.hpp"

namespace sepcal {

/// An option in a message, by its name in code: "drop_invalid".
struct Option {
  std::string name;
};

/// An error with options in its message, most often as the way out. what() names them as code does.
class OptionError : public Error {
 public:
  using Message = std::vector<std::variant<std::string, Option>>;

  explicit OptionError(Message message);

  const Message& message() const { return message_; }

  /// what() with `spell(name)` for each option.
  std::string spelled(const std::function<std::string(const std::string& name)>& spell) const;

 private:
  Message message_;
};

/// Throws `error` again with words about it: "FLIGHT: ...". Its options stay options.
[[noreturn]] void throw_within(const std::string& before, const Error& error,
                               const std::string& after = "");

}  // namespace sepcal
