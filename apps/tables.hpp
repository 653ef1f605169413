// SPDX-License-Identifier: BSD-3-Clause
// What can be typed, as data: completions and manual pages are made of it. Python's commands join
// in the same form.
//
//   {"name": "mag", "sentence": ..., "footer": ..., "verbs": [VERB, ...]}
//   VERB: {"name": "fit", "sentence": ..., "usage": ..., "arguments": [{"name", "sentence"}],
//          "groups": [{"name", "options": [OPTION, ...]}], "examples": [...]}
//   OPTION: {"names": ["-o", "--output"], "value": "BASE.json", or empty, "sentence",
//            "choices": [...]}
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace sepcal::app {

/// The JSON of an instrument's verbs. `cli` is complete; effects are of the catalogues of `models`.
std::string table_of(const CLI::App& cli, const std::vector<std::string>& models);

/// What a shell sources: "bash", "zsh" or "fish". `tables` are as table_of() gives them. Throws
/// Error for another shell.
std::string completions(const std::string& shell, const std::vector<std::string>& tables);

/// The manual page of an instrument (man 7 man), or of `sepcal` where `name` is that. Throws Error
/// for a name that is not there.
std::string manual_page(const std::string& name, const std::vector<std::string>& tables);

}  // namespace sepcal::app
