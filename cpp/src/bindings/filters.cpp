// SPDX-License-Identifier: BSD-3-Clause
// The filters and recursions of flight software, in sizes that are known at run time, and what they
// are fed with: transitions, noises of a step, rows of least squares.
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <Eigen/Cholesky>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "sepcal/detail/states/information_root.hpp"
#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/discretise.hpp"
#include "sepcal/states/extended_filter.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/iterated_update.hpp"
#include "sepcal/states/least_squares.hpp"
#include "sepcal/states/recursive_least_squares.hpp"
#include "sepcal/states/smoother.hpp"
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

void check_square(const char* name, const MatrixXd& matrix) {
  check_size(name, matrix, matrix.rows(), matrix.rows());
}

using DynamicTransition = Transition<Dynamic, Dynamic>;
using DynamicStage = Stage<Dynamic, Dynamic>;

/// Python's outputs(x): what is expected of y at x (n_z), and its derivative (n_z x n_x).
using Outputs = std::function<std::pair<VectorXd, MatrixXd>(const VectorXd&)>;

class AnyFilter {
 public:
  AnyFilter(const VectorXd& x, const MatrixXd& P, const std::string& form)
      : filter_(make(x, P, form)) {
    if (!covariance().allFinite()) {
      throw Error("P is singular, and form 'information' keeps its inverse; take 'square_root'");
    }
  }

  /// Of form "information", from R with R'R = P^-1.
  static AnyFilter of_information_root(const VectorXd& x, const MatrixXd& R) {
    check_size("information_root", R, x.size(), x.size());
    return AnyFilter(Information(x, InformationForm<Dynamic>::of_information_root(R)));
  }

  VectorXd x() const {
    return std::visit([](const auto& filter) -> VectorXd { return filter.x(); }, filter_);
  }
  MatrixXd covariance() const {
    return std::visit([](const auto& filter) -> MatrixXd { return filter.covariance(); }, filter_);
  }
  std::optional<MatrixXd> information_root() const {
    const auto* filter = std::get_if<Information>(&filter_);
    if (filter == nullptr) return std::nullopt;
    return filter->form().information_root();
  }

  bool predict(const VectorXd& x_next, const MatrixXd& Phi, const MatrixXd& Gamma,
               const MatrixXd& Q) {
    const Index n = x().size();
    check_length("x", x_next, n);
    check_size("Phi", Phi, n, n);
    check_size("Gamma", Gamma, n, Gamma.cols());
    check_size("Q", Q, Gamma.cols(), Gamma.cols());
    const DynamicTransition to{x_next, Phi, Gamma, Q};
    std::optional<DynamicStage> stage;
    if (keeps_pass_) stage = {estimate(), to};
    const bool used =
        std::visit([&](auto& filter) { return filter.predict(to); }, filter_) == FilterStatus::ok;
    if (used && stage) pass_.push_back(*std::move(stage));
    return used;
  }

  std::optional<Innovation<Dynamic>> update(const VectorXd& y, const VectorXd& expected,
                                            const MatrixXd& H, const MatrixXd& R) {
    const Linearisation<Dynamic, Dynamic> at = linearisation(y, expected, H);
    check_size("R", R, y.size(), y.size());
    Innovation<Dynamic> innovation = std::visit(
        [&](auto& filter) { return filter.template update<Dynamic>(y, at, R); }, filter_);
    if (innovation.status == FilterStatus::refused) return std::nullopt;
    return innovation;
  }

  /// The innovation, and whether the iterations ended by themselves.
  std::optional<std::pair<Innovation<Dynamic>, bool>> iterated_update(
      const VectorXd& y, const Outputs& outputs, const MatrixXd& R,
      const IterationOptions& options) {
    check_size("R", R, y.size(), y.size());
    const auto at = [&](const VectorXd& eta) {
      const auto [expected, H] = outputs(eta);
      return linearisation(y, expected, H);
    };
    Innovation<Dynamic> innovation = std::visit(
        [&](auto& filter) { return sepcal::iterated_update(filter, y, at, R, options); }, filter_);
    if (innovation.status == FilterStatus::refused) return std::nullopt;
    const bool converged = innovation.status == FilterStatus::ok;
    return std::pair(std::move(innovation), converged);
  }

