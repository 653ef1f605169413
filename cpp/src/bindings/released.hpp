// SPDX-License-Identifier: BSD-3-Clause
// Python while the engine works: its other threads run, and Ctrl-C is heeded.
#pragma once

#include <pybind11/pybind11.h>

#include "sepcal/stop.hpp"

namespace sepcal::bindings {

/// While it lives, the lock of Python's interpreter is free. What a signal's handler raises, such
/// as KeyboardInterrupt, ends the work of the main thread, the only one that Python tells of it.
class Released {
 public:
  Released() : scope_(&raise_of_signals) {}

 private:
  static void raise_of_signals() {
    const pybind11::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }

  pybind11::gil_scoped_release released_;
  StopScope scope_;
};

using WithoutGil = pybind11::call_guard<Released>;

}  // namespace sepcal::bindings
