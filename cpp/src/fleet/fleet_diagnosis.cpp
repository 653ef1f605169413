// SPDX-License-Identifier: BSD-3-Clause
// The recipe: test every candidate as one of the whole fleet, then as one vehicle's, then as one
// that differs between vehicles; add the one that takes most of the misfit and ask again beside it.
// What judges is how vehicles' estimates scatter (Hartung & Knapp 2001, for several coefficients
// Hotelling's T^2), how those without a flight do within a vehicle (the jackknife, its variances
// moderated after Smyth 2004), and of one among many vehicles the median of all (genomic control,
// Devlin & Roeder 1999).
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <ranges>

#include "fleet/common.hpp"
#include "fleet/moderation.hpp"
#include "fleet/scores.hpp"
#include "fleet/spread.hpp"
#include "fleet/weighting.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/order_statistics.hpp"
#include "numerics/tails.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fleet.hpp"

namespace sepcal {

using namespace fleet;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double causes = 3.0;           // that share the significance
constexpr std::size_t few_vehicles = 8;  // fewer are compared flight by flight
constexpr double as_much = 9.2;          // -2 ln L: less tells no cause from another
constexpr double seen = 1e-8;            // least eigenvalue of what accepted columns leave

/// One test, with what adding its effect needs.
struct Tested {
  FleetFinding finding;
  std::size_t group = 0;
  std::size_t vehicle = 0;  // of one
};

/// Whether one coefficient is the whole fleet's.
bool is_of_fleet(const FleetFinding& finding) {
  return finding.cause == FleetCause::everywhere || finding.cause == FleetCause::grows;
}

/// Information and score of each unit whose estimates are compared: vehicles, or flights.
struct Units {
  std::vector<MatrixXd> information;
  std::vector<VectorXd> score;
  double freedom = 0.0;  // of their scatter, before coefficients are estimated
};

/// What vehicles say of a group, each by itself.
struct VehicleScores {
  std::vector<std::size_t> vehicles;  // that tell
  std::vector<VehicleScore> scores;
  Moderation moderation;  // of their inflations

  /// Of the variance of all: at least what noise models say.
  double pooled() const { return std::max(1.0, moderation.pooled); }
};

class Recipe {
 public:
  /// `options.common` are columns already.
  Recipe(const std::vector<FleetFlight>& flights, const FleetDiagnosisOptions& options)
      : flights_(flights), options_(options), scores_(flights) {
    for (const Group& group : scores_.groups()) {
      if (!is_common(group)) continue;
      accepted_.insert(accepted_.end(), group.columns.begin(), group.columns.end());
    }
  }

  FleetDiagnosis run();

 private:
  void estimate();
  Units units_of(const std::vector<Index>& columns) const;
  VehicleScores ask_vehicles(const Group& group) const;
  std::optional<Tested> test_everywhere(std::size_t group, const VehicleScores& vehicles) const;
  void test_vehicles(std::size_t group, const VehicleScores& vehicles,
                     std::vector<Tested>& tested) const;
  std::optional<Tested> test_differences(std::size_t group, const VehicleScores& vehicles) const;
  bool is_accepted(const Group& group) const;
  bool is_common(const Group& group) const;
  bool is_eliminated(const Group& group) const;
  std::vector<Tested> test_all() const;
  void add(const Tested& best);
  void eliminate(double number);
  double explained(const std::vector<Index>& columns) const;
  std::vector<Index> columns_with(const std::vector<std::size_t>& without,
                                  std::optional<std::size_t> with) const;
  std::vector<std::size_t> accepted_groups() const;
  bool exchange();
  void replace(const std::vector<std::size_t>& groups, std::size_t by);
  std::vector<std::string> as_good_as(std::size_t group) const;
  VectorXd mean_of(const Group& group) const;
  std::vector<Index> places_of(const Group& group) const;
  void forget(const std::string& effect);
  std::vector<Coefficient> coefficients(const Group& group, const VectorXd& estimate,
                                        const VectorXd& errors) const;
  double per_reading(double misfit) const { return misfit / readings_; }

