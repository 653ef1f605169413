// SPDX-License-Identifier: BSD-3-Clause
// Effects written in Python, a function of the record's columns each. It is called again for every
// record that the effect meets, on the thread that asks, and holds the GIL only meanwhile.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::bindings {

namespace py = pybind11;

/// Name, port (None: on the outputs), unit of a coefficient, and a function of ({column: (N,)},
/// number of outputs) that gives the driver (N,) or, without a port, [(component, (N, n_z)), ...].
using PythonEffect = std::tuple<std::string, std::optional<std::string>, std::string, py::object>;

/// The effects as `kit` takes them. Throws Error for a name that two have or that the kit knows and
/// for a port that there isn't.
OwnEffects own_effects(const std::vector<PythonEffect>& effects, const EffectKit& kit);

/// Gives a calibration that was read the effects of its caller's making. Throws Error as
/// own_effects() does, and for an effect that the calibration doesn't have.
void give_own_effects(Calibration& calibration, const std::vector<PythonEffect>& effects);

/// Throws Error for an effect of the caller's making that a calibration was read without.
void need_own_effects(const Calibration& calibration);

}  // namespace sepcal::bindings
