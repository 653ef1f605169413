// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/driver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/interpolated_column.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;

/// The suffixes of one function alone.
std::vector<std::string> single() { return {""}; }

/// A driver with one function of the channel's value alone: phi(d, shape) and its slope.
template <class Function>
class Pointwise final : public Driver {
 public:
  Pointwise(std::optional<Variable> input, std::optional<Variable> shape, Function function)
      : Driver(std::move(input), single(), std::move(shape)), function_(std::move(function)) {}

  void evaluate(const double* d, std::size_t /*first*/, double shape, Ref<MatrixXd> values,
                MatrixXd* slopes) const override {
    for (Index i = 0; i < values.rows(); ++i) {
      const auto [value, slope] = function_(d == nullptr ? 0.0 : d[i], shape);
      values(i, 0) = value;
      if (slopes != nullptr) (*slopes)(i, 0) = slope;
    }
  }

 private:
  Function function_;
};

template <class Function>
DriverPointer pointwise(std::optional<Variable> input, std::optional<Variable> shape,
                        Function function) {
  return std::make_shared<const Pointwise<Function>>(std::move(input), std::move(shape),
                                                     std::move(function));
}

using ValueAndSlope = std::pair<double, double>;

std::vector<std::string> numbered(int functions) {
  std::vector<std::string> suffixes;
  for (int j = 0; j < functions; ++j)
    suffixes.push_back(std::string("_").append(std::to_string(j + 2)));
  return suffixes;
}

class SplineDriver final : public Driver {
 public:
  SplineDriver(Variable input, SplineBasis basis, const std::vector<double>& means,
               bool without_line)
      : Driver(std::move(input), numbered(basis.functions() - (without_line ? 1 : 0))),
        basis_(std::move(basis)) {
    const int all = basis_.functions();
    means_ = Eigen::RowVectorXd::Zero(all);
    if (means.empty()) return;
    if (static_cast<int>(means.size()) != all) {
      throw Error("a spline of " + std::to_string(all + 1) + " knots has " + std::to_string(all) +
                  " functions, but " + std::to_string(means.size()) + " means were given");
    }
    means_ = Eigen::Map<const Eigen::RowVectorXd>(means.data(), all);
  }

  void evaluate(const double* d, std::size_t /*first*/, double /*shape*/, Ref<MatrixXd> values,
                MatrixXd* slopes) const override {
    Eigen::RowVectorXd row(basis_.functions());
    for (Index i = 0; i < values.rows(); ++i) {
      basis_.evaluate(d[i], row);
      values.row(i) = (row - means_).head(functions());
    }
    if (slopes != nullptr) slopes->setZero();
  }

 private:
  SplineBasis basis_;
  Eigen::RowVectorXd means_;
};

class LevelsDriver final : public Driver {
 public:
  LevelsDriver(Variable input, std::vector<double> thresholds)
      : Driver(std::move(input), numbered(static_cast<int>(thresholds.size()))),
        thresholds_(std::move(thresholds)) {}

  void evaluate(const double* d, std::size_t /*first*/, double /*shape*/, Ref<MatrixXd> values,
                MatrixXd* slopes) const override {
    values.setZero();
    for (Index i = 0; i < values.rows(); ++i) {
      const Index level = std::ranges::upper_bound(thresholds_, d[i]) - thresholds_.begin();
      if (level > 0) values(i, level - 1) = 1.0;
    }
    if (slopes != nullptr) slopes->setZero();
  }

 private:
  std::vector<double> thresholds_;
};

class CategoryDriver final : public Driver {
 public:
  CategoryDriver(Variable input, std::vector<std::string> suffixes)
      : Driver(std::move(input), std::move(suffixes)) {}

  void evaluate(const double* d, std::size_t /*first*/, double /*shape*/, Ref<MatrixXd> values,
                MatrixXd* slopes) const override {
    for (Index j = 0; j < values.cols(); ++j) {
      for (Index i = 0; i < values.rows(); ++i) {
        values(i, j) = d[i] == static_cast<double>(j + 1) ? 1.0 : 0.0;
      }
    }
    if (slopes != nullptr) slopes->setZero();
  }
};

class StepDriver final : public Driver {
 public:
  StepDriver(Variable time, double first, double last)
      : Driver(std::move(time), single(), Variable("t0", "s", first, last)) {}

  bool is_step() const override { return true; }

  void evaluate(const double* d, std::size_t /*first*/, double shape, Ref<MatrixXd> values,
                MatrixXd* slopes) const override {
    for (Index i = 0; i < values.rows(); ++i) values(i, 0) = d[i] >= shape ? 1.0 : 0.0;
    if (slopes != nullptr) slopes->setZero();
  }
};

