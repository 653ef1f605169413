// SPDX-License-Identifier: BSD-3-Clause
// A column between its samples, never beyond them or across a gap: held, on straight lines, or on
// parabolas. A parabola is fitted to the samples about the time that is asked for, with the weights
// (1 - (dt / w)^2)^3 (Cleveland & Devlin, J. Am. Stat. Assoc. 83, 1988). Unlike a straight line,
// which has half the noise in the middle between two samples, it has the same noise everywhere: a
// cost that shifts the column in time is not pulled to where noise is least. The width w is the
// one, of 3 to 12 intervals, by which the samples that are left out are predicted best.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace sepcal::logs {

/// What stands between two samples.
enum class Joining { smooth, linear, held };

/// By its name. Throws OptionError for another word.
Joining parse_joining(const std::string& how);

/// A whole turn in the unit of an angle's header ("yaw_deg": 360); 0 of another column.
double turn_of(const std::string& header);

class SlowColumn {
 public:
  /// Its samples are the rows in which `values` holds a reading and `time` [s] rises; both have a
  /// value a row. `turn`: what an angle's values may jump by; 0 of another column.
  SlowColumn(std::span<const double> time, std::span<const double> values, Joining joining,
             double turn = 0.0);

  std::size_t samples() const { return time_.size(); }

  /// The usual interval [s] from one sample to the next; NaN of fewer than two.
  double interval() const { return interval_; }

  /// NaN before the first sample, behind the last and within gaps.
  double at(double time) const;

 private:
  /// Of a parabola about a time: its value there, and the weight in it of a sample at that time.
  struct Fitted {
    double value;
    double own_weight;
  };

  void unwrap(double turn);
  void cut_at_gaps(double gap);
  void choose_width();
  double prediction_error(double width) const;
  double on_line(std::size_t after, double time) const;
  double on_parabola(std::size_t after, double time) const;
  Fitted fit_parabola(std::size_t near, double time, double width) const;

  Joining joining_;
  std::vector<double> time_;            // s
  std::vector<double> values_;          // an angle's without jumps by a turn
  std::vector<std::size_t> stretches_;  // of each sample: where the stretch without a gap begins
  double turn_ = 0.0;                   // where an angle jumps
  double lowest_ = 0.0;                 // where its turn begins
  double interval_;
  double width_ = 0.0;  // of parabolas [s]
};

}  // namespace sepcal::logs
