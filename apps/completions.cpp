// SPDX-License-Identifier: BSD-3-Clause
// Completions are told by the way to a verb ("mag fit"): what may follow it, and its options.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/escaping.hpp"
#include "commands.hpp"
#include "sepcal/error.hpp"
#include "tables.hpp"

namespace sepcal::app {
namespace {

using Json = nlohmann::ordered_json;

struct Word {
  std::string name;
  std::string sentence;
};

struct OptionWord {
  std::vector<std::string> names;
  std::string value;  // empty: none follows
  std::string sentence;
  std::vector<std::string> choices;
};

/// What may follow some words.
struct Place {
  std::string path;              // "", "mag", "mag fit"
  std::vector<Word> words = {};  // commands or verbs; else files
  std::vector<OptionWord> options = {};
};

std::vector<OptionWord> options_in(const Json& verb) {
  std::vector<OptionWord> options;
  for (const Json& group : verb.at("groups")) {
    for (const Json& option : group.at("options")) {
      options.push_back(
          {option.at("names"), option.at("value"), option.at("sentence"), option.at("choices")});
    }
  }
  return options;
}

const std::vector<OptionWord>& common_options() {
  static const std::vector<OptionWord> common{{{"-h", "--help"}, "", "prints the help", {}},
                                              {{"--version"}, "", "prints the version", {}}};
  return common;
}

std::vector<Place> places_of(const std::vector<std::string>& tables) {
  Place first{.path = "", .options = common_options()};
  for (const Command& command : commands) {
    first.words.push_back({std::string(command.name), std::string(command.sentence)});
  }
  std::vector<Place> places{first};
  for (const std::string& text : tables) {
    const Json table = Json::parse(text);
    Place of_command{.path = table.at("name"), .options = common_options()};
    for (const Json& verb : table.at("verbs")) {
      const std::string name = verb.at("name");
      if (name.empty()) {  // a command without verbs
        of_command.options = options_in(verb);
        continue;
      }
      of_command.words.push_back({name, verb.at("sentence")});
      places.push_back({.path = of_command.path + " " + name, .options = options_in(verb)});
    }
    places.push_back(std::move(of_command));
  }
  places.push_back({.path = "completion", .words = {{"bash", ""}, {"zsh", ""}, {"fish", ""}}});
  return places;
}

/// A word between single quotes, whatever is in it.
std::string quoted(const std::string& text) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return all + "'";
}

constexpr std::string_view programs = "sepcal sepcal-mag sepcal-pitot sepcal-aircraft";

std::string for_bash(const std::vector<Place>& places) {
  std::string words;
  std::string choices;
  for (const Place& place : places) {
    std::vector<std::string> options;
    for (const OptionWord& option : place.options) {
      options.insert(options.end(), option.names.begin(), option.names.end());
      if (option.value.empty()) continue;
      for (const std::string& name : option.names) {
        choices += fmt::format("    {}) echo {} ;;\n", quoted(place.path + " " + name),
                               quoted(fmt::format("{}", fmt::join(option.choices, " "))));
      }
    }
    std::vector<std::string> names;
    for (const Word& word : place.words) names.push_back(word.name);
    words += fmt::format("    {}) words={} options={} ;;\n", quoted(place.path),
                         quoted(fmt::format("{}", fmt::join(names, " "))),
                         quoted(fmt::format("{}", fmt::join(options, " "))));
  }
  return fmt::format(R"(# Completions of sepcal for bash, made by `sepcal completion bash`.

# What an option of "PATH OPTION" may be followed by; 1 where nothing follows it.
_sepcal_values() {{
  case $1 in
{1}    *) return 1 ;;
  esac
}}

_sepcal() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} path='' words='' options='' values word i
  local program=${{COMP_WORDS[0]##*/}}
  if [[ $program == sepcal-* ]]; then path=${{program#sepcal-}}; fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${{COMP_WORDS[i]}}
    if [[ $word == -* ]]; then break; fi
    case $path in
      '' | mag | pitot | aircraft | model) path=${{path:+$path }}$word ;;
    esac
  done
  case $path in
{0}  esac
  COMPREPLY=()
  if ((COMP_CWORD > 0)) && values=$(_sepcal_values "$path ${{COMP_WORDS[COMP_CWORD - 1]}}"); then
    if [[ -n $values ]]; then mapfile -t COMPREPLY < <(compgen -W "$values" -- "$current"); fi
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  elif [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
}}

complete -o bashdefault -o default -F _sepcal {2}
)",
                     words, choices, programs);
}

