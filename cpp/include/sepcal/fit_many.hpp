// SPDX-License-Identifier: BSD-3-Clause
// Many flights of one model, fitted jointly: some parameters are shared by all (one probe), some
// are each flight's own (a wind a flight). Whatever a flight has to say at a point is one small
// triangular factor an output; these cross processes and machines, the data never move.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/fit.hpp"

namespace sepcal {

/// A flight that can be used by nobody: what is wrong with it, in one line.
struct LeftOut {
  std::string name;
  std::string reason;
};

struct ManyOptions {
  /// Names of the parameters that every flight has for itself, linear or not. The others are
  /// shared.
  std::vector<std::string> own = {};
  /// Every choice of a fit but a loss; it holds for each flight. R is common to all flights, and by
  /// filter error the process noises too. The prior of an own parameter holds for each flight's;
  /// that of a shared one counts once.
  FitOptions fit = {};
  /// A flight that can't be used is left out and listed; else it is an Error.
  bool leave_out = false;
};

/// Does the flight's own estimate of the shared parameters agree with that of all the others? Both
/// to first order at the joint solution, along the combinations that both determine. NaN where
/// nothing can be tested: a single flight, nothing that both determine, a singular joint problem.
struct Departure {
  int combinations = 0;    // that both determine, k
  double statistic = 0.0;  // d' V^-1 d, d the difference, V as the flights' noise models have it
  double p = 1.0;          // of a larger one where nothing departs: F(k, rows x outputs - n)
  double p_holm = 1.0;     // the same, by Holm for the number of flights
  double p_white = 1.0;    // with white residuals of the common R, off the drop in cost
  double p_white_holm = 1.0;
  /// Own estimate less that of the others, and its standard error, by shared parameter, and by
  /// filter error then by estimated noise, of its logarithm; NaN for one that is fixed, at a bound,
  /// or not determined by both.
  std::vector<std::string> names = {};
  Eigen::VectorXd difference = {};
  Eigen::VectorXd standard_error = {};
};

struct FlightFit {
  std::string name;
  std::vector<Parameter> own = {};  // in the model's order
  std::vector<OutputValue> rmse = {};
  std::size_t rows = 0;
  FitStatus alone = FitStatus::converged;  // of the flight's fit by itself, where the joint began
  std::string message = {};                // of that fit
  Departure departure = {};
};

struct ManyFit {
  FitStatus status = FitStatus::not_converged;
  std::string message;
  std::vector<Parameter> shared;  // in the model's order, fixed ones among them

  /// Of the shared parameters, in their order, the flights' own ones being estimated too. Sandwich
  /// of every flight's and output's noise model, and as white residuals would have it; see Fit.
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd correlation;
  Eigen::MatrixXd covariance_white;

  std::vector<FlightFit> flights;  // in the order given
  std::vector<LeftOut> left_out;

  std::vector<OutputValue> noise;  // common to all flights: given, or from R-hat = SSE / N
  std::vector<OutputValue> rmse;   // over all flights; by filter error of innovations
  double cost = 0.0;               // J of Eq. 6 over all rows; by filter error V_m (S 5.7)
  FitMethod method = FitMethod::output_error;
  std::vector<NoiseSize> noise_sizes = {};  // by filter error: process noises, then outputs
  double log_likelihood = not_a_number;     // by filter error
  Identifiability identifiability;
  int iterations = 0;
  int noise_iterations = 0;
  int passes = 0;        // over the data, beside each flight's own fit
  std::size_t rows = 0;  // of all flights