  const std::vector<FleetFlight>& flights_;
  const FleetDiagnosisOptions& options_;
  Scores scores_;
  std::vector<Index> accepted_ = {};  // columns of the fleet
  VectorXd known_ = {};               // their coefficients
  MatrixXd known_covariance_ = {};
  std::vector<std::string> eliminated_ = {};
  std::vector<std::size_t> differing_ = {};  // groups that each vehicle has for itself
  double readings_ = 0.0;
  FleetDiagnosis result_;
};

std::vector<Coefficient> Recipe::coefficients(const Group& group, const VectorXd& estimate,
                                              const VectorXd& errors) const {
  std::vector<Coefficient> all;
  for (std::size_t k = 0; k < group.columns.size(); ++k) {
    const Index column = group.columns[k];
    const CandidateColumn& about = scores_.columns()[static_cast<std::size_t>(column)];
    const double unit = scores_.unit_of(column);
    const auto at = static_cast<Index>(k);
    all.push_back({about.name, about.unit, estimate[at] * unit, errors[at] * unit});
  }
  return all;
}

/// A few vehicles are compared by their flights, of which each vehicle's own estimate takes one.
Units Recipe::units_of(const std::vector<Index>& columns) const {
  Units units;
  for (std::size_t v = 0; v < scores_.vehicles(); ++v) {
    if (std::ranges::any_of(columns, [&](Index k) { return scores_.is_free(v, k); })) continue;
    if (scores_.vehicles() < few_vehicles) {
      scores_.each_flight(v, columns, units.information, units.score);
      units.freedom += static_cast<double>(scores_.flights(v)) - 1.0;
    } else {
      units.information.push_back(scores_.information(v, columns));
      units.score.push_back(scores_.score(v, columns));
      units.freedom += 1.0;
    }
  }
  return units;
}

/// One coefficient a column for all units, and its covariance by their scatter.
struct Common {
  VectorXd estimate;
  MatrixXd covariance;
  MatrixXd plain;  // as noise models have it
  double freedom = 0.0;
};

std::optional<Common> fit_common(const Units& units) {
  if (units.information.empty()) return std::nullopt;
  const Index q = units.score.front().size();
  MatrixXd information = MatrixXd::Zero(q, q);
  VectorXd score = VectorXd::Zero(q);
  for (std::size_t i = 0; i < units.score.size(); ++i) {
    information += units.information[i];
    score += units.score[i];
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information);
  if (!(eigen.eigenvalues()[0] > seen)) return std::nullopt;
  Common common;
  common.plain = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                 eigen.eigenvectors().transpose();
  common.estimate = common.plain * score;
  common.freedom = units.freedom - static_cast<double>(q);
  if (common.freedom < 1.0) return std::nullopt;
  MatrixXd meat = MatrixXd::Zero(q, q);
  for (std::size_t i = 0; i < units.score.size(); ++i) {
    const VectorXd u = units.score[i] - units.information[i] * common.estimate;
    meat += u * u.transpose();
  }
  common.covariance = common.plain * meat * common.plain * (units.freedom / common.freedom);
  return common;
}

void Recipe::estimate() {
  if (accepted_.empty()) {
    known_.resize(0);
    return;
  }
  const std::optional<Common> common = fit_common(units_of(accepted_));
  if (!common) throw Error("what was found can't be told apart in this fleet");
  known_ = common->estimate;
  known_covariance_ = common->covariance;
}

bool Recipe::is_accepted(const Group& group) const {
  return std::ranges::find(accepted_, group.columns.front()) != accepted_.end();
}

bool Recipe::is_eliminated(const Group& group) const {
  return std::ranges::find(eliminated_, group.effect) != eliminated_.end();
}

/// Of what the model has already.
bool Recipe::is_common(const Group& group) const {
  return std::ranges::find(options_.common, group.effect) != options_.common.end();
}

/// Of the group's coefficients: the fleet's where it has them, else none.
VectorXd Recipe::mean_of(const Group& group) const {
  if (!is_accepted(group)) return VectorXd::Zero(std::ssize(group.columns));
  return known_(places_of(group));
}

/// Of an accepted group's columns, among those accepted.
std::vector<Index> Recipe::places_of(const Group& group) const {
  std::vector<Index> places;
  for (const Index column : group.columns) {
    places.push_back(std::ranges::find(accepted_, column) - accepted_.begin());
  }
  return places;
}

/// An effect that explains nothing more, of the fleet or of what differs.
void Recipe::forget(const std::string& effect) {
  std::erase_if(result_.found, [&](const FleetFinding& one) {
    return one.effect == effect && one.cause != FleetCause::one_vehicle;
  });
}

VehicleScores Recipe::ask_vehicles(const Group& group) const {
  std::vector<Index> beside;
  std::vector<double> values;
  for (std::size_t k = 0; k < accepted_.size(); ++k) {
    if (std::ranges::find(group.columns, accepted_[k]) != group.columns.end()) continue;
    beside.push_back(accepted_[k]);
    values.push_back(known_[static_cast<Index>(k)]);
  }
  const VectorXd known = Eigen::Map<const VectorXd>(values.data(), std::ssize(values));
  VehicleScores asked;
  std::vector<double> inflations;
  std::vector<double> freedoms;
  for (std::size_t v = 0; v < scores_.vehicles(); ++v) {
    if (scores_.is_free(v, group.columns.front())) continue;
    VehicleScore score = scores_.of_vehicle(v, group.columns, beside, known);
    if (!score.tells) continue;
    inflations.push_back(score.inflation);
    freedoms.push_back(score.freedom);
    asked.vehicles.push_back(v);
    asked.scores.push_back(std::move(score));
  }
  asked.moderation = moderate(inflations, freedoms);
  return asked;
}

/// log10 of the probability that the coefficients at these places are none, by their scatter.
double test_none(const Common& common, const std::vector<Index>& places) {
  const auto q = static_cast<double>(places.size());
  const double freedom = common.freedom - q + 1.0;
  if (freedom < 1.0) return 0.0;
  const VectorXd estimate = common.estimate(places);
  const double T2 = estimate.dot(common.covariance(places, places).ldlt().solve(estimate));
  return numerics::log10_f_tail(T2 * freedom / (common.freedom * q), q, freedom);
}

std::optional<Tested> Recipe::test_everywhere(std::size_t g, const VehicleScores& vehicles) const {
  const Group& group = scores_.groups()[g];
  std::vector<Index> columns = accepted_;
  columns.insert(columns.end(), group.columns.begin(), group.columns.end());
  const std::optional<Common> common = fit_common(units_of(columns));
  if (!common) return std::nullopt;
  const auto q = static_cast<Index>(group.columns.size());
  std::vector<Index> places(group.columns.size());
  std::iota(places.begin(), places.end(), std::ssize(accepted_));
  const VectorXd estimate = common->estimate.tail(q);
  const MatrixXd covariance = common->covariance.bottomRightCorner(q, q);
  const MatrixXd plain = common->plain.bottomRightCorner(q, q);
  const double drop = estimate.dot(plain.ldlt().solve(estimate));
  const double pooled = vehicles.pooled();
  const double by_noise = numerics::log10_chi_squared_tail(drop / pooled, static_cast<double>(q));
  const VectorXd errors = covariance.diagonal().cwiseMax(pooled * plain.diagonal()).cwiseSqrt();
  return Tested{.finding = {.cause = group.cause,
                            .effect = group.effect,
                            .coefficients = coefficients(group, estimate, errors),
                            .log10_p = std::max(test_none(*common, places), by_noise),
                            .drop = drop},
                .group = g};
}

void Recipe::test_vehicles(std::size_t g, const VehicleScores& asked,
                           std::vector<Tested>& tested) const {
  const Group& group = scores_.groups()[g];
  if (asked.vehicles.size() < 3) return;
  const auto q = static_cast<double>(group.columns.size());
  const VectorXd mean = mean_of(group);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < asked.vehicles.size(); ++i) {
    const VehicleScore& score = asked.scores[i];
    const VectorXd d = score.estimate - mean;
    ratios.push_back(d.dot(score.information * d) / (q * asked.moderation.inflations[i]));
  }
  const double typical = numerics::upper_median(std::vector<double>(ratios)) /
                         (numerics::chi_squared_point(0.5, q) / q);
  const double control = std::max(1.0, typical);
  for (std::size_t i = 0; i < asked.vehicles.size(); ++i) {
    const VehicleScore& score = asked.scores[i];
    const VectorXd d = score.estimate - mean;
    const double F = ratios[i] / control;
    // Where no vehicle's flights show their scatter, that between vehicles is all there is.
    const double freedom = asked.moderation.is_known
                               ? asked.moderation.freedoms[i]
                               : static_cast<double>(asked.vehicles.size()) - 1.0;
    const MatrixXd covariance =
        score.information.inverse() * (asked.moderation.inflations[i] * control);
    tested.push_back(
        {.finding = {.cause = FleetCause::one_vehicle,
                     .effect = group.effect,
                     .vehicle = scores_.vehicle(asked.vehicles[i]),
                     .coefficients =
                         coefficients(group, score.estimate, covariance.diagonal().cwiseSqrt()),
                     .log10_p = std::isinf(freedom) ? numerics::log10_chi_squared_tail(q * F, q)
                                                    : numerics::log10_f_tail(F, q, freedom),
                     .drop = d.dot(score.information * d)},
         .group = g,
         .vehicle = asked.vehicles[i]});
  }
}

