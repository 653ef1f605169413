// SPDX-License-Identifier: BSD-3-Clause
// Memory across the border, never copied: NumPy's seen from C++, and C++'s seen from NumPy.
#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "sepcal/record.hpp"

namespace sepcal::bindings {

namespace py = pybind11;

/// A reference that any thread may give back: it takes the GIL for it.
std::shared_ptr<const py::object> share(py::object object);

/// One column: a C-contiguous array of float64, (N,).
using Array = py::array_t<double, py::array::c_style>;

struct ArrayView {
  std::span<const double> values;
  std::shared_ptr<const void> owner;  // a reference to the array; takes the GIL to give it back
};

ArrayView view_array(const Array& array);

/// A read-only array (N,) over memory that `owner` keeps.
Array read_only_array(std::span<const double> values, std::shared_ptr<const void> owner);

/// The same over a part of a Python object.
Array array_within(std::span<const double> values, const py::object& whole);

/// An array (N,) that has taken the values over.
Array adopt(std::vector<double> values);

/// The columns {name: array} seen as a record. Where there are a column `time` [s] or `labels` (N
/// or none), it is cut at gaps and at changes of label. Throws Error as Record::view() and
/// find_segments() do.
Record record_of(const py::dict& columns, const std::vector<std::string>& labels);

inline std::span<const double> values_in(const Eigen::VectorXd& column) {
  return {column.data(), static_cast<std::size_t>(column.size())};
}

/// (label, first row, row after the last)
using SegmentRows = std::tuple<std::string, std::size_t, std::size_t>;

/// The segments of a column. Throws Error as Record::cut() does.
std::vector<Segment> segments_of(const std::vector<SegmentRows>& rows,
                                 std::span<const double> column);

}  // namespace sepcal::bindings
