// SPDX-License-Identifier: BSD-3-Clause
#include "states/joint_track.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/name_list.hpp"
#include "base/parameter_values.hpp"
#include "base/stop.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/iterated_update.hpp"
#include "states/change_watch.hpp"
#include "states/information_track.hpp"
#include "states/known_inputs.hpp"
#include "states/start_deviations.hpp"

namespace sepcal::states {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What the filter estimates: s = [x; xi], x the n_x states that are integrated, xi the k
/// parameters that the start leaves free. The others are held; initial states are x itself.
struct Layout {
  std::vector<std::string> states;  // n_x
  std::vector<std::string> names;   // of all parameters but initial states
  std::vector<int> columns;         // of these, among the plan's parameters
  std::vector<int> free;            // places in `columns` of those that are free, k
  VectorXd start;                   // n, all parameters of the plan
};

/// What is known where the stream begins.
struct Beginning {
  VectorXd s;     // n_x + k
  MatrixXd root;  // U, U'U its covariance
};

/// Where the start's rows end: its estimates of x at that segment's first row and of what is free,
/// and the places of these in it.
struct Batch {
  std::vector<std::string> names;  // n_x + k; of x empty where no rows have told it
  std::size_t segment = 0;
  std::size_t row = 0;  // the first that is not in the start
};

void check_trajectory(const TrajectoryOptions& options) {
  if (std::isfinite(options.shoot)) throw Error("a track runs on; leave shoot out");
  if (options.scales_about_start) {
    throw Error("a track has no start to count scales from; leave scales_about_start out");
  }
}

/// The place of a name in the start. Throws Error where it isn't there.
Layout lay_out(const TrajectoryPlan& plan, const StreamStart& start) {
  Layout layout;
  std::vector<int> initial;
  for (const int i : plan.integrated()) {
    layout.states.push_back(plan.model().states[static_cast<std::size_t>(i)].name);
    for (int t = 0; t < plan.trajectories(); ++t) initial.push_back(plan.column_of_start(i, t));
  }
  const std::vector<Variable> all = plan.tables().parameters();
  layout.start = VectorXd::Zero(static_cast<Index>(all.size()));
  for (int column = 0; column < static_cast<int>(all.size()); ++column) {
    if (std::ranges::find(initial, column) != initial.end()) continue;
    const std::string& name = all[static_cast<std::size_t>(column)].name;
    const Index place = place_in(start, name);
    const bool is_free = std::ranges::find(start.free, static_cast<int>(place)) != start.free.end();
    if (is_free) layout.free.push_back(static_cast<int>(layout.columns.size()));
    layout.start[column] = start.xi[place];
    layout.columns.push_back(column);
    layout.names.push_back(name);
  }
  return layout;
}

std::vector<std::string> free_names(const Layout& layout) {
  std::vector<std::string> names;
  for (const int k : layout.free) names.push_back(layout.names[static_cast<std::size_t>(k)]);
  return names;
}

Batch batch_of(const TrajectoryPlan& plan, const Layout& layout, const Record& record,
               const StreamStart& start) {
  Batch batch{std::vector<std::string>(layout.states.size())};
  if (start.rows > 0) {
    const Record rows = first_rows(record, start.rows);
    batch.segment = rows.segments().size() - 1;
    batch.row = rows.segments().back().last;
    const TrajectoryPlan begun(plan.model(), &rows, plan.options());
    for (std::size_t i = 0; i < layout.states.size(); ++i) {
      batch.names[i] = begun.start_name(layout.states[i], begun.trajectories() - 1);
    }
  }
  std::ranges::copy(free_names(layout), std::back_inserter(batch.names));
  return batch;
}

/// The start's estimates under these names, and the columns of U that belong to them, U'U the
/// covariance of what the start has free: zero for what it holds.
Beginning estimates_of(const StreamStart& start, const std::vector<std::string>& names) {
  const MatrixXd U = covariance_root(start.R);
  const auto n = static_cast<Index>(names.size());
  Beginning begin{VectorXd::Zero(n), MatrixXd::Zero(U.rows(), n)};
  for (Index i = 0; i < n; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (name.empty()) continue;
    const Index place = place_in(start, name);
    begin.s[i] = start.xi[place];
    const auto at = std::ranges::find(start.free, static_cast<int>(place));
    if (at != start.free.end()) begin.root.col(i) = U.col(at - start.free.begin());
  }
  return begin;
}

VectorXd density_of(const TrajectoryPlan& plan, const StreamStart& start,
                    const TrackOptions& options) {
  const std::vector<Variable>& noises = plan.model().noise;
  const VectorXd given = base::deviations_in_order(noises, options.process_noise, "process noise");
  const bool of_start = start.process_noise.size() == given.size();
  if (options.process_noise.empty()) {
    return of_start ? VectorXd(start.process_noise.cwiseAbs2()) : VectorXd::Zero(given.size());
  }
  if (start.rows > 0 && !of_start && given.maxCoeff() > 0.0) {
    throw Error(
        "the first rows were fitted as if no noise drove the states, and their standard errors are "
        "too small: start by filter error (method), with the process noise");
  }
  return given.cwiseAbs2();
}

/// A joint filter on its way along a record.
class JointStream {
 public:
  JointStream(const StateBlockModel& model, const Record& record, const StreamStart& start,
              const TrackOptions& options)
      : plan_(model.plan()),
        record_(record),
        options_(options),
        layout_(lay_out(plan_, start)),
        xi_(layout_.start),
        density_(density_of(plan_, start, options)),
        walk_(walk_of(free_names(layout_), options)),
        R_(noise_of(plan_.tables().outputs, start, options).cwiseAbs2().asDiagonal()),
        steps_(model.steps(record, xi_)),
        watch_(record, free_names(layout_), n_x() + static_cast<Index>(layout_.free.size()),
               options.changes),
        forgetting_(options) {
    base::deviations_in_order(plan_.model().states, options.initial_states, "state");
    for (const Variable& output : plan_.tables().outputs) {
      outputs_.push_back(record.column(output.name));
    }
  }

