// SPDX-License-Identifier: BSD-3-Clause
// A column between its samples: held, or on straight lines, and never beyond them or across a gap.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace sepcal::logs {

/// What stands between two samples.
enum class Joining { linear, held };

/// "linear" or "held". Throws OptionError for another word.
Joining parse_joining(const std::string& how);

/// A whole turn in the unit of an angle's header ("yaw_deg": 360); 0 of another column.
double turn_of(const std::string& header);

class SlowColumn {
 public:
  /// Its samples are the rows in which `values` holds a reading and `time` [s] rises; both have a
  /// value a row. `turn`: what an angle's values may jump by; 0 of another column.
  SlowColumn(std::span<const double> time, std::span<const double> values, double turn = 0.0);

  std::size_t samples() const { return time_.size(); }

  /// The usual interval [s] from one sample to the next; NaN of fewer than two.
  double interval() const { return interval_; }

  /// NaN before the first sample, behind the last and within gaps.
  double at(double time, Joining joining) const;

 private:
  double between(std::size_t after, double time) const;

  std::vector<double> time_;
  std::vector<double> values_;
  double turn_;
  double lowest_ = 0.0;  // where an angle's turn begins
  double interval_;
  double gap_;
};

}  // namespace sepcal::logs
