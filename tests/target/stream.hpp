// SPDX-License-Identifier: BSD-3-Clause
// A flight as a vehicle meets it: the first rows are kept, the two-stage start works on them a
// piece a call, and from its triangle an iterated filter goes on through the rest.
#pragma once

#include "link.hpp"
#include "sepcal/core.hpp"

namespace target {

/// Reads the noise (n_z) and the rows; writes how the start ended, its calls and iterations, xi, R,
/// then the filter's xi and R, how many rows it refused, and the worst counts of instructions.
template <class Scalar, int Rows, class M>
void stream(const M& model) {
  using Start = sepcal::TwoStageStart<M, Rows, 3, Scalar>;
  using Form = sepcal::InformationForm<Start::n, Scalar>;
  const auto noise = read_vector<Scalar, Start::n_z>();
  static Start start(model, noise);
  int rows = read_count();
  for (; rows > 0 && start.status() == sepcal::StartStatus::collecting; --rows) {
    const auto u = read_vector<Scalar, Start::n_u>();
    start.add(u, read_vector<Scalar, Start::n_z>());
  }
  Worst of_start;
  int calls = 1;
  while (of_start.of([&] { return start.work(); }) == sepcal::StartStatus::working) ++calls;
  write(static_cast<double>(start.status()));
  write(calls);
  write(start.most_calls());
  write(start.worst_iterations());
  write_all(start.parameters());
  write_all(start.information_root());

  sepcal::JointFilter<M, Form> filter(
      model, {start.parameters(), Form::of_information_root(start.information_root())});
  const Scalar s = start.noise_ratio();
  const Eigen::Matrix<Scalar, Start::n_z, Start::n_z> R = (s * noise).cwiseAbs2().asDiagonal();
  Worst of_update;
  int refused = 0;
  for (; rows > 0; --rows) {
    const auto u = read_vector<Scalar, Start::n_u>();
    const auto z = read_vector<Scalar, Start::n_z>();
    const auto innovation = of_update.of([&] { return filter.update_iterated(u, z, R); });
    refused += innovation.status == sepcal::FilterStatus::refused ? 1 : 0;
  }
  write_all(filter.filter().x());
  write_all(filter.filter().form().information_root());
  write(refused);
  write(of_start.most());
  write(of_update.most());
}

}  // namespace target
