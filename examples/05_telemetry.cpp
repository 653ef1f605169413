// SPDX-License-Identifier: BSD-3-Clause
// The engine inside other software: a magnetometer calibrated from buffers that are there already,
// without a file and without a copy. Needs sepcal::sepcal alone. Exits 1 where the truth is missed.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <sepcal/sepcal.hpp>
#include <vector>

namespace {

/// In the order of the model's parameters: scale errors, hard iron [uT], misalignment [rad], and a
/// soft iron that isn't there.
constexpr std::array truth{0.04, -0.03, 0.02, 12.0, -7.0, 5.0, 0.03, -0.02, 0.04, 0.0, 0.0, 0.0};

/// What a vehicle keeps of its last turns: the true field in body axes and the readings [uT].
struct Telemetry {
  std::vector<double> hx, hy, hz;
  std::vector<double> mx, my, mz;
};

/// A field of 53 uT met from all over the sphere, read with 0.3 uT of noise: every axis scales its
/// own component, the triad is turned by the misalignment, hard iron adds to that.
Telemetry tumble(int rows, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution noise(0.0, 0.3);
  const Eigen::Map<const Eigen::Vector3d> lambda(&truth[0]);
  const Eigen::Map<const Eigen::Vector3d> hard_iron(&truth[3]);
  const Eigen::Map<const Eigen::Vector3d> eta(&truth[6]);
  Telemetry buffers;
  for (int i = 0; i < rows; ++i) {
    const double turn = 0.37 * i;
    const double tilt = 0.05 * i;
    const Eigen::Vector3d h = 53.0 * Eigen::Vector3d(std::cos(turn) * std::sin(tilt),
                                                     std::sin(turn) * std::sin(tilt),  //
                                                     std::cos(tilt));
    const Eigen::Vector3d scaled = h + lambda.cwiseProduct(h);
    const Eigen::Vector3d m = scaled + eta.cross(scaled) + hard_iron;
    buffers.hx.push_back(h.x());
    buffers.hy.push_back(h.y());
    buffers.hz.push_back(h.z());
    buffers.mx.push_back(m.x() + noise(generator));
    buffers.my.push_back(m.y() + noise(generator));
    buffers.mz.push_back(m.z() + noise(generator));
  }
  return buffers;
}

sepcal::Fit calibrate(const Telemetry& buffers) {
  sepcal::Record record;
  record.view("hx", buffers.hx).view("hy", buffers.hy).view("hz", buffers.hz);
  record.view("mx", buffers.mx).view("my", buffers.my).view("mz", buffers.mz);
  sepcal::FitOptions options;
  options.samples = 100;
  options.threads = 1;
  return sepcal::fit(sepcal::Magnetometer{}, record, options);
}

}  // namespace

int main() {
  const Telemetry buffers = tumble(400, 1);
  const sepcal::Fit fit = calibrate(buffers);
  bool found = fit.status == sepcal::FitStatus::converged;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const sepcal::Parameter& p = fit.parameters[k];
    std::printf("%-9s %9.5f +- %.5f %s\n", p.name.c_str(), p.value, p.standard_error,
                p.unit.c_str());
    found = found && std::abs(p.value - truth[k]) < 4.0 * p.standard_error;
  }
  return found ? 0 : 1;
}
