// SPDX-License-Identifier: BSD-3-Clause
#include "states/likelihood_track.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/name_list.hpp"
#include "base/parameter_values.hpp"
#include "base/stop.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/recursive_likelihood.hpp"
#include "states/joint_track.hpp"
#include "states/known_inputs.hpp"
#include "states/start_deviations.hpp"

namespace sepcal::states {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Recursion = ScoreRecursion<Dynamic, Dynamic, Dynamic, Dynamic>;
using Scores = Recursion::Filter;

class LikelihoodStream {
 public:
  LikelihoodStream(const StateBlockModel& model, const Record& record, const StreamStart& start,
                   const TrackOptions& options)
      : plan_(model.plan()),
        record_(record),
        start_(start),
        options_(options),
        all_(plan_.tables().parameters()),
        acting_(plan_.acting_columns()),
        n_(static_cast<Index>(acting_.size())),
        n_x_(static_cast<Index>(plan_.integrated().size())),
        n_w_(static_cast<Index>(plan_.model().noise.size())),
        n_z_(static_cast<Index>(plan_.outputs().size())),
        xi_(VectorXd::Zero(static_cast<Index>(all_.size()))),
        time_(record.column("time")) {
    for (const Variable& output : plan_.tables().outputs) {
      outputs_.push_back(record.column(output.name));
    }
    for (const int i : plan_.integrated()) {
      states_.push_back(plan_.model().states[static_cast<std::size_t>(i)].name);
    }
    lay_theta();
    steps_ = model.steps(record, xi_);
  }

  Track run() {
    std::vector<std::string> names = states_;
    for (const int column : acting_) names.push_back(all_[static_cast<std::size_t>(column)].name);
    for (const Variable& noise : plan_.model().noise) names.push_back("q_" + noise.name);
    for (const Variable& output : plan_.tables().outputs) names.push_back("r_" + output.name);
    track_ = empty_track(std::move(names), record_.rows() - start_.rows, static_cast<int>(n_z_));
    std::unique_ptr<Recursion> recursion;
    follow(recursion, record_.rows());
    return std::move(track_);
  }

  /// What the start's rows tell of the logarithms of the process noises' sizes, all else known,
  /// n_w; infinite of those that are held.
  VectorXd told_of_sizes() {
    std::unique_ptr<Recursion> recursion;
    follow(recursion, start_.rows);
    VectorXd information(n_w_);
    for (Index k = 0; k < n_w_; ++k) {
      const Index at = n_ + n_x_ + k;
      information[k] = free_[at] ? recursion->information_root().col(at).squaredNorm() : infinity;
    }
    return information;
  }

 private:
  /// From the record's begin, so many rows.
  void follow(std::unique_ptr<Recursion>& recursion, std::size_t until) {
    std::size_t seen = 0;
    for (const Segment& segment : record_.segments()) {
      const bool fitted = seen < start_.rows;  // its x(0) is among what the start knows
      Scores filter = begin(segment, fitted, recursion.get());
      if (!recursion) {
        recursion =
            std::make_unique<Recursion>(std::move(filter), theta_, information(), lower_, upper_);
      } else {
        recursion->restart(std::move(filter));
      }
      free_.segment(n_, n_x_) = fitted;
      for (std::size_t row = segment.first; row < segment.last; ++row) {
        base::heed_stop();
        if (row > segment.first) predict(*recursion, row - 1);
        update(*recursion, row, seen++);
        if (seen == until) return;
      }
    }
  }

  /// The place of a name in the start. Throws Error where it isn't there.
  bool is_free_in_start(Index place) const {
    return std::ranges::find(start_.free, static_cast<int>(place)) != start_.free.end();
  }

