// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_records.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "block_inputs.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"

namespace sepcal::test {

void add_outputs(Record& record, const BlockModel& model, const Eigen::VectorXd& xi1,
                 const Eigen::VectorXd& xi2, const Eigen::VectorXd& noise, Draws& draws) {
  const auto n_z = static_cast<Eigen::Index>(model.tables().outputs.size());
  const auto carry = model.new_carry();
  std::vector<std::vector<double>> outputs(static_cast<std::size_t>(n_z),
                                           std::vector<double>(record.length(), 0.0));
  for (const Segment& segment : record.segments()) {
    const BlockInputs inputs = block_inputs(model, record, segment.first);
    const Block block{inputs.pointers, segment.rows(), segment.first, true};
    const auto rows = static_cast<Eigen::Index>(segment.rows());
    Eigen::MatrixXd values(n_z * rows, xi1.size() + 1);
    model.evaluate(block, xi2.data(), nullptr, carry.get(), values);
    const Eigen::VectorXd z = values.leftCols(xi1.size()) * xi1 + values.rightCols<1>();
    for (Eigen::Index j = 0; j < n_z; ++j) {
      for (Eigen::Index row = 0; row < rows; ++row) {
        outputs[static_cast<std::size_t>(j)][segment.first + static_cast<std::size_t>(row)] =
            z[j * rows + row] + noise[j] * draws.normal();
      }
    }
  }
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    record.add(model.tables().outputs[j].name, outputs[j]);
  }
}

Simulated simulate_five_hole(std::size_t rows, double noise, std::uint64_t seed) {
  const FiveHoleProbe probe{4.5, 4.0, {0.35, -0.1, -0.02}};
  Simulated flight{"five-hole", block_model(probe), Eigen::VectorXd(5), Eigen::VectorXd(5), {}};
  flight.xi1 << 0.08, -0.7, 3.0, -2.0, 0.4;
  flight.xi2 << 0.1, 0.03, -0.12, -0.02, 0.05;
  Draws draws(seed);
  std::map<std::string, std::vector<double>> u;
  for (std::size_t k = 0; k < rows; ++k) {
    const double airspeed = draws.uniform(15, 30);
    const double pressure = 0.5 * 1.2 * airspeed * airspeed;
    u["roll"].push_back(draws.uniform(-0.8, 0.8));
    u["pitch"].push_back(draws.uniform(-0.3, 0.3));
    u["yaw"].push_back(draws.uniform(-3.1, 3.1));
    for (const char* rate : {"p", "q", "r"}) u[rate].push_back(draws.uniform(-0.5, 0.5));
    u["ps"].push_back(95000);
    u["pt"].push_back(95000 + pressure);
    u["dpa"].push_back(4.5 * pressure * draws.uniform(-0.1, 0.2));
    u["dpb"].push_back(4.0 * pressure * draws.uniform(-0.15, 0.15));
    u["rho"].push_back(draws.uniform(1.1, 1.2));
  }
  for (auto& [name, column] : u) flight.record.add(name, std::move(column));
  add_outputs(flight.record, *flight.model, flight.xi1, flight.xi2,
              noise * Eigen::Vector3d(0.1, 0.2, 0.3), draws);
  return flight;
}

Simulated simulate_magnetometer(std::size_t rows, double noise, std::uint64_t seed) {
  Simulated flight{
      "magnetometer", block_model(Magnetometer{}), Eigen::VectorXd(6), Eigen::VectorXd(6), {}};
  flight.xi1 << 0.05, -0.04, 0.1, 3.0, -5.0, 8.0;
  flight.xi2 << 0.02, -0.03, 0.04, 0.05, -0.02, 0.03;
  Draws draws(seed);
  std::vector<double> h[3];
  for (std::size_t k = 0; k < rows; ++k) {
    const Eigen::Vector3d field = 50.0 * draws.normal_matrix(3, 1).normalized();
    for (std::size_t i = 0; i < 3; ++i) h[i].push_back(field[static_cast<Eigen::Index>(i)]);
  }
  flight.record.add("hx", h[0]).add("hy", h[1]).add("hz", h[2]);
  add_outputs(flight.record, *flight.model, flight.xi1, flight.xi2,
              noise * Eigen::Vector3d(0.1, 0.2, 0.3), draws);
  return flight;
}

Simulated simulate_scalar_1(std::size_t rows, double noise, std::uint64_t seed) {
  Simulated wave{"scalar 1",
                 block_model(ScalarExample1{}),
                 Eigen::Vector2d(0.5, -0.3),
                 Eigen::VectorXd::Constant(1, 0.2),
                 {}};
  Draws draws(seed);
  wave.record.add("eta", draws.uniform_column(rows, -std::numbers::pi, std::numbers::pi));
  add_outputs(wave.record, *wave.model, wave.xi1, wave.xi2,
              Eigen::VectorXd::Constant(1, 0.1 * noise), draws);
  return wave;
}

Simulated simulate_scalar_2(std::size_t rows, double noise, std::uint64_t seed) {
  Simulated wave{"scalar 2",
                 block_model(ScalarExample2{}),
                 Eigen::Vector2d(0.5, -0.3),
                 Eigen::Vector2d(0.15, -0.25),
                 {}};
  Draws draws(seed);
  wave.record.add("eta", draws.uniform_column(rows, -std::numbers::pi, std::numbers::pi));
  add_outputs(wave.record, *wave.model, wave.xi1, wave.xi2,
              Eigen::VectorXd::Constant(1, 0.1 * noise), draws);
  return wave;
}

std::vector<Simulated> simulate_all(std::size_t rows, double noise) {
  std::vector<Simulated> all;
  all.push_back(simulate_scalar_1(rows, noise));
  all.push_back(simulate_scalar_2(rows, noise));
  all.push_back(simulate_five_hole(rows, noise));
  all.push_back(simulate_magnetometer(rows, noise));
  return all;
}

}  // namespace sepcal::test
