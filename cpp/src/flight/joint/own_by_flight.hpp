// SPDX-License-Identifier: BSD-3-Clause
// A model in which some parameters are added to by a parameter of each flight: what they are of a
// flight's rows is p + p@flight. With p held at zero these are the flights' own, and what acts on
// p, as a wind that drifts, still finds it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "flight/files/headers.hpp"
#include "sepcal/detail/block_model.hpp"

namespace sepcal::joint {

/// The input that says which flight a row is of.
using files::flight_number;

/// "w_n@monday".
std::string name_of_own(const std::string& parameter, const std::string& flight);

class OwnByFlight final : public BlockModel {
 public:
  /// `own`: parameters of `model`, which must outlive this.
  OwnByFlight(const BlockModel& model, const std::vector<std::string>& own,
              const std::vector<std::string>& flights);

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

  std::size_t kept_bytes(std::size_t rows) const override { return model_.kept_bytes(rows); }
  void keep_rows(const Block& block, void* to) const override {
    model_.keep_rows(without_number(block), to);
  }

  std::size_t lane_width() const override { return own_2_.empty() ? model_.lane_width() : 0; }
  bool evaluate_lanes(const LaneBlock& block, const PointTiles& points, double* scratch,
                      const VisitTile& visit) const override;

  void input_tangent(const Block& block, const double* xi2, const double* xi1,
                     std::span<const int> inputs,
                     Eigen::Ref<Eigen::MatrixXd> columns) const override;

  bool add_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                              Eigen::Ref<Eigen::MatrixXd> sum) const override;

  Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z) const override;

  std::unique_ptr<Carry> new_carry() const override { return model_.new_carry(); }

 private:
  /// The model's own parameters on a flight, of all of these.
  static Eigen::VectorXd on_flight(const double* all, Eigen::Index count,
                                   const std::vector<Eigen::Index>& own, Eigen::Index flight);

  /// Of a block's rows, which are of one flight.
  Eigen::Index flight_of(const double* const* inputs) const;

  /// A block as the model takes it.
  Block without_number(const Block& block) const;

  const BlockModel& model_;
  Eigen::Index flights_;
  std::vector<Eigen::Index> own_1_;  // places among the model's linear and nonlinear parameters
  std::vector<Eigen::Index> own_2_;
};

}  // namespace sepcal::joint