std::optional<Tested> Recipe::test_differences(std::size_t g, const VehicleScores& asked) const {
  const Group& group = scores_.groups()[g];
  const auto q = static_cast<Index>(group.columns.size());
  std::vector<VehicleScore> scores;  // of vehicles whose flights show how they scatter
  double within = 0.0;
  for (const VehicleScore& score : asked.scores) {
    if (!(score.freedom > 0.0)) continue;
    within += score.freedom;
    scores.push_back(score);
  }
  const std::size_t count = scores.size();
  if (count < 3 || within < 1.0) return std::nullopt;
  MatrixXd information = MatrixXd::Zero(q, q);
  VectorXd sum = VectorXd::Zero(q);
  for (const VehicleScore& score : scores) {
    information += score.information;
    sum += score.information * score.estimate;
  }
  const VectorXd mean = information.ldlt().solve(sum);
  double Q = 0.0;
  for (const VehicleScore& score : scores) {
    const VectorXd d = score.estimate - mean;
    Q += d.dot(score.information * d);
  }
  const double between = static_cast<double>(q) * (static_cast<double>(count) - 1.0);
  const double F = Q / between / asked.pooled();
  Tested tested{
      .finding = {.cause = FleetCause::differs,
                  .effect = group.effect,
                  .log10_p = numerics::log10_f_tail(F, between, static_cast<double>(q) * within),
                  .drop = Q - between * asked.pooled()},
      .group = g};
  VectorXd means(q);
  VectorXd errors(q);
  for (Index k = 0; k < q; ++k) {
    std::vector<double> estimates;
    std::vector<double> variances;
    for (const VehicleScore& score : scores) {
      estimates.push_back(score.estimate[k]);
      variances.push_back(score.information.inverse()(k, k) * asked.pooled());
    }
    const Spread spread = find_spread(estimates, variances);
    means[k] = spread.mean;
    errors[k] = spread.standard_error;
    tested.finding.spread.push_back(std::sqrt(spread.variance) *
                                    scores_.unit_of(group.columns[static_cast<std::size_t>(k)]));
  }
  tested.finding.coefficients = coefficients(group, means, errors);
  return tested;
}

