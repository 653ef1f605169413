// SPDX-License-Identifier: BSD-3-Clause
// Records that are no start, one after another: of each how it ended, its calls and the most that
// there may be, trial steps, and the instructions of its worst call.
#include "calibrated.hpp"
#include "link.hpp"

void fly() {
  constexpr int rows = 10;
  const auto k = target::read_vector<double, 2>();
  for (int records = target::read_count(); records > 0; --records) {
    using Start = sepcal::TwoStageStart<sepcal::FiveHoleProbe, rows>;
    const sepcal::FiveHoleProbe probe{k[0], k[1]};
    Start start(probe, Start::Outputs::Constant(target::read()));
    for (int row = 0; row < rows; ++row) {
      const auto u = target::read_vector<double, 14>();
      start.add(u, target::read_vector<double, 3>());
    }
    start.seal();
    target::Worst worst;
    int calls = 1;
    while (worst.of([&] { return start.work(); }) == sepcal::StartStatus::working) ++calls;
    target::write(static_cast<double>(start.status()));
    target::write(calls);
    target::write(start.most_calls());
    target::write(start.worst_iterations());
    target::write(worst.most());
  }
}
