// SPDX-License-Identifier: BSD-3-Clause
#include "many/departure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "numerics/decompositions.hpp"
#include "numerics/tails.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One flight's test, probabilities as logarithms.
struct Test {
  Departure departure;
  double log10_p = not_a_number;
  double log10_p_white = not_a_number;
};

class Tester {
 public:
  Tester(const Compared& compared, const JointCovariance& covariance)
      : compared_(compared), covariance_(covariance) {}

  Test run(Index flight) const {
    constexpr double least_information = 1e-8;  // of all flights', to determine a combination
    Test test{untested(), not_a_number, not_a_number};
    const Index k = covariance_.joint.cols();
    const MatrixXd B = covariance_.contribution(flight);
    const Eigen::JacobiSVD<MatrixXd> svd(B, Eigen::ComputeFullV);
    const VectorXd all = svd.singularValues().cwiseAbs2();
    std::vector<Index> both;
    for (Index i = 0; i < k; ++i) {
      if (all[i] > least_information && 1.0 - all[i] > least_information) both.push_back(i);
    }
    if (both.empty()) return test;
    const MatrixXd V = svd.matrixV()(Eigen::all, both);
    const VectorXd L = all(both);
    const VectorXd others = VectorXd::Ones(L.size()) - L;
    const auto& share = covariance_.flights[static_cast<std::size_t>(flight)].share.shared;
    const VectorXd b = V.transpose() * (B.transpose() * share.matrix().col(k).head(k));

    const MatrixXd own_middle = V.transpose() * covariance_.shared_middle(flight) * V;
    const MatrixXd their_middle =
        V.transpose() * (covariance_.middle_sum - covariance_.shared_middle(flight)) * V;
    const MatrixXd C = others.asDiagonal() * own_middle * others.asDiagonal() +
                       MatrixXd(L.asDiagonal() * their_middle * L.asDiagonal());
    const VectorXd information = L.cwiseProduct(others);
    judge(test, flight, b.dot(C.ldlt().solve(b)),
          covariance_.ratio * b.cwiseAbs2().cwiseQuotient(information).sum(),
          static_cast<double>(both.size()));
    const MatrixXd to_difference = V * information.cwiseInverse().asDiagonal();
    fill_differences(test.departure, V, to_difference * b,
                     to_difference * C * to_difference.transpose());
    return test;
  }

  Departure untested() const {
    Departure departure{.statistic = not_a_number,
                        .p = not_a_number,
                        .p_holm = not_a_number,
                        .p_white = not_a_number,
                        .p_white_holm = not_a_number};
    departure.difference = VectorXd::Constant(compared_.layout.shared, not_a_number);
    departure.standard_error = departure.difference;
    return departure;
  }

 private:
  /// `drop`: of the cost at R, twice.
  void judge(Test& test, Index flight, double statistic, double drop, double k) const {
    const double measurements =
        std::accumulate(compared_.measurements.begin(), compared_.measurements.end(), 0.0);
    const double freedom = measurements - static_cast<double>(compared_.layout.size()) - k;
    if (compared_.chi_squared) {
      test.log10_p_white = numerics::log10_chi_squared_tail(drop, k);
    } else if (freedom > 0 && drop < measurements) {
      test.log10_p_white =
          numerics::log10_f_tail(drop / k * freedom / (measurements - drop), k, freedom);
    }
    const double own_freedom = compared_.measurements[static_cast<std::size_t>(flight)] -
                               static_cast<double>(compared_.layout.own + compared_.layout.shared);
    const bool coloured =
        covariance_.flights[static_cast<std::size_t>(flight)].middle.size() > 0 && own_freedom > 0;
    test.log10_p =
        coloured ? numerics::log10_f_tail(statistic / k, k, own_freedom) : test.log10_p_white;
    test.departure.statistic = statistic;
    test.departure.combinations = static_cast<int>(k);
  }

  /// Back to the parameters, where the combinations that both determine tell them.
  void fill_differences(Departure& departure, const MatrixXd& V, const VectorXd& difference,
                        const MatrixXd& covariance) const {
    const Index k = covariance_.joint.cols();
    const MatrixXd rows =
        covariance_.joint.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(k, k));
    for (Index i = 0; i < k; ++i) {
      const VectorXd row = rows.row(i).transpose();
      const double outside = (row - V * (V.transpose() * row)).norm();
      if (outside > 1e-6 * row.norm()) continue;
      const Index place = covariance_.shared[static_cast<std::size_t>(i)];
      departure.difference[place] = row.dot(difference);
      departure.standard_error[place] = std::sqrt(row.dot(covariance * row));
    }
  }

  const Compared& compared_;
  const JointCovariance& covariance_;
};

/// Holm's adjustment of those that were tested.
void adjust(std::vector<Test>& tests, double Test::* log10_p, double Departure::* p,
            double Departure::* p_holm) {
  std::vector<double> tested;
  for (const Test& test : tests) {
    if (!std::isnan(test.*log10_p)) tested.push_back(test.*log10_p);
  }
  const std::vector<double> adjusted = numerics::adjust_by_holm(tested);
  std::size_t next = 0;
  for (Test& test : tests) {
    if (std::isnan(test.*log10_p)) continue;
    test.departure.*p = std::pow(10.0, test.*log10_p);
    test.departure.*p_holm = adjusted[next++];
  }
}

}  // namespace

std::vector<Departure> find_departures(const Compared& compared,
                                       const JointCovariance& covariance) {
  const Index flights = compared.layout.flights;
  const bool testable = flights > 1 && !covariance.singular && covariance.joint.cols() > 0 &&
                        std::isfinite(covariance.ratio);
  std::vector<Test> tests;
  const Tester tester(compared, covariance);
  for (Index i = 0; i < flights; ++i) {
    tests.push_back(testable ? tester.run(i) : Test{tester.untested()});
  }
  adjust(tests, &Test::log10_p, &Departure::p, &Departure::p_holm);
  adjust(tests, &Test::log10_p_white, &Departure::p_white, &Departure::p_white_holm);
  std::vector<Departure> departures;
  for (Test& test : tests) departures.push_back(std::move(test.departure));
  return departures;
}

}  // namespace sepcal::many