  Track run(const StreamStart& start) {
    std::vector<std::string> names = layout_.states;
    names.insert(names.end(), layout_.names.begin(), layout_.names.end());
    track_ = empty_track(std::move(names), record_.rows() - start.rows, plan_.tables().n_z());
    if (options_.method == TrackMethod::srif) {
      run_in<InformationForm<Dynamic>>(start);
    } else {
      run_in<SquareRootForm<Dynamic>>(start);
    }
    track_.changes = std::move(watch_).changes();
    return std::move(track_);
  }

 private:
  template <class Form>
  void run_in(const StreamStart& start) {
    const Batch batch = batch_of(plan_, layout_, record_, start);
    const Beginning known = estimates_of(start, batch.names);
    const Segment& segment = record_.segments()[batch.segment];
    if (start.rows == 0) {
      const Beginning begin = restarted(known.s, known.root, segment, 0.0);
      Filter<Dynamic, Form> filter(begin.s, form_of<Form>(begin.root));
      follow(filter, batch.segment, segment.first, false);
      return;
    }
    const std::size_t last = batch.row - 1;
    const bool is_driven = !density_.isZero(0.0);
    const Beginning begin = is_driven ? behind(known, segment.first, last) : rooted(known);
    Filter<Dynamic, Form> filter(begin.s, form_of<Form>(begin.root));
    if (!is_driven) {  // x follows from s: in the filter's own form, which keeps what dies away
      const VectorXd walk = std::exchange(walk_, VectorXd::Zero(walk_.size()));
      for (std::size_t row = segment.first; row < last; ++row) predict(filter, row);
      walk_ = walk;
    }
    follow(filter, batch.segment, last, true);
  }

