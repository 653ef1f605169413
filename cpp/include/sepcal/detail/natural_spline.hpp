// SPDX-License-Identifier: BSD-3-Clause
// The natural cubic spline: twice continuously differentiable, without curvature at its ends and a
// straight line beyond them. It interpolates a record's columns in time, and its cardinal functions
// (one at their own knot, zero at the others) are the smooth drivers of effects.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sepcal/detail/eigen.hpp"

namespace sepcal {

class NaturalSpline {
 public:
  struct Value {
    double value = 0.0;
    double slope = 0.0;
    double curvature = 0.0;
  };

  /// Throws Error unless there are two knots or more, strictly increasing, and a value at each.
  NaturalSpline(std::vector<double> knots, std::vector<double> values);

  Value at(double x) const;

  /// The same where x lies near the interval `hint`, which moves there: for walks along a column.
  Value at(double x, std::size_t& hint) const;

 private:
  Value within(std::size_t interval, double x) const;

  std::vector<double> knots_;
  std::vector<double> values_;
  std::vector<double> curvatures_;
};

/// `count` knots from lowest to highest, evenly spaced. Throws Error for fewer than two and where
/// the ends are no interval.
std::vector<double> even_knots(double lowest, double highest, int count);

/// The cardinal natural splines of all knots but the first: the functions that are zero at the
/// first knot and take any value at the others.
class SplineBasis {
 public:
  /// Throws Error as NaturalSpline does, and for fewer than three knots.
  explicit SplineBasis(std::vector<double> knots);

  int functions() const { return static_cast<int>(curvatures_.cols()) - 1; }

  /// Values of every function at x (functions()), linear beyond the end knots.
  void evaluate(double x, Eigen::Ref<Eigen::RowVectorXd> values) const;

  /// One of them (from 0 on), of any number that compares with a double.
  template <class X>
  X value(int function, const X& x) const {
    std::size_t piece = 0;  // before the first knot, between two of them, beyond the last
    while (piece < knots_.size() && !(x < knots_[piece])) ++piece;
    const Cubic cubic = piece_of(function, piece);
    const X t = x - cubic.from;
    return cubic.c[0] + t * (cubic.c[1] + t * (cubic.c[2] + t * cubic.c[3]));
  }

 private:
  struct Cubic {
    double from;              // a knot
    std::array<double, 4> c;  // of the powers of x - from
  };
  Cubic piece_of(int function, std::size_t piece) const;

  std::vector<double> knots_;
  Eigen::MatrixXd curvatures_;  // knots x knots: of cardinal function j at knot i
};

}  // namespace sepcal
