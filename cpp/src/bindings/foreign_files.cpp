// SPDX-License-Identifier: BSD-3-Clause
// Files of other forms than text, which Python reads for C++. Each module has the flights' code,
// and a reader, of its own.
#include "bindings.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::bindings {
namespace {

/// What the reader refuses, in its own words.
[[noreturn]] void rethrow(py::error_already_set& raised) {
  const py::object error = py::module_::import("sepcal._core").attr("Error");
  if (!raised.matches(error)) throw;
  throw Error(py::str(raised.value()).cast<std::string>());
}

/// The reader, which is never destroyed; None: there is none.
py::object& kept_reader() {
  static auto* const reader = new py::object(py::none());
  return *reader;
}

/// None: files of other forms are refused.
void read_foreign_files(py::object reader) {
  kept_reader() = std::move(reader);
  if (kept_reader().is_none()) return read_foreign_files_with({});
  read_foreign_files_with([](const std::string& file, const std::string& form) {
    const py::gil_scoped_acquire gil;
    try {
      return kept_reader()(file, form).cast<Flight>();
    } catch (py::error_already_set& raised) {
      rethrow(raised);
    }
  });
}

}  // namespace

void define_foreign_files(py::module_& module) {
  module.def("read_foreign_files", &read_foreign_files);
  module.def("foreign_reader", [] { return kept_reader(); });
}

}  // namespace sepcal::bindings
