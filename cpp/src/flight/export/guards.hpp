// SPDX-License-Identifier: BSD-3-Clause
// A look at what effects follow: beyond what the fit saw of it, a correction is a guess.
#pragma once

#include <string>
#include <vector>

#include "flight/export/correction.hpp"

namespace sepcal::exporting {

/// A table of the least and the greatest value for each guard, less its origin.
std::vector<Constant> guard_constants(const Correction& correction, const Dialect& dialect);

/// "const int is_extrapolated = ...;"; empty where there is nothing to guard.
std::string guard_statement(const Correction& correction, const Dialect& dialect);

}  // namespace sepcal::exporting
