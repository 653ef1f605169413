// SPDX-License-Identifier: BSD-3-Clause
// Every choice is read back by its name.
#include "sepcal/detail/choices.hpp"

#include <doctest/doctest.h>

namespace choices_test {

using doctest::Contains;

TEST_CASE_TEMPLATE("a choice is found by its own name", T, sepcal::Search, sepcal::Sampling,
                   sepcal::SecondStage, sepcal::ProjectedJacobian, sepcal::Loss) {
  for (const std::string_view name : sepcal::ChoiceNames<T>::names) {
    CHECK(sepcal::to_string(sepcal::choice_of<T>("it", name)) == name);
  }
}

TEST_CASE("names stand at their enumerators") {
  CHECK(sepcal::to_string(sepcal::Search::global) == "global");
  CHECK(sepcal::to_string(sepcal::Sampling::low_discrepancy) == "low_discrepancy");
  CHECK(sepcal::to_string(sepcal::SecondStage::joint) == "joint");
  CHECK(sepcal::to_string(sepcal::SecondStage::projected) == "projected");
  CHECK(sepcal::to_string(sepcal::ProjectedJacobian::golub_pereyra) == "golub_pereyra");
  CHECK(sepcal::to_string(sepcal::Loss::huber) == "huber");
  CHECK(sepcal::to_string(sepcal::Loss::cauchy) == "cauchy");
}

TEST_CASE("an unknown name is refused with those there are") {
  CHECK_THROWS_WITH_AS(sepcal::choice_of<sepcal::Loss>("--loss", "tukey"),
                       Contains("--loss 'tukey' is unknown; known: 'squares', 'huber', 'cauchy'"),
                       sepcal::Error);
}

}  // namespace choices_test
