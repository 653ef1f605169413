// SPDX-License-Identifier: BSD-3-Clause
// Eigen and Ceres together on a five-hole flight.
#include "peers/five_hole.hpp"

#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

#include "peers/peers.hpp"

namespace benchmark {
namespace {

/// "50-by-hand-qr": 50 samples a block, derivatives by hand, DENSE_QR.
CeresWay way_of(const std::string& text) {
  return {std::atoi(text.c_str()), text.find("by-hand") != std::string::npos,
          text.find("-qr") != std::string::npos};
}

/// Samples and, from the best of them, the alternation: the two stages alone.
Answer fit(const FiveHoleFile& file, const CeresWay& way) {
  const auto rows = hoist(file);
  Answer x = sample_by_eigen(rows, file).best;
  alternate_by_ceres(rows, way, noise_at(rows, x), x);
  return x;
}

/// Samples, and descents from some of them with R = I: the lowest end.
Answer stage_one(const FiveHoleFile& file, const CeresWay& way) {
  const auto rows = hoist(file);
  const double one[3] = {1.0, 1.0, 1.0};
  Answer lowest;
  double least = std::numeric_limits<double>::infinity();
  for (Answer x : sample_by_eigen(rows, file).starts) {
    const double cost = solve_by_ceres(rows, way, one, x);
    if (cost >= least) continue;
    least = cost;
    lowest = x;
  }
  return lowest;
}

Answer known_noise(const FiveHoleFile& file, const CeresWay& way) {
  const auto rows = hoist(file);
  Answer x(file.start, file.start + parameters);
  solve_by_ceres(rows, way, file.noise, x);
  return x;
}

Answer stage_two(const FiveHoleFile& file, const CeresWay& way) {
  const auto rows = hoist(file);
  Answer x(file.start, file.start + parameters);
  alternate_by_ceres(rows, way, {file.start_noise[0], file.start_noise[1], file.start_noise[2]}, x);
  return x;
}

std::optional<Answer> run(const std::string& method, const FiveHoleFile& file) {
  const auto colon = method.find(':');
  const std::string what = method.substr(0, colon);
  const CeresWay way = way_of(colon == std::string::npos ? "50" : method.substr(colon + 1));
  if (what == "sampling") return sample_by_eigen(hoist(file), file).best;
  if (what == "known-noise") return known_noise(file, way);
  if (what == "stage-two") return stage_two(file, way);
  if (what == "fit") return fit(file, way);
  if (what == "fit-with-effects") return fit_with_effects(file);
  if (what == "stage-one") return stage_one(file, way);
  return {};
}

}  // namespace

bool run_five_hole_peers(const std::string& method, const std::vector<double>& numbers,
                         int repeats) {
  const FiveHoleFile file(numbers);
  bool known = true;
  report(repeats, [&] {
    auto answer = run(method, file);
    known = answer.has_value();
    return known ? *answer : Answer{};
  });
  return known;
}

}  // namespace benchmark