  /// Throws Error for a name that is not a shared parameter or not a flight.
  const Parameter& operator[](std::string_view name) const;
  const FlightFit& flight(std::string_view name) const;
};

/// Where a flight by itself stands. The order of n parameters is [own | shared] everywhere here,
/// each part in the model's order, without fixed ones. By filter error the logarithms of noises
/// that are not given, process noises first, end the shared ones, and there is one factor, that of
/// the score rows.
struct FlightStart {
  std::string error = {};  // not empty: why the flight can't be used; the rest is then empty
  FitStatus status = FitStatus::not_converged;
  std::string message = {};
  Eigen::VectorXd x = {};                      // n
  Eigen::VectorXd noise = {};                  // n_z
  std::vector<TriangularFactor> factors = {};  // n_z of [own | shared | r] at x, not whitened
  Eigen::VectorXd output_squares = {};         // n_z, sums of z^2; by filter error none
  std::size_t rows = 0;
  Eigen::VectorXd floor = {};  // by filter error: below each of the noises that are not given
};

/// A flight by its place, and where it is to be linearised.
struct FlightPoint {
  std::size_t flight = 0;
  Eigen::VectorXd x;  // n, [own | shared]
};

/// What the joint covariance asks of a flight at the solution.
struct ScoreQuestion {
  std::size_t flight = 0;
  Eigen::VectorXd x;                  // n
  Eigen::VectorXd noise;              // n_z, behind K: the common R's, as it is judged
  Eigen::VectorXd rounding;           // n_z: a smaller rms is rounding
  std::vector<Eigen::Index> columns;  // k of the n
  Eigen::MatrixXd K;                  // k x k, upper
};

/// What a flight hands over by filter error, at a point.
struct FlightScore {
  TriangularFactor factor{0};  // of [own | shared | r], the score rows'
  double cost = 0.0;           // V_m of S 5.7; infinite where its filter can't go on, at `row`
  std::size_t readings = 0;
  std::size_t row = 0;
};

/// Of a flight's innovations at a point: sums over the readings that are there, by output (n_z).
struct FlightInnovations {
  Eigen::VectorXd squares;   // of innovations
  Eigen::VectorXd counts;    // of readings
  Eigen::VectorXd readings;  // of readings' squares
  double memory = 1.0;       // rows of innovations that count as one; NaN: not finite
};

/// Flights, wherever they are: in this process or behind a map over workers. One call visits all
/// flights that it names; the answers are in the order of the questions.
class FlightSource {
 public:
  FlightSource() = default;
  FlightSource(const FlightSource&) = delete;
  FlightSource& operator=(const FlightSource&) = delete;
  virtual ~FlightSource() = default;

  virtual std::vector<std::string> names() const = 0;

  /// Each flight's fit by itself.
  virtual std::vector<FlightStart> start() = 0;

  /// n_z factors of [own | shared | r] for each point, not whitened; not finite where the model is
  /// not.
  virtual std::vector<std::vector<TriangularFactor>> linearise(
      const std::vector<FlightPoint>& points) = 0;

  /// K^-T [sum_j J_j' Sigma_j J_j / r_jj^2] K^-1 (k x k) for each question; Sigma_j from a noise
  /// model of what the flight's own linear fit leaves of output j. Empty where there is none.
  virtual std::vector<Eigen::MatrixXd> score_covariances(
      const std::vector<ScoreQuestion>& questions) = 0;

  /// By filter error, for each point. A source that doesn't answer throws Error.
  virtual std::vector<FlightScore> scores(const std::vector<FlightPoint>& points);
  virtual std::vector<FlightInnovations> innovations(const std::vector<FlightPoint>& points);
  /// The factor of each of so many blocks of the flight, as long as each other.
  virtual std::vector<std::vector<TriangularFactor>> score_blocks(
      const std::vector<FlightPoint>& points, const std::vector<int>& blocks);
};

/// One flight, prepared: what a FlightSource's answers are made of.
class FlightProblem {
 public:
  /// `model` must outlive it. Throws Error as fit() does.
  FlightProblem(const BlockModel& model, Record record, const ManyOptions& options);
  FlightProblem(const FlightProblem&) = delete;
  FlightProblem& operator=(const FlightProblem&) = delete;
  ~FlightProblem();

  FlightStart start() const;
  std::vector<TriangularFactor> linearise(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd score_covariance(const ScoreQuestion& question) const;

  /// By filter error.
  FlightScore score(const Eigen::VectorXd& x) const;
  FlightInnovations innovations(const Eigen::VectorXd& x) const;
  std::vector<TriangularFactor> score_blocks(const Eigen::VectorXd& x, int blocks) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

/// Fits `model` to all flights of a source. Throws Error for misuse: names that the model doesn't
/// have, nothing shared, flights of one name or none, a loss; for flights that can't be used unless
/// they are left out; and what the source throws.
ManyFit fit_many(const BlockModel& model, FlightSource& source, const ManyOptions& options);

/// The same on records in memory, on ManyOptions::fit.threads threads.
ManyFit fit_many(const BlockModel& model, std::vector<std::pair<std::string, Record>> flights,
                 const ManyOptions& options);

template <SeparableModel M>
ManyFit fit_many(const M& model, std::vector<std::pair<std::string, Record>> flights,
                 const ManyOptions& options) {
  return fit_many(StaticModel<M>(model), std::move(flights), options);
}

}  // namespace sepcal
