// SPDX-License-Identifier: BSD-3-Clause
#include "fit_arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <concepts>
#include <optional>

#include "flight/schema/option_fields.hpp"
#include "option_values.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

using schema::each_option;

template <class Value>
constexpr bool is_scalar = std::is_arithmetic_v<Value> || std::same_as<Value, std::string> ||
                           std::same_as<Value, std::optional<double>>;

/// What CLI11 reads by itself.
template <class Value>
CLI::Option* add_scalar(CLI::App& verb, const std::string& flags, Value& value,
                        const std::string& sentence) {
  if constexpr (std::same_as<Value, bool>) {
    return verb.add_flag(flags, value, sentence);
  } else if constexpr (std::integral<Value>) {
    return add_whole_number(verb, flags, value, sentence);
  } else if constexpr (std::floating_point<Value>) {
    return verb.add_option(flags, value, sentence)->capture_default_str();
  } else {
    return verb.add_option(flags, value, sentence);
  }
}

CLI::Option* add_texts(CLI::App& verb, const schema::About& about,
                       std::vector<std::string>& texts) {
  const bool by_comma = about.form.ends_with("[,...]");
  CLI::Option* option =
      verb.add_option(std::string(about.flags), texts,
                      std::string(about.sentence) + (by_comma ? "" : "; may be repeated"))
          ->take_all()
          ->allow_extra_args(false);
  return by_comma ? option->delimiter(',') : option;
}

template <NamedChoice Choice>
CLI::Option* add_choice(CLI::App& verb, const schema::About& about, Choice by_default,
                        std::vector<std::string>& texts) {
  return verb
      .add_option(
          std::string(about.flags), texts,
          fmt::format("{}; one of {}", about.sentence, fmt::join(ChoiceNames<Choice>::names, ", ")))
      ->expected(1)
      ->default_str(std::string(to_string(by_default)));
}

template <class Value>
bool is_given(const Value& value) {
  if constexpr (requires { value.empty(); }) return !value.empty();
  if constexpr (requires { value.has_value(); }) return value.has_value();
  if constexpr (std::same_as<Value, bool>) return value;
}

}  // namespace

template <class Field>
void FitArguments::add(CLI::App& verb, const Field& field) {
  const schema::About& about = field.about;
  if (about.flags.empty()) return;
  auto& value = field.in(options_);
  using Value = std::remove_reference_t<decltype(value)>;
  CLI::Option* option = nullptr;
  if constexpr (is_scalar<Value>) {
    option = add_scalar(verb, std::string(about.flags), value, std::string(about.sentence));
  } else if constexpr (NamedChoice<Value>) {
    option = add_choice(verb, about, value, texts_[field.name]);
  } else if constexpr (!std::same_as<Value, std::optional<Screens>>) {
    option = add_texts(verb, about, texts_[field.name]);
  }
  if (!about.form.empty()) option->type_name(std::string(about.form));
  if (field.is_of_log) option->group("Columns and rows of the log");
}

void FitArguments::add_to(CLI::App& fit) {
  each_option([&](const auto& field) { add(fit, field); });
}

void FitArguments::add_log_choice_to(CLI::App& verb) {
  each_option([&](const auto& field) {
    if (field.is_of_log) add(verb, field);
  });
}

CalibrationOptions FitArguments::resolve() const {
  CalibrationOptions options = options_;
  each_option([&](const auto& field) {
    using Value = std::remove_reference_t<decltype(field.in(options))>;
    if constexpr (!is_scalar<Value> && !std::same_as<Value, std::optional<Screens>>) {
      const auto texts = texts_.find(field.name);
      if (texts == texts_.end() || texts->second.empty()) return;
      schema::read_typed(
          {std::string(field.about.flags), std::string(field.about.form), texts->second},
          field.in(options));
    }
  });
  for (const auto& [name, value] : options.fit.fix) {
    if (!options.fit.bounds.contains(name)) continue;
    throw Error(fmt::format("--fix {0} and --bounds {0} contradict each other; keep one", name));
  }
  return options;
}

LogChoice FitArguments::over(LogChoice choice) const {
  CalibrationOptions put_over;
  put_over.log = std::move(choice);
  const CalibrationOptions typed = resolve();
  each_option([&](const auto& field) {
    if constexpr (std::remove_cvref_t<decltype(field)>::is_of_log) {
      if (is_given(field.in(typed))) field.in(put_over) = field.in(typed);
    }
  });
  return put_over.log;
}

}  // namespace sepcal::app
