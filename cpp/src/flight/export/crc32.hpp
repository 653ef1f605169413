// SPDX-License-Identifier: BSD-3-Clause
// The CRC-32 of IEEE 802.3, as zlib's crc32() computes it: polynomial 0xEDB88320, bits reversed.
#pragma once

#include <cstdint>
#include <span>

namespace sepcal::exporting {

class Crc32 {
 public:
  void absorb(std::span<const unsigned char> bytes);

  /// The eight bytes of a double, the lowest first; of a float its four.
  void absorb(double value);
  void absorb(float value);

  std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

}  // namespace sepcal::exporting
