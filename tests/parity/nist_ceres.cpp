// SPDX-License-Identifier: BSD-3-Clause
// NIST's nonlinear regression sets by Ceres alone: one residual block a sample, all parameters at
// once, automatic derivatives, Levenberg-Marquardt with a dense QR, tolerances of 1e-16. The peer
// of docs/nist.md; its formulas are its own.
//   nist_ceres SET < NUMBERS    NUMBERS: the start b1 b2 ..., then rows of the predictors and y
// Prints "converged" or "stopped" and b1 b2 ....
#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <array>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using std::numbers::pi;

template <int N, int Inputs = 1>
struct Sizes {
  static constexpr int n = N;
  static constexpr int inputs = Inputs;
};

struct Bennett : Sizes<3> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * pow(b[1] + x[0], -1.0 / b[2]);
  }
};

struct Saturation : Sizes<2> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * (1.0 - exp(-b[1] * x[0]));
  }
};

struct Chwirut : Sizes<3> {
  template <class T>
  static T at(const T* b, const double* x) {
    return exp(-b[0] * x[0]) / (b[1] + b[2] * x[0]);
  }
};

struct DanWood : Sizes<2> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * pow(x[0], b[1]);
  }
};

struct Enso : Sizes<9> {
  template <class T>
  static T at(const T* b, const double* x) {
    const T turn(2.0 * pi * x[0]);
    return b[0] + b[1] * cos(turn / 12.0) + b[2] * sin(turn / 12.0) + b[4] * cos(turn / b[3]) +
           b[5] * sin(turn / b[3]) + b[7] * cos(turn / b[6]) + b[8] * sin(turn / b[6]);
  }
};

struct Eckerle : Sizes<3> {
  template <class T>
  static T at(const T* b, const double* x) {
    const T t = (x[0] - b[2]) / b[1];
    return b[0] / b[1] * exp(-0.5 * t * t);
  }
};

struct Gauss : Sizes<8> {
  template <class T>
  static T at(const T* b, const double* x) {
    const T s = (x[0] - b[3]) / b[4];
    const T t = (x[0] - b[6]) / b[7];
    return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-s * s) + b[5] * exp(-t * t);
  }
};

/// A polynomial over one with the constant term 1, both of that degree.
template <int Degree>
struct Rational : Sizes<2 * Degree + 1> {
  template <class T>
  static T at(const T* b, const double* x) {
    T above(0.0);
    T below(0.0);
    for (int k = Degree; k >= 1; --k) {
      above = (above + b[k]) * x[0];
      below = (below + b[Degree + k]) * x[0];
    }
    return (b[0] + above) / (1.0 + below);
  }
};

struct Lanczos : Sizes<6> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-b[3] * x[0]) + b[4] * exp(-b[5] * x[0]);
  }
};

struct Mgh09 : Sizes<4> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * (x[0] * x[0] + x[0] * b[1]) / (x[0] * x[0] + x[0] * b[2] + b[3]);
  }
};

struct Mgh10 : Sizes<3> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * exp(b[1] / (x[0] + b[2]));
  }
};

struct Mgh17 : Sizes<5> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] + b[1] * exp(-x[0] * b[3]) + b[2] * exp(-x[0] * b[4]);
  }
};

struct Misra1b : Sizes<2> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * (1.0 - pow(1.0 + 0.5 * b[1] * x[0], -2.0));
  }
};

struct Misra1c : Sizes<2> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * (1.0 - pow(1.0 + 2.0 * b[1] * x[0], -0.5));
  }
};

struct Misra1d : Sizes<2> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] * b[1] * x[0] / (1.0 + b[1] * x[0]);
  }
};

struct Nelson : Sizes<3, 2> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] - b[1] * x[0] * exp(-b[2] * x[1]);
  }
};

struct Rat42 : Sizes<3> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] / (1.0 + exp(b[1] - b[2] * x[0]));
  }
};

struct Rat43 : Sizes<4> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] / pow(1.0 + exp(b[1] - b[2] * x[0]), 1.0 / b[3]);
  }
};

struct Roszman : Sizes<4> {
  template <class T>
  static T at(const T* b, const double* x) {
    return b[0] - b[1] * x[0] - atan(b[2] / (x[0] - b[3])) / pi;
  }
};

/// y - f(x, b) of one row: predictors, then y.
template <class Model>
struct Residual {
  std::span<const double> row;

  template <class T>
  bool operator()(const T* b, T* residual) const {
    *residual = row[Model::inputs] - Model::at(b, row.data());
    return true;
  }
};

template <class Model>
void solve(const std::vector<double>& numbers) {
  constexpr std::size_t n = Model::n;
  constexpr std::size_t columns = Model::inputs + 1;
  if (numbers.size() < n + columns || (numbers.size() - n) % columns != 0) {
    throw std::runtime_error("the numbers are no start and whole rows");
  }
  std::array<double, n> b{};
  std::copy_n(numbers.begin(), n, b.begin());
  ceres::Problem problem;
  for (std::size_t at = n; at < numbers.size(); at += columns) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual<Model>, 1, Model::n>(
                                 new Residual<Model>{std::span(numbers).subspan(at, columns)}),
                             nullptr, b.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 20000;
  options.function_tolerance = 1e-16;
  options.gradient_tolerance = 1e-16;
  options.parameter_tolerance = 1e-16;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  std::cout << (summary.termination_type == ceres::CONVERGENCE ? "converged" : "stopped")
            << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const double value : b) std::cout << ' ' << value;
  std::cout << '\n';
}

using Solve = void (*)(const std::vector<double>&);

Solve find(const std::string& set) {
  static const std::map<std::string, Solve> sets{
      {"Bennett5", solve<Bennett>},   {"BoxBOD", solve<Saturation>},
      {"Chwirut1", solve<Chwirut>},   {"Chwirut2", solve<Chwirut>},
      {"DanWood", solve<DanWood>},    {"ENSO", solve<Enso>},
      {"Eckerle4", solve<Eckerle>},   {"Gauss1", solve<Gauss>},
      {"Gauss2", solve<Gauss>},       {"Gauss3", solve<Gauss>},
      {"Hahn1", solve<Rational<3>>},  {"Kirby2", solve<Rational<2>>},
      {"Lanczos1", solve<Lanczos>},   {"Lanczos2", solve<Lanczos>},
      {"Lanczos3", solve<Lanczos>},   {"MGH09", solve<Mgh09>},
      {"MGH10", solve<Mgh10>},        {"MGH17", solve<Mgh17>},
      {"Misra1a", solve<Saturation>}, {"Misra1b", solve<Misra1b>},
      {"Misra1c", solve<Misra1c>},    {"Misra1d", solve<Misra1d>},
      {"Nelson", solve<Nelson>},      {"Rat42", solve<Rat42>},
      {"Rat43", solve<Rat43>},        {"Roszman1", solve<Roszman>},
      {"Thurber", solve<Rational<3>>}};
  const auto at = sets.find(set);
  if (at == sets.end()) throw std::runtime_error("there is no set '" + set + "'");
  return at->second;
}

}  // namespace

int main(int count, char** arguments) {
  FLAGS_minloglevel = google::GLOG_FATAL;
  try {
    if (count != 2) throw std::runtime_error("usage: nist_ceres SET < NUMBERS");
    find(arguments[1])({std::istream_iterator<double>(std::cin), {}});
  } catch (const std::exception& error) {
    std::cerr << "nist_ceres: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
