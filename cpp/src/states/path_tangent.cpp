// SPDX-License-Identifier: BSD-3-Clause
#include "states/path_tangent.hpp"

#include <Eigen/QR>
#include <cmath>
#include <utility>

#include "base/stop.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/filter.hpp"
#include "states/differences.hpp"
#include "states/start_deviations.hpp"

namespace sepcal::states {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TrajectoryTangent::TrajectoryTangent(Path path, Inputs inputs,
                                     const std::optional<PathNoise>& noise)
    : path_(std::move(path)), inputs_(std::move(inputs)), points_(path_.record.length()) {
  follow(noise);
}

Index TrajectoryTangent::n_x() const {
  return static_cast<Index>(path_.model.plan().integrated().size());
}

void TrajectoryTangent::follow(const std::optional<PathNoise>& noise) {
  const TrajectoryPlan& plan = path_.model.plan();
  const auto steps = path_.model.steps(path_.record, path_.xi);
  const auto time = path_.record.column("time");
  MatrixXd R;
  std::vector<std::span<const double>> outputs;
  if (noise) {
    R = noise->outputs.cwiseAbs2().asDiagonal();
    for (const Variable& output : path_.model.tables().outputs) {
      outputs.push_back(path_.record.column(output.name));
    }
  }
  for (const Segment& segment : path_.record.segments()) {
    Filter<Dynamic> filter(VectorXd::Zero(n_x()), MatrixXd::Zero(n_x(), n_x()));
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      base::heed_stop();
      Point& point = points_[row];
      const int trajectory = plan.trajectory_at(row, row == segment.first);
      point.begins = trajectory >= 0;
      if (point.begins) {
        filter = {start_of(plan, trajectory, path_.xi), MatrixXd::Zero(n_x(), n_x())};
      }
      point.reading = filter.x();
      StateSteps::Reading expected = steps->read(row, filter.x());
      point.H = expected.H;
      if (noise) {
        VectorXd y(n_z());
        for (Index j = 0; j < y.size(); ++j) y[j] = outputs[static_cast<std::size_t>(j)][row];
        const MatrixXd P = filter.covariance();
        const auto innovation =
            filter.update<Dynamic>(y, {std::move(expected.z), std::move(expected.H)}, R);
        if (innovation.status != FilterStatus::ok) {
          throw Error("the filter can't go on from row " + std::to_string(row) +
                      " (counted from 0)");
        }
        point.whitens = innovation.S.transpose().triangularView<Eigen::Lower>().solve(
            MatrixXd::Identity(y.size(), y.size()));
        for (Index j = 0; j < y.size(); ++j) {
          if (std::isnan(y[j])) point.whitens.col(j).setZero();
        }
        point.K = P * point.H.transpose() * point.whitens.transpose() * point.whitens;
      }
      point.leaving = filter.x();
      if (row + 1 == segment.last) break;
      StateSteps::Step step = steps->advance(row, filter.x());
      point.goes_on = plan.trajectory_at(row + 1, false) < 0;
      point.Phi = step.Phi;
      const double held = plan.discrete() ? 1.0 : time[row + 1] - time[row];
      const VectorXd variances = noise ? plan.noise_variances(noise->process.cwiseAbs2(), held)
                                       : VectorXd(VectorXd::Zero(step.Gamma.cols()));
      if (filter.predict<Dynamic>({std::move(step.x), std::move(step.Phi), std::move(step.Gamma),
                                   MatrixXd(variances.asDiagonal())}) != FilterStatus::ok) {
        throw Error("the state is not finite after row " + std::to_string(row) +
                    " (counted from 0)");
      }
    }
  }
}

void TrajectoryTangent::set_parameters(StateSteps& steps, std::size_t row) const {
  if (inputs_.drift.size() == 0) return;
  VectorXd here = inputs_.xi;
  here.head(inputs_.drift.cols()) += inputs_.drift.row(static_cast<Index>(row)).transpose();
  steps.set_parameters(here);
}

/// The record with every other row of an input moved.
Record TrajectoryTangent::moved(const std::string& input, std::size_t parity, double by) const {
  const Record& record = inputs_.record;
  Record result;
  std::vector<double> values(record.length(), 0.0);
  for (const std::string& name : record.names()) {
    if (name == input) {
      values.assign(record.column(name).begin(), record.column(name).end());
    } else {
      result.view(name, record.column(name));
    }
  }
  for (std::size_t row = parity; row < values.size(); row += 2) values[row] += by;
  result.add(input, std::move(values));
  result.cut(record.segments());
  return result;
}

