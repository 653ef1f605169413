// SPDX-License-Identifier: BSD-3-Clause
// The filters and recursions of flight software, in sizes that are known at run time.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <Eigen/Cholesky>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "bindings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/information_root.hpp"
#include "sepcal/states/joseph_form.hpp"
#include "sepcal/states/recursive_least_squares.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Throws Error naming a matrix of another size.
void check_size(const char* name, const MatrixXd& matrix, Index rows, Index columns) {
  if (matrix.rows() == rows && matrix.cols() == columns) return;
  const auto text = [](Index n, Index m) {
    return "(" + std::to_string(n) + ", " + std::to_string(m) + ")";
  };
  throw Error(std::string(name) + " has the shape " + text(matrix.rows(), matrix.cols()) +
              "; here it takes " + text(rows, columns));
}

void check_length(const char* name, const VectorXd& vector, Index length) {
  if (vector.size() == length) return;
  throw Error(std::string(name) + " has " + std::to_string(vector.size()) +
              " entries; here it takes " + std::to_string(length));
}

class AnyFilter {
 public:
  AnyFilter(const VectorXd& x, const MatrixXd& P, const std::string& form)
      : filter_(make(x, P, form)) {}

  VectorXd x() const {
    return std::visit([](const auto& filter) -> VectorXd { return filter.x(); }, filter_);
  }
  MatrixXd covariance() const {
    return std::visit([](const auto& filter) -> MatrixXd { return filter.covariance(); }, filter_);
  }

  bool predict(const VectorXd& x_next, const MatrixXd& Phi, const MatrixXd& Gamma,
               const MatrixXd& Q) {
    const Index n = x().size();
    check_length("x", x_next, n);
    check_size("Phi", Phi, n, n);
    check_size("Gamma", Gamma, n, Gamma.cols());
    check_size("Q", Q, Gamma.cols(), Gamma.cols());
    const Transition<Dynamic, Dynamic> to{x_next, Phi, Gamma, Q};
    return std::visit([&](auto& filter) { return filter.predict(to); }, filter_) ==
           FilterStatus::ok;
  }

  std::optional<Innovation<Dynamic>> update(const VectorXd& y, const VectorXd& expected,
                                            const MatrixXd& H, const MatrixXd& R) {
    const Index n_z = y.size();
    check_size("H", H, n_z, x().size());
    check_length("expected", expected, n_z);
    check_size("R", R, n_z, n_z);
    const Linearisation<Dynamic, Dynamic> at{expected, H};
    Innovation<Dynamic> innovation = std::visit(
        [&](auto& filter) { return filter.template update<Dynamic>(y, at, R); }, filter_);
    if (innovation.status != FilterStatus::ok) return std::nullopt;
    return innovation;
  }

 private:
  using SquareRoot = Filter<Dynamic, SquareRootForm<Dynamic>>;
  using Joseph = Filter<Dynamic, JosephForm<Dynamic>>;
  using Either = std::variant<SquareRoot, Joseph>;

  static Either make(const VectorXd& x, const MatrixXd& P, const std::string& form) {
    check_size("P", P, x.size(), x.size());
    if (form == "square_root") return SquareRoot(x, P);
    if (form == "joseph") return Joseph(x, P);
    throw Error("form is '" + form +
                "'; a filter keeps its covariance as 'square_root' or 'joseph'");
  }

  Either filter_;
};

class AnyRecursion {
 public:
  AnyRecursion(const VectorXd& p, const std::optional<MatrixXd>& P, const std::string& form)
      : size_(p.size()), recursion_(make(p, P, form)) {}

  bool absorb(const MatrixXd& H, const VectorXd& y, const MatrixXd& W) {
    check_size("H", H, y.size(), size_);
    check_size("W", W, y.size(), y.size());
    return std::visit([&](auto& form) { return form.template absorb<Dynamic>(H, y, W); },
                      recursion_);
  }
  VectorXd solution() const {
    return std::visit([](const auto& form) -> VectorXd { return form.solution(); }, recursion_);
  }
  MatrixXd covariance() const {
    return std::visit([](const auto& form) -> MatrixXd { return form.covariance(); }, recursion_);
  }
  bool determined() const {
    const auto* root = std::get_if<Root>(&recursion_);
    return root == nullptr || root->determined();
  }

 private:
  using Root = InformationRoot<Dynamic>;
  using Information = InformationRecursion<Dynamic>;
  using Covariance = CovarianceRecursion<Dynamic>;
  using Any = std::variant<Root, Information, Covariance>;

  static Any make(const VectorXd& p, const std::optional<MatrixXd>& P, const std::string& form) {
    const Index n = p.size();
    if (P) check_size("covariance", *P, n, n);
    if (form == "square_root") {
      Root root(MatrixXd::Zero(n + 1, n + 1));
      if (P && !root.absorb<Dynamic>(MatrixXd::Identity(n, n), p, *P)) refuse();
      return root;
    }
    if (!P) throw Error("form '" + form + "' begins at a covariance; 'square_root' needs none");
    if (form == "covariance") return Covariance(p, *P);
    if (form != "information") {
      throw Error("form is '" + form + "'; it is 'square_root', 'information' or 'covariance'");
    }
    const Eigen::LLT<MatrixXd> root(*P);
    if (root.info() != Eigen::Success) refuse();
    return Information(p, root.solve(MatrixXd::Identity(n, n)));
  }

  [[noreturn]] static void refuse() {
    throw Error("the covariance to begin with is not positive definite");
  }

  Index size_;
  Any recursion_;
};

}  // namespace

void define_filters(py::module_& module) {
  py::class_<AnyFilter>(module, "Filter")
      .def(py::init<const VectorXd&, const MatrixXd&, const std::string&>())
      .def(py::init<const AnyFilter&>())
      .def_property_readonly("x", &AnyFilter::x)
      .def_property_readonly("covariance", &AnyFilter::covariance)
      .def("predict", &AnyFilter::predict)
      .def("update", &AnyFilter::update);
  py::class_<AnyRecursion>(module, "RecursiveLeastSquares")
      .def(py::init<const VectorXd&, const std::optional<MatrixXd>&, const std::string&>())
      .def_property_readonly("solution", &AnyRecursion::solution)
      .def_property_readonly("covariance", &AnyRecursion::covariance)
      .def_property_readonly("determined", &AnyRecursion::determined)
      .def("absorb", &AnyRecursion::absorb);
}

}  // namespace sepcal::bindings