  static Beginning rooted(const Beginning& known) {
    MatrixXd rows = known.root;
    Beginning begin{known.s, MatrixXd::Zero(known.s.size(), known.s.size())};
    absorb_rows(begin.root, rows);
    return begin;
  }

  /// From x at a segment's first row to x at the last row of the start, which these rows have told:
  /// given what the start estimates, s, a filter knows x, and s moves it by dx/ds along that
  /// filter's gains. Then x and the parameters are off together,
  ///   x - x_hat = dx/ds (s - s_hat) + e,  cov e = P of the filter.
  Beginning behind(const Beginning& known, std::size_t row, std::size_t last) {
    const Index n = known.s.size();
    set_parameters(known.s);
    Filter<Dynamic> filter(known.s.head(n_x()), MatrixXd(MatrixXd::Zero(n_x(), n_x())));
    MatrixXd slopes = MatrixXd::Identity(n_x(), n);  // dx/ds
    for (;; ++row) {
      absorb_known(filter, slopes, row);
      if (row == last) break;
      const StateSteps::JointStep step = steps_->advance_jointly(row, filter.x(), density_);
      const MatrixXd Phi = of_estimated(step.Phi);
      slopes = (Phi.leftCols(n_x()) * slopes).eval();
      slopes.rightCols(n - n_x()) += Phi.rightCols(n - n_x());
      filter.predict(Transition<Dynamic, Dynamic>{step.x, Phi.leftCols(n_x()),
                                                  MatrixXd::Identity(n_x(), n_x()), step.Q_d});
    }
    MatrixXd rows = MatrixXd::Zero(known.root.rows() + n_x(), n);
    rows.topLeftCorner(known.root.rows(), n_x()) = known.root * slopes.transpose();
    rows.topRightCorner(known.root.rows(), n - n_x()) = known.root.rightCols(n - n_x());
    rows.bottomLeftCorner(n_x(), n_x()) = filter.form().root();
    Beginning begin{known.s, MatrixXd::Zero(n, n)};
    begin.s.head(n_x()) = filter.x();
    absorb_rows(begin.root, rows);
    return begin;
  }

  /// A row of the start: x moves by its readings, and dx/ds with it.
  void absorb_known(Filter<Dynamic>& filter, MatrixXd& slopes, std::size_t row) const {
    const VectorXd z = reading(row);
    const StateSteps::Reading expected = steps_->read_jointly(row, filter.x());
    MatrixXd H = of_estimated(expected.H);
    for (Index j = 0; j < z.size(); ++j) {
      if (std::isnan(z[j])) H.row(j).setZero();
    }
    const MatrixXd PH = filter.covariance() * H.leftCols(n_x()).transpose();
    const MatrixXd S = H.leftCols(n_x()) * PH + MatrixXd(R_);
    MatrixXd moved = H.leftCols(n_x()) * slopes;
    moved.rightCols(slopes.cols() - n_x()) += H.rightCols(slopes.cols() - n_x());
    filter.update<Dynamic>(z, {expected.z, H.leftCols(n_x())}, R_);
    slopes -= PH * S.llt().solve(moved);
  }

  template <class Form>
  Form form_of(const MatrixXd& root) const {
    if (options_.method == TrackMethod::srif && (root.diagonal().array() == 0.0).any()) {
      throw Error(
          "srif can't hold what is known exactly; give every state a deviation above 0 "
          "(initial_states), or take ekf");
    }
    return Form::of_covariance_root(root);
  }

  Index n_x() const { return static_cast<Index>(layout_.states.size()); }

