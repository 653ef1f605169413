// SPDX-License-Identifier: BSD-3-Clause
#include "many/joint_filter_error.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/sentences.hpp"
#include "estimation/block_errors.hpp"
#include "estimation/covariance.hpp"
#include "estimation/fitted_parameters.hpp"
#include "estimation/innovation_summary.hpp"
#include "estimation/prior_checks.hpp"
#include "estimation/scored_estimate.hpp"
#include "estimation/scoring.hpp"
#include "estimation/theta_layout.hpp"
#include "many/departure.hpp"
#include "many/flights_likelihood.hpp"
#include "many/joint_covariance.hpp"
#include "many/joint_start.hpp"
#include "many/named_results.hpp"
#include "sepcal/error.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Estimated;
using estimation::Scored;
using estimation::Scoring;

class JointFilterError {
 public:
  JointFilterError(const BlockModel& model, const estimation::Problem& problem,
                   const ManyOptions& options, FlightSource& source, UsedFlights flights)
      : model_(model),
        problem_(problem),
        source_(source),
        flights_(std::move(flights)),
        noises_(estimation::estimable_noises(model, problem.options())),
        parting_(split_with_noises(problem, options.own, static_cast<Index>(noises_.size()))),
        layout_{static_cast<Index>(flights_.names.size()), parting_.n_own(), parting_.n_shared()},
        likelihood_(source, flights_.places, layout_, count(Estimated::Kind::process_noise),
                    count(Estimated::Kind::output_noise)),
        estimated_(list_estimated()) {}

  void run(ManyFit& result) {
    const std::vector<bool> silent = fill_silent();
    Scoring scoring{.model = likelihood_,
                    .free = {},
                    .box = box(),
                    .prior = prior(),
                    .iterations = problem_.options().iterations};
    for (Index k = 0; k < layout_.size(); ++k) {
      const Index noise = k - first_noise();
      if (noise < 0 || !silent[static_cast<std::size_t>(noise)]) scoring.free.push_back(k);
    }
    std::erase_if(estimated_, [&](const Estimated& one) {
      const auto at = std::ranges::find(noises_, one.name, &Estimated::name);
      return at != noises_.end() && silent[static_cast<std::size_t>(at - noises_.begin())];
    });
    if (problem_.options().progress) {
      scoring.progress = [this](int iteration) {
        problem_.options().progress("filter error", 1.0 - std::exp(-0.1 * iteration));
      };
    }
    Scored at = minimise_by_scoring(scoring, start(scoring));
    if (problem_.options().hessian == Hessian::observed) {
      at = finish_by_newton(scoring, std::move(at));
    }
    describe(scoring, at, result);
  }

 private:
  Index count(Estimated::Kind kind) const {
    return std::ranges::count(noises_, kind, &Estimated::kind);
  }
  Index first_noise() const { return layout_.size() - static_cast<Index>(noises_.size()); }
  Index shared_parameters() const { return layout_.shared - static_cast<Index>(noises_.size()); }
  const Variable& parameter(Index place) const {
    return problem_.parameters()[static_cast<std::size_t>(place)];
  }

  /// In the layout's order; own ones as their flight's, "alpha_0[climb]".
  std::vector<Estimated> list_estimated() const {
    std::vector<Estimated> list;
    for (const std::string& flight : flights_.names) {
      for (const Index k : parting_.own) {
        std::string name = parameter(k).name + "[";
        name += flight + "]";
        list.push_back({std::move(name), parameter(k)});
      }
    }
    for (Index k = 0; k < shared_parameters(); ++k) {
      const Variable& shared = parameter(parting_.shared[static_cast<std::size_t>(k)]);
      list.push_back({shared.name, shared});
    }
    list.insert(list.end(), noises_.begin(), noises_.end());
    return list;
  }

  /// Noises that reach no output of any flight, which are none; where they reach some the others'
  /// start is these ones'.
  std::vector<bool> fill_silent() {
    const auto n = static_cast<Index>(noises_.size());
    std::vector<bool> silent;
    for (Index k = 0; k < n; ++k) {
      double sum = 0.0;
      double told = 0.0;
      for (const FlightStart& start : flights_.starts) {
        const double here = start.x.tail(n)[k];
        if (!std::isfinite(here)) continue;
        sum += here;
        told += 1.0;
      }
      silent.push_back(told == 0.0);
      for (FlightStart& start : flights_.starts) {
        double& here = start.x.tail(n)[k];
        if (told > 0.0 && !std::isfinite(here)) here = sum / told;
      }
    }
    return silent;
  }

