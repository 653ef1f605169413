// SPDX-License-Identifier: BSD-3-Clause
// From the parameters of a flight path to the flight.
#include <array>
#include <string>
#include <vector>

#include "base/columns.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/states/reconstruct.hpp"

namespace sepcal {

Record reconstruct(const TrajectoryModel<FlightPath>& model,
                   const std::map<std::string, double>& parameters, const Record& record) {
  const Eigen::MatrixXd x = model.states(record, parameters);
  Vec<double, 6> bias;
  for (int i = 0; i < 6; ++i) {
    bias[i] = parameters.at(std::string(FlightPath::nonlinear[static_cast<std::size_t>(i)].name));
  }
  const std::vector<double> empty(record.length(), not_a_number);
  std::array<std::vector<double>, 6> inputs;
  std::array<std::vector<double>, 6> outputs;
  std::array<std::vector<double>, 6> states;
  for (auto* table : {&inputs, &outputs, &states}) table->fill(empty);
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      Vec<double, FlightPath::n_u> u;
      for (std::size_t i = 0; i < FlightPath::inputs.size(); ++i) {
        const Quantity& input = FlightPath::inputs[i];
        u[static_cast<Eigen::Index>(i)] =
            record.has(input.name) ? record.column(input.name)[row] : input.absent;
      }
      const Vec<double, 6> at = x.row(static_cast<Eigen::Index>(row)).transpose();
      const auto read = model.state_model().at(at, u, bias);
      for (std::size_t i = 0; i < 6; ++i) {
        const auto j = static_cast<Eigen::Index>(i);
        inputs[i][row] = u[j] + bias[j];
        outputs[i][row] = read.b[j];
        states[i][row] = at[j];
      }
    }
  }
  base::Columns columns(record);
  for (std::size_t i = 0; i < 6; ++i) {
    columns.set(std::string(FlightPath::inputs[i].name), inputs[i]);
    columns.set(std::string(FlightPath::outputs[i].name), outputs[i]);
    columns.set(std::string(FlightPath::states[i].name), states[i]);
  }
  return columns.record();
}

}  // namespace sepcal
