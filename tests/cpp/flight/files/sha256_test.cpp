// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/sha256.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

namespace sepcal::files {
namespace {

std::string digest(const std::string& bytes, bool portable, std::size_t piece) {
  Sha256 hash(portable);
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    const std::string taken = bytes.substr(at, piece);
    hash.absorb(taken.data(), taken.size());
  }
  return hash.finish();
}

}  // namespace

TEST_CASE(
    "SHA-256 of NIST's examples, by the processor's rounds and without, in pieces of any size") {
  // FIPS 180-2, appendix B, and NIST's CAVP (the empty message).
  const std::vector<std::pair<std::string, std::string>> examples{
      {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
      {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
      {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
       "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
      {std::string(1000000, 'a'),
       "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"}};
  for (const auto& [bytes, expected] : examples) {
    for (const bool portable : {false, true}) {
      for (const std::size_t piece : {1UL, 55UL, 63UL, 64UL, 65UL, 1000UL}) {
        if (piece == 1 && bytes.size() > 1000) continue;
        CHECK(digest(bytes, portable, piece) == expected);
      }
    }
  }
}

TEST_CASE("SHA-256 with and without the processor's rounds, for every length around a block") {
  for (std::size_t size = 0; size < 200; ++size) {
    std::string bytes;
    for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>((i * 37 + size) % 251);
    CHECK(digest(bytes, false, 200) == digest(bytes, true, 7));
  }
}

}  // namespace sepcal::files