  void keep_pass() { keeps_pass_ = true; }
  bool keeps_pass() const { return keeps_pass_; }

  /// Of every sample x and P; of every step between samples w and Q.
  using SmoothedParts = std::tuple<std::vector<VectorXd>, std::vector<MatrixXd>,
                                   std::vector<VectorXd>, std::vector<MatrixXd>>;

  SmoothedParts smooth() const {
    std::vector<DynamicStage> pass = pass_;
    pass.push_back({.filtered = estimate()});
    std::vector<Smoothed<Dynamic, Dynamic>> smoothed(pass.size());
    sepcal::smooth(pass, smoothed);
    SmoothedParts result;
    auto& [x, P, w, Q] = result;
    for (Smoothed<Dynamic, Dynamic>& sample : smoothed) {
      x.push_back(std::move(sample.x));
      P.push_back(std::move(sample.P));
      w.push_back(std::move(sample.w));
      Q.push_back(std::move(sample.Q));
    }
    w.pop_back();  // nothing comes after the last sample
    Q.pop_back();
    return result;
  }

 private:
  using SquareRoot = Filter<Dynamic, SquareRootForm<Dynamic>>;
  using Joseph = Filter<Dynamic, JosephForm<Dynamic>>;
  using Information = Filter<Dynamic, InformationForm<Dynamic>>;
  using Any = std::variant<SquareRoot, Joseph, Information>;

  explicit AnyFilter(Any filter) : filter_(std::move(filter)) {}

  static Any make(const VectorXd& x, const MatrixXd& P, const std::string& form) {
    check_size("P", P, x.size(), x.size());
    if (form == "square_root") return SquareRoot(x, P);
    if (form == "joseph") return Joseph(x, P);
    if (form == "information") return Information(x, P);
    throw Error("form is '" + form +
                "'; a filter keeps its covariance as 'square_root', 'joseph' or 'information'");
  }

  Estimate<Dynamic> estimate() const {
    return std::visit([](const auto& filter) { return filter.estimate(); }, filter_);
  }

  Linearisation<Dynamic, Dynamic> linearisation(const VectorXd& y, const VectorXd& expected,
                                                const MatrixXd& H) const {
    check_size("H", H, y.size(), x().size());
    check_length("expected", expected, y.size());
    return {expected, H};
  }

  Any filter_;
  bool keeps_pass_ = false;
  std::vector<DynamicStage> pass_;
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

/// x' = f(x, t) + G(x, t) w of Python's functions, whose shapes are looked at.
class PythonSystem {
 public:
  using ToVector = std::function<VectorXd(const VectorXd&, double)>;
  using ToMatrix = std::function<MatrixXd(const VectorXd&, double)>;

  PythonSystem(ToVector rate, ToMatrix rate_jacobian, ToMatrix noise_input, Index n_w)
      : rate_(std::move(rate)),
        rate_jacobian_(std::move(rate_jacobian)),
        noise_input_(std::move(noise_input)),
        n_w_(n_w) {}

  VectorXd rate(const VectorXd& x, double t) const {
    VectorXd f = rate_(x, t);
    check_length("rate(x, t)", f, x.size());
    return f;
  }
  MatrixXd rate_jacobian(const VectorXd& x, double t) const {
    MatrixXd F = rate_jacobian_(x, t);
    check_size("rate_jacobian(x, t)", F, x.size(), x.size());
    return F;
  }
  MatrixXd noise_input(const VectorXd& x, double t) const {
    MatrixXd G = noise_input_(x, t);
    check_size("noise_input(x, t)", G, x.size(), n_w_);
    return G;
  }