TrajectoryTangent::Response TrajectoryTangent::find_response(const std::string& input) const {
  const Record& record = inputs_.record;
  const auto length = static_cast<Index>(record.length());
  Response response{MatrixXd::Zero(n_x(), length), MatrixXd::Zero(n_x(), length),
                    MatrixXd::Zero(n_z(), length)};
  const double size = record.has(input) ? rms(record.column(input)) : 0.0;
  const double step = share_of_input * (size > 0 ? size : 1.0);
  for (std::size_t parity = 0; parity < 2; ++parity) {
    for (const auto& [node, weight] : difference_nodes) {
      const Record there = moved(input, parity, node * step);
      const auto steps = inputs_.model.steps(there, inputs_.xi);
      const double share = weight / step;
      for (const Segment& segment : record.segments()) {
        for (std::size_t row = segment.first; row < segment.last; ++row) {
          base::heed_stop();
          const Point& point = points_[row];
          const auto at = static_cast<Index>(row);
          const bool here = row % 2 == parity;
          set_parameters(*steps, row);
          if (here) response.read.col(at) += share * steps->expect(row, point.reading);
          if (!point.goes_on) continue;
          auto& end = here ? response.from : response.to;
          end.col(at) += share * steps->next(row, point.leaving);
        }
      }
    }
  }
  return response;
}

const TrajectoryTangent::Response& TrajectoryTangent::response(const std::string& input) const {
  const std::lock_guard lock(finding_);
  const auto known = responses_.find(input);
  if (known != responses_.end()) return known->second;
  return responses_.emplace(input, find_response(input)).first->second;
}

MatrixXd TrajectoryTangent::columns(const PathChange& change) const {
  const Index directions = !change.inputs.empty()    ? change.inputs.front().slopes.cols()
                           : change.steps.size() > 0 ? change.steps.cols()
                                                     : change.readings.cols();
  const auto rows = static_cast<Index>(path_.record.rows());
  std::vector<const Response*> responses;
  for (const InputSlopes& moved : change.inputs) responses.push_back(&response(moved.input));
  MatrixXd columns(n_z() * rows, directions);
  MatrixXd s = MatrixXd::Zero(n_x(), directions);
  Index to = 0;
  for (const Segment& segment : path_.record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row, ++to) {
      const Point& point = points_[row];
      const auto at = static_cast<Index>(row);
      if (point.begins) s.setZero();
      MatrixXd z = point.H * s;
      if (change.readings.size() > 0)
        z += change.readings(Eigen::seqN(to, n_z(), rows), Eigen::all);
      for (std::size_t i = 0; i < responses.size(); ++i) {
        z += responses[i]->read.col(at) * change.inputs[i].slopes.row(at);
      }
      columns(Eigen::seqN(to, n_z(), rows), Eigen::all) =
          point.whitens.size() > 0 ? MatrixXd(point.whitens * z) : z;
      if (!point.goes_on) continue;
      if (point.K.size() > 0) s -= point.K * z;
      s = (point.Phi * s).eval();
      if (change.steps.size() > 0) s += change.steps.middleRows(to * n_x(), n_x());
      for (std::size_t i = 0; i < responses.size(); ++i) {
        s += responses[i]->from.col(at) * change.inputs[i].slopes.row(at) +
             responses[i]->to.col(at) * change.inputs[i].slopes.row(at + 1);
      }
    }
  }
  return columns;
}

PathChange TrajectoryTangent::change(const BlockModel& with, const Record& record,
                                     const VectorXd& xi, const std::vector<Index>& places) const {
  const auto steps = dynamic_cast<const StateBlockModel&>(with).steps(record, xi);
  const auto rows = static_cast<Index>(record.rows());
  const auto directions = static_cast<Index>(places.size());
  const VectorXd silent =
      VectorXd::Zero(static_cast<Index>(path_.model.plan().model().noise.size()));
  const auto chosen = [&](const MatrixXd& joint) {
    return MatrixXd(joint.rightCols(xi.size())(Eigen::all, places));
  };
  PathChange change{.inputs = {},
                    .steps = MatrixXd::Zero(n_x() * rows, directions),
                    .readings = MatrixXd(n_z() * rows, directions)};
  Index to = 0;
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row, ++to) {
      base::heed_stop();
      const Point& point = points_[row];
      change.readings(Eigen::seqN(to, n_z(), rows), Eigen::all) =
          chosen(steps->read_jointly(row, point.reading).H);
      if (!point.goes_on) continue;
      change.steps.middleRows(to * n_x(), n_x()) =
          chosen(steps->advance_jointly(row, point.leaving, silent).Phi);
    }
  }
  return change;
}

}  // namespace sepcal::states

namespace sepcal {

std::unique_ptr<PathTangent> StateBlockModel::path_tangent(
    const Record& record, const Eigen::VectorXd& xi, const std::optional<PathNoise>& noise) const {
  return std::make_unique<states::TrajectoryTangent>(
      states::TrajectoryTangent::Path{*this, record, xi},
      states::TrajectoryTangent::Inputs{*this, record, xi, Eigen::MatrixXd()}, noise);
}

}  // namespace sepcal
