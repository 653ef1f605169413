// SPDX-License-Identifier: BSD-3-Clause
// What one core can do: multiplications and additions a second by instruction set, and bytes a
// second from and to memory.
#include <algorithm>
#include <array>

#include "benchmark.hpp"
#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace benchmark {
namespace {

constexpr int chains = 12;  // of dependent operations: enough for two units of latency four
constexpr int steps = 2'000'000;

/// The smallest seconds of a few runs.
template <class Run>
double fastest(const Run& run) {
  double least = 1e300;
  for (int i = 0; i < 5; ++i) {
    const double begin = thread_seconds();
    run();
    least = std::min(least, thread_seconds() - begin);
  }
  return least;
}

volatile double sink;  // what is computed is used

/// `width` lanes in each of the chains, two operations a step.
double operations_per_second(int width, double (*run)()) {
  return 2.0 * width * chains * steps / fastest([run] { sink = run(); });
}

#ifdef __x86_64__
double run_baseline() {
  __m128d sums[chains];
  for (__m128d& sum : sums) sum = _mm_setzero_pd();
  const __m128d a = _mm_set1_pd(0.999999);
  const __m128d b = _mm_set1_pd(1e-6);
  for (int i = 0; i < steps; ++i) {
    for (__m128d& sum : sums) sum = _mm_add_pd(_mm_mul_pd(sum, a), b);
  }
  double total = 0.0;
  for (const __m128d& sum : sums) total += _mm_cvtsd_f64(sum);
  return total;
}

__attribute__((target("avx2,fma"))) double run_avx2() {
  __m256d sums[chains];
  for (__m256d& sum : sums) sum = _mm256_setzero_pd();
  const __m256d a = _mm256_set1_pd(0.999999);
  const __m256d b = _mm256_set1_pd(1e-6);
  for (int i = 0; i < steps; ++i) {
    for (__m256d& sum : sums) sum = _mm256_fmadd_pd(sum, a, b);
  }
  double total = 0.0;
  for (const __m256d& sum : sums) total += _mm256_cvtsd_f64(sum);
  return total;
}

__attribute__((target("avx512f"))) double run_avx512() {
  __m512d sums[chains];
  for (__m512d& sum : sums) sum = _mm512_setzero_pd();
  const __m512d a = _mm512_set1_pd(0.999999);
  const __m512d b = _mm512_set1_pd(1e-6);
  for (int i = 0; i < steps; ++i) {
    for (__m512d& sum : sums) sum = _mm512_fmadd_pd(sum, a, b);
  }
  double total = 0.0;
  for (const __m512d& sum : sums) total += _mm512_cvtsd_f64(sum);
  return total;
}

/// Baseline, AVX2, AVX-512; zero where the processor lacks it.
Answer peaks() {
  return {operations_per_second(2, run_baseline),
          __builtin_cpu_supports("avx2") ? operations_per_second(4, run_avx2) : 0.0,
          __builtin_cpu_supports("avx512f") ? operations_per_second(8, run_avx512) : 0.0};
}
#else
double run_baseline() {
  using Pair = double __attribute__((vector_size(16)));
  Pair sums[chains]{};
  const Pair a{0.999999, 0.999999};
  const Pair b{1e-6, 1e-6};
  for (int i = 0; i < steps; ++i) {
    for (Pair& sum : sums) sum = sum * a + b;
  }
  double total = 0.0;
  for (const Pair& sum : sums) total += sum[0];
  return total;
}

Answer peaks() { return {operations_per_second(2, run_baseline), 0.0, 0.0}; }
#endif

/// Bytes a second of a sum over a long array, and of a[i] = b[i] + c d[i].
Answer bandwidths() {
  constexpr std::size_t n = 20'000'000;
  std::vector<double> a(n, 1.0);
  const std::vector<double> b(n, 2.0);
  const std::vector<double> d(n, 3.0);
  const double reading = fastest([&] {
    std::array<double, 16> sums{};
    for (std::size_t i = 0; i < n; i += sums.size()) {
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += b[i + k];
    }
    sink = sums[0] + sums[7];
  });
  const double triad = fastest([&] {
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 0.5 * d[i];
    sink = a[n / 2];
  });
  const double bytes = static_cast<double>(n * sizeof(double));
  return {bytes / reading, 3.0 * bytes / triad};
}

}  // namespace

bool run_limits(const std::string& method, const std::vector<double>& /*numbers*/, int repeats) {
  if (method != "core") return false;
  report(repeats, [] {
    Answer answer = peaks();
    const Answer memory = bandwidths();
    answer.insert(answer.end(), memory.begin(), memory.end());
    return answer;
  });
  return true;
}

}  // namespace benchmark
