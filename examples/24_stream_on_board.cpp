// SPDX-License-Identifier: BSD-3-Clause
// On board: a two-stage start on the first rows, a piece of work a cycle, then an iterated filter
// row by row. No heap, no exceptions; float. Here the flight is made up as it goes.
#include <cmath>
#include <cstdio>
#include <sepcal/core.hpp>

#include "24_wind_box.hpp"

using namespace sepcal;

using Start = TwoStageStart<WindBox, 60, 3, float>;
using Form = InformationForm<Start::n, float>;

/// A row of a flight in circles: the truth, with half a metre per second of something on it.
struct Row {
  Vec<float, 2> u;
  Vec<float, 2> z;
};
Row fly(int k) {
  const float v = 20.0F + 2.0F * std::sin(0.31F * static_cast<float>(k));
  const float psi = 0.05F * static_cast<float>(k);
  const Vec<float, 2> noise(0.5F * std::sin(12.9898F * static_cast<float>(k)),
                            0.5F * std::sin(78.233F * static_cast<float>(k)));
  return {{v, psi},
          Vec<float, 2>(1.05F * v * std::cos(psi + 0.1F) + 2.0F,
                        1.05F * v * std::sin(psi + 0.1F) - 3.0F) +
              noise};
}

int main() {
  const Vec<float, 2> noise(0.5F, 0.5F);  // m/s
  static Start start(WindBox{}, noise);
  int k = 0;
  while (start.status() == StartStatus::collecting) {  // one row a cycle
    const Row row = fly(k++);
    start.add(row.u, row.z);
  }
  while (start.work() == StartStatus::working) ++k;  // eight rows of the start a cycle
  if (start.status() != StartStatus::done) return 1;
  std::printf("start: done after %d cycles\n", k);

  JointFilter<WindBox, Form> filter(
      {}, {start.parameters(), Form::of_information_root(start.information_root())});
  const Eigen::Matrix2f R = (start.noise_ratio() * noise).cwiseAbs2().asDiagonal();
  for (int end = k + 500; k < end; ++k) {
    const Row row = fly(k);
    if (filter.update_iterated(row.u, row.z, R).status != FilterStatus::ok) return 1;
  }
  const Eigen::Matrix4f P = filter.filter().covariance();
  for (int i = 0; i < Start::n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const std::string_view name = i < 3 ? WindBox::linear[at].name : WindBox::nonlinear[0].name;
    std::printf("%-8.*s %8.4f +- %.4f\n", static_cast<int>(name.size()), name.data(),
                static_cast<double>(filter.filter().x()[i]),
                static_cast<double>(std::sqrt(P(i, i))));
  }
}
