// SPDX-License-Identifier: BSD-3-Clause
// Records that a model itself made, z = A xi1 + b + noise, with the truth beside them: one for each
// of the four models that the tests fit.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "draws.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/record.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal::test {

struct Simulated {
  std::string name;
  std::shared_ptr<const BlockModel> model;
  Eigen::VectorXd xi1;  // the truth
  Eigen::VectorXd xi2;
  Record record;
};

/// Adds the model's outputs to `record`, output j with noise of standard deviation noise[j]; zeros
/// outside its segments.
void add_outputs(Record& record, const BlockModel& model, const Eigen::VectorXd& xi1,
                 const Eigen::VectorXd& xi2, const Eigen::VectorXd& noise, Draws& draws);

/// A probe that circles, climbs and slips; noise of 0.1, 0.2, 0.3 m/s times `noise`.
Simulated simulate_five_hole(std::size_t rows, double noise = 1.0, std::uint64_t seed = 1);

/// A magnetometer turned every way in a field of 50 uT; noise of 0.1, 0.2, 0.3 uT times `noise`.
Simulated simulate_magnetometer(std::size_t rows, double noise = 1.0, std::uint64_t seed = 2);

/// Scalar example 1 over one turn of eta, noise of 0.1 times `noise`.
Simulated simulate_scalar_1(std::size_t rows, double noise = 1.0, std::uint64_t seed = 3);

/// Scalar example 2, the same way.
Simulated simulate_scalar_2(std::size_t rows, double noise = 1.0, std::uint64_t seed = 4);

std::vector<Simulated> simulate_all(std::size_t rows, double noise = 1.0);

}  // namespace sepcal::test
