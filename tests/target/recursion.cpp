// SPDX-License-Identifier: BSD-3-Clause
// Recursive least squares over a flight: at a given xi2 the five linear parameters of a five-hole
// probe, about a nominal xi1, row by row as square-root information, and as both recursions of S
// 4.12, from a wide start. Out comes how many rows each refused, the triangle, and what each says
// of xi1.
#include "link.hpp"
#include "sepcal/core.hpp"

void fly() {
  using sepcal::FiveHoleProbe;
  using Scalar = SCALAR;
  const auto k = target::read_vector<double, 2>();
  const FiveHoleProbe probe{k[0], k[1]};
  const auto xi2 = target::read_vector<Scalar, 5>();
  const auto nominal = target::read_vector<Scalar, 5>();
  const auto noise = static_cast<Scalar>(target::read());
  const Eigen::Matrix<Scalar, 3, 3> W = noise * noise * Eigen::Matrix<Scalar, 3, 3>::Identity();
  using Matrix = Eigen::Matrix<Scalar, 5, 5>;
  const Matrix identity = Matrix::Identity();
  const sepcal::Vec<Scalar, 5> zero = sepcal::Vec<Scalar, 5>::Zero();
  sepcal::InformationRoot<5, Scalar> root;
  sepcal::InformationRecursion<5, Scalar> information(zero, Scalar(1e-6) * identity);
  sepcal::CovarianceRecursion<5, Scalar> covariance(zero, Scalar(1e6) * identity);
  target::Worst of_root;
  target::Worst of_recursion;
  int refused[3] = {0, 0, 0};
  for (int rows = target::read_count(); rows > 0; --rows) {
    auto u = target::read_vector<double, 14>();
    u[6] -= u[7];  // pressures as a difference, for float
    u[7] = 0;
    const auto z = target::read_vector<Scalar, 3>();
    const auto row = probe.at(sepcal::Vec<Scalar, 14>(u.cast<Scalar>()), xi2);
    const sepcal::Vec<Scalar, 3> rest = z - row.b - sepcal::states::product(row.A, nominal);
    refused[0] += of_root.of([&] { return root.absorb<3>(row.A, rest, W); }) ? 0 : 1;
    refused[1] += information.absorb<3>(row.A, rest, W) ? 0 : 1;
    refused[2] += of_recursion.of([&] { return covariance.absorb<3>(row.A, rest, W); }) ? 0 : 1;
  }
  for (const int rows : refused) target::write(rows);
  target::write_all(root.matrix());
  target::write_all(root.solution());
  target::write_all(information.solution());
  target::write_all(covariance.solution());
  target::write(of_root.most());
  target::write(of_recursion.most());
}