  /// Theta where the stream begins, its bounds, and what of it is estimated.
  void lay_theta() {
    const Index size = n_ + n_x_ + n_w_ + n_z_;
    theta_ = VectorXd::Zero(size);
    free_ = Scores::Moves::Constant(size, true);
    lower_ = VectorXd::Constant(size, -infinity);
    upper_ = VectorXd::Constant(size, infinity);
    for (Index k = 0; k < n_; ++k) {
      const int column = acting_[static_cast<std::size_t>(k)];
      const Variable& parameter = all_[static_cast<std::size_t>(column)];
      const Index place = place_in(start_, parameter.name);
      theta_[k] = xi_[column] = start_.xi[place];
      free_[k] = is_free_in_start(place);
      lower_[k] = std::min(parameter.lower, theta_[k]);
      upper_[k] = std::max(parameter.upper, theta_[k]);
    }
    if (plan_.model().noise.empty()) {
      throw Error("rml needs process noise, and the model's table `noise` is empty");
    }
    VectorXd q =
        base::deviations_in_order(plan_.model().noise, options_.process_noise, "process noise");
    for (Index k = 0; k < n_w_; ++k) {
      const Variable& noise = plan_.model().noise[static_cast<std::size_t>(k)];
      if (q[k] > 0.0) {
        free_[n_ + n_x_ + k] = false;
      } else if (start_.process_noise.size() == n_w_) {
        q[k] = start_.process_noise[k];
      } else {
        throw Error("rml has no size of the process noise '" + noise.name +
                    "' to begin with: start by filter error, or give it");
      }
    }
    const VectorXd r = noise_of(plan_.tables().outputs, start_, options_);
    if (!options_.noise.empty()) free_.tail(n_z_) = false;
    theta_.segment(n_ + n_x_, n_w_) = q.array().log();
    theta_.tail(n_z_) = r.array().log();
    // No noise moves by more than a factor of 1000 from where it began.
    lower_.tail(n_w_ + n_z_) = theta_.tail(n_w_ + n_z_).array() - std::log(1e3);
    upper_.tail(n_w_ + n_z_) = theta_.tail(n_w_ + n_z_).array() + std::log(1e3);
  }

  /// What a start without rows of this record knows of the parameters, and of noises: that their
  /// sizes are right within a factor of e. With rows these are gone through again at the start's
  /// theta, and tell it all.
  MatrixXd information() const {
    const Index size = theta_.size();
    MatrixXd R = MatrixXd::Zero(size, size);
    if (start_.rows > 0) return R;
    MatrixXd rows = MatrixXd::Zero(start_.R.rows() + n_w_ + n_z_, size);
    for (std::size_t i = 0; i < start_.free.size(); ++i) {
      const std::string& name = start_.names[static_cast<std::size_t>(start_.free[i])];
      for (Index k = 0; k < n_; ++k) {
        const int column = acting_[static_cast<std::size_t>(k)];
        if (all_[static_cast<std::size_t>(column)].name == name) {
          rows.col(k).head(start_.R.rows()) = start_.R.col(static_cast<Index>(i));
        }
      }
    }
    for (Index k = 0; k < n_w_ + n_z_; ++k) {
      if (free_[n_ + n_x_ + k]) rows(start_.R.rows() + k, n_ + n_x_ + k) = 1.0;
    }
    absorb_rows(R, rows);
    return R;
  }

  Scores begin(const Segment& segment, bool fitted, const Recursion* recursion) {
    if (recursion != nullptr) take_parameters(recursion->theta());
    VectorXd x(n_x_);
    MatrixXd P = MatrixXd::Zero(n_x_, n_x_);
    if (fitted) {
      for (Index i = 0; i < n_x_; ++i) {
        const Record batch = first_rows(record_, start_.rows);
        const TrajectoryPlan begun(plan_.model(), &batch, plan_.options());
        const int trajectory = begun.trajectory_at(segment.first, true);
        x[i] = start_.xi[place_in(
            start_, begun.start_name(states_[static_cast<std::size_t>(i)], trajectory))];
      }
    } else {
      x = steps_->start(segment.first);
      P = start_deviations(*steps_, segment, x, states_, options_.initial_states)
              .cwiseAbs2()
              .asDiagonal();
    }
    Scores::Moves moves = Scores::Moves::Constant(theta_.size(), true);
    if (plan_.separable()) {
      const int n_1 = plan_.tables().n_1();
      for (Index k = 0; k < n_; ++k) moves[k] = acting_[static_cast<std::size_t>(k)] >= n_1;
      moves.segment(n_, n_x_) = false;
    }
    return {x, P, n_, n_w_, n_z_, moves};
  }

  void take_parameters(const VectorXd& theta) {
    xi_(acting_) = theta.head(n_);
    steps_->set_parameters(xi_);
  }

  void predict(Recursion& recursion, std::size_t row) {
    const double held = plan_.discrete() ? 1.0 : time_[row + 1] - time_[row];
    if (recursion.predict(steps_->advance_to_second_order(row, recursion.filter().x()), held) !=
        FilterStatus::ok) {
      ++track_.refused;
    }
  }

  /// The row that `seen` others came before. Rows of the start move nothing.
  void update(Recursion& recursion, std::size_t row, std::size_t seen) {
    VectorXd y(n_z_);
    for (Index j = 0; j < n_z_; ++j) y[j] = outputs_[static_cast<std::size_t>(j)][row];
    const bool in_start = seen < start_.rows;
    const Innovation<Dynamic> innovation =
        recursion.update(y, steps_->read_to_second_order(row, recursion.filter().x()), free_,
                         in_start ? 1.0 : options_.forgetting);
    if (in_start) return;
    if (innovation.status != FilterStatus::ok) ++track_.refused;
    if ((seen + 1 - start_.rows) % static_cast<std::size_t>(options_.every) == 0) {
      recursion.step();
      take_parameters(recursion.theta());
    }
    VectorXd e = VectorXd::Constant(n_z_, not_a_number);
    for (Index j = 0; j < innovation.e.size(); ++j) {
      if (std::isfinite(y[j])) e[j] = innovation.e[j];
    }
    keep(recursion, row, e);
  }