/// All tests, with probabilities corrected for their number.
std::vector<Tested> Recipe::test_all() const {
  std::vector<Tested> fleet;
  std::vector<Tested> vehicle;
  std::vector<Tested> differences;
  for (std::size_t g = 0; g < scores_.groups().size(); ++g) {
    if (std::ranges::find(differing_, g) != differing_.end()) continue;
    const Group& group = scores_.groups()[g];
    if (is_eliminated(group)) continue;
    const VehicleScores asked = ask_vehicles(group);
    if (!is_accepted(group)) {
      if (auto tested = test_everywhere(g, asked)) fleet.push_back(std::move(*tested));
    }
    if (group.cause == FleetCause::grows) continue;
    test_vehicles(g, asked, vehicle);
    if (auto tested = test_differences(g, asked)) differences.push_back(std::move(*tested));
  }
  std::vector<Tested> all;
  for (std::vector<Tested>* of_cause : {&fleet, &vehicle, &differences}) {
    const double number = causes * static_cast<double>(of_cause->size());
    for (Tested& tested : *of_cause) {
      FleetFinding& finding = tested.finding;
      finding.p_adjusted = std::min(1.0, number * std::pow(10.0, finding.log10_p));
      finding.found = finding.p_adjusted < options_.significance;
      finding.stands_in = scores_.groups()[tested.group].stands_in;
      all.push_back(std::move(tested));
    }
  }
  return all;
}

