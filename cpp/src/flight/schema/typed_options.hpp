// SPDX-License-Identifier: BSD-3-Clause
// An option as it is typed, from its texts to a value, one text for each time that it is given. All
// throw Error with the option's flag and the form that it should have.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/options.hpp"

namespace sepcal::schema {

std::vector<std::string> split(std::string_view text, char separator);

/// The whole of `text` as a finite number; `option` opens the message.
double parse_value(const std::string& option, const std::string& text);

/// "NAME=VALUE" to its two halves.
std::pair<std::string, std::string> parse_assignment(const std::string& option,
                                                     const std::string& text,
                                                     const std::string& form);

/// An option on a command line.
struct Typed {
  std::string flag;  // "--bounds"
  std::string form;  // "NAME=LO,HI"
  std::vector<std::string> texts;
};

/// Either end may be empty, which leaves it open.
void read_typed(const Typed& typed, std::map<std::string, Interval>& values);
void read_typed(const Typed& typed, std::map<std::string, double>& values);
void read_typed(const Typed& typed, std::map<std::string, Normal>& values);
void read_typed(const Typed& typed, std::map<std::string, std::string>& values);
void read_typed(const Typed& typed, std::vector<std::string>& values);
void read_typed(const Typed& typed, std::vector<EffectSetting>& values);
void read_typed(const Typed& typed, std::string& value);

template <NamedChoice Choice>
void read_typed(const Typed& typed, Choice& value) {
  value = choice_of<Choice>(typed.flag, typed.texts.back());
}

}  // namespace sepcal::schema
