// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/sha256.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <string_view>

#if defined(__x86_64__) && defined(__GNUC__)
#define SEPCAL_SHA_INSTRUCTIONS
#include <cpuid.h>
#include <immintrin.h>
#endif

namespace sepcal::files {
namespace {

using Word = std::uint32_t;
using State = Sha256::State;

// K_t of FIPS 180-4, 4.2.2: the first 32 bits of the fractions of the first 64 primes' cube roots.
alignas(16) constexpr std::array<Word, 64> round_constants{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

// FIPS 180-4, 6.2.2: `count` whole blocks.
void compress(State& state, const unsigned char* block, std::size_t count) {
  for (; count > 0; --count, block += Sha256::block_size) {
    std::array<Word, 64> w;
    for (std::size_t t = 0; t < 16; ++t) {
      const unsigned char* at = block + 4 * t;
      w[t] = Word{at[0]} << 24U | Word{at[1]} << 16U | Word{at[2]} << 8U | Word{at[3]};
    }
    for (std::size_t t = 16; t < 64; ++t) {
      const Word early = w[t - 15];
      const Word late = w[t - 2];
      w[t] = w[t - 16] + (std::rotr(early, 7) ^ std::rotr(early, 18) ^ (early >> 3U)) + w[t - 7] +
             (std::rotr(late, 17) ^ std::rotr(late, 19) ^ (late >> 10U));
    }
    auto [a, b, c, d, e, f, g, h] = state;
    for (std::size_t t = 0; t < 64; ++t) {
      const Word first = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                         ((e & f) ^ (~e & g)) + round_constants[t] + w[t];
      const Word second =
          (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
      h = g;
      g = f;
      f = e;
      e = d + first;
      d = c;
      c = b;
      b = a;
      a = first + second;
    }
    const State after{a, b, c, d, e, f, g, h};
    std::transform(state.begin(), state.end(), after.begin(), state.begin(), std::plus<>());
  }
}

#ifdef SEPCAL_SHA_INSTRUCTIONS
// The same with the processor's own rounds: ten times as fast, and a log is hashed as it is read.
// The instructions keep the state as words a, b, e, f and c, d, g, h, the first one on top.
__attribute__((target("sha,sse4.1"))) void compress_by_instructions(State& state,
                                                                    const unsigned char* block,
                                                                    std::size_t count) {
  const auto load = [](const void* from) __attribute__((target("sha,sse4.1"))) {
    return _mm_loadu_si128(static_cast<const __m128i*>(from));
  };
  const __m128i big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  const __m128i cdab = _mm_shuffle_epi32(load(state.data()), 0xb1);
  const __m128i hgfe = _mm_shuffle_epi32(load(state.data() + 4), 0x1b);
  __m128i abef = _mm_alignr_epi8(cdab, hgfe, 8);
  __m128i cdgh = _mm_blend_epi16(hgfe, cdab, 0xf0);
  for (; count > 0; --count, block += Sha256::block_size) {
    const __m128i abef_before = abef;
    const __m128i cdgh_before = cdgh;
    __m128i w[4];  // NOLINT(modernize-avoid-c-arrays): std::array<__m128i> loses its alignment
    for (std::size_t i = 0; i < 4; ++i) {
      w[i] = _mm_shuffle_epi8(load(block + 16 * i), big_endian);
    }
#pragma GCC unroll 16
    for (std::size_t four = 0; four < 16; ++four) {
      __m128i& now = w[four % 4];
      const __m128i sum = _mm_add_epi32(now, load(round_constants.data() + 4 * four));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0e));
      if (four < 12) {  // these words of the schedule make place for those 16 later
        const __m128i& last = w[(four + 3) % 4];
        now = _mm_sha256msg1_epu32(now, w[(four + 1) % 4]);
        now = _mm_add_epi32(now, _mm_alignr_epi8(last, w[(four + 2) % 4], 4));
        now = _mm_sha256msg2_epu32(now, last);
      }
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }
  const __m128i feba = _mm_shuffle_epi32(abef, 0x1b);
  const __m128i dchg = _mm_shuffle_epi32(cdgh, 0xb1);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data()), _mm_blend_epi16(feba, dchg, 0xf0));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data() + 4), _mm_alignr_epi8(dchg, feba, 8));
}

bool has_sha_instructions() {
  unsigned int a = 0;
  unsigned int b = 0;
  unsigned int c = 0;
  unsigned int d = 0;
  const bool sse41 = __get_cpuid(1, &a, &b, &c, &d) != 0 && (c & unsigned{bit_SSE4_1}) != 0;
  return sse41 && __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (b & unsigned{bit_SHA}) != 0;
}

#endif

}  // namespace

Sha256::Sha256([[maybe_unused]] bool portable) : compress_(compress) {
#ifdef SEPCAL_SHA_INSTRUCTIONS
  static const bool instructions = has_sha_instructions();
  if (instructions && !portable) compress_ = compress_by_instructions;
#endif
}

void Sha256::absorb(const char* bytes, std::size_t count) {
  byte_count_ += count;
  if (rest_size_ > 0) {
    const std::size_t taken = std::min(count, block_size - rest_size_);
    std::copy_n(bytes, taken, rest_.begin() + static_cast<std::ptrdiff_t>(rest_size_));
    rest_size_ += taken;
    bytes += taken;
    count -= taken;
    if (rest_size_ < block_size) return;
    compress_(state_, rest_.data(), 1);
  }
  const std::size_t whole = count / block_size;
  compress_(state_, reinterpret_cast<const unsigned char*>(bytes), whole);
  rest_size_ = count % block_size;
  std::copy_n(bytes + whole * block_size, rest_size_, rest_.begin());
}

std::string Sha256::finish() {
  // A bit 1, zeros up to the last eight bytes of a block, and there the number of bits (5.1.1).
  const std::uint64_t bits = 8 * byte_count_;
  std::string padding(1 + (2 * block_size - 9 - rest_size_) % block_size, '\0');
  padding[0] = '\x80';
  for (unsigned int shift = 64; shift > 0; shift -= 8) {
    padding += static_cast<char>(static_cast<unsigned char>(bits >> (shift - 8)));
  }
  absorb(padding.data(), padding.size());
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const Word word : state_) {
    for (unsigned int shift = 32; shift > 0; shift -= 4)
      text += digits[(word >> (shift - 4)) & 15U];
  }
  return text;
}

}  // namespace sepcal::files
