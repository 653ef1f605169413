// SPDX-License-Identifier: BSD-3-Clause
// Pages and JSON of results whose flights, channels, labels, messages and files have hostile names,
// beside the same with plain ones: as many lines, nothing that steers a terminal, and JSON that
// gives the very names back.
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "hostile_words.hpp"
#include "sepcal/flight/aircraft.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/intervals.hpp"
#include "sepcal/flight/stepwise.hpp"
#include "simulated_calibrations.hpp"

namespace sepcal::fuzz {
namespace {

/// Words to put into names, the hostile ones or the plain ones of as many bytes. A mark at the end
/// keeps sepcal from reading a unit out of them, and names apart from one another.
class Words {
 public:
  explicit Words(Hostile& hostile) {
    constexpr int count = 8;
    for (int i = 0; i < count; ++i) words_.push_back(hostile.word());
  }
  Words plain() const {
    Words other = *this;
    for (std::string& word : other.words_) word = plain_of(word);
    other.next_ = 0;
    return other;
  }

  std::string next() {
    const std::size_t at = next_++ % words_.size();
    return words_[at] + "~" + std::to_string(at);
  }
  void join(std::string& name) { name += next(); }
  void join(std::vector<std::string>& names) {
    for (std::string& name : names) join(name);
  }

 private:
  std::vector<std::string> words_;
  std::size_t next_ = 0;
};

/// What is shown of a result: pages, its JSON, and names that the JSON must give back.
struct Shown {
  std::vector<std::string> pages;
  std::vector<std::string> json;
  std::vector<std::string> names;
};

template <class Result>
Shown show(const Result& result, std::vector<std::string> names) {
  return {{to_text(result, Detail::brief), to_text(result, Detail::explained)},
          {to_json(result)},
          std::move(names)};
}

const Fitted& magnetic() {
  static const Fitted fitted = fit_with(magnetometer_probe(std::array{19.7, -1.4, 49.4}),
                                        magnetic_record(), {"bias[c1]", "bias[current_a*c2]"});
  return fitted;
}
const Fitted& tube() {
  static const Fitted fitted =
      fit_with(pitot_static_probe(), tube_record(), {"airspeed_scale[c2]"});
  return fitted;
}

/// Its columns c1 and c2, its labels and its own name are `words`.
Flight named(const Fitted& fitted, Words& words, std::string& first, std::string& second) {
  first = words.next();
  second = words.next();
  const Flight columns = renamed(fitted.flight, first, second);
  Flight flight(words.next());
  for (const Flight::Column& column : columns.columns()) flight.view(column.header, column.values);
  const std::array labels{words.next(), words.next(), words.next()};
  std::vector<std::string> each(columns.rows());
  for (std::size_t row = 0; row < each.size(); ++row) {
    each[row] = labels.at(row * labels.size() / each.size());
  }
  flight.label(std::move(each));
  return flight;
}

Calibration spoilt(const Fitted& fitted, Words& words) {
  const std::string first = words.next();
  Calibration calibration = renamed(fitted.calibration, first, words.next());
  words.join(calibration.flight.file);
  words.join(calibration.file);
  calibration.fit.message += "; " + words.next();
  calibration.fit.status = FitStatus::not_identifiable;
  calibration.history.push_back({words.next(), 2.0, 1.0});
  calibration.departures.push_back({words.next(), 1e-9, words.next(), 1.0, 0.1});
  calibration.notes.push_back(words.next());
  for (Restatement& one : calibration.restated) words.join(one.sentence);
  calibration.fit.identifiability.unobservable.push_back({{words.next()}, words.next(), 1.0});
  calibration.fit.stage_one.flat_directions.push_back(words.next());
  calibration.fit.parameters.front().at_bound = true;
  return calibration;
}

void spoil(FlightDiagnosis& diagnosis, Words& words) {
  words.join(diagnosis.calibration);
  words.join(diagnosis.flight.file);
  diagnosis.message += "; " + words.next();
  words.join(diagnosis.sentences);
  for (Misfit& misfit : diagnosis.where) words.join(misfit.segment);
  diagnosis.missing_channels.push_back(words.next());
  diagnosis.notes.push_back(words.next());
  Diagnosis& found = diagnosis.diagnosis;
  for (EffectFinding& effect : found.effects) {
    const std::string word = words.next();
    effect.name += word;
    words.join(effect.drivers);
    for (Coefficient& one : effect.coefficients) one.name = effect.name + ".x";
  }
  found.pairs.push_back(words.next());
  found.advice.withheld.push_back(words.next());
  found.left_undone.push_back(words.next());
  found.unmeasured.push_back({.outputs = {words.next(), words.next()}});
  found.omnibus.significant = true;
  found.omnibus.windows.emplace_back(words.next(), 3.0);
  for (DetectionLimit& limit : found.limits) words.join(limit.port);
  diagnosis.injection = Injection{.effect = words.next(), .sizes = {1.0}, .found = true, .rank = 1};
}

/// As the catalogue's effects of a short flight have it, once with something found.
FlightDiagnosis diagnosed(bool is_found) {
  static const FlightDiagnosis plain = [] {
    DiagnosisOptions options;
    options.threads = 1;
    options.simulations = 2;
    options.only = {"bias[throttle]", "bias[voltage_v]", "scale[temp_degc]"};
    return diagnose(magnetic().calibration, magnetic().flight, {}, options);
  }();
  FlightDiagnosis diagnosis = plain;
  if (!is_found) return diagnosis;
  diagnosis.diagnosis.verdict = Verdict::effect_missing;
  diagnosis.diagnosis.effects.front().status = FindingStatus::found;
  diagnosis.diagnosis.advice.effect = diagnosis.diagnosis.effects.front().name;
  if (diagnosis.sentences.empty()) diagnosis.sentences.emplace_back("a sentence");
  return diagnosis;
}

Shown show_check(const Fitted& fitted, Words& words) {
  std::string first, second;
  const Flight flight = named(fitted, words, first, second);
  const FlightCheck result = check(*fitted.calibration.probe, flight);
  std::vector<std::string> pages = brief_notes(result);
  for (const std::string& note : pages) check_message(note);
  pages.push_back(to_text(result));
  return {pages, {to_json(result)}, {first, second, flight.name()}};
}

Shown show_comparison(const Fitted& fitted, Words& words) {
  std::string first, second;
  const Flight flight = named(fitted, words, first, second);
  Calibration calibration = renamed(fitted.calibration, first, second);
  calibration.fit.message = "first; " + words.next();
  const Comparison result = compare(calibration, flight);
  std::vector<std::string> names{first, flight.name(), calibration.fit.message};
  names.insert(names.end(), flight.maneuvers().begin(), flight.maneuvers().end());
  return show(result, names);
}

Shown show_calibration(const Fitted& fitted, Words& words) {
  const Calibration calibration = spoilt(fitted, words);
  Shown shown = show(calibration, {calibration.flight.file, calibration.fit.message,
                                   calibration.history.back().effect});
  shown.pages.push_back(to_text(calibration.fit, calibration.options));
  Applied applied{.output = words.next(), .rows = 3, .rows_left_empty = 1};
  applied.headers = {words.next(), words.next()};
  shown.pages.push_back(to_text(applied, calibration));
  shown.json.push_back(to_json(applied, calibration));
  return shown;
}

Shown show_diagnosis(bool is_found, Words& words) {
  FlightDiagnosis diagnosis = diagnosed(is_found);
  spoil(diagnosis, words);
  return show(diagnosis,
              {diagnosis.flight.file, diagnosis.message, diagnosis.diagnosis.effects.front().name});
}

Shown show_intervals(Words& words) {
  FlightIntervals intervals{.model = "magnetometer"};
  intervals.flight.file = words.next();
  intervals.message = "first; " + words.next();
  intervals.at_bound = {words.next()};
  for (int i = 0; i < 3; ++i) {
    intervals.parameters.push_back({.name = words.next(), .unit = "uT", .message = words.next()});
  }
  Shown shown = show(intervals, {intervals.flight.file, intervals.parameters[1].name});
  shown.pages.push_back(to_text(intervals.parameters, 0.9));
  shown.json.push_back(to_json(intervals.parameters, 0.9));
  return shown;
}

Shown show_stepwise(Words& words) {
  StepwiseCalibration result{spoilt(tube(), words), {}};
  result.course.reason = words.next();
  result.course.last = diagnosed(true);
  spoil(result.course.last, words);
  StepwiseStep step{.promised = result.course.last.diagnosis.effects.front(),
                    .rmse_before = 2.0,
                    .rmse_after = 1.0};
  step.as_good = {words.next()};
  step.dropped = {words.next(), words.next()};
  result.course.steps.push_back(step);
  Shown shown = show(result, {result.course.reason, result.calibration.flight.file});
  shown.pages.push_back(to_text(result.course));
  return shown;
}

Shown show_aircraft(Words& words) {
  AircraftFit fitted;
  fitted.fit = spoilt(magnetic(), words).fit;
  fitted.flight.file = words.next();
  fitted.file = words.next();
  fitted.warning = words.next();
  fitted.notes = {words.next()};
  const std::vector<OutputValue> rmse{{words.next(), 1.0}};
  fitted.history.push_back({words.next(), rmse, rmse, 0.3});
  fitted.initial_states = {words.next()};
  Shown shown = show(fitted, {fitted.flight.file, fitted.fit.message});
  shown.pages.push_back(to_text(TwoStepFit{.path = fitted, .aero = fitted}));
  Applied applied{.output = words.next(), .rows = 3, .headers = {words.next()}};
  shown.pages.push_back(to_text(applied, fitted));
  shown.json.push_back(to_json(applied, fitted));
  return shown;
}

const std::vector<std::function<Shown(Words&)>>& results() {
  static const std::vector<std::function<Shown(Words&)>> all{
      [](Words& words) { return show_check(magnetic(), words); },
      [](Words& words) { return show_check(tube(), words); },
      [](Words& words) { return show_comparison(magnetic(), words); },
      [](Words& words) { return show_comparison(tube(), words); },
      [](Words& words) { return show_calibration(magnetic(), words); },
      [](Words& words) { return show_calibration(tube(), words); },
      [](Words& words) { return show_diagnosis(false, words); },
      [](Words& words) { return show_diagnosis(true, words); },
      show_intervals,
      show_stepwise,
      show_aircraft,
  };
  return all;
}

void collect(const nlohmann::json& value, std::set<std::string>& texts) {
  if (value.is_string()) texts.insert(value.get<std::string>());
  if (!value.is_structured()) return;
  for (const auto& [key, entry] : value.items()) {
    if (value.is_object()) texts.insert(key);
    collect(entry, texts);
  }
}

void check_json(const Shown& shown) {
  std::set<std::string> texts;
  for (const std::string& json : shown.json) {
    require(is_utf8(json), "JSON is UTF-8");
    const auto parsed = nlohmann::json::parse(json, nullptr, false);
    require(!parsed.is_discarded(), "JSON parses");
    collect(parsed, texts);
  }
  for (const std::string& name : shown.names) {
    require(!is_utf8(name) || texts.contains(name), "JSON gives the very name back");
  }
}

std::ptrdiff_t lines_of(const std::string& page) { return std::ranges::count(page, '\n'); }

void check_pages(const Shown& shown, const Shown& plain) {
  require(shown.pages.size() == plain.pages.size(), "as many pages");
  for (std::size_t at = 0; at < shown.pages.size(); ++at) {
    check_printed(shown.pages[at]);
    if (lines_of(shown.pages[at]) != lines_of(plain.pages[at])) {
      std::fprintf(stderr, "%s\n---\n%s\n", shown.pages[at].c_str(), plain.pages[at].c_str());
    }
    require(lines_of(shown.pages[at]) == lines_of(plain.pages[at]), "no name makes a line");
  }
}

}  // namespace
}  // namespace sepcal::fuzz

/// The fits and the diagnosis that all inputs begin with: they take longer than an input may.
extern "C" int LLVMFuzzerInitialize(int* /*count*/, char*** /*arguments*/) {
  using namespace sepcal::fuzz;
  static_cast<void>(tube());
  static_cast<void>(diagnosed(true));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sepcal::fuzz;
  Hostile hostile(data, size);
  const auto& result =
      results()[static_cast<std::size_t>(hostile.choice(static_cast<int>(results().size()) - 1))];
  Words words(hostile);
  Words plain_words = words.plain();
  Shown shown, plain;
  const bool is_shown = accepts([&] { shown = result(words); });
  const bool is_plain_shown = accepts([&] { plain = result(plain_words); });
  require(is_shown == is_plain_shown, "a name decides on no page");
  if (!is_shown) return 0;
  check_json(shown);
  check_pages(shown, plain);
  return 0;
}
