// SPDX-License-Identifier: BSD-3-Clause
// What `sepcal` can be asked for, for its help, its completion and its manual.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "base/page.hpp"

namespace sepcal::app {

enum class CommandKind { instrument, file, python };

struct Command {
  std::string_view name;
  CommandKind kind;
  std::string_view form;      // what stands behind it
  std::string_view sentence;  // without a full stop
};

inline constexpr std::array commands{
    Command{"mag", CommandKind::instrument, "VERB", "three-axis magnetometers"},
    Command{"pitot", CommandKind::instrument, "VERB",
            "five-hole probes, vane booms, Pitot-static tubes"},
    Command{"aircraft", CommandKind::instrument, "VERB",
            "flight paths and aerodynamic coefficients"},
    Command{"model", CommandKind::python, "VERB", "a model of your own, a class of Python"},
    Command{"fleet", CommandKind::python, "VERB", "many flights of many vehicles"},
    Command{"check", CommandKind::file, "FILE", "says what a log is, and whose it may be"},
    Command{"join", CommandKind::file, "MEASURED OTHER", "brings logs of two rates into one"},
    Command{"completion", CommandKind::file, "SHELL", "prints completions for bash, zsh or fish"},
    Command{"manual", CommandKind::file, "PAGE", "prints a manual page, e.g. sepcal-mag"},
    Command{"log", CommandKind::python, "LOG",
            "lists an autopilot's log, or writes a flight of it"},
    Command{"report", CommandKind::python, "FLIGHT CAL", "writes a calibration as a page to read"},
    Command{"field", CommandKind::python, "LAT LON ALT DATE", "the Earth's field at a place"},
    Command{"validate", CommandKind::python, "MODEL", "holds the fits against SciPy's"},
};

/// What `sepcal --help` prints.
base::Page command_help();

/// "mag, pitot, ...".
std::string list_commands();

/// Nothing where there is none of that name.
const Command* find_command(std::string_view name);

/// What a word that is no command is answered: the instrument that its verb lacks, or all commands.
std::string explain_unknown_command(const std::string& word);

}  // namespace sepcal::app
