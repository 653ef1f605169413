// SPDX-License-Identifier: BSD-3-Clause
// A short period whose parameters jump in flight: the joint filter with the test of its innovations
// beside it, from a start that is given, in SCALAR.
#include "link.hpp"
#include "sepcal/core.hpp"

void fly() {
  using Scalar = SCALAR;
  using Form = sepcal::SquareRootForm<10, Scalar>;
  using Filter = sepcal::JointFilter<sepcal::ShortPeriod, Form>;
  using Row = sepcal::StateRow<sepcal::ShortPeriod, Scalar>;
  const auto s = target::read_vector<Scalar, 10>();
  const auto deviation = target::read_vector<Scalar, 10>();
  const auto density = target::read_vector<Scalar, 2>();
  const auto noise = target::read_vector<Scalar, 3>();
  static Filter filter({}, {s, Form::of_covariance_root(deviation.asDiagonal())});
  static sepcal::ChangeTest<10, 8, Scalar, 12> changes;
  const Eigen::Matrix<Scalar, 2, 2> Q = density.cwiseAbs2().asDiagonal();
  const Eigen::Matrix<Scalar, 3, 3> R = noise.cwiseAbs2().asDiagonal();
  target::Worst of_row;
  target::Worst of_plain_row;
  int refused = 0;
  int found = -1;
  sepcal::Jump<10, 8, Scalar> jump;
  Row row;
  const int rows = target::read_count();
  for (int k = 0; k < rows; ++k) {
    const Row last = row;
    row.time = static_cast<Scalar>(target::read());
    row.u = target::read_vector<Scalar, 2>();
    const auto z = target::read_vector<Scalar, 3>();
    static Filter plain = filter;
    plain = filter;
    of_plain_row.of([&] {
      if (k > 0) plain.predict(last, row, Q);
      return plain.update(row.u, z, R).status;
    });
    const auto status = of_row.of([&] {
      if (k > 0 && filter.predict(last, row, Q, {}, changes) != sepcal::FilterStatus::ok) ++refused;
      return filter.update(row.u, z, R, changes);
    });
    if (status != sepcal::ChangeStatus::changed) continue;
    if (found < 0) {
      jump = changes.jump();
      found = k;
    }
    filter.follow_change(changes);
  }
  target::write(refused);
  target::write(found);
  target::write(jump.rows);
  target::write_all(jump.size);
  target::write_all(jump.deviation);
  target::write_all(filter.filter().x());
  target::write_all(filter.filter().form().root());
  target::write(of_plain_row.most());
  target::write(of_row.most());
}
