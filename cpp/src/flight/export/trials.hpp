// SPDX-License-Identifier: BSD-3-Clause
// What a header's self-test puts in: plain rows, and for each guard one that is a little beyond.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "flight/export/probe_body.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::exporting {

inline constexpr std::size_t plain_rows = 3;  // the first ones, which no guard finds

class Trials {
 public:
  /// In float the rows are what a float holds of them.
  Trials(const Calibration& calibration, const ProbeBody& body, const Correction& correction,
         bool single);

  std::size_t rows() const { return outside_.size(); }

  /// Under the names that apply() reads.
  Flight flight() const;

  /// The row as the header's function takes it: readings, then drivers less their origins.
  std::vector<double> inputs(std::size_t row) const;

  /// Whether a guard finds the row beyond what the fit saw.
  bool is_outside(std::size_t row) const { return outside_[row]; }

  /// Leaves a row out.
  void drop(std::size_t row);

 private:
  double channel_at(const std::string& channel, std::size_t row) const;
  void set_channel(const std::string& channel, std::size_t row, double value);
  void add_beyond(const Guard& guard);
  void round_row(std::size_t row);
  double& cell(const std::string& header, std::size_t row);
  double cell(const std::string& header, std::size_t row) const;
  bool reads(const std::string& header) const;
  bool is_flow_angle(const std::string& channel) const;
  bool has(const std::string& header) const;
  std::string header_of(const std::string& channel) const;

  const ProbeBody& body_;
  const Correction& correction_;
  bool single_;
  double k_alpha_ = 0.0;  // of a five-hole probe, 1/rad
  double k_beta_ = 0.0;
  Eigen::Matrix3d turn_;  // of a magnetometer, from its axes into the body's
  std::vector<std::pair<std::string, std::vector<double>>> columns_;
  std::vector<bool> outside_;
};

}  // namespace sepcal::exporting
