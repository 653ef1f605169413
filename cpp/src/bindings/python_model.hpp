// SPDX-License-Identifier: BSD-3-Clause
// A model written in Python, as the waist takes it: at(u, xi2) is asked for a block of rows at a
// time, whichever thread wants it, and holds the GIL only meanwhile.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "sepcal/detail/block_model.hpp"

namespace sepcal::bindings {

namespace py = pybind11;

/// What a model in Python calls, N rows at a time.
struct PythonFunctions {
  py::object gather;       // a list of n_u columns (N,) -> u
  py::object at;           // (u, xi2) -> A (N, n_z, n_1), b (N, n_z)
  py::object try_at;       // the same without NumPy's warnings, for the points of differences
  py::object derivatives;  // (u, xi2) -> dA (N, n_z, n_1, n_2), db (N, n_z, n_2); or None
};

class PythonModel final : public BlockModel {
 public:
  /// `name` opens messages. Throws Error where names clash. There must be an input: from it alone
  /// at() sees how many rows are wanted.
  PythonModel(std::string name, Tables tables, PythonFunctions functions);

  /// D is what `derivatives` gives, else fourth-order differences. Throws Error for arrays of
  /// another shape or kind than asked for; an exception of the model's own passes as it is.
  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

  /// By fourth-order differences.
  void input_tangent(const Block& block, const double* xi2, const double* xi1,
                     std::span<const int> inputs,
                     Eigen::Ref<Eigen::MatrixXd> columns) const override;

 private:
  using Rows = Eigen::Ref<Eigen::MatrixXd>;

  py::tuple call(const char* name, const py::object& function, const Block& block,
                 const double* xi2) const;
  void fill_values(const py::object& at, const Block& block, const double* xi2, Rows rows) const;
  void fill_supplied(const Block& block, const double* xi2, const double* xi1, Rows tangent) const;
  void fill_differences(const Block& block, const double* xi2, const double* xi1,
                        Rows tangent) const;
  Eigen::VectorXd predict(const Block& block, const double* xi2, const double* xi1) const;

  std::string name_;
  std::shared_ptr<const PythonFunctions> functions_;  // takes the GIL to give them back
};

}  // namespace sepcal::bindings
