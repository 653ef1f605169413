// SPDX-License-Identifier: BSD-3-Clause
// From the parameters of a flight path to the flight.
#include "sepcal/states/reconstruct.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/columns.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/flight_path.hpp"

namespace sepcal {
namespace {

using Six = Vec<double, 6>;

/// The record with what was flown in the rows that are put. Path: FlightPath, with or without
/// position, whose inputs and first outputs and biases are the same.
template <class Path>
class Reconstruction {
 public:
  using State = Vec<double, Path::n_x>;

  Reconstruction(const TrajectoryModel<Path>& model, const Record& record)
      : model_(model), record_(record) {
    const std::vector<double> empty(record.length(), not_a_number);
    for (auto* table : {&inputs_, &outputs_}) table->fill(empty);
    states_.fill(empty);
  }

  void put(std::size_t row, const State& x, const Six& bias) {
    Vec<double, Path::n_u> u;
    for (std::size_t i = 0; i < Path::inputs.size(); ++i) {
      const Quantity& input = Path::inputs[i];
      u[static_cast<Eigen::Index>(i)] =
          record_.has(input.name) ? record_.column(input.name)[row] : input.absent;
    }
    Vec<double, Path::n_p> p = Vec<double, Path::n_p>::Zero();  // the wind moves no air data
    p.template head<6>() = bias;
    const auto read = model_.state_model().at(x, u, p);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      inputs_[i][row] = u[j] + bias[j];
      outputs_[i][row] = read.b[j];
    }
    for (std::size_t i = 0; i < states_.size(); ++i) {
      states_[i][row] = x[static_cast<Eigen::Index>(i)];
    }
  }

  Record record() const {
    base::Columns columns(record_);
    for (std::size_t i = 0; i < 6; ++i) {
      columns.set(std::string(Path::inputs[i].name), inputs_[i]);
      columns.set(std::string(Path::outputs[i].name), outputs_[i]);
    }
    for (std::size_t i = 0; i < states_.size(); ++i) {
      columns.set(std::string(Path::states[i].name), states_[i]);
    }
    return columns.record();
  }

 private:
  const TrajectoryModel<Path>& model_;
  const Record& record_;
  std::array<std::vector<double>, 6> inputs_;
  std::array<std::vector<double>, 6> outputs_;
  std::array<std::vector<double>, Path::n_x> states_;
};

template <class Path>
Record by_fit(const TrajectoryModel<Path>& model, const std::map<std::string, double>& parameters,
              const Record& record) {
  const Eigen::MatrixXd x = model.states(record, parameters);
  Six bias;
  for (std::size_t i = 0; i < 6; ++i) {
    bias[static_cast<Eigen::Index>(i)] = parameters.at(std::string(Path::nonlinear[i].name));
  }
  Reconstruction<Path> flown(model, record);
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      flown.put(row, x.row(static_cast<Eigen::Index>(row)).transpose(), bias);
    }
  }
  return flown.record();
}

template <class Path>
Record by_track(const TrajectoryModel<Path>& model, const Track& track, const Record& record) {
  const auto value = [&](std::size_t at, std::string_view name) {
    const auto place = std::ranges::find(track.names, name);
    if (place != track.names.end()) {
      return track.estimates(static_cast<Eigen::Index>(at), place - track.names.begin());
    }
    if (record.has(name)) return record.column(name)[track.rows[at]];  // a state that is measured
    throw Error("the track has no '" + std::string(name) + "', and the record neither");
  };
  Reconstruction<Path> flown(model, record);
  for (std::size_t at = 0; at < track.rows.size(); ++at) {
    Vec<double, Path::n_x> x;
    for (std::size_t i = 0; i < Path::states.size(); ++i) {
      x[static_cast<Eigen::Index>(i)] = value(at, Path::states[i].name);
    }
    Six bias;
    for (std::size_t i = 0; i < 6; ++i) {
      bias[static_cast<Eigen::Index>(i)] = value(at, Path::nonlinear[i].name);
    }
    flown.put(track.rows[at], x, bias);
  }
  return flown.record();
}

/// What `found` makes of the path as it was compiled.
Record as_compiled(const StateBlockModel& path, const auto& found) {
  if (const auto* plain = dynamic_cast<const TrajectoryModel<FlightPath>*>(&path)) {
    return found(*plain);
  }
  if (const auto* placed = dynamic_cast<const TrajectoryModel<FlightPathWithPosition>*>(&path)) {
    return found(*placed);
  }
  throw Error("the model is no flight path");
}

/// Of those of the record what the track has.
std::vector<Segment> tracked_segments(const Record& record, const Track& track) {
  std::vector<Segment> segments;
  for (Segment segment : record.segments()) {
    const auto first = std::ranges::lower_bound(track.rows, segment.first);
    if (first == track.rows.end() || *first >= segment.last) continue;
    segment.first = *first;
    segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace

Record reconstruct(const StateBlockModel& path, const std::map<std::string, double>& parameters,
                   const Record& record) {
  return as_compiled(path, [&](const auto& model) { return by_fit(model, parameters, record); });
}

Record reconstruct(const StateBlockModel& path, const Track& track, const Record& record) {
  return as_compiled(path, [&](const auto& model) { return by_track(model, track, record); })
      .cut(tracked_segments(record, track));
}

}  // namespace sepcal
