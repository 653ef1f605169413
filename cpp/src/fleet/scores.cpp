// SPDX-License-Identifier: BSD-3-Clause
#include "fleet/scores.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "diagnosis/projection.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/error.hpp"

namespace sepcal::fleet {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double seen = 1e-8;  // least eigenvalue of information, of columns of unit length

/// The mean of each attribute over the flights that have it.
std::map<std::string, double> attribute_means(const std::vector<FleetFlight>& flights) {
  std::map<std::string, std::pair<double, double>> sums;
  for (const FleetFlight& flight : flights) {
    for (const auto& [name, value] : flight.attributes) {
      if (!std::isfinite(value)) {
        throw Error("flight '" + flight.name + "': its attribute '" + name +
                    "' is no finite number");
      }
      sums[name].first += value;
      sums[name].second += 1.0;
    }
  }
  std::map<std::string, double> means;
  for (const auto& [name, sum] : sums) means[name] = sum.first / sum.second;
  return means;
}

}  // namespace

Scores::Scores(const std::vector<FleetFlight>& flights)
    : parameters_(flights.empty() ? 0 : flights.front().factor.values.size()),
      count_(flights.size()) {
  for (Vehicle& vehicle : group_vehicles(flights)) {
    vehicles_.push_back({.of = std::move(vehicle)});
  }
  find_groups(flights);
  const std::map<std::string, double> means = attribute_means(flights);
  const auto c = static_cast<Index>(columns_.size());
  norms_ = VectorXd::Zero(c);
  for (Rows& vehicle : vehicles_) {
    const VectorXd& reference = flights[vehicle.of.flights.front()].factor.values;
    for (const std::size_t i : vehicle.of.flights) {
      const FlightFactor& factor = flights[i].factor;
      const MatrixXd given = rows_about(factor, reference);
      MatrixXd rows = MatrixXd::Zero(given.rows(), parameters_ + c + 1);
      rows.leftCols(parameters_) = given.leftCols(parameters_);
      rows.rightCols<1>() = given.rightCols<1>();
      for (std::size_t k = 0; k < factor.columns.size(); ++k) {
        const auto at = std::ranges::find(columns_, factor.columns[k]) - columns_.begin();
        rows.col(parameters_ + at) = given.col(parameters_ + static_cast<Index>(k));
      }
      for (const Growth& growth : growths_) {
        const auto value = flights[i].attributes.find(growth.attribute);
        if (value == flights[i].attributes.end()) continue;
        rows.col(parameters_ + growth.column) =
            given.col(growth.parameter) * (value->second - means.at(growth.attribute));
      }
      norms_ += rows.middleCols(parameters_, c).colwise().squaredNorm().transpose();
      vehicle.flights.push_back({.rows = std::move(rows), .Q = {}, .G = {}, .r = {}});
    }
  }
  norms_ = norms_.cwiseSqrt();
  for (double& norm : norms_) norm = norm > 0.0 ? norm : 1.0;
  for (Rows& vehicle : vehicles_) {
    for (Part& part : vehicle.flights) {
      part.rows.middleCols(parameters_, c) *= norms_.cwiseInverse().asDiagonal();
    }
    project(vehicle);
  }
}

void Scores::find_groups(const std::vector<FleetFlight>& flights) {
  std::set<std::string> attributes;
  for (const FleetFlight& flight : flights) {
    for (const CandidateColumn& column : flight.factor.columns) {
      if (std::ranges::find(columns_, column) != columns_.end()) continue;
      auto group = std::ranges::find(groups_, column.effect, &Group::effect);
      if (group == groups_.end())
        group = groups_.insert(
            groups_.end(), {.effect = column.effect, .columns = {}, .stands_in = column.stands_in});
      group->columns.push_back(static_cast<Index>(columns_.size()));
      columns_.push_back(column);
    }
    for (const auto& [name, value] : flight.attributes) attributes.insert(name);
  }
  const FlightFactor& first = flights.front().factor;
  for (const std::string& attribute : attributes) {
    for (std::size_t k = 0; k < first.parameters.size(); ++k) {
      const std::string name = rate_name(first.parameters[k], attribute);
      if (std::ranges::find(groups_, name, &Group::effect) != groups_.end()) continue;
      const auto column = static_cast<Index>(columns_.size());
      growths_.push_back({column, static_cast<Index>(k), attribute});
      groups_.push_back({.cause = FleetCause::grows, .effect = name, .columns = {column}});
      columns_.push_back({name, name, rate_unit(first.units[k], attribute)});
    }
  }
}

