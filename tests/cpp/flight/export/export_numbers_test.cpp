// SPDX-License-Identifier: BSD-3-Clause
// Numbers and text of exported headers: the CRC's check value, code in float, drivers' origins.
#include <doctest/doctest.h>
#include <cmath>
#include <string>

#include "flight/export/crc32.hpp"
#include "flight/export/driver_origin.hpp"
#include "flight/export/single_precision.hpp"
#include "sepcal/error.hpp"

namespace export_numbers_test {

using namespace sepcal;
using namespace sepcal::exporting;

TEST_CASE("the CRC-32 has the check value of its catalogue, and absorbs piece by piece") {
  const std::string digits = "123456789";
  Crc32 crc;
  for (const char c : digits) {
    const auto byte = static_cast<unsigned char>(c);
    crc.absorb({&byte, 1});
  }
  CHECK(crc.value() == 0xCBF43926U);
  CHECK(Crc32().value() == 0U);
  Crc32 one;  // zlib.crc32(struct.pack("<d", 1.5)), zlib.crc32(struct.pack("<f", 1.5))
  one.absorb(1.5);
  CHECK(one.value() == 0x0F2199E1U);
  Crc32 half;
  half.absorb(1.5F);
  CHECK(half.value() == 0x5CD8256FU);
}

TEST_CASE("statements in double become statements in float, comments stay") {
  CHECK(in_single_precision("const double x = sqrt(2.0 * a1[0]) - 1e-9; /* double 2.0 */") ==
        "const float x = sqrtf(2.0f * a1[0]) - 1e-9f; /* double 2.0 */");
  CHECK(in_single_precision("double_in + x_2 >= 3 ? pow(d, 2.0 / 7.0) : 1e+20") ==
        "double_in + x_2 >= 3 ? powf(d, 2.0f / 7.0f) : 1e+20f");
  CHECK(in_single_precision("y[i] += 0.5;\n/* open") == "y[i] += 0.5f;\n/* open");
}

TEST_CASE("a number beyond a float is refused, others become the nearest one") {
  CHECK(to_single(0.1) == static_cast<double>(0.1F));
  CHECK_THROWS_AS(to_single(1e39), Error);
  CHECK_THROWS_AS(to_single(-3.5e38), Error);
}

TEST_CASE("a driver far from zero has an origin of few decimals within its range") {
  CHECK(origin_of({0.0, 1.0}) == 0.0);
  CHECK(origin_of({20.0, 28.0}) == 0.0);
  CHECK(origin_of({-8.0, 24.0}) == 0.0);
  CHECK(origin_of({1764000000.0, 1764001000.0}) == 1764000500.0);
  CHECK(origin_of({1013.2, 1016.2}) == 1015.0);
  CHECK(origin_of({-11034.0, -11009.0}) == -11020.0);
  CHECK(origin_of({0.90001, 0.90007}) == 0.90004);
  CHECK(origin_of({5.5, 5.5}) == 5.5);
}

TEST_CASE("an origin's powers are the binomial's") {
  const std::vector<double> c = powers_about(-3.0, 4);
  REQUIRE(c.size() == 5);
  for (const double d : {-2.0, 0.0, 0.5, 7.0}) {
    double sum = 0.0;
    for (std::size_t j = 0; j < c.size(); ++j) sum += c[j] * std::pow(d, static_cast<double>(j));
    CHECK(sum == doctest::Approx(std::pow(d - 3.0, 4)));
  }
  CHECK(horner("c", 0, 3, "d") == "c[0] + d * (c[1] + d * (c[2] + d * c[3]))");
  CHECK(horner("c", 1, 1, "d") == "c[1]");
}

}  // namespace export_numbers_test