  /// Of a flight's point, its noises as low as any flight's floor.
  numerics::Box box() const {
    const auto n = static_cast<Index>(noises_.size());
    VectorXd floor = flights_.starts.front().floor;
    for (const FlightStart& start : flights_.starts) floor = floor.cwiseMin(start.floor);
    const numerics::Box own = problem_.box();
    VectorXd lower(own.lower.size() + n);
    VectorXd upper(lower.size());
    lower << own.lower, floor;
    upper << own.upper, VectorXd::Constant(n, infinity);
    const std::vector<Index> order = parting_.order();
    return {layout_.repeat(lower(order)), layout_.repeat(upper(order))};
  }

  /// Of a flight's point; that of shared parameters counts once.
  estimation::Prior flight_prior() const {
    const Index n = layout_.own + layout_.shared;
    estimation::Prior whole{VectorXd::Zero(n), VectorXd::Zero(n)};
    for (const estimation::Prior& given : problem_.prior()) {
      whole.mean.head(given.mean.size()) = given.mean;
      whole.weight.head(given.weight.size()) = given.weight;
    }
    const std::vector<Index> order = parting_.order();
    return {whole.mean(order), whole.weight(order)};
  }
  estimation::Prior prior() const {
    const estimation::Prior one = flight_prior();
    return {layout_.repeat(one.mean), layout_.repeat(one.weight)};
  }

  VectorXd start(const Scoring& scoring) const {
    VectorXd best = scoring.box.clip(layout_.repeat(flights_.starts.front().x));
    double least = infinity;
    for (const VectorXd& x : joint_starts(flights_.starts, true, layout_, scoring.box)) {
      const Scored at = score_at(scoring, x);
      const double cost = cost_with_prior(scoring, at);
      if (!(cost < least)) continue;
      least = cost;
      best = x;
    }
    return best;
  }

  std::vector<FlightInnovations> ask_innovations(const VectorXd& theta) const {
    return source_.innovations(likelihood_.points(theta));
  }

  /// Blocks lie within flights: as many as one record of all rows would be cut into.
  std::vector<TriangularFactor> block_factors(const Scoring& scoring, const Scored& at,
                                              const std::vector<FlightInnovations>& innovations,
                                              const std::vector<Index>& inside) const {
    double memory = 1.0;
    double rows = 0.0;
    for (std::size_t i = 0; i < innovations.size(); ++i) {
      if (!std::isfinite(innovations[i].memory)) return {};
      memory = std::max(memory, innovations[i].memory);
      rows += static_cast<double>(flights_.starts[i].rows);
    }
    const double all = estimation::choose_blocks(static_cast<Index>(rows), memory);
    if (all == 0) return {};
    std::vector<int> blocks;
    for (const FlightStart& start : flights_.starts) {
      const double share = std::round(all * static_cast<double>(start.rows) / rows);
      blocks.push_back(std::max(1, static_cast<int>(share)));
    }
    std::vector<Index> columns;
    for (const Index i : inside) columns.push_back(scoring.free[static_cast<std::size_t>(i)]);
    columns.push_back(layout_.size());
    std::vector<TriangularFactor> factors;
    const auto answers = source_.score_blocks(likelihood_.points(at.theta), blocks);
    for (Index i = 0; i < layout_.flights; ++i) {
      for (const TriangularFactor& block : answers[static_cast<std::size_t>(i)]) {
        MatrixXd rows_of_all = likelihood_.spread(block, i)(Eigen::all, columns);
        factors.emplace_back(static_cast<int>(columns.size())).absorb(rows_of_all);
      }
    }
    return factors;
  }

  void describe(const Scoring& scoring, const Scored& at, ManyFit& result) const {
    const bool finite = std::isfinite(at.cost);
    std::vector<FlightInnovations> innovations;
    if (finite) innovations = ask_innovations(at.theta);
    const estimation::ScoredErrors errors = find_scored_errors(
        scoring, at, estimated_, problem_.options(), [&](const std::vector<Index>& inside) {
          return block_factors(scoring, at, innovations, inside);
        });
    fill_noises(scoring, at, errors, result);
    std::vector<bool> held(static_cast<std::size_t>(layout_.size()), true);
    for (std::size_t i = 0; i < scoring.free.size() && finite; ++i) {
      held[static_cast<std::size_t>(scoring.free[i])] = at.at_bound[i];
    }
    fill_parameters(scoring, at, held, errors, result);
    fill_outputs(at, innovations, result);
    if (finite) fill_departures(at, held, errors, result);
    result.method = FitMethod::filter_error;
    result.cost = at.cost;
    result.log_likelihood = -at.cost - estimation::likelihood_constant(at.readings);
    result.iterations = at.iterations;
    result.passes = likelihood_.passes();
    tell(scoring, at, innovations, errors, result);
  }

