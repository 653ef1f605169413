// SPDX-License-Identifier: BSD-3-Clause
// Filter error of a short period by sepcal: the likelihood's score, as score rows that become
// Fisher's information, or by differences of the same filter; and recursive maximum likelihood.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "benchmark.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/joint_filter.hpp"
#include "sepcal/states/recursive_likelihood.hpp"

namespace benchmark {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::InnovationModel;
using sepcal::ShortPeriod;

constexpr Index sizes = 15;  // of theta: 3 + 5 parameters, 2 initial states, 2 + 3 noises
constexpr std::size_t rows = 1000;
constexpr double airspeed = 25.0;  // m/s

struct Flight {
  VectorXd theta;
  std::span<const double> time, elevator, alpha, q, az;

  explicit Flight(const std::vector<double>& numbers)
      : theta(Eigen::Map<const VectorXd>(numbers.data(), sizes)) {
    const auto columns = std::span(numbers).subspan(sizes);
    time = columns.subspan(0, rows);
    elevator = columns.subspan(rows, rows);
    alpha = columns.subspan(2 * rows, rows);
    q = columns.subspan(3 * rows, rows);
    az = columns.subspan(4 * rows, rows);
  }

  sepcal::Record record() const {
    sepcal::Record record;
    record.view("time", time).view("elevator", elevator);
    record.view("alpha_m", alpha).view("q_m", q).view("az_m", az);
    return record.add("airspeed", std::vector<double>(rows, airspeed));
  }

  sepcal::StateRow<ShortPeriod> row(std::size_t k) const {
    sepcal::StateRow<ShortPeriod> row;
    row.time = time[k];
    row.u = {elevator[k], airspeed};
    return row;
  }

  Eigen::Vector3d readings(std::size_t k) const { return {alpha[k], q[k], az[k]}; }
};

Answer answer_of(const VectorXd& x) { return {x.begin(), x.end()}; }

/// The gradient of V_m by score rows, with the step that Fisher's scoring takes from there.
Answer step_by_score(const InnovationModel& model, const VectorXd& theta) {
  sepcal::TriangularFactor factor(static_cast<int>(sizes) + 1);
  model.scores(theta, [&](std::size_t /*row*/, MatrixXd& scores) { factor.absorb(scores); });
  const MatrixXd R = factor.matrix().topLeftCorner(sizes, sizes);
  const VectorXd q = factor.matrix().topRightCorner(sizes, 1);
  if (!sepcal::solve_triangular(R, q).x.allFinite()) return {};
  return answer_of(-(R.transpose() * q));
}

/// The gradient alone, by central differences of V_m.
Answer difference(const InnovationModel& model, const VectorXd& theta) {
  VectorXd gradient(sizes);
  for (Index i = 0; i < sizes; ++i) {
    const double h = 6e-6 * std::max(1.0, std::abs(theta[i]));  // cube root of the last digit
    VectorXd to = theta;
    to[i] = theta[i] + h;
    const double above = model.value(to).cost;
    to[i] = theta[i] - h;
    gradient[i] = (above - model.value(to).cost) / (2.0 * h);
  }
  return answer_of(gradient);
}

using Likelihood = sepcal::RecursiveLikelihood<ShortPeriod>;

/// Of theta as a trajectory's tables have it, each place of the recursion's.
constexpr std::array<Index, sizes> in_trajectory{0, 1, 2, 7, 8, 9, 3, 4, 5, 6, 10, 11, 12, 13, 14};

/// All samples by recursive maximum likelihood, theta moved every ten of them, from an information
/// of a tenth of each of theta or of one.
Answer track_by_likelihood(const Flight& flight) {
  Likelihood::Theta theta;
  for (Index i = 0; i < sizes; ++i) {
    theta[i] = flight.theta[in_trajectory[static_cast<std::size_t>(i)]];
  }
  const Likelihood::Theta bound = Likelihood::Theta::Constant(1e3);
  const Likelihood::Root R =
      (10.0 / theta.array().abs().max(1.0)).matrix().asDiagonal().toDenseMatrix();
  Likelihood stream({}, theta, R, -bound, bound, Likelihood::Free::Constant(true));
  for (std::size_t k = 0; k < rows; ++k) {
    if (k > 0) stream.predict(flight.row(k - 1), flight.row(k));
    stream.update(flight.row(k).u, flight.readings(k));
    if (k % 10 == 9) stream.step();
  }
  return answer_of(stream.theta().segment<5>(3));
}

/// The same by the joint extended filter of states and parameters, the noises known.
Answer track_jointly(const Flight& flight) {
  using Joint = sepcal::JointFilter<ShortPeriod>;
  Joint::Vector s;  // x(0); b_alpha b_q b_az; Za Ma Mq Zd Md
  s << flight.theta.segment<2>(5), flight.theta.head<3>(), flight.theta.segment<3>(7),
      flight.theta.segment<2>(3);
  const Joint::Vector deviation = 0.1 * s.cwiseAbs().cwiseMax(1.0);
  Joint joint({}, sepcal::Filter<Joint::n>(
                      s, Joint::Matrix(deviation.cwiseAbs2().asDiagonal().toDenseMatrix())));
  const Eigen::Vector2d density = (2.0 * flight.theta.segment<2>(10)).array().exp();
  const Eigen::Vector3d variance = (2.0 * flight.theta.tail<3>()).array().exp();
  const Eigen::Matrix2d Q = density.asDiagonal();
  const Eigen::Matrix3d covariance = variance.asDiagonal();
  for (std::size_t k = 0; k < rows; ++k) {
    if (k > 0) joint.predict(flight.row(k - 1), flight.row(k), Q);
    joint.update(flight.row(k).u, flight.readings(k), covariance);
  }
  return answer_of(joint.p());
}

}  // namespace

bool run_filter_error(const std::string& method, const std::vector<double>& numbers, int repeats) {
  const Flight flight(numbers);
  const sepcal::Record record = flight.record();
  const sepcal::TrajectoryModel<ShortPeriod> model({}, record);
  const auto innovations = model.innovations(record);
  if (method == "score") {
    report(repeats, [&] { return step_by_score(*innovations, flight.theta); });
  } else if (method == "differences") {
    report(repeats, [&] { return difference(*innovations, flight.theta); });
  } else if (method == "rml") {
    report(repeats, [&] { return track_by_likelihood(flight); });
  } else if (method == "joint") {
    report(repeats, [&] { return track_jointly(flight); });
  } else {
    return false;
  }
  return true;
}

}  // namespace benchmark