void Recipe::add(const Tested& best) {
  const Group& group = scores_.groups()[best.group];
  if (best.finding.cause == FleetCause::one_vehicle) {
    scores_.free(best.vehicle, group.columns);
  } else if (best.finding.cause == FleetCause::differs) {
    differing_.push_back(best.group);
    for (const Index column : group.columns) std::erase(accepted_, column);
    for (std::size_t v = 0; v < scores_.vehicles(); ++v) {
      if (!scores_.is_free(v, group.columns.front())) scores_.free(v, group.columns);
    }
  } else {
    accepted_.insert(accepted_.end(), group.columns.begin(), group.columns.end());
  }
  estimate();
  result_.found.push_back(best.finding);
}

/// What was taken for the cause before its cause was found explains nothing beside it.
void Recipe::eliminate(double number) {
  for (;;) {
    if (accepted_.empty()) return;
    const std::optional<Common> common = fit_common(units_of(accepted_));
    if (!common) return;
    const Group* weakest = nullptr;
    double largest = std::log10(options_.significance / number);
    for (const Group& group : scores_.groups()) {
      if (!is_accepted(group) || is_common(group)) continue;
      const double log10_p = test_none(*common, places_of(group));
      if (log10_p <= largest) continue;
      largest = log10_p;
      weakest = &group;
    }
    if (weakest == nullptr) return;
    eliminated_.push_back(weakest->effect);
    for (const Index column : weakest->columns) std::erase(accepted_, column);
    forget(weakest->effect);
    estimate();
  }
}

std::vector<std::size_t> Recipe::accepted_groups() const {
  std::vector<std::size_t> accepted;
  for (std::size_t g = 0; g < scores_.groups().size(); ++g) {
    const Group& group = scores_.groups()[g];
    if (is_accepted(group) && !is_common(group)) accepted.push_back(g);
  }
  return accepted;
}

/// The accepted columns but those of some groups, with those of another.
std::vector<Index> Recipe::columns_with(const std::vector<std::size_t>& without,
                                        std::optional<std::size_t> with) const {
  std::vector<Index> columns = accepted_;
  for (const std::size_t g : without) {
    for (const Index column : scores_.groups()[g].columns) std::erase(columns, column);
  }
  if (with) {
    const std::vector<Index>& added = scores_.groups()[*with].columns;
    columns.insert(columns.end(), added.begin(), added.end());
  }
  return columns;
}