  void fill_noises(const Scoring& scoring, const Scored& at, const estimation::ScoredErrors& errors,
                   ManyFit& result) const {
    const FitOptions& options = problem_.options();
    const auto add = [&](const std::string& name, const Variable& noise,
                         const std::map<std::string, double>& given) {
      const auto place = std::ranges::find(estimated_, name, &Estimated::name);
      if (place != estimated_.end()) {
        result.noise_sizes.push_back(
            size_of(at, scoring, estimated_, errors, place - estimated_.begin()));
        return;
      }
      const auto value = given.find(noise.name);  // or silent
      result.noise_sizes.push_back({.name = name,
                                    .unit = noise.unit,
                                    .value = value == given.end() ? 0.0 : value->second,
                                    .standard_error = not_a_number});
    };
    for (const Variable& noise : model_.process_noises()) {
      add(estimation::process_noise_name(noise), noise, options.process_noise);
    }
    for (const Variable& output : model_.tables().outputs) {
      add(estimation::output_noise_name(output), output, options.noise);
    }
    for (std::size_t j = 0; j < model_.tables().outputs.size(); ++j) {
      result.noise.push_back({model_.tables().outputs[j].name,
                              result.noise_sizes[model_.process_noises().size() + j].value});
    }
  }

  void fill_parameters(const Scoring& scoring, const Scored& at, const std::vector<bool>& held,
                       const estimation::ScoredErrors& errors, ManyFit& result) const {
    std::vector<Index> within(static_cast<std::size_t>(layout_.size()), -1);  // of those inside
    for (std::size_t i = 0; i < errors.inside.size(); ++i) {
      const Index place = scoring.free[static_cast<std::size_t>(errors.inside[i])];
      within[static_cast<std::size_t>(place)] = static_cast<Index>(i);
    }
    const SharedParameters shared = list_shared(
        model_, problem_, parting_, at.theta.tail(layout_.shared).head(shared_parameters()),
        {held.end() - static_cast<std::ptrdiff_t>(layout_.shared), held.end()});
    result.shared = shared.parameters;
    std::vector<Index> places;  // in result.shared
    std::vector<Index> chosen;  // within errors
    for (Index k = 0; k < shared_parameters(); ++k) {
      const Index i = within[static_cast<std::size_t>(layout_.flights * layout_.own + k)];
      if (i < 0) continue;
      places.push_back(shared.places[static_cast<std::size_t>(k)]);
      chosen.push_back(i);
    }
    const auto n = static_cast<Index>(result.shared.size());
    result.covariance = estimation::spread(errors.believed(chosen, chosen), places, n);
    result.covariance_white = estimation::spread(errors.white(chosen, chosen), places, n);
    result.correlation = estimation::correlation_of(result.covariance);
    set_errors(result.shared, places, errors.believed(chosen, chosen),
               errors.white(chosen, chosen));

    for (Index i = 0; i < layout_.flights; ++i) {
      const FlightStart& start = flights_.starts[static_cast<std::size_t>(i)];
      FlightFit flight{.name = flights_.names[static_cast<std::size_t>(i)],
                       .rows = start.rows,
                       .alone = start.status,
                       .message = start.message};
      places.clear();
      chosen.clear();
      for (Index k = 0; k < layout_.own; ++k) {
        const Index place = layout_.place(i, k);
        flight.own.push_back(to_parameter(parameter(parting_.own[static_cast<std::size_t>(k)]),
                                          at.theta[place], held[static_cast<std::size_t>(place)]));
        const Index j = within[static_cast<std::size_t>(place)];
        if (j < 0) continue;
        places.push_back(k);
        chosen.push_back(j);
      }
      set_errors(flight.own, places, errors.believed(chosen, chosen), errors.white(chosen, chosen));
      result.rows += start.rows;
      result.flights.push_back(std::move(flight));
    }
  }

  void fill_outputs(const Scored& at, const std::vector<FlightInnovations>& innovations,
                    ManyFit& result) const {
    const Tables& tables = model_.tables();
    const auto n_z = static_cast<Index>(tables.outputs.size());
    estimation::InnovationSummary all{VectorXd::Zero(n_z), VectorXd::Zero(n_z), {}};
    for (std::size_t i = 0; i < innovations.size(); ++i) {
      const estimation::InnovationSummary one{innovations[i].squares, innovations[i].counts, {}};
      result.flights[i].rmse = estimation::by_output(tables, one.rmse());
      all.squares += one.squares;
      all.counts += one.counts;
    }
    const VectorXd undefined = VectorXd::Constant(n_z, not_a_number);
    result.rmse = estimation::by_output(tables, std::isfinite(at.cost) ? all.rmse() : undefined);
    if (innovations.empty()) {
      for (FlightFit& flight : result.flights) {
        flight.rmse = estimation::by_output(tables, undefined);
      }
    }
  }

