// SPDX-License-Identifier: BSD-3-Clause
// The path tangent of a trajectory, or of a filter that follows it: Phi and H at every row of the
// path that a fit's parameters give, and, of the inputs that are asked for, what they do at either
// end of a step and to the outputs, by differences of fourth order.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/detail/path_model.hpp"
#include "sepcal/detail/states/state_steps.hpp"

namespace sepcal::states {

class TrajectoryTangent final : public PathTangent {
 public:
  /// What is followed; all must outlive the tangent but xi.
  struct Path {
    const StateBlockModel& model;
    const Record& record;
    Eigen::VectorXd xi;
  };
  /// The same model without effects, on inputs as effects leave them. `drift`: what effects add to
  /// each of its linear parameters in each row (length x n_1; empty: nothing).
  struct Inputs {
    const StateBlockModel& model;
    Record record;
    Eigen::VectorXd xi;
    Eigen::MatrixXd drift;
  };

  TrajectoryTangent(Path path, Inputs inputs, const std::optional<PathNoise>& noise);

  Eigen::MatrixXd columns(const PathChange& change) const override;

  PathChange change(const BlockModel& with, const Record& record, const Eigen::VectorXd& xi,
                    const std::vector<Eigen::Index>& places) const override;

 private:
  struct Point {
    bool begins = false;      // a trajectory
    bool goes_on = false;     // to the next row
    Eigen::VectorXd reading;  // x where the outputs are read
    Eigen::VectorXd leaving;  // x where the step begins
    Eigen::MatrixXd Phi;
    Eigen::MatrixXd H;
    Eigen::MatrixXd K;        // n_x x n_z; of output error empty
    Eigen::MatrixXd whitens;  // S'^-1, n_z x n_z; likewise
  };
  /// What one input does: a column a row of the record.
  struct Response {
    Eigen::MatrixXd from;  // n_x, by its value at the row, to the state at the next
    Eigen::MatrixXd to;    // n_x, by its value at the next row
    Eigen::MatrixXd read;  // n_z
  };

  void follow(const std::optional<PathNoise>& noise);
  Eigen::Index n_x() const;
  Eigen::Index n_z() const { return path_.model.tables().n_z(); }
  void set_parameters(StateSteps& steps, std::size_t row) const;
  Record moved(const std::string& input, std::size_t parity, double by) const;
  Response find_response(const std::string& input) const;
  const Response& response(const std::string& input) const;

  Path path_;
  Inputs inputs_;
  std::vector<Point> points_;  // of the record's rows; those outside its segments are empty
  mutable std::mutex finding_;
  mutable std::map<std::string, Response> responses_;
};

}  // namespace sepcal::states
