// SPDX-License-Identifier: BSD-3-Clause
#include "python_model.hpp"

#include <pybind11/numpy.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "model/differences.hpp"
#include "sepcal/error.hpp"

namespace sepcal::bindings {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Values = py::array_t<double, py::array::forcecast>;

/// A copy of its own: at() may keep or change it, and the block's memory may be gone by then.
Values copy(const double* values, std::size_t count) {
  return Values(static_cast<py::ssize_t>(count), count == 0 ? nullptr : values);
}

std::string shape_of(const py::array& array) {
  return py::str(array.attr("shape")).cast<std::string>();
}

/// "(256, 2, 3)"
std::string to_text(const std::vector<py::ssize_t>& shape) {
  std::string text;
  for (const py::ssize_t length : shape) {
    text += (text.empty() ? "(" : ", ") + std::to_string(length);
  }
  return text + ")";
}

/// What a model gave, as float64 of the shape asked for; `what` opens messages.
Values take(const std::string& what, const py::handle& given, const std::vector<py::ssize_t>& shape,
            const char* axes) {
  const auto array = py::array::ensure(given);
  if (!array || std::string_view("fiub").find(array.dtype().kind()) == std::string_view::npos) {
    const auto kind = array ? py::str(array.dtype()).cast<std::string>() : "no array";
    throw Error(what + " is " + kind + "; give an array of real numbers");
  }
  if (!std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim())) {
    throw Error(what + " has the shape " + shape_of(array) + "; this block of rows takes " +
                to_text(shape) + ", " + axes);
  }
  return Values(array);
}

}  // namespace

PythonModel::PythonModel(std::string name, Tables tables, PythonFunctions functions)
    : BlockModel(std::move(tables)),
      name_(std::move(name)),
      functions_(new PythonFunctions(std::move(functions)), [](const PythonFunctions* released) {
        const py::gil_scoped_acquire gil;
        delete released;
      }) {}

py::tuple PythonModel::call(const char* name, const py::object& function, const Block& block,
                            const double* xi2) const {
  py::list columns;
  for (const double* column : block.inputs) columns.append(copy(column, block.rows));
  const auto n_2 = static_cast<std::size_t>(tables().n_2());
  py::object answer = function(functions_->gather(columns), copy(xi2, n_2));
  if (py::isinstance<py::tuple>(answer) && py::len(answer) == 2) return answer;
  const auto kind = py::type::of(answer).attr("__name__").cast<std::string>();
  throw Error(name_ + ": " + name + "() gives " + kind + "; return a tuple of two arrays");
}

void PythonModel::fill_values(const py::object& at, const Block& block, const double* xi2,
                              Rows rows) const {
  const auto n = static_cast<py::ssize_t>(block.rows);
  const py::ssize_t n_z = tables().n_z();
  const py::ssize_t n_1 = tables().n_1();
  const py::tuple answer = call("at", at, block, xi2);
  const Values linear = take(name_ + ": A", answer[0], {n, n_z, n_1}, "(N, n_z, n_1)");
  const Values offset = take(name_ + ": b", answer[1], {n, n_z}, "(N, n_z)");
  const auto A = linear.unchecked<3>();
  const auto b = offset.unchecked<2>();
  for (py::ssize_t j = 0; j < n_z; ++j) {
    for (py::ssize_t row = 0; row < n; ++row) {
      for (py::ssize_t k = 0; k < n_1; ++k) rows(j * n + row, k) = A(row, j, k);
      rows(j * n + row, n_1) = b(row, j);
    }
  }
}

void PythonModel::fill_supplied(const Block& block, const double* xi2, const double* xi1,
                                Rows tangent) const {
  const auto n = static_cast<py::ssize_t>(block.rows);
  const py::ssize_t n_z = tables().n_z();
  const py::ssize_t n_1 = tables().n_1();
  const py::ssize_t n_2 = tables().n_2();
  const py::tuple answer = call("derivatives", functions_->derivatives, block, xi2);
  const Values linear = take(name_ + ": dA", answer[0], {n, n_z, n_1, n_2}, "(N, n_z, n_1, n_2)");
  const Values offset = take(name_ + ": db", answer[1], {n, n_z, n_2}, "(N, n_z, n_2)");
  const auto dA = linear.unchecked<4>();
  const auto db = offset.unchecked<3>();
  for (py::ssize_t j = 0; j < n_z; ++j) {
    for (py::ssize_t row = 0; row < n; ++row) {
      for (py::ssize_t i = 0; i < n_2; ++i) {
        double sum = db(row, j, i);
        for (py::ssize_t k = 0; k < n_1; ++k) sum += dA(row, j, k, i) * xi1[k];
        tangent(j * n + row, i) = sum;
      }
    }
  }
}

VectorXd PythonModel::predict(const Block& block, const double* xi2, const double* xi1) const {
  const Index n_1 = tables().n_1();
  MatrixXd rows(static_cast<Index>(block.rows) * tables().n_z(), n_1 + 1);
  fill_values(functions_->try_at, block, xi2, rows);
  return rows.leftCols(n_1) * Map<const VectorXd>(xi1, n_1) + rows.col(n_1);
}

void PythonModel::fill_differences(const Block& block, const double* xi2, const double* xi1,
                                   Rows tangent) const {
  VectorXd x = Map<const VectorXd>(xi2, tables().n_2());
  for (Index i = 0; i < x.size(); ++i) {
    const Variable& parameter = tables().nonlinear[static_cast<std::size_t>(i)];
    const double middle = x[i];
    const double scale =
        std::min(0.5 * (parameter.upper - parameter.lower), std::max(1.0, std::abs(middle)));
    const auto along = [&](double step) {
      x[i] = middle + step;
      return predict(block, x.data(), xi1);
    };
    tangent.col(i) =
        model::differentiate(along, scale, parameter.lower - middle, parameter.upper - middle);
    x[i] = middle;
  }
}

void PythonModel::evaluate(const Block& block, const double* xi2, const double* xi1,
                           Carry* /*carry*/, Rows rows) const {
  const py::gil_scoped_acquire gil;
  const Index n_1 = tables().n_1();
  const Index n_2 = tables().n_2();
  if (xi1 == nullptr) return fill_values(functions_->at, block, xi2, rows);
  MatrixXd values(rows.rows(), n_1 + 1);
  fill_values(functions_->at, block, xi2, values);
  rows.leftCols(n_1) = values.leftCols(n_1);
  rows.col(n_1 + n_2) = values.col(n_1);
  if (n_2 == 0) return;
  if (functions_->derivatives.is_none()) {
    fill_differences(block, xi2, xi1, rows.middleCols(n_1, n_2));
  } else {
    fill_supplied(block, xi2, xi1, rows.middleCols(n_1, n_2));
  }
}

void PythonModel::input_tangent(const Block& block, const double* xi2, const double* xi1,
                                std::span<const int> inputs, Rows columns) const {
  const py::gil_scoped_acquire gil;
  model::differentiate_by_inputs([&](const Block& moved) { return predict(moved, xi2, xi1); },
                                 block, inputs, columns);
}

}  // namespace sepcal::bindings
