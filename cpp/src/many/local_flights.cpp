// SPDX-License-Identifier: BSD-3-Clause
// A source in this process: records in memory, visited by a pool of threads.
#include <algorithm>
#include <thread>

#include "base/thread_pool.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal {
namespace {

using Flights = std::vector<std::pair<std::string, Record>>;

/// Threads for a flight: those of the whole source, shared out.
int threads_each(int threads, std::size_t flights) {
  const int all =
      threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::max(1, all / static_cast<int>(std::max<std::size_t>(flights, 1)));
}

class LocalFlights final : public FlightSource {
 public:
  LocalFlights(const BlockModel& model, Flights flights, ManyOptions options)
      : model_(model),
        flights_(std::move(flights)),
        options_(std::move(options)),
        pool_(options_.fit.threads),
        problems_(flights_.size()) {
    options_.fit.threads = threads_each(options_.fit.threads, flights_.size());
  }

  std::vector<std::string> names() const override {
    std::vector<std::string> names;
    for (const auto& [name, record] : flights_) names.push_back(name);
    return names;
  }

  std::vector<FlightStart> start() override {
    std::vector<FlightStart> starts(flights_.size());
    pool_.for_each(flights_.size(), [&](std::size_t i) {
      try {
        problems_[i] = std::make_unique<FlightProblem>(model_, flights_[i].second, options_);
        starts[i] = problems_[i]->start();
      } catch (const Error& error) {
        starts[i] = {.error = error.what()};
      }
    });
    return starts;
  }

  std::vector<std::vector<TriangularFactor>> linearise(
      const std::vector<FlightPoint>& points) override {
    std::vector<std::vector<TriangularFactor>> factors(points.size());
    pool_.for_each(points.size(), [&](std::size_t i) {
      factors[i] = problems_[points[i].flight]->linearise(points[i].x);
    });
    return factors;
  }

  std::vector<Eigen::MatrixXd> score_covariances(
      const std::vector<ScoreQuestion>& questions) override {
    std::vector<Eigen::MatrixXd> covariances(questions.size());
    pool_.for_each(questions.size(), [&](std::size_t i) {
      covariances[i] = problems_[questions[i].flight]->score_covariance(questions[i]);
    });
    return covariances;
  }

  std::vector<FlightScore> scores(const std::vector<FlightPoint>& points) override {
    std::vector<FlightScore> scores(points.size());
    pool_.for_each(points.size(), [&](std::size_t i) {
      scores[i] = problems_[points[i].flight]->score(points[i].x);
    });
    return scores;
  }

  std::vector<FlightInnovations> innovations(const std::vector<FlightPoint>& points) override {
    std::vector<FlightInnovations> innovations(points.size());
    pool_.for_each(points.size(), [&](std::size_t i) {
      innovations[i] = problems_[points[i].flight]->innovations(points[i].x);
    });
    return innovations;
  }

  std::vector<std::vector<TriangularFactor>> score_blocks(const std::vector<FlightPoint>& points,
                                                          const std::vector<int>& blocks) override {
    std::vector<std::vector<TriangularFactor>> factors(points.size());
    pool_.for_each(points.size(), [&](std::size_t i) {
      factors[i] = problems_[points[i].flight]->score_blocks(points[i].x, blocks[i]);
    });
    return factors;
  }

 private:
  const BlockModel& model_;
  Flights flights_;
  ManyOptions options_;
  base::ThreadPool pool_;
  std::vector<std::unique_ptr<FlightProblem>> problems_;
};

}  // namespace

ManyFit fit_many(const BlockModel& model, Flights flights, const ManyOptions& options) {
  LocalFlights source(model, std::move(flights), options);
  return fit_many(model, source, options);
}

}  // namespace sepcal
