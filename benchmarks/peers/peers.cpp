// SPDX-License-Identifier: BSD-3-Clause
// sepcal_benchmark_peers_* METHOD FILE REPEATS: Eigen and Ceres on the five-hole flight in FILE;
// prints seconds and answer. It knows nothing of sepcal, so that it may be compiled with any flags.
#include "peers/peers.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <string>

namespace {

using namespace benchmark;

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

/// Samples, and descents from the deepest `descents` of them with R = I.
Answer stage_one(const FiveHoleFile& file, const CeresWay& way, std::size_t descents) {
  const auto rows = hoist(file);
  const Sampled sampled = sample_by_eigen(rows, file);
  std::vector<std::size_t> order(sampled.squares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t s) { return sampled.squares[s]; });
  const double one[3] = {1.0, 1.0, 1.0};
  Answer first;
  for (std::size_t k = 0; k < std::min(descents, order.size()); ++k) {
    const double* xi2 = file.points + order[k] * nonlinear;
    const auto xi1 = linear_estimate(rows, xi2);
    Answer x(xi1.begin(), xi1.end());
    x.insert(x.end(), xi2, xi2 + nonlinear);
    solve_by_ceres(rows, way, one, x);
    if (k == 0) first = x;
  }
  return first;
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
  constexpr std::string_view descents = "stage-one-";  // and how many
  if (what.starts_with(descents)) {
    return stage_one(file, way, std::stoul(what.substr(descents.size())));
  }
  return {};
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) {
    std::fprintf(stderr, "usage: %s METHOD FILE REPEATS\n", arguments[0]);
    return 2;
  }
  const std::string method = arguments[1];
  const std::vector<double> numbers = read_doubles(arguments[2]);
  const FiveHoleFile file(numbers);
  bool known = true;
  report(std::atoi(arguments[3]), [&] {
    auto answer = run(method, file);
    known = answer.has_value();
    return known ? *answer : Answer{};
  });
  if (!known) std::fprintf(stderr, "%s: no method '%s'\n", arguments[0], method.c_str());
  return known ? 0 : 2;
}