  /// From `row` of a segment, which the filter has seen already or not, to the record's end.
  template <class Form>
  void follow(Filter<Dynamic, Form>& filter, std::size_t first, std::size_t row, bool seen) {
    for (std::size_t i = first; i < record_.segments().size(); ++i) {
      const Segment& segment = record_.segments()[i];
      if (i > first) {
        row = segment.first;
        const Beginning begin = restarted(
            filter.x(), filter.form().root(), segment,
            std::max(0.0, seconds_between(record_, record_.segments()[i - 1].last - 1, row)));
        filter = Filter<Dynamic, Form>(begin.s, form_of<Form>(begin.root));
        watch_.restart();
      }
      if (!seen) update(filter, row);
      seen = false;
      for (; row + 1 < segment.last; ++row) {
        base::heed_stop();
        if (predict(filter, row) == FilterStatus::refused) ++track_.refused;
        update(filter, row + 1);
      }
    }
  }

  /// A new segment: x begins anew, independent of the past; what is known of parameters, of s and
  /// its covariance's root, stays, but for what walks in the `away` seconds before.
  Beginning restarted(VectorXd s, const MatrixXd& root, const Segment& segment, double away) {
    set_parameters(s);
    s.head(n_x()) = steps_->start(segment.first);
    const VectorXd deviations =
        start_deviations(*steps_, segment, s.head(n_x()), layout_.states, options_.initial_states);
    const Index k = s.size() - n_x();
    MatrixXd rows = MatrixXd::Zero(root.rows() + k, k);
    rows.topRows(root.rows()) = root.rightCols(k);
    rows.bottomRows(k).diagonal() = (away * walk_).cwiseSqrt();
    MatrixXd marginal = MatrixXd::Zero(k, k);
    absorb_rows(marginal, rows);
    MatrixXd U = MatrixXd::Zero(s.size(), s.size());
    U.topLeftCorner(n_x(), n_x()) = deviations.asDiagonal();
    U.bottomRightCorner(k, k) = marginal;
    return {std::move(s), std::move(U)};
  }

  VectorXd reading(std::size_t row) const {
    VectorXd z(static_cast<Index>(outputs_.size()));
    for (Index j = 0; j < z.size(); ++j) z[j] = outputs_[static_cast<std::size_t>(j)][row];
    return z;
  }

  /// From `row` to the next.
  Transition<Dynamic, Dynamic> step_from(std::size_t row, const VectorXd& s) {
    set_parameters(s);
    StateSteps::JointStep step = steps_->advance_jointly(row, s.head(n_x()), density_);
    const Index n = s.size();
    Transition<Dynamic, Dynamic> next{s, MatrixXd::Identity(n, n), MatrixXd::Identity(n, n_x()),
                                      std::move(step.Q_d)};
    if (!walk_.isZero(0.0)) {  // what walks is driven too
      next.Q_d = with_walk(next.Q_d, seconds_between(record_, row, row + 1));
      next.Gamma = MatrixXd::Identity(n, n);
    }
    next.x.head(n_x()) = step.x;
    next.Phi.topRows(n_x()) = of_estimated(step.Phi);
    return next;
  }

  template <class Form>
  FilterStatus predict(Filter<Dynamic, Form>& filter, std::size_t row) {
    const Transition<Dynamic, Dynamic> next = step_from(row, filter.x());
    const FilterStatus status = filter.predict(next);
    if (status != FilterStatus::refused) watch_.predict(next.Phi);
    forget(filter, forgetting_.next());
    return status;
  }

  MatrixXd with_walk(const MatrixXd& Q_d, double seconds) const {
    MatrixXd both = MatrixXd::Zero(n_x() + walk_.size(), n_x() + walk_.size());
    both.topLeftCorner(n_x(), n_x()) = Q_d;
    both.diagonal().tail(walk_.size()) = seconds * walk_;
    return both;
  }

  Linearisation<Dynamic, Dynamic> expected(std::size_t row, const VectorXd& s) {
    set_parameters(s);
    StateSteps::Reading reading = steps_->read_jointly(row, s.head(n_x()));
    return {std::move(reading.z), of_estimated(reading.H)};
  }

