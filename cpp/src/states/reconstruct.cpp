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

/// The record with what was flown in the rows that are put.
class Reconstruction {
 public:
  Reconstruction(const TrajectoryModel<FlightPath>& model, const Record& record)
      : model_(model), record_(record) {
    const std::vector<double> empty(record.length(), not_a_number);
    for (auto* table : {&inputs_, &outputs_, &states_}) table->fill(empty);
  }

  void put(std::size_t row, const Six& x, const Six& bias) {
    Vec<double, FlightPath::n_u> u;
    for (std::size_t i = 0; i < FlightPath::inputs.size(); ++i) {
      const Quantity& input = FlightPath::inputs[i];
      u[static_cast<Eigen::Index>(i)] =
          record_.has(input.name) ? record_.column(input.name)[row] : input.absent;
    }
    const auto read = model_.state_model().at(x, u, bias);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      inputs_[i][row] = u[j] + bias[j];
      outputs_[i][row] = read.b[j];
      states_[i][row] = x[j];
    }
  }

  Record record() const {
    base::Columns columns(record_);
    for (std::size_t i = 0; i < 6; ++i) {
      columns.set(std::string(FlightPath::inputs[i].name), inputs_[i]);
      columns.set(std::string(FlightPath::outputs[i].name), outputs_[i]);
      columns.set(std::string(FlightPath::states[i].name), states_[i]);
    }
    return columns.record();
  }

 private:
  const TrajectoryModel<FlightPath>& model_;
  const Record& record_;
  std::array<std::vector<double>, 6> inputs_;
  std::array<std::vector<double>, 6> outputs_;
  std::array<std::vector<double>, 6> states_;
};

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

Record reconstruct(const TrajectoryModel<FlightPath>& model,
                   const std::map<std::string, double>& parameters, const Record& record) {
  const Eigen::MatrixXd x = model.states(record, parameters);
  Six bias;
  for (int i = 0; i < 6; ++i) {
    bias[i] = parameters.at(std::string(FlightPath::nonlinear[static_cast<std::size_t>(i)].name));
  }
  Reconstruction flown(model, record);
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      flown.put(row, x.row(static_cast<Eigen::Index>(row)).transpose(), bias);
    }
  }
  return flown.record();
}

Record reconstruct(const TrajectoryModel<FlightPath>& model, const Track& track,
                   const Record& record) {
  const auto value = [&](std::size_t at, std::string_view name) {
    const auto place = std::ranges::find(track.names, name);
    if (place != track.names.end()) {
      return track.estimates(static_cast<Eigen::Index>(at), place - track.names.begin());
    }
    if (record.has(name)) return record.column(name)[track.rows[at]];  // a state that is measured
    throw Error("the track has no '" + std::string(name) + "', and the record neither");
  };
  Reconstruction flown(model, record);
  for (std::size_t at = 0; at < track.rows.size(); ++at) {
    Six x;
    Six bias;
    for (std::size_t i = 0; i < 6; ++i) {
      x[static_cast<Eigen::Index>(i)] = value(at, FlightPath::states[i].name);
      bias[static_cast<Eigen::Index>(i)] = value(at, FlightPath::nonlinear[i].name);
    }
    flown.put(track.rows[at], x, bias);
  }
  return flown.record().cut(tracked_segments(record, track));
}

}  // namespace sepcal
