// SPDX-License-Identifier: BSD-3-Clause
// Filter and smoother along a record in which every sample has its own transition.
#include "sepcal/states/smoother.hpp"

#include "benchmark.hpp"
#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/states/filter.hpp"

namespace benchmark {
namespace {

constexpr int n = 4;
constexpr int m = 2;
using State = Eigen::Vector<double, n>;
using Square = Eigen::Matrix<double, n, n, Eigen::RowMajor>;
using Outputs = Eigen::Matrix<double, m, n, Eigen::RowMajor>;
using Noise = Eigen::Matrix<double, m, m, Eigen::RowMajor>;
using Reading = Eigen::Vector<double, m>;

struct Sample {
  Eigen::Matrix<double, n, n> Phi;
  Eigen::Matrix<double, n, n> Q;
  Reading y;
};

struct Problem {
  State x;
  Eigen::Matrix<double, n, n> P;
  Eigen::Matrix<double, m, n> C;
  Eigen::Matrix<double, m, m> R;
  std::vector<Sample> samples;

  explicit Problem(const std::vector<double>& numbers) {
    const double* at = numbers.data();
    const auto read = [&at]<class Matrix>(Matrix matrix) {
      matrix = Eigen::Map<const Matrix>(at);
      at += matrix.size();
      return matrix;
    };
    x = read(State());
    P = read(Square());
    C = read(Outputs());
    R = read(Noise());
    while (at < numbers.data() + numbers.size()) {
      Sample sample;
      sample.Phi = read(Square());
      sample.Q = read(Square());
      sample.y = read(Reading());
      samples.push_back(sample);
    }
  }
};

template <class Form>
Answer smooth(const Problem& problem) {
  const std::size_t count = problem.samples.size();
  std::vector<sepcal::Stage<n>> pass(count);
  std::vector<sepcal::Smoothed<n>> smoothed(count);
  sepcal::Filter<n, Form> filter(problem.x, problem.P);
  const sepcal::LinearOutputs<m, n> outputs{problem.C};
  for (std::size_t k = 0; k < count; ++k) {
    const Sample& sample = problem.samples[k];
    filter.update(sample.y, outputs.at(filter.x(), Reading::Zero().eval()), problem.R);
    const sepcal::LinearDynamics<n> step{sample.Phi, Eigen::Matrix<double, n, n>::Identity(),
                                         sample.Q};
    pass[k] = {filter.estimate(), step.from(filter.x(), State::Zero())};
    filter.predict(pass[k].next);
  }
  sepcal::smooth(pass, smoothed);
  Answer answer;
  for (const auto& one : smoothed) answer.insert(answer.end(), one.x.begin(), one.x.end());
  return answer;
}

}  // namespace

bool run_smoother(const std::string& method, const std::vector<double>& numbers, int repeats) {
  const Problem problem(numbers);
  if (method == "square-root") {
    report(repeats, [&] { return smooth<sepcal::SquareRootForm<n>>(problem); });
  } else if (method == "joseph") {
    report(repeats, [&] { return smooth<sepcal::JosephForm<n>>(problem); });
  } else {
    return false;
  }
  return true;
}

}  // namespace benchmark