  /// By the reading z of a row, `before` its outputs at the estimate before it.
  template <class Form>
  Innovation<Dynamic> absorb(Filter<Dynamic, Form>& filter, std::size_t row, const VectorXd& z,
                             const Linearisation<Dynamic, Dynamic>& before) {
    if (options_.method != TrackMethod::iekf) return filter.template update<Dynamic>(z, before, R_);
    return iterated_update<Dynamic, Form, Dynamic>(
        filter, z, [&](const VectorXd& s) { return expected(row, s); }, R_, options_.iterations);
  }

  /// The last rows until `row` again, all in its segment: V_m of them.
  template <class Form>
  double run_again(Filter<Dynamic, Form>& filter, std::size_t row, std::size_t count) {
    double cost = 0.0;
    for (std::size_t at = row - count; at < row; ++at) {
      filter.predict(step_from(at, filter.x()));
      forget(filter, forgetting_.constant());
      const Innovation<Dynamic> innovation =
          absorb(filter, at + 1, reading(at + 1), expected(at + 1, filter.x()));
      if (innovation.status != FilterStatus::refused) cost += innovation.cost();
    }
    return cost;
  }

  template <class Form>
  void update(Filter<Dynamic, Form>& filter, std::size_t row) {
    const VectorXd z = reading(row);
    Linearisation<Dynamic, Dynamic> before;  // at the estimate before the row
    if (options_.method != TrackMethod::iekf || watch_.looks()) before = expected(row, filter.x());
    const MatrixXd P = watch_.looks() ? filter.covariance() : MatrixXd();
    const Innovation<Dynamic> innovation = absorb(filter, row, z, before);
    forgetting_.follow(innovation.w, innovation.count);
    track_.refused += innovation.status == FilterStatus::refused ? 1 : 0;
    track_.not_converged += innovation.status == FilterStatus::not_converged ? 1 : 0;
    VectorXd e = VectorXd::Constant(z.size(), not_a_number);
    for (Index j = 0; j < innovation.e.size(); ++j) {
      if (std::isfinite(z[j])) e[j] = innovation.e[j];
    }
    watch_.update(filter, P, before.jacobian, z, innovation, row,
                  [&](Filter<Dynamic, Form>& anew, std::size_t count) {
                    return run_again(anew, row, count);
                  });
    keep(row, filter.x(), filter.covariance().diagonal().cwiseSqrt(), e);
  }

  /// Of all parameters, held ones with no deviation.
  void keep(std::size_t row, const VectorXd& s, const VectorXd& deviation, const VectorXd& e) {
    const auto n = static_cast<Index>(track_.names.size());
    VectorXd estimate(n);
    estimate << s.head(n_x()), layout_.start(layout_.columns);
    VectorXd all = VectorXd::Zero(n);
    all.head(n_x()) = deviation.head(n_x());
    for (std::size_t i = 0; i < layout_.free.size(); ++i) {
      const Index from = n_x() + static_cast<Index>(i);
      estimate[n_x() + layout_.free[i]] = s[from];
      all[n_x() + layout_.free[i]] = deviation[from];
    }
    append(track_, row, record_, estimate, all, e);
  }

  void set_parameters(const VectorXd& s) {
    for (std::size_t i = 0; i < layout_.free.size(); ++i) {
      xi_[column_of(i)] = s[n_x() + static_cast<Index>(i)];
    }
    steps_->set_parameters(xi_);
  }

  int column_of(std::size_t free) const {
    return layout_.columns[static_cast<std::size_t>(layout_.free[free])];
  }

  /// Of derivatives by x and all parameters those by s.
  MatrixXd of_estimated(const MatrixXd& derivative) const {
    MatrixXd result(derivative.rows(), n_x() + static_cast<Index>(layout_.free.size()));
    result.leftCols(n_x()) = derivative.leftCols(n_x());
    for (std::size_t i = 0; i < layout_.free.size(); ++i) {
      result.col(n_x() + static_cast<Index>(i)) = derivative.col(n_x() + column_of(i));
    }
    return result;
  }

