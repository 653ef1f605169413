// SPDX-License-Identifier: BSD-3-Clause
// Many small problems by Ceres, one residual block of all rows each, and by its solver for small
// problems, which has no problem to build.
#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <cmath>

#include "peers/peers.hpp"
#include "trials_file.hpp"

namespace benchmark {
namespace {

/// z - ((1 + a) cos(eta + b) + c) of every row; x: a, c, b.
struct Residuals {
  std::span<const double> eta;
  std::span<const double> z;

  template <class T>
  bool operator()(const T* x, T* residual) const {
    using std::cos;
    for (std::size_t i = 0; i < eta.size(); ++i) {
      residual[i] = z[i] - ((1.0 + x[0]) * cos(eta[i] + x[2]) + x[1]);
    }
    return true;
  }
  // As the solver for small problems asks.
  int NumResiduals() const { return static_cast<int>(eta.size()); }
};

void solve(const Residuals& residuals, double* x) {
  ceres::Problem problem;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residuals, ceres::DYNAMIC, 3>(
                               new Residuals(residuals), residuals.NumResiduals()),
                           nullptr, x);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

Answer solve_each(const TrialsFile& file) {
  Answer answer(3 * file.trials, 0.0);
  for (std::size_t trial = 0; trial < file.trials; ++trial) {
    solve({file.eta, file.z(trial)}, answer.data() + 3 * trial);
  }
  return answer;
}

Answer solve_each_tinily(const TrialsFile& file) {
  using Function = ceres::TinySolverAutoDiffFunction<Residuals, Eigen::Dynamic, 3>;
  Answer answer;
  ceres::TinySolver<Function> solver;
  for (std::size_t trial = 0; trial < file.trials; ++trial) {
    const Residuals residuals{file.eta, file.z(trial)};
    const Function function(residuals);
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    solver.Solve(function, &x);
    answer.insert(answer.end(), x.begin(), x.end());
  }
  return answer;
}

}  // namespace

bool run_scalar_peers(const std::string& method, const std::vector<double>& numbers, int repeats) {
  const TrialsFile file(numbers);
  if (method == "ceres") {
    report(repeats, [&] { return solve_each(file); });
  } else if (method == "tiny-solver") {
    report(repeats, [&] { return solve_each_tinily(file); });
  } else {
    return false;
  }
  return true;
}

}  // namespace benchmark
