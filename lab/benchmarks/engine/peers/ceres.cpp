// SPDX-License-Identifier: BSD-3-Clause
// Ceres on the five-hole probe, every residual of a row its own, as its users write it.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "peers/five_hole.hpp"

namespace benchmark {
namespace {

/// Some rows one after another; `noise` may change from one solution to the next.
struct Rows {
  const HoistedRow* first;
  int count;
  const double* noise;
};

/// Residuals with automatic derivatives.
struct Residuals {
  Rows rows;

  template <class T>
  bool operator()(const T* x, T* residual) const {
    using std::cos;
    using std::sin;
    const T cos_eps = cos(x[9]);
    const T sin_eps = sin(x[9]);
    const double weights[3] = {1.0 / rows.noise[0], 1.0 / rows.noise[1], 1.0 / rows.noise[2]};
    for (int i = 0; i < rows.count; ++i) {
      const HoistedRow& row = rows.first[i];
      T F[3];
      air_direction(row, x + 5, cos_eps, sin_eps, F);
      const T V = (1.0 + x[0]) * row.airspeed + x[1];
      for (int j = 0; j < 3; ++j) {
        residual[3 * i + j] = (row.z[j] - (F[j] * V - row.rotation[j] + x[2 + j])) * weights[j];
      }
    }
    return true;
  }
};

/// Residuals with derivatives by hand.
class ByHand final : public ceres::CostFunction {
 public:
  explicit ByHand(const Rows& rows) : rows_(rows) {
    set_num_residuals(3 * rows.count);
    mutable_parameter_block_sizes()->push_back(parameters);
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    const double* x = blocks[0];
    const double ce = std::cos(x[9]);
    const double se = std::sin(x[9]);
    double* J = jacobians != nullptr ? jacobians[0] : nullptr;
    const double weights[3] = {1.0 / rows_.noise[0], 1.0 / rows_.noise[1], 1.0 / rows_.noise[2]};
    for (int i = 0; i < rows_.count; ++i) {
      const HoistedRow& row = rows_.first[i];
      const double alpha = (1.0 + x[5]) * row.alpha + x[6];
      const double beta = (1.0 + x[7]) * row.beta + x[8];
      const double ca = std::cos(alpha);
      const double sa = std::sin(alpha);
      const double cb = std::cos(beta);
      const double sb = std::sin(beta);
      const double V = (1.0 + x[0]) * row.airspeed + x[1];
      const double up = sa * cb;
      const double d[3] = {ca * cb, ce * sb + se * up, ce * up - se * sb};
      const double by_alpha[3] = {-sa * cb, se * ca * cb, ce * ca * cb};
      const double by_beta[3] = {-ca * sb, ce * cb - se * sa * sb, -ce * sa * sb - se * cb};
      for (int j = 0; j < 3; ++j) {
        const double* C = row.C + 3 * j;
        const double w = weights[j];
        const double F = C[0] * d[0] + C[1] * d[1] + C[2] * d[2];
        residual[3 * i + j] = (row.z[j] - (F * V - row.rotation[j] + x[2 + j])) * w;
        if (J == nullptr) continue;
        double* to = J + (3 * i + j) * parameters;
        const double wV = -w * V;
        const double a = wV * (C[0] * by_alpha[0] + C[1] * by_alpha[1] + C[2] * by_alpha[2]);
        const double b = wV * (C[0] * by_beta[0] + C[1] * by_beta[1] + C[2] * by_beta[2]);
        to[0] = -w * F * row.airspeed;
        to[1] = -w * F;
        to[2] = to[3] = to[4] = 0.0;
        to[2 + j] = -w;
        to[5] = a * row.alpha;
        to[6] = a;
        to[7] = b * row.beta;
        to[8] = b;
        to[9] = wV * (C[1] * d[2] - C[2] * d[1]);
      }
    }
    return true;
  }

 private:
  Rows rows_;
};

ceres::CostFunction* cost_of(const Rows& rows, const CeresWay& way) {
  if (way.analytic) return new ByHand(rows);
  if (rows.count == 1) {
    return new ceres::AutoDiffCostFunction<Residuals, 3, parameters>(new Residuals{rows});
  }
  return new ceres::AutoDiffCostFunction<Residuals, ceres::DYNAMIC, parameters>(new Residuals{rows},
                                                                                3 * rows.count);
}

std::unique_ptr<ceres::Problem> problem_of(const std::vector<HoistedRow>& rows, const CeresWay& way,
                                           const double* noise, Answer& x) {
  auto problem = std::make_unique<ceres::Problem>();
  const auto block = static_cast<std::size_t>(way.samples);
  for (std::size_t i = 0; i < rows.size(); i += block) {
    const int count = static_cast<int>(std::min(block, rows.size() - i));
    problem->AddResidualBlock(cost_of({rows.data() + i, count, noise}, way), nullptr, x.data());
  }
  return problem;
}

}  // namespace

double solve(ceres::Problem& problem, bool qr) {
  ceres::Solver::Options options;
  options.linear_solver_type = qr ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.function_tolerance = 1e-10;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.final_cost;
}

void alternate(ceres::Problem& problem, bool qr, std::array<double, 3>& noise,
               const std::function<std::array<double, 3>()>& noise_at) {
  for (int turn = 0; turn < 20; ++turn) {
    solve(problem, qr);
    const std::array<double, 3> found = noise_at();
    double change = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      const double ratio = found[j] / noise[j];
      change = std::max(change, std::abs(ratio * ratio - 1.0));
    }
    noise = found;
    if (change < 1e-3) break;
  }
}

double solve_by_ceres(const std::vector<HoistedRow>& rows, const CeresWay& way, const double* noise,
                      Answer& x) {
  return solve(*problem_of(rows, way, noise, x), way.qr);
}

void alternate_by_ceres(const std::vector<HoistedRow>& rows, const CeresWay& way,
                        std::array<double, 3> noise, Answer& x) {
  const auto problem = problem_of(rows, way, noise.data(), x);
  alternate(*problem, way.qr, noise, [&] { return noise_at(rows, x); });
}

std::array<double, 3> noise_at(const std::vector<HoistedRow>& rows, const Answer& x) {
  const double one[3] = {1.0, 1.0, 1.0};
  std::array<double, 3> squares{};
  for (const HoistedRow& row : rows) {
    double residual[3];
    Residuals{{&row, 1, one}}(x.data(), residual);
    for (std::size_t j = 0; j < 3; ++j) squares[j] += residual[j] * residual[j];
  }
  for (double& square : squares) square = std::sqrt(square / static_cast<double>(rows.size()));
  return squares;
}

}  // namespace benchmark