/// "name:sentence" of zsh, in which a colon ends the name.
std::string described(const std::string& name, const std::string& sentence) {
  std::string safe;
  for (const char c : name) safe += c == ':' ? std::string("\\:") : std::string(1, c);
  return quoted(safe + ":" + sentence);
}

std::string for_zsh(const std::vector<Place>& places) {
  std::string cases;
  for (const Place& place : places) {
    std::string words;
    std::string options;
    for (const Word& word : place.words) words += " " + described(word.name, word.sentence);
    for (const OptionWord& option : place.options) {
      for (const std::string& name : option.names)
        options += " " + described(name, option.sentence);
    }
    cases += fmt::format("    {}) next=({}) options=({}) ;;\n", quoted(place.path), words, options);
  }
  std::string values;
  for (const Place& place : places) {
    for (const OptionWord& option : place.options) {
      if (option.value.empty()) continue;
      for (const std::string& name : option.names) {
        values += fmt::format("    {}) takes=1 choices=({}) ;;\n", quoted(place.path + " " + name),
                              fmt::join(option.choices, " "));
      }
    }
  }
  return fmt::format(R"(#compdef {2}
# Completions of sepcal for zsh, made by `sepcal completion zsh`.

_sepcal() {{
  local path_to='' word takes='' i
  local -a next options choices
  local program=${{words[1]:t}}
  if [[ $program == sepcal-* ]]; then path_to=${{program#sepcal-}}; fi
  for ((i = 2; i < CURRENT; i++)); do
    word=${{words[i]}}
    if [[ $word == -* ]]; then break; fi
    case $path_to in
      '' | mag | pitot | aircraft | model) path_to=${{path_to:+$path_to }}$word ;;
    esac
  done
  case $path_to in
{0}  esac
  case "$path_to ${{words[CURRENT - 1]}}" in
{1}  esac
  if [[ -n $takes ]]; then
    if (( $#choices )); then compadd -a choices; else _files; fi
  elif [[ ${{words[CURRENT]}} == -* ]]; then
    _describe option options
  elif (( $#next )); then
    _describe command next
  else
    _files
  fi
}}

if [[ $funcstack[1] == _sepcal ]]; then _sepcal "$@"; else compdef _sepcal {2}; fi
)",
                     cases, values, programs);
}

std::string for_fish(const std::vector<Place>& places) {
  std::string lines;
  const auto add = [&](const std::string& path, const std::string& what) {
    for (const std::string program : {"sepcal", "sepcal-mag", "sepcal-pitot", "sepcal-aircraft"}) {
      const std::string instrument = program == "sepcal" ? "" : program.substr(7);
      if (!instrument.empty() && path.substr(0, path.find(' ')) != instrument) continue;
      lines += fmt::format("complete -c {} -n {} {}\n", program,
                           quoted("__sepcal_is_at " + quoted(path)), what);
    }
  };
  for (const Place& place : places) {
    for (const Word& word : place.words) {
      add(place.path, fmt::format("-f -a {} -d {}", word.name, quoted(word.sentence)));
    }
    for (const OptionWord& option : place.options) {
      std::string what;
      for (const std::string& name : option.names) {
        what +=
            name.starts_with("--") ? "-l " + name.substr(2) + " " : "-s " + name.substr(1) + " ";
      }
      if (!option.value.empty()) what += "-r ";
      if (!option.choices.empty()) {
        what += fmt::format("-f -a {} ", quoted(fmt::format("{}", fmt::join(option.choices, " "))));
      }
      add(place.path, what + "-d " + quoted(option.sentence));
    }
  }
  return fmt::format(R"(# Completions of sepcal for fish, made by `sepcal completion fish`.

# Whether the words that were typed lead to this place: "", "mag", "mag fit".
function __sepcal_is_at
    set -l words (commandline -opc)
    set -l path
    set -l program (basename $words[1])
    if string match -q 'sepcal-*' -- $program
        set path (string replace sepcal- '' -- $program)
    end
    for word in $words[2..-1]
        if string match -q -- '-*' $word
            break
        end
        switch "$path"
            case '' mag pitot aircraft model
                set -a path $word
        end
    end
    test "$path" = "$argv[1]"
end

{0})",
                     lines);
}

}  // namespace

std::string completions(const std::string& shell, const std::vector<std::string>& tables) {
  const std::vector<Place> places = places_of(tables);
  if (shell == "bash") return for_bash(places);
  if (shell == "zsh") return for_zsh(places);
  if (shell == "fish") return for_fish(places);
  throw Error(fmt::format("there are completions for bash, zsh and fish, not for '{}'", shell));
}

}  // namespace sepcal::app
