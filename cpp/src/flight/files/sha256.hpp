// SPDX-License-Identifier: BSD-3-Clause
// The SHA-256 of bytes that come in pieces (FIPS 180-4).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace sepcal::files {

class Sha256 {
 public:
  /// `portable` does without the processor's own rounds, where it has them.
  explicit Sha256(bool portable = false);

  void absorb(const char* bytes, std::size_t count);

  /// 64 lower-case hexadecimal digits of all that was absorbed. Ends the hash: call it once.
  std::string finish();

  static constexpr std::size_t block_size = 64;
  using State = std::array<std::uint32_t, 8>;

 private:
  void (*compress_)(State& state, const unsigned char* block, std::size_t count);
  State state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
               0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, block_size> rest_{};  // what doesn't fill a block yet
  std::size_t rest_size_ = 0;
  std::uint64_t byte_count_ = 0;
};

}  // namespace sepcal::files