class DelayDriver final : public Driver {
 public:
  DelayDriver(Variable input, numerics::InterpolatedColumn column, double longest)
      : Driver(std::move(input), single(), Variable("tau", "s", -longest, longest)),
        column_(std::move(column)),
        longest_(longest) {}

  double reach() const override { return longest_; }

  void evaluate(const double* /*d*/, std::size_t first, double shape, Ref<MatrixXd> values,
                MatrixXd* slopes) const override {
    std::vector<NaturalSpline::Value> delayed(static_cast<std::size_t>(values.rows()));
    column_.fill(first, -shape, delayed);
    for (Index i = 0; i < values.rows(); ++i) {
      const NaturalSpline::Value& at = delayed[static_cast<std::size_t>(i)];
      values(i, 0) = at.value;
      if (slopes != nullptr) (*slopes)(i, 0) = -at.slope;
    }
  }

 private:
  numerics::InterpolatedColumn column_;
  double longest_;
};

}  // namespace

Driver::Driver(std::optional<Variable> input, std::vector<std::string> suffixes,
               std::optional<Variable> shape)
    : input_(std::move(input)), suffixes_(std::move(suffixes)), shape_(std::move(shape)) {}

DriverPointer constant_driver() {
  return pointwise({}, {}, [](double, double) { return ValueAndSlope{1.0, 0.0}; });
}

DriverPointer power_driver(Variable input, double centre, int power, double mean) {
  if (power < 1 || power > 9) {
    throw Error("the power " + std::to_string(power) + " of '" + input.name +
                "' must be a whole number from 1 to 9");
  }
  return pointwise(std::move(input), {}, [centre, power, mean](double d, double) {
    double value = 1.0;
    for (int i = 0; i < power; ++i) value *= d - centre;
    return ValueAndSlope{value - mean, 0.0};
  });
}

DriverPointer exponent_driver(Variable input) {
  return pointwise(std::move(input), Variable("exponent", "1", 0.3, 2.0),
                   [](double d, double exponent) {
                     if (!(d > 0)) return ValueAndSlope{0.0, 0.0};
                     const double value = std::pow(d, exponent);
                     return ValueAndSlope{value, value * std::log(d)};
                   });
}

DriverPointer spline_driver(Variable input, std::vector<double> knots,
                            const std::vector<double>& means, bool without_line) {
  return std::make_shared<const SplineDriver>(std::move(input), SplineBasis(std::move(knots)),
                                              means, without_line);
}

DriverPointer levels_driver(Variable input, std::vector<double> thresholds) {
  if (thresholds.empty() || !std::ranges::is_sorted(thresholds)) {
    throw Error("levels of '" + input.name + "' take thresholds that rise");
  }
  return std::make_shared<const LevelsDriver>(std::move(input), std::move(thresholds));
}

DriverPointer category_driver(Variable input, const std::vector<std::string>& labels) {
  if (labels.size() < 2) {
    throw Error("'" + input.name + "' has fewer than two labels, so that nothing varies with it");
  }
  std::vector<std::string> suffixes;
  for (std::size_t i = 1; i < labels.size(); ++i)
    suffixes.push_back(std::string("_").append(labels[i]));
  return std::make_shared<const CategoryDriver>(std::move(input), std::move(suffixes));
}

DriverPointer step_driver(Variable time, double first, double last) {
  return std::make_shared<const StepDriver>(std::move(time), first, last);
}

DriverPointer ramp_driver(Variable time, double first, double last) {
  const double corner = ramp_corner * (last - first);
  return pointwise(std::move(time), Variable("t0", "s", first, last),
                   [corner](double t, double t0) {
                     const double x = t - t0;
                     if (x <= -corner) return ValueAndSlope{0.0, 0.0};
                     if (x >= corner) return ValueAndSlope{x, -1.0};
                     const double into = x + corner;
                     return ValueAndSlope{into * into / (4.0 * corner), -into / (2.0 * corner)};
                   });
}

DriverPointer decay_driver(Variable time, double first, double last) {
  const double span = last - first;
  return pointwise(std::move(time), Variable("tau", "s", 0.01 * span, 2.0 * span),
                   [first](double t, double tau) {
                     const double age = (t - first) / tau;
                     const double value = std::exp(-age);
                     return ValueAndSlope{value, value * age / tau};
                   });
}

DriverPointer delay_driver(Variable input, const Record& record, double longest) {
  numerics::InterpolatedColumn column(record, input.name);
  return std::make_shared<const DelayDriver>(std::move(input), std::move(column), longest);
}

}  // namespace sepcal
