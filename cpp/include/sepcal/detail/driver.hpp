// SPDX-License-Identifier: BSD-3-Clause
// What drives an effect: functions phi_j(d) of one logged channel or of time, some with a shape
// parameter of their own (an exponent, a delay, a step's time). A driver takes the channel as it
// was logged, whatever other effects correct.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

class Driver {
 public:
  /// `suffixes`: one a function, joined to a coefficient's name ("" or "_2", "_3" ...).
  Driver(std::optional<Variable> input, std::vector<std::string> suffixes,
         std::optional<Variable> shape = {});
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  virtual ~Driver() = default;

  /// The column that it reads; none for a constant.
  const std::optional<Variable>& input() const { return input_; }

  /// Its own nonlinear parameter, named without the effect ("exponent", "t0", "tau").
  const std::optional<Variable>& shape() const { return shape_; }

  int functions() const { return static_cast<int>(suffixes_.size()); }
  const std::vector<std::string>& suffixes() const { return suffixes_; }

  /// Whether its shape is a time at which it jumps, which no derivative finds.
  virtual bool is_step() const { return false; }

  /// How far [s] it reaches from a row along the time axis.
  virtual double reach() const { return 0.0; }

  /// Fills `values` (rows x functions) with phi_j of the column `d` (rows values; nullptr without
  /// an input), and `slopes`, where not null, with d phi_j / d shape. `first`: the record's row of
  /// d[0].
  virtual void evaluate(const double* d, std::size_t first, double shape,
                        Eigen::Ref<Eigen::MatrixXd> values, Eigen::MatrixXd* slopes) const = 0;

 private:
  std::optional<Variable> input_;
  std::vector<std::string> suffixes_;
  std::optional<Variable> shape_;
};

using DriverPointer = std::shared_ptr<const Driver>;

/// phi = 1.
DriverPointer constant_driver();

/// phi = (d - centre)^power - mean, power 1 to 9.
DriverPointer power_driver(Variable input, double centre, int power, double mean = 0.0);

/// phi = max(d, 0)^exponent, the exponent fitted within [0.3, 2].
DriverPointer exponent_driver(Variable input);

/// phi_j: the cardinal natural splines of the knots but the first, each less its mean (one a
/// function, or none to leave them zero at the first knot). Where the model has a straight line of
/// the input, `without_line` leaves out the last: the others and a line are any such spline.
DriverPointer spline_driver(Variable input, std::vector<double> knots,
                            const std::vector<double>& means = {}, bool without_line = false);

/// phi_j = 1 where d lies from the threshold j = 1, 2, ... on and below the next (one a function).
/// `thresholds` rise.
DriverPointer levels_driver(Variable input, std::vector<double> thresholds);

/// phi_j = 1 where d is the code j = 1, 2, ...; `labels` are those of the codes 0, 1, 2, ...
DriverPointer category_driver(Variable input, const std::vector<std::string>& labels);

/// phi = 1 from t0 on, before it 0, and max(t - t0, 0): t0 within [first, last]. A step has no
/// derivative with respect to t0: find t0 by a scan and hold it. A ramp's corner is rounded over
/// +-ramp_corner of the span, (x + w)^2 / 4w: a sharp one makes a local minimum at every row.
inline constexpr double ramp_corner = 0.005;
DriverPointer step_driver(Variable time, double first, double last);
DriverPointer ramp_driver(Variable time, double first, double last);

/// phi = exp(-(t - first) / tau), tau within [span / 100, 2 span], span = last - first.
DriverPointer decay_driver(Variable time, double first, double last);

/// phi = d(t - tau), tau within +-longest [s], interpolated within a segment of `record`, which
/// holds "time" and is read here and no more.
DriverPointer delay_driver(Variable input, const Record& record, double longest);

}  // namespace sepcal