void Scores::project(Rows& vehicle) const {
  const auto c = static_cast<Index>(columns_.size());
  std::vector<Index> estimated(static_cast<std::size_t>(parameters_));
  std::iota(estimated.begin(), estimated.end(), Index{0});
  for (const Index column : vehicle.own) estimated.push_back(parameters_ + column);
  TriangularFactor merged(static_cast<int>(estimated.size()));
  for (const Part& part : vehicle.flights) {
    MatrixXd rows = part.rows(Eigen::all, estimated);
    merged.absorb(rows);
  }
  const MatrixXd weights = diagnosis::orthonormal_weights(merged.matrix());
  MatrixXd explained = MatrixXd::Zero(weights.cols(), c + 1);
  for (Part& part : vehicle.flights) {
    part.Q = part.rows(Eigen::all, estimated) * weights;
    explained += part.Q.transpose() * part.rows.rightCols(c + 1);
  }
  vehicle.information = MatrixXd::Zero(c, c);
  vehicle.score = VectorXd::Zero(c);
  for (Part& part : vehicle.flights) {
    const MatrixXd left = part.rows.rightCols(c + 1) - part.Q * explained;
    part.G = left.leftCols(c);
    part.r = left.rightCols<1>();
    vehicle.information += part.G.transpose() * part.G;
    vehicle.score += part.G.transpose() * part.r;
  }
}

void Scores::free(std::size_t vehicle, const std::vector<Index>& columns) {
  Rows& rows = vehicles_[vehicle];
  rows.own.insert(rows.own.end(), columns.begin(), columns.end());
  project(rows);
}

bool Scores::is_free(std::size_t vehicle, Index column) const {
  const std::vector<Index>& own = vehicles_[vehicle].own;
  return std::ranges::find(own, column) != own.end();
}

MatrixXd Scores::information(std::size_t vehicle, const std::vector<Index>& columns) const {
  return vehicles_[vehicle].information(columns, columns);
}

VectorXd Scores::score(std::size_t vehicle, const std::vector<Index>& columns) const {
  return vehicles_[vehicle].score(columns);
}

void Scores::each_flight(std::size_t vehicle, const std::vector<Index>& columns,
                         std::vector<MatrixXd>& informations, std::vector<VectorXd>& scores) const {
  for (const Part& part : vehicles_[vehicle].flights) {
    const MatrixXd G = part.G(Eigen::all, columns);
    informations.emplace_back(G.transpose() * G);
    scores.emplace_back(G.transpose() * part.r);
  }
}

VehicleScore Scores::of_vehicle(std::size_t v, const std::vector<Index>& columns,
                                const std::vector<Index>& accepted, const VectorXd& known) const {
  const Rows& vehicle = vehicles_[v];
  VehicleScore result{.information = vehicle.information(columns, columns)};
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(result.information);
  const auto q = static_cast<Index>(columns.size());
  if (!(eigen.eigenvalues()[0] > seen / static_cast<double>(vehicles_.size()))) return result;
  result.tells = true;
  const MatrixXd inverse_root =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal();
  const MatrixXd inverse = inverse_root * inverse_root.transpose();
  VectorXd score = vehicle.score(columns);
  if (!accepted.empty()) score -= vehicle.information(columns, accepted) * known;
  result.estimate = inverse * score;
  // Flights that have the columns; one that has them alone can't be left out.
  std::vector<const Part*> telling;
  for (const Part& part : vehicle.flights) {
    const double share = (part.G(Eigen::all, columns) * inverse_root).squaredNorm();
    if (share > 1e-6) telling.push_back(&part);
    if (share > static_cast<double>(q) - 1e-6) return result;
  }
  const auto n = static_cast<double>(telling.size());
  if (telling.size() < 3) return result;
  // Leaving a flight out moves the estimate by I^-1 G'(1 - H)^-1 e, H the flight's share of the
  // projector on all that the vehicle estimates, [Q | G I^-1/2].
  double sum = 0.0;
  VectorXd mean = VectorXd::Zero(q);
  std::vector<VectorXd> moves;
  for (const Part* const one : telling) {
    const Part& part = *one;
    const MatrixXd G = part.G(Eigen::all, columns) * inverse_root;
    VectorXd e = part.r - part.G(Eigen::all, columns) * result.estimate;
    if (!accepted.empty()) e -= part.G(Eigen::all, accepted) * known;
    MatrixXd X(part.Q.rows(), part.Q.cols() + q);
    X << part.Q, G;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> hat(X.transpose() * X);
    // What only this flight tells goes with it.
    VectorXd gain = hat.eigenvalues();
    for (double& share : gain) share = share < 1.0 - 1e-9 ? 1.0 / (1.0 - share) : 0.0;
    const VectorXd inner = hat.eigenvectors().transpose() * (X.transpose() * e);
    const VectorXd u =
        G.transpose() * e + (G.transpose() * X) * (hat.eigenvectors() * gain.cwiseProduct(inner));
    mean += u / n;
    moves.push_back(u);
  }
  for (const VectorXd& u : moves) sum += (u - mean).squaredNorm();
  result.freedom = n - 1.0;
  result.inflation = (n - 1.0) / n * sum / static_cast<double>(q);
  return result;
}

std::vector<double> Scores::misfits(const std::vector<Index>& accepted,
                                    const VectorXd& known) const {
  std::vector<double> misfits(count_);
  for (const Rows& vehicle : vehicles_) {
    for (std::size_t f = 0; f < vehicle.flights.size(); ++f) {
      const Part& part = vehicle.flights[f];
      VectorXd left = part.r;
      if (!accepted.empty()) left -= part.G(Eigen::all, accepted) * known;
      misfits[vehicle.of.flights[f]] = left.squaredNorm();
    }
  }
  return misfits;
}

}  // namespace sepcal::fleet
