// SPDX-License-Identifier: BSD-3-Clause
// The restricted likelihood of a mixed linear model on triangles. With H_v = 1 + R_v S R_v' and
// B_v = R_v' H_v^-1 R_v, A = sum B_v, g_v = R_v' H_v^-1 (q_v - R_v mean),
//   l = -1/2 [sum ln det H_v + ln det A + sum e_v' H_v^-1 e_v],
//   dl/dS = 1/2 sum [g_v g_v' - B_v + B_v A^-1 B_v],
// predictions b_v = S g_v, and theta_v's error (1 - S B_v) A^-1 (1 - S B_v)' + S - S B_v S. That S
// is an estimate adds 2 sum_ij V_ij D_i B_v D_j', D_i = (1 - S B_v) dS/ds_i, V = [1/2 sum tr(B_v
// dS/ds_i B_v dS/ds_j)]^-1 the covariance of its entries (Prasad & Rao 1990).
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>
#include <numeric>

#include "fleet/common.hpp"
#include "fleet/vehicles.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fleet.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A vehicle's R_v (p x p) and q_v, in units in which parameters' errors are about 1.
struct VehicleData {
  MatrixXd R;
  VectorXd q;
};

/// The likelihood at a spread, and what is behind it.
struct AtSpread {
  double log_likelihood = 0.0;
  VectorXd mean;
  MatrixXd mean_covariance;  // A^-1
  MatrixXd gradient;         // by S
  std::vector<MatrixXd> B;
  std::vector<VectorXd> g;
};

AtSpread evaluate(const std::vector<VehicleData>& vehicles, const MatrixXd& S) {
  const Index p = S.rows();
  AtSpread at;
  MatrixXd A = MatrixXd::Zero(p, p);
  VectorXd sum = VectorXd::Zero(p);
  std::vector<MatrixXd> weighted;  // H^-1 R
  for (const VehicleData& vehicle : vehicles) {
    const Eigen::LLT<MatrixXd> H(MatrixXd::Identity(p, p) + vehicle.R * S * vehicle.R.transpose());
    at.log_likelihood -= MatrixXd(H.matrixL()).diagonal().array().log().sum();
    weighted.emplace_back(H.solve(vehicle.R));
    at.B.emplace_back(vehicle.R.transpose() * weighted.back());
    A += at.B.back();
    sum += weighted.back().transpose() * vehicle.q;
  }
  const Eigen::LLT<MatrixXd> sum_factor(A);
  at.log_likelihood -= MatrixXd(sum_factor.matrixL()).diagonal().array().log().sum();
  at.mean = sum_factor.solve(sum);
  at.mean_covariance = sum_factor.solve(MatrixXd::Identity(p, p));
  at.gradient = MatrixXd::Zero(p, p);
  for (std::size_t v = 0; v < vehicles.size(); ++v) {
    const VectorXd e = vehicles[v].q - vehicles[v].R * at.mean;
    at.g.emplace_back(weighted[v].transpose() * e);
    // e'H^-1e = e'e - e'R S g, by Woodbury: H^-1 e = e - R S g.
    at.log_likelihood -= 0.5 * (e.squaredNorm() - (vehicles[v].R.transpose() * e).dot(S * at.g[v]));
    const MatrixXd& B = at.B[v];
    at.gradient += 0.5 * (at.g[v] * at.g[v].transpose() - B + B * at.mean_covariance * B);
  }
  return at;
}

using Places = std::vector<std::pair<Index, Index>>;  // row and column

/// Of a spread between these parameters, what is estimated: the diagonal, or all below it too.
Places spread_places(const std::vector<Index>& varying, bool correlated) {
  Places places;
  for (std::size_t i = 0; i < varying.size(); ++i) {
    for (std::size_t j = i; j < (correlated ? varying.size() : i + 1); ++j) {
      places.emplace_back(varying[j], varying[i]);
    }
  }
  return places;
}

/// Over entries of L, S = L L'.
class RestrictedLikelihood final : public ceres::FirstOrderFunction {
 public:
  RestrictedLikelihood(const std::vector<VehicleData>& vehicles, Index p, Places places)
      : vehicles_(vehicles), p_(p), places_(std::move(places)) {}

  MatrixXd root(const double* x) const {
    MatrixXd L = MatrixXd::Zero(p_, p_);
    for (std::size_t k = 0; k < places_.size(); ++k) L(places_[k].first, places_[k].second) = x[k];
    return L;
  }

  VectorXd start() const {
    VectorXd x = VectorXd::Zero(std::ssize(places_));
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (places_[k].first == places_[k].second) x[static_cast<Index>(k)] = 1.0;
    }
    return x;
  }

  bool Evaluate(const double* x, double* cost, double* gradient) const override {
    const MatrixXd L = root(x);
    const AtSpread at = evaluate(vehicles_, L * L.transpose());
    *cost = -at.log_likelihood;
    if (gradient != nullptr) {
      const MatrixXd slope = -2.0 * at.gradient * L;
      for (std::size_t k = 0; k < places_.size(); ++k) {
        gradient[k] = slope(places_[k].first, places_[k].second);
      }
    }
    return std::isfinite(*cost);
  }

  int NumParameters() const override { return static_cast<int>(places_.size()); }

 private:
  const std::vector<VehicleData>& vehicles_;
  Index p_;
  Places places_;
};

/// dS/ds of each entry of a spread.
std::vector<MatrixXd> spread_directions(Index p, const Places& places) {
  std::vector<MatrixXd> directions;
  for (const auto& [row, column] : places) {
    directions.emplace_back(MatrixXd::Zero(p, p));
    directions.back()(row, column) = directions.back()(column, row) = 1.0;
  }
  return directions;
}