  void fill_departures(const Scored& at, const std::vector<bool>& held,
                       const estimation::ScoredErrors& errors, ManyFit& result) const {
    estimation::Prior own = flight_prior();
    estimation::Prior shared = own.tail(layout_.shared);
    own.weight.tail(layout_.shared).setZero();
    const auto readings = static_cast<double>(at.readings);
    const double ratio =
        readings / std::max(1.0, readings - static_cast<double>(errors.inside.size()));
    std::vector<TriangularFactor> blocks;
    Compared compared{.layout = layout_, .measurements = {}, .chi_squared = true};
    for (Index i = 0; i < layout_.flights; ++i) {
      const FlightScore& score = likelihood_.ask(at.theta)[static_cast<std::size_t>(i)];
      compared.measurements.push_back(static_cast<double>(score.readings));
      TriangularFactor block = score.factor;
      own.join(block, layout_.point(at.theta, i));
      MatrixXd rows = block.matrix() / std::sqrt(ratio);
      blocks.emplace_back(block.columns()).absorb(rows);
    }
    TriangularFactor known(static_cast<int>(layout_.shared) + 1);
    shared.weight /= std::sqrt(ratio);
    shared.join(known, at.theta.tail(layout_.shared));
    JointCovariance covariance = factorise(blocks, held, layout_, known.matrix());
    covariance.ratio = ratio;
    if (covariance.is_defined()) covariance.add_middles(shared.weight);

    std::vector<std::string> names;
    std::vector<Index> places;  // of the layout's shared ones among all names
    for (const Parameter& one : result.shared) {
      if (!one.fixed) places.push_back(static_cast<Index>(names.size()));
      names.push_back(one.name);
    }
    for (const Estimated& noise : noises_) {
      places.push_back(static_cast<Index>(names.size()));
      names.push_back(noise.name);
    }
    std::vector<Departure> departures = find_departures(compared, covariance);
    for (std::size_t i = 0; i < departures.size(); ++i) {
      result.flights[i].departure = named(std::move(departures[i]), names, places);
    }
  }

  void tell(const Scoring& scoring, const Scored& at,
            const std::vector<FlightInnovations>& innovations,
            const estimation::ScoredErrors& errors, ManyFit& result) const {
    const FitOptions& options = problem_.options();
    std::vector<std::string> sentences;
    if (!std::isfinite(at.cost)) {
      sentences.push_back(describe_failure(at.theta));
    } else {
      VectorXd noise(static_cast<Index>(result.noise.size()));
      for (Index j = 0; j < noise.size(); ++j) {
        noise[j] = result.noise[static_cast<std::size_t>(j)].value;
      }
      double whitened_square = 0.0;
      for (const FlightInnovations& one : innovations) {
        whitened_square += (one.readings.array() / noise.array().square()).sum();
      }
      result.identifiability = judge_scored(at, estimated_, whitened_square);
      if (!at.converged) sentences.push_back(estimation::describe_no_maximum(options));
    }
    sentences.push_back(result.identifiability.message());
    std::ranges::move(describe_floors(at, scoring, estimated_, problem_.options()),
                      std::back_inserter(sentences));
    std::ranges::move(estimation::describe_noises(result.noise_sizes),
                      std::back_inserter(sentences));
    std::ranges::copy(errors.sentences, std::back_inserter(sentences));
    std::ranges::move(estimation::judge_priors(result.shared, options),
                      std::back_inserter(sentences));
    result.message = base::join_sentences(sentences);
    result.status = !result.identifiability.unobservable.empty() ? FitStatus::not_identifiable
                    : std::isfinite(at.cost) && at.converged     ? FitStatus::converged
                                                                 : FitStatus::not_converged;
  }

  /// Of the first flight that its filter can't follow.
  std::string describe_failure(const VectorXd& theta) const {
    const std::vector<FlightScore>& scores = likelihood_.ask(theta);
    for (std::size_t i = 0; i < scores.size(); ++i) {
      if (std::isfinite(scores[i].cost) && scores[i].factor.all_finite()) continue;
      return "flight '" + flights_.names[i] + "': " + estimation::describe_stop(scores[i].row);
    }
    return estimation::describe_no_maximum(problem_.options());
  }

  const BlockModel& model_;
  const estimation::Problem& problem_;
  FlightSource& source_;
  UsedFlights flights_;
  std::vector<Estimated> noises_;  // that are not given
  Split parting_;
  Layout layout_;
  FlightsLikelihood likelihood_;
  std::vector<Estimated> estimated_;
};

}  // namespace

void fit_joint_filter_error(const BlockModel& model, const estimation::Problem& problem,
                            const ManyOptions& options, FlightSource& source, UsedFlights flights,
                            ManyFit& result) {
  JointFilterError(model, problem, options, source, std::move(flights)).run(result);
}

}  // namespace sepcal::many
