// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <numeric>
#include <string>
#include <utility>

namespace sepcal::bindings {
namespace {

py::capsule keep(std::shared_ptr<const void> owner) {
  using Owner = std::shared_ptr<const void>;
  return {new Owner(std::move(owner)), [](void* pointer) { delete static_cast<Owner*>(pointer); }};
}

}  // namespace

std::shared_ptr<const py::object> share(py::object object) {
  return {new py::object(std::move(object)), [](const py::object* released) {
            const py::gil_scoped_acquire gil;
            delete released;
          }};
}

ArrayView view_array(const Array& array) {
  if (array.ndim() != 1) throw py::type_error("a column is an array of one dimension");
  const std::shared_ptr<const void> owner(array.inc_ref().ptr(), [](const void* object) {
    const py::gil_scoped_acquire gil;
    py::handle(static_cast<PyObject*>(const_cast<void*>(object))).dec_ref();
  });
  return {{array.data(), static_cast<std::size_t>(array.size())}, owner};
}

Array read_only_array(std::span<const double> values, std::shared_ptr<const void> owner) {
  Array array(static_cast<py::ssize_t>(values.size()), values.data(), keep(std::move(owner)));
  array.attr("flags").attr("writeable") = false;
  return array;
}

Array array_within(std::span<const double> values, const py::object& whole) {
  Array array(static_cast<py::ssize_t>(values.size()), values.data(), whole);
  array.attr("flags").attr("writeable") = false;
  return array;
}

Array adopt(std::vector<double> values) {
  const auto owner = std::make_shared<std::vector<double>>(std::move(values));
  return Array(static_cast<py::ssize_t>(owner->size()), owner->data(), keep(owner));
}

Record record_of(const py::dict& columns, const std::vector<std::string>& labels) {
  Record record;
  for (const auto& [name, values] : columns) {
    auto [span, owner] = view_array(values.cast<Array>());
    record.view(name.cast<std::string>(), span, std::move(owner));
  }
  if (record.has("time")) {
    record.cut(find_segments(record.column("time"), labels));
  } else if (!labels.empty()) {
    std::vector<double> rows(record.length());  // stand in for time: no gap anywhere
    std::iota(rows.begin(), rows.end(), 0.0);
    record.cut(find_segments(rows, labels));
  }
  return record;
}

std::vector<Segment> segments_of(const std::vector<SegmentRows>& rows,
                                 std::span<const double> column) {
  std::vector<Segment> segments;
  for (const auto& [label, first, last] : rows) segments.push_back({label, first, last});
  return Record().view("residual", column).cut(std::move(segments)).segments();
}

}  // namespace sepcal::bindings
