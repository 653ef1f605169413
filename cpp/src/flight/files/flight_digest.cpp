// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/flight_digest.hpp"

#include <span>

#include "flight/files/sha256.hpp"

namespace sepcal::files {

std::string digest_of(const Flight& flight) {
  if (!flight.sha256().empty()) return flight.sha256();
  Sha256 hash;
  for (const Flight::Column& column : flight.columns()) {
    hash.absorb(column.header.data(), column.header.size());
    const auto bytes = std::as_bytes(column.values);
    hash.absorb(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return hash.finish();
}

}  // namespace sepcal::files