/// What these columns take of the misfit, as noise models have it; below 0 where they can't be told
/// apart.
double Recipe::explained(const std::vector<Index>& columns) const {
  if (columns.empty()) return 0.0;
  const std::optional<Common> common = fit_common(units_of(columns));
  return common ? common->estimate.dot(common->plain.ldlt().solve(common->estimate)) : -1.0;
}

void Recipe::replace(const std::vector<std::size_t>& groups, std::size_t by) {
  accepted_ = columns_with(groups, by);
  estimate();
  const Group& group = scores_.groups()[by];
  FleetFinding* kept = nullptr;
  for (FleetFinding& one : result_.found) {
    if (is_of_fleet(one) && one.effect == scores_.groups()[groups.front()].effect) kept = &one;
  }
  if (kept == nullptr) return;
  kept->cause = group.cause;
  kept->effect = group.effect;
  kept->stands_in = group.stands_in;
  if (groups.size() < 2) return;
  forget(scores_.groups()[groups.back()].effect);
}

/// Two of the fleet's that one explains as well as both, and one that another explains better.
/// Returns whether there was any.
bool Recipe::exchange() {
  const std::vector<std::size_t> accepted = accepted_groups();
  if (accepted.empty()) return false;
  const double now = explained(accepted_);
  for (std::size_t a = 0; a < accepted.size(); ++a) {
    for (std::size_t b = a; b < accepted.size(); ++b) {
      std::vector<std::size_t> leaving{accepted[a]};
      if (b > a) leaving.push_back(accepted[b]);
      std::size_t best = 0;
      double most = b > a ? now - as_much : now + 1e-6 * std::abs(now);
      bool has = false;
      for (std::size_t g = 0; g < scores_.groups().size(); ++g) {
        if (std::ranges::find(accepted, g) != accepted.end()) continue;
        if (std::ranges::find(differing_, g) != differing_.end()) continue;
        if (is_eliminated(scores_.groups()[g])) continue;  // or it would come and go for ever
        const double then = explained(columns_with(leaving, g));
        if (then <= most) continue;
        most = then;
        best = g;
        has = true;
      }
      if (!has) continue;
      replace(leaving, best);
      return true;
    }
  }
  return false;
}

std::vector<std::string> Recipe::as_good_as(std::size_t group) const {
  std::vector<std::string> names;
  const double now = explained(accepted_);
  for (std::size_t g = 0; g < scores_.groups().size(); ++g) {
    if (is_accepted(scores_.groups()[g])) continue;
    if (explained(columns_with({group}, g)) > now - as_much) {
      names.push_back(scores_.groups()[g].effect);
    }
  }
  return names;
}

/// The whole fleet comes before one vehicle, and that before what differs.
int order_of(FleetCause cause) {
  return static_cast<int>(cause == FleetCause::grows ? FleetCause::everywhere : cause);
}

/// Of what was found that of the first cause which takes most; of those that take as much, -2 ln L
/// within 9.2, one that can be the cause where it is. A vehicle that is found by any candidate has
/// the one that takes most in it, as sure as the surest.
std::optional<Tested> choose(const std::vector<Tested>& tested) {
  const Tested* best = nullptr;
  for (const Tested& one : tested) {
    if (!one.finding.found) continue;
    const int order =
        best == nullptr ? -1 : order_of(one.finding.cause) - order_of(best->finding.cause);
    if (order < 0 || (order == 0 && one.finding.drop > best->finding.drop)) best = &one;
  }
  if (best == nullptr) return std::nullopt;
  const bool is_of_one = best->finding.cause == FleetCause::one_vehicle;
  const auto competes = [&](const Tested& one) {
    if (order_of(one.finding.cause) != order_of(best->finding.cause)) return false;
    return is_of_one ? one.vehicle == best->vehicle : one.finding.found;
  };
  const Tested* most = best;
  for (const Tested& one : tested) {
    if (competes(one) && one.finding.drop > most->finding.drop) most = &one;
  }
  const Tested* chosen = most;
  for (const Tested& one : tested) {
    const bool is_as_good =
        competes(one) && !one.finding.stands_in && one.finding.drop > most->finding.drop - as_much;
    if (is_as_good && (chosen->finding.stands_in || one.finding.drop > chosen->finding.drop)) {
      chosen = &one;
    }
  }
  Tested result = *chosen;
  result.finding.found = true;
  result.finding.log10_p = std::min(result.finding.log10_p, best->finding.log10_p);
  result.finding.p_adjusted = std::min(result.finding.p_adjusted, best->finding.p_adjusted);
  return result;
}

