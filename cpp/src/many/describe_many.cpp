// SPDX-License-Identifier: BSD-3-Clause
#include "many/describe_many.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/sentences.hpp"
#include "estimation/covariance.hpp"
#include "estimation/fitted_parameters.hpp"
#include "estimation/prior_checks.hpp"
#include "many/departure.hpp"
#include "many/named_results.hpp"
#include "sepcal/detail/identifiability.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class Description {
 public:
  Description(const BlockModel& model, const JointProblem& joint, const JointStage& stage,
              const ManyObjective& objective, const JointCovariance& covariance, ManyFit& result)
      : model_(model),
        joint_(joint),
        stage_(stage),
        objective_(objective),
        covariance_(covariance),
        result_(result) {}

  void describe(const std::vector<std::string>& names) {
    describe_shared();
    for (Index i = 0; i < joint_.layout.flights; ++i) {
      describe_flight(i, names[objective_.flight(i)]);
    }
    describe_departures();
    describe_noise();
    std::vector<std::string> sentences = stage_.sentences;
    std::ranges::move(judge(), std::back_inserter(sentences));
    std::ranges::move(estimation::judge_priors(result_.shared, joint_.problem.options()),
                      std::back_inserter(sentences));
    result_.message = base::join_sentences(sentences);
    result_.iterations = stage_.iterations;
    result_.noise_iterations = stage_.noise_iterations;
    result_.passes = objective_.passes();
  }

 private:
  Index first_shared() const { return joint_.layout.flights * joint_.layout.own; }

  bool at_bound(Index place) const { return stage_.at_bound[static_cast<std::size_t>(place)]; }

  void describe_shared() {
    SharedParameters shared =
        list_shared(model_, joint_.problem, joint_.parting, stage_.x.tail(joint_.layout.shared),
                    {stage_.at_bound.begin() + first_shared(), stage_.at_bound.end()});
    result_.shared = std::move(shared.parameters);
    shared_places_ = std::move(shared.places);
    std::vector<Index> inside;
    for (const Index k : covariance_.shared)
      inside.push_back(shared_places_[static_cast<std::size_t>(k)]);
    const auto n = static_cast<Index>(result_.shared.size());
    result_.covariance = estimation::spread(covariance_.shared_coloured(), inside, n);
    result_.covariance_white = estimation::spread(covariance_.shared_white(), inside, n);
    result_.correlation = estimation::correlation_of(result_.covariance);
    set_errors(result_.shared, inside, result_.covariance(inside, inside),
               result_.covariance_white(inside, inside));
  }

  void describe_flight(Index i, const std::string& name) {
    const FlightStart& start = joint_.starts[static_cast<std::size_t>(i)];
    FlightFit flight{.name = name, .rows = start.rows, .alone = start.status};
    flight.message = start.message;
    std::vector<Index> inside;
    for (Index k = 0; k < joint_.layout.own; ++k) {
      const Index place = i * joint_.layout.own + k;
      const auto free = static_cast<std::size_t>(joint_.parting.own[static_cast<std::size_t>(k)]);
      flight.own.push_back(
          to_parameter(joint_.problem.parameters()[free], stage_.x[place], at_bound(place)));
      if (!at_bound(place)) inside.push_back(k);
    }
    set_errors(flight.own, inside, covariance_.own_coloured(i), covariance_.own_white(i));
    const VectorXd rmse = (objective_.squares(i) / static_cast<double>(start.rows)).cwiseSqrt();
    flight.rmse = estimation::by_output(model_.tables(), rmse);
    result_.rows += start.rows;
    result_.flights.push_back(std::move(flight));
  }

  void describe_departures() {
    std::vector<std::string> names;
    for (const Parameter& parameter : result_.shared) names.push_back(parameter.name);
    std::vector<Departure> departures = find_departures(joint_.compared(), covariance_);
    for (std::size_t i = 0; i < departures.size(); ++i) {
      result_.flights[i].departure = named(std::move(departures[i]), names, shared_places_);
    }
  }

  void describe_noise() {
    VectorXd squares = VectorXd::Zero(stage_.noise.size());
    for (Index i = 0; i < joint_.layout.flights; ++i) squares += objective_.squares(i);
    result_.rmse = estimation::by_output(model_.tables(), (squares / joint_.rows).cwiseSqrt());
    result_.noise = estimation::by_output(model_.tables(), stage_.noise);
    result_.cost = 0.5 * objective_.square() + joint_.rows * stage_.noise.array().log().sum();
  }

  /// What all flights together leave open, in sentences: of the shared parameters, then of each
  /// flight's own.
  /// With the columns of parameters at a bound: a bound may hold what the flights leave open.
  std::vector<std::string> judge() {
    const Eliminated all = eliminate_own(objective_);
    const VectorXd scale = plausible_lengths(joint_, objective_);
    const double factor = std::isnan(covariance_.ratio) ? 1.0 : std::sqrt(covariance_.ratio);
    std::vector<std::string> names;
    for (const Variable& variable : variables(joint_.problem, joint_.parting)) {
      names.push_back(variable.name);
    }
    const std::vector<std::string> shared(names.begin() + joint_.layout.own, names.end());
    result_.identifiability =
        identify(all.shared, shared, scale.tail(joint_.layout.shared), factor);
    std::vector<std::string> sentences{result_.identifiability.message()};
    bool open = !result_.identifiability.unobservable.empty();
    std::vector<std::string> open_flights;
    std::string first;
    for (Index i = 0; i < joint_.layout.flights && !open; ++i) {
      const Identifiability alone =
          identify(beside_others(all.shares[static_cast<std::size_t>(i)], all.shared), names,
                   joint_.layout.point(scale, i), factor);
      if (alone.unobservable.empty()) continue;
      if (open_flights.empty()) first = alone.sentences.front();
      open_flights.push_back(result_.flights[static_cast<std::size_t>(i)].name);
    }
    if (!open_flights.empty()) {
      open = true;
      sentences.push_back("flight '" + open_flights.front() + "': " + first);
      if (open_flights.size() > 1) {
        sentences.push_back("the same or more in " + std::to_string(open_flights.size() - 1) +
                            " other flights");
      }
    }
    if (std::isnan(covariance_.ratio)) {
      open = true;
      sentences.emplace_back(
          "the flights have no more measurements than parameters, which leaves nothing to judge "
          "the fit by (log more, or fix parameters)");
    }
    result_.status = open                 ? FitStatus::not_identifiable
                     : stage_.converged() ? FitStatus::converged
                                          : FitStatus::not_converged;
    return sentences;
  }

  const BlockModel& model_;
  const JointProblem& joint_;
  const JointStage& stage_;
  const ManyObjective& objective_;
  const JointCovariance& covariance_;
  ManyFit& result_;
  std::vector<Index> shared_places_;
};

}  // namespace

void describe_many(const BlockModel& model, const JointProblem& joint, const JointStage& stage,
                   const ManyObjective& objective, const JointCovariance& covariance,
                   const std::vector<std::string>& names, ManyFit& result) {
  Description(model, joint, stage, objective, covariance, result).describe(names);
}

}  // namespace sepcal::many
