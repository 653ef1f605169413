// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/crc32.hpp"

#include <array>
#include <bit>

namespace sepcal::exporting {
namespace {

template <class Bits>
auto bytes_of(Bits bits) {
  std::array<unsigned char, sizeof(Bits)> bytes{};
  for (unsigned char& byte : bytes) {
    byte = static_cast<unsigned char>(bits & 0xFFU);
    bits >>= 8U;
  }
  return bytes;
}

}  // namespace

void Crc32::absorb(std::span<const unsigned char> bytes) {
  constexpr std::uint32_t polynomial = 0xEDB88320U;
  for (const unsigned char byte : bytes) {
    state_ ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      state_ = (state_ >> 1U) ^ ((state_ & 1U) != 0U ? polynomial : 0U);
    }
  }
}

void Crc32::absorb(double value) { absorb(bytes_of(std::bit_cast<std::uint64_t>(value))); }

void Crc32::absorb(float value) { absorb(bytes_of(std::bit_cast<std::uint32_t>(value))); }

}  // namespace sepcal::exporting