  const TrajectoryPlan& plan_;
  const Record& record_;
  const TrackOptions& options_;
  Layout layout_;
  VectorXd xi_;
  VectorXd density_;
  VectorXd walk_;  // k, variance a second
  MatrixXd R_;
  std::unique_ptr<StateSteps> steps_;
  std::vector<std::span<const double>> outputs_;
  ChangeWatch watch_;
  Forgetting forgetting_;
  Track track_;
};

}  // namespace

Track track_jointly(const StateBlockModel& model, const Record& record, const StreamStart& start,
                    const TrackOptions& options) {
  check_trajectory(model.plan().options());
  check_inputs(model.tables(), record);
  return JointStream(model, record, start, options).run(start);
}

namespace {

/// The start's, which may have other outputs too.
VectorXd own_noise(const std::vector<Variable>& outputs, const StreamStart& start) {
  if (start.outputs.empty() && start.noise.size() == static_cast<Index>(outputs.size())) {
    return start.noise;
  }
  VectorXd noise(static_cast<Index>(outputs.size()));
  for (Index j = 0; j < noise.size(); ++j) {
    const std::string& name = outputs[static_cast<std::size_t>(j)].name;
    const auto at = std::ranges::find(start.outputs, name);
    if (at == start.outputs.end()) {
      throw Error("the start has no noise of the output '" + name + "'; give that of all outputs");
    }
    noise[j] = start.noise[at - start.outputs.begin()];
  }
  return noise;
}

}  // namespace

VectorXd walk_of(const std::vector<std::string>& names, const TrackOptions& options) {
  VectorXd variances = VectorXd::Zero(static_cast<Index>(names.size()));
  for (const auto& [name, deviation] : options.walk) {
    const auto at = std::ranges::find(names, name);
    if (at == names.end()) {
      throw Error("'" + name + "' can't walk: it is not estimated along the way; there are " +
                  base::list_first(names, 12));
    }
    if (!(std::isfinite(deviation) && deviation >= 0.0)) {
      throw Error("the walk of '" + name + "' is no standard deviation; give 0 or more");
    }
    variances[at - names.begin()] = deviation * deviation;
  }
  return variances;
}

double seconds_between(const Record& record, std::size_t row, std::size_t later) {
  if (!record.has("time")) return static_cast<double>(later - row);
  const auto time = record.column("time");
  return time[later] - time[row];
}

VectorXd noise_of(const std::vector<Variable>& outputs, const StreamStart& start,
                  const TrackOptions& options) {
  if (options.noise.empty()) return own_noise(outputs, start);
  const VectorXd noise = base::deviations_in_order(outputs, options.noise, "output");
  for (Index j = 0; j < noise.size(); ++j) {
    if (noise[j] > 0) continue;
    throw Error("output '" + outputs[static_cast<std::size_t>(j)].name +
                "' needs a noise above 0, as every output does");
  }
  return noise;
}

Index place_in(const StreamStart& start, const std::string& name) {
  const auto at = std::ranges::find(start.names, name);
  if (at != start.names.end()) return at - start.names.begin();
  throw Error("the start has no '" + name + "'; it has " + base::list_first(start.names, 12) +
              ": start from this model and record");
}

Track empty_track(std::vector<std::string> names, std::size_t rows, int n_z) {
  Track track;
  const auto count = static_cast<Index>(rows);
  const auto n = static_cast<Index>(names.size());
  track.names = std::move(names);
  track.estimates.resize(count, n);
  track.standard_deviations.resize(count, n);
  track.innovations.resize(count, n_z);
  return track;
}

void append(Track& track, std::size_t row, const Record& record, const VectorXd& estimate,
            const VectorXd& deviation, const VectorXd& innovation) {
  const auto at = static_cast<Index>(track.rows.size());
  track.rows.push_back(row);
  if (record.has("time")) track.time.push_back(record.column("time")[row]);
  track.estimates.row(at) = estimate;
  track.standard_deviations.row(at) = deviation;
  track.innovations.row(at) = innovation;
}

}  // namespace sepcal::states