  void keep(const Recursion& recursion, std::size_t row, const VectorXd& e) {
    const VectorXd& theta = recursion.theta();
    const MatrixXd covariance = covariance_of(recursion.information_root());
    VectorXd estimate(n_x_ + n_ + n_w_ + n_z_);
    VectorXd deviation = VectorXd::Zero(estimate.size());
    const VectorXd sizes = theta.tail(n_w_ + n_z_).array().exp();
    estimate << recursion.filter().x(), theta.head(n_), sizes;
    // x is as uncertain as the filter says, and as theta makes it.
    const MatrixXd& dx = recursion.filter().slopes();
    deviation.head(n_x_) =
        (recursion.filter().covariance() + dx * covariance * dx.transpose()).diagonal().cwiseSqrt();
    const VectorXd sd = covariance.diagonal().cwiseSqrt();
    deviation.segment(n_x_, n_) = sd.head(n_);
    deviation.tail(n_w_ + n_z_) = sizes.cwiseProduct(sd.tail(n_w_ + n_z_));
    append(track_, row, record_, estimate, deviation, e);
  }

  /// (R'R)^-1 of what is estimated; zeros for the others, infinite where the rows leave it open.
  MatrixXd covariance_of(const MatrixXd& R) const {
    std::vector<Index> places;
    for (Index k = 0; k < free_.size(); ++k) {
      if (free_[k]) places.push_back(k);
    }
    MatrixXd rows = R(Eigen::all, places);
    MatrixXd own = MatrixXd::Zero(rows.cols(), rows.cols());
    absorb_rows(own, rows);
    MatrixXd covariance = MatrixXd::Zero(R.rows(), R.rows());
    if (!is_regular(own)) {
      for (const Index k : places) covariance(k, k) = infinity;
      return covariance;
    }
    const MatrixXd V = inverse_root(own);
    covariance(places, places) = V.transpose() * V;
    return covariance;
  }

  const TrajectoryPlan& plan_;
  const Record& record_;
  const StreamStart& start_;
  const TrackOptions& options_;
  std::vector<Variable> all_;
  std::vector<int> acting_;
  Index n_;
  Index n_x_;
  Index n_w_;
  Index n_z_;
  VectorXd xi_;
  std::span<const double> time_;
  std::vector<std::span<const double>> outputs_;
  std::vector<std::string> states_;
  VectorXd theta_;  // where the stream begins
  VectorXd lower_;
  VectorXd upper_;
  Scores::Moves free_;
  std::unique_ptr<StateSteps> steps_;
  Track track_;
};

}  // namespace

namespace {

/// The start with noises that its rows don't tell, which a fit leaves at their floor, as large as
/// they may be without being told: a recursion that begins at the floor finds no slope there, and
/// stays, surer than it may be.
StreamStart with_sizes(const StateBlockModel& model, const Record& record, StreamStart start,
                       const TrackOptions& options) {
  constexpr int most = 40;
  constexpr double factor = 2.0;
  if (start.rows == 0 || start.process_noise.size() == 0) return start;
  for (int pass = 0; pass < most; ++pass) {
    const VectorXd told = LikelihoodStream(model, record, start, options).told_of_sizes();
    if ((told.array() >= 1.0).all()) break;
    for (Index k = 0; k < told.size(); ++k) {
      if (told[k] < 1.0) start.process_noise[k] *= factor;
    }
  }
  return start;
}

}  // namespace

Track track_likelihood(const StateBlockModel& model, const Record& record, const StreamStart& start,
                       const TrackOptions& options) {
  const TrajectoryOptions& along = model.plan().options();
  if (std::isfinite(along.shoot)) throw Error("a track runs on; leave shoot out");
  if (along.scales_about_start) {
    throw Error("a track has no start to count scales from; leave scales_about_start out");
  }
  if (options.every < 1) throw Error("every must be at least 1 sample");
  base::deviations_in_order(model.plan().model().states, options.initial_states, "state");
  check_inputs(model.tables(), record);
  const StreamStart begin = with_sizes(model, record, start, options);
  return LikelihoodStream(model, record, begin, options).run();
}

}  // namespace sepcal::states
