// SPDX-License-Identifier: BSD-3-Clause
// Misuse and bad input. Non-convergence is not an error: it is a status of the fit.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace sepcal {

/// Bad input or misuse. what() is one line that names the culprit and the way out.
class Error : public std::runtime_error {
 public:
  /// A message may quote what a file holds: control characters, line ends among them, and bytes
  /// that are not UTF-8 become escapes like "\n" and "\x1b".
  explicit Error(const std::string& message);
};

/// An option in a message. It is typed as `drop_invalid` in code and as `--drop-invalid` on a
/// command line; whoever shows such an error to a user spells it as that user types it.
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