FleetDiagnosis Recipe::run() {
  if (flights_.size() < 3) {
    throw Error(
        "a fleet of fewer than three flights does not show how flights scatter; diagnose "
        "each by itself");
  }
  result_.vehicles = scores_.vehicles();
  result_.flights = flights_.size();
  for (const FleetFlight& flight : flights_) readings_ += flight.factor.readings;
  const auto total = [](const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0);
  };
  const auto tell = [&](std::vector<double> misfits) {
    for (std::size_t i = 0; i < misfits.size(); ++i) misfits[i] /= flights_[i].factor.readings;
    return misfits;
  };
  estimate();
  const std::vector<double> before = scores_.misfits(accepted_, known_);
  result_.misfit_before = per_reading(total(before));
  result_.flights_before = tell(before);
  std::vector<Tested> tested;
  for (;;) {
    tested = test_all();
    if (result_.tests == 0) result_.tests = tested.size();
    const std::optional<Tested> best = choose(tested);
    if (!best) break;
    if (static_cast<int>(result_.found.size()) == options_.most) {
      result_.notes.emplace_back(
          "more is significant than was added; what is last found is least sure");
      break;
    }
    add(*best);
    eliminate(causes * static_cast<double>(scores_.groups().size()));
    for (int round = 0; round < options_.most && exchange(); ++round) {
    }
  }
  // Coefficients of the fleet are those beside all that was found.
  for (FleetFinding& finding : result_.found) {
    if (!is_of_fleet(finding)) continue;
    const auto group = std::ranges::find(scores_.groups(), finding.effect, &Group::effect);
    if (!is_accepted(*group)) continue;  // it differs
    const std::vector<Index> places = places_of(*group);
    finding.as_good = as_good_as(static_cast<std::size_t>(group - scores_.groups().begin()));
    finding.coefficients =
        coefficients(*group, known_(places), known_covariance_.diagonal()(places).cwiseSqrt());
  }
  const std::vector<double> after = scores_.misfits(accepted_, known_);
  result_.misfit_after = per_reading(total(after));
  result_.flights_after = tell(after);
  const auto share_of = [&](const FleetFinding& finding) {
    double misfit = 0.0;
    for (std::size_t i = 0; i < flights_.size(); ++i) {
      const bool counts = finding.vehicle.empty() || finding.vehicle == flights_[i].vehicle;
      misfit += counts ? before[i] : 0.0;
    }
    return finding.drop / misfit;
  };
  for (FleetFinding& finding : result_.found) finding.share = share_of(finding);
  std::ranges::stable_sort(tested, {}, [](const Tested& one) { return one.finding.p_adjusted; });
  std::vector<std::string> told;
  for (Tested& one : tested) {
    if (std::ranges::find(told, one.finding.effect) != told.end()) continue;
    told.push_back(one.finding.effect);
    one.finding.share = share_of(one.finding);
    result_.others.push_back(std::move(one.finding));
  }
  return std::move(result_);
}

}  // namespace

FleetDiagnosis diagnose(const std::vector<FleetFlight>& flights,
                        const FleetDiagnosisOptions& options) {
  group_vehicles(flights);  // throws Error for what is no fleet
  FleetDiagnosis result =
      options.common.empty()
          ? Recipe(flights, options).run()
          : Recipe(common_as_columns(flights, part(flights, options.common)), options).run();
  const std::string moved = note_weighting(flights, options.significance);
  if (!moved.empty()) result.notes.push_back(moved);
  return result;
}

}  // namespace sepcal
