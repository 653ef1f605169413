// SPDX-License-Identifier: BSD-3-Clause
// Who hears what a long task does and how far it is: the commands of `python -m sepcal`.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "sepcal/options.hpp"

namespace sepcal::bindings {

/// The function that hears, of this module; None: nobody does. It is never destroyed, as Python may
/// be gone by then.
inline pybind11::object& listener() {
  static auto* const heard_by = new pybind11::object(pybind11::none());
  return *heard_by;
}

/// What tells it; nothing where nobody hears. Call it with the interpreter's lock.
inline FitProgress heard() {
  if (listener().is_none()) return {};
  return [](std::string_view task, double fraction) {
    const pybind11::gil_scoped_acquire gil;
    listener()(std::string(task), fraction);
  };
}

}  // namespace sepcal::bindings