/// The covariance of a spread's entries.
MatrixXd spread_covariance(const std::vector<MatrixXd>& B,
                           const std::vector<MatrixXd>& directions) {
  const Index n = std::ssize(directions);
  MatrixXd information = MatrixXd::Zero(n, n);
  for (const MatrixXd& of_vehicle : B) {
    std::vector<MatrixXd> along;
    for (const MatrixXd& direction : directions) along.emplace_back(of_vehicle * direction);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        information(i, j) += 0.5 * along[static_cast<std::size_t>(i)]
                                       .cwiseProduct(along[static_cast<std::size_t>(j)].transpose())
                                       .sum();
      }
    }
  }
  return information.completeOrthogonalDecomposition().pseudoInverse();
}

/// By what variances exceed those of white noise: the mean over vehicles of what leaving out
/// flights shows, not below 1; where fewer than three show it, as noise models have it.
VectorXd measured_inflation(const std::vector<VehicleFit>& fits, Index p) {
  VectorXd inflation(p);
  for (Index k = 0; k < p; ++k) {
    std::vector<double> shown;
    double modelled = 0.0;
    for (const VehicleFit& fit : fits) {
      modelled += fit.inflation[k] / static_cast<double>(fits.size());
      const double ratio = fit.inflation[k] * fit.jackknife(k, k) / fit.covariance(k, k);
      if (std::isfinite(ratio)) shown.push_back(ratio);
    }
    const double mean =
        std::accumulate(shown.begin(), shown.end(), 0.0) / static_cast<double>(shown.size());
    inflation[k] = shown.size() < 3 ? modelled : std::max(1.0, mean);
  }
  return inflation;
}

}  // namespace

Population fit_population(const std::vector<FleetFlight>& flights,
                          const PopulationOptions& options) {
  const std::vector<fleet::Vehicle> vehicles = fleet::group_vehicles(flights);
  if (vehicles.size() < 3) {
    throw Error("a population is of at least three vehicles; this fleet has " +
                std::to_string(vehicles.size()));
  }
  const std::vector<VehicleFit> fits = fit_vehicles(flights, options.common);
  const VectorXd& reference = flights.front().factor.values;
  const Index p = reference.size();
  Population population{.parameters = flights.front().factor.parameters};
  population.inflation =
      options.inflation.size() > 0 ? options.inflation : measured_inflation(fits, p);
  if (population.inflation.size() != p || !(population.inflation.array() > 0.0).all()) {
    throw Error("inflation has a factor above 0 for each of " + std::to_string(p) + " parameters");
  }
  std::vector<MatrixXd> triangles;
  VectorXd information = VectorXd::Zero(p);
  for (const fleet::Vehicle& vehicle : vehicles) {
    triangles.push_back(fleet::merge_parameters(flights, vehicle, reference).matrix());
    information += triangles.back().leftCols(p).colwise().squaredNorm().transpose() /
                   static_cast<double>(vehicles.size());
  }
  if (!(information.array() > 0.0).all()) throw Error("no flight tells all of the parameters");
  const VectorXd unit = (population.inflation.array() / information.array()).sqrt();
  std::vector<VehicleData> data;
  for (const MatrixXd& T : triangles) {
    const MatrixXd R = T.topLeftCorner(p, p);
    const VectorXd found = solve_triangular(R, T.col(p).head(p)).x;
    const MatrixXd scaled = R * population.inflation.cwiseSqrt().cwiseInverse().asDiagonal();
    data.push_back({scaled * unit.asDiagonal(), scaled * found});
  }

  const Places places = spread_places(fleet::part(flights, options.common).own, options.correlated);
  auto* likelihood = new RestrictedLikelihood(data, p, places);
  const ceres::GradientProblem problem(likelihood);
  VectorXd x = likelihood->start();
  ceres::GradientProblemSolver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = 500;
  solver.line_search_direction_type = ceres::BFGS;
  solver.function_tolerance = 1e-15;
  solver.gradient_tolerance = 1e-9;
  solver.parameter_tolerance = 1e-12;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(solver, problem, x.data(), &summary);
  population.converged = summary.termination_type == ceres::CONVERGENCE;

  const MatrixXd L = likelihood->root(x.data());
  const MatrixXd S = L * L.transpose();
  const AtSpread at = evaluate(data, S);
  population.log_likelihood = at.log_likelihood;
  population.mean = reference + unit.cwiseProduct(at.mean);
  population.mean_covariance = unit.asDiagonal() * at.mean_covariance * unit.asDiagonal();
  population.spread = unit.asDiagonal() * S * unit.asDiagonal();
  const std::vector<MatrixXd> directions = spread_directions(p, places);
  const MatrixXd of_spread = spread_covariance(at.B, directions);
  population.shrunken.resize(p, std::ssize(vehicles));
  population.shrunken_errors.resize(p, std::ssize(vehicles));
  for (std::size_t v = 0; v < vehicles.size(); ++v) {
    const auto column = static_cast<Index>(v);
    const MatrixXd left = MatrixXd::Identity(p, p) - S * at.B[v];
    MatrixXd error = left * at.mean_covariance * left.transpose() + S - S * at.B[v] * S;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      for (std::size_t j = 0; j < directions.size(); ++j) {
        error += 2.0 * of_spread(static_cast<Index>(i), static_cast<Index>(j)) * left *
                 directions[i] * at.B[v] * directions[j] * left.transpose();
      }
    }
    population.vehicles.push_back(vehicles[v].name);
    population.shrunken.col(column) = reference + unit.cwiseProduct(at.mean + S * at.g[v]);
    population.shrunken_errors.col(column) =
        unit.cwiseProduct(error.diagonal().cwiseMax(0.0).cwiseSqrt());
  }
  return population;
}

}  // namespace sepcal