 private:
  ToVector rate_;
  ToMatrix rate_jacobian_;
  ToMatrix noise_input_;
  Index n_w_;
};

/// x, Phi and Q_d at `end`.
std::tuple<VectorXd, MatrixXd, MatrixXd> propagate_python(PythonSystem::ToVector rate,
                                                          PythonSystem::ToMatrix rate_jacobian,
                                                          PythonSystem::ToMatrix noise_input,
                                                          const VectorXd& x, const MatrixXd& Q,
                                                          double begin, double end,
                                                          double longest_step) {
  check_square("Q", Q);
  const PythonSystem system(std::move(rate), std::move(rate_jacobian), std::move(noise_input),
                            Q.cols());
  DynamicTransition to =
      propagate<Dynamic, Dynamic, double>(system, x, Q, begin, end, longest_step);
  return {std::move(to.x), std::move(to.Phi), std::move(to.Q_d)};
}

/// Phi and Q_d.
std::pair<MatrixXd, MatrixXd> discretise_noise(const MatrixXd& F, const MatrixXd& density,
                                               double dt) {
  check_square("F", F);
  check_size("density", density, F.rows(), F.rows());
  DiscreteNoise<Dynamic> step = discretise<Dynamic>(F, density, dt);
  return {std::move(step.Phi), std::move(step.Q_d)};
}

/// held, begin, end.
std::tuple<MatrixXd, MatrixXd, MatrixXd> discretise_python_inputs(const MatrixXd& F,
                                                                  const MatrixXd& B, double dt) {
  check_square("F", F);
  check_size("B", B, F.rows(), B.cols());
  DiscreteInputs<Dynamic, Dynamic> step = discretise_inputs<Dynamic, Dynamic>(F, B, dt);
  return {std::move(step.held), std::move(step.begin), std::move(step.end)};
}

/// Python's sample(k, p): z, H, W.
using Sample = std::function<std::tuple<VectorXd, MatrixXd, MatrixXd>(int, const VectorXd&)>;

/// status, iterations, p, [R q; 0 rho], covariance, values, cost.
std::tuple<std::string, int, VectorXd, MatrixXd, MatrixXd, int, double> iterate_python_samples(
    const Sample& sample, int count, const VectorXd& p, int iterations, double tolerance,
    int halvings) {
  const auto rows = [&](int k, const VectorXd& at) {
    auto [z, H, W] = sample(k, at);
    check_size("H", H, z.size(), p.size());
    check_size("W", W, z.size(), z.size());
    return LeastSquaresRows<Dynamic, Dynamic>{std::move(z), std::move(H), std::move(W)};
  };
  const auto found = iterate_least_squares<Dynamic, double>(
      rows, count, p, {.iterations = iterations, .tolerance = tolerance, .halvings = halvings});
  const auto word = [&] {
    switch (found.status) {
      case LeastSquaresStatus::converged:
        return "converged";
      case LeastSquaresStatus::not_converged:
        return "not_converged";
      case LeastSquaresStatus::not_determined:
        return "not_determined";
      case LeastSquaresStatus::refused:
        break;
    }
    return "refused";
  };
  return {word(),
          found.iterations,
          found.p,
          found.rows.matrix(),
          found.rows.covariance(),
          found.rows.count(),
          found.cost};
}

}  // namespace

void define_filters(py::module_& module) {
  py::class_<AnyFilter>(module, "Filter")
      .def(py::init<const VectorXd&, const MatrixXd&, const std::string&>())
      .def(py::init<const AnyFilter&>())
      .def_static("of_information_root", &AnyFilter::of_information_root)
      .def_property_readonly("x", &AnyFilter::x)
      .def_property_readonly("covariance", &AnyFilter::covariance)
      .def_property_readonly("information_root", &AnyFilter::information_root)
      .def_property_readonly("keeps_pass", &AnyFilter::keeps_pass)
      .def("keep_pass", &AnyFilter::keep_pass)
      .def("predict", &AnyFilter::predict)
      .def("update", &AnyFilter::update)
      .def("iterated_update", &AnyFilter::iterated_update)
      .def("smooth", &AnyFilter::smooth);
  py::class_<AnyRecursion>(module, "RecursiveLeastSquares")
      .def(py::init<const VectorXd&, const std::optional<MatrixXd>&, const std::string&>())
      .def_property_readonly("solution", &AnyRecursion::solution)
      .def_property_readonly("covariance", &AnyRecursion::covariance)
      .def_property_readonly("determined", &AnyRecursion::determined)
      .def("absorb", &AnyRecursion::absorb);
  module.def("matrix_exponential", [](const MatrixXd& A) {
    check_square("A", A);
    return matrix_exponential(A);
  });
  module.def("discretise", &discretise_noise);
  module.def("discretise_inputs", &discretise_python_inputs);
  module.def("propagate", &propagate_python);
  module.def("iterate_least_squares", &iterate_python_samples);
}

}  // namespace sepcal::bindings
