// SPDX-License-Identifier: BSD-3-Clause
// Calibrations and truth files, whatever they hold. What parses is written, parses again and is
// written as the same text; and a calibration is put to use on a short log, as `apply` and
// `compare` do first.
#include "flight/verbs/prepared_flight.hpp"
#include "fuzzing.hpp"
#include "sepcal/detail/simulation/truth.hpp"
#include "sepcal/flight/apply.hpp"
#include "small_flights.hpp"

namespace sepcal::fuzz {
namespace {

constexpr const char* source = "fuzzed.json";

/// The result of `parse`, unless it refuses; then written and parsed to the same text for ever.
template <class Parse>
auto parse_twice(const Parse& parse, std::string_view bytes) {
  std::optional<decltype(parse(bytes))> parsed;
  if (!accepts([&] { parsed = parse(bytes); })) return parsed;
  const std::string text = to_json(*parsed);
  require(is_utf8(text), "what is written is UTF-8");
  std::string again;
  require(accepts([&] { again = to_json(parse(text)); }), "what was written parses");
  require(again == text, "what was written parses to the same");
  return parsed;
}

void use(const Calibration& calibration) {
  const Flight& flight = flight_for(*calibration.probe);
  accepts([&] {
    for (const CorrectedColumn& column : apply(calibration, flight)) {
      require(column.values.size() == flight_rows, "a corrected column has the flight's rows");
    }
  });
  accepts([&] {
    const EffectiveFlight prepared =
        verbs::with_effects_of(calibration, verbs::prepare(calibration, flight));
    require(prepared.prepared.record.length() <= flight_rows, "effects add no rows");
  });
}

}  // namespace
}  // namespace sepcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sepcal;
  using namespace sepcal::fuzz;
  const std::string_view bytes = text_of(data, size);
  const auto calibration =
      parse_twice([](std::string_view text) { return parse_calibration(text, source); }, bytes);
  if (calibration) use(*calibration);
  parse_twice([](std::string_view text) { return parse_five_hole_truth(text, source); }, bytes);
  parse_twice([](std::string_view text) { return parse_pitot_static_truth(text, source); }, bytes);
  parse_twice([](std::string_view text) { return parse_magnetometer_truth(text, source); }, bytes);
  return 0;
}
