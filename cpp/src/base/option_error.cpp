// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/error.hpp"

#include <utility>

namespace sepcal {
namespace {

std::string as_in_code(const std::string& name) { return name; }

template <class Spell>
std::string text_of(const OptionError::Message& message, const Spell& spell) {
  std::string text;
  for (const auto& piece : message) {
    const Option* option = std::get_if<Option>(&piece);
    text += option == nullptr ? std::get<std::string>(piece) : spell(option->name);
  }
  return text;
}

}  // namespace

OptionError::OptionError(Message message)
    : Error(text_of(message, as_in_code)), message_(std::move(message)) {}

std::string OptionError::spelled(
    const std::function<std::string(const std::string& name)>& spell) const {
  return Error(text_of(message_, spell)).what();  // as printable as what()
}

void throw_within(const std::string& before, const Error& error, const std::string& after) {
  const auto* with_options = dynamic_cast<const OptionError*>(&error);
  if (with_options == nullptr) throw Error(before + error.what() + after);
  OptionError::Message message = with_options->message();
  message.insert(message.begin(), before);
  message.emplace_back(after);
  throw OptionError(std::move(message));
}

}  // namespace sepcal
