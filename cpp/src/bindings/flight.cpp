// SPDX-License-Identifier: BSD-3-Clause
// Flights, and what is done with a probe on one: calibrate, compare, add, apply, save and load.
#include "sepcal/flight/flight.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <filesystem>

#include "arrays.hpp"
#include "bindings.hpp"
#include "python_effect.hpp"
#include "released.hpp"
#include "residual_columns.hpp"
#include "results.hpp"
#include "sepcal/detail/flight/certified.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/intervals.hpp"
#include "sepcal/flight/joined_rates.hpp"
#include "sepcal/flight/stepwise.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;

/// The function that hears what a long task does and how far it is, of the commands of `python -m
/// sepcal`; None: nobody does. It is never destroyed, as Python may be gone by then.
py::object& listener() {
  static auto* const heard_by = new py::object(py::none());
  return *heard_by;
}

/// What tells it; nothing where nobody hears. Call it with the interpreter's lock.
FitProgress heard() {
  if (listener().is_none()) return {};
  return [](std::string_view task, double fraction) {
    const py::gil_scoped_acquire gil;
    listener()(std::string(task), fraction);
  };
}

std::vector<std::string> headers(const Flight& flight) {
  std::vector<std::string> headers;
  for (const Flight::Column& column : flight.columns()) headers.push_back(column.header);
  return headers;
}

void view(Flight& flight, const std::string& header, const Array& values) {
  auto [span, owner] = view_array(values);
  flight.view(header, span, std::move(owner));
}

/// None where there is no such column.
std::optional<Array> column(const Flight& flight, const std::string& header) {
  const Flight::Column* found = flight.find(header);
  if (found == nullptr) return std::nullopt;
  return read_only_array(found->values, found->owner);
}

std::vector<std::string> maneuvers(const Flight& flight) {
  return {flight.maneuvers().begin(), flight.maneuvers().end()};
}

/// [(header, values, first cell that is no number or None, the log's own header or ""), ...]
using PickledColumns =
    std::vector<std::tuple<std::string, Array, std::optional<std::pair<std::size_t, std::string>>,
                           std::string>>;
using PickledFlight = std::tuple<std::string, std::string, PickledColumns, std::vector<std::string>,
                                 std::vector<std::string>>;

/// All that a flight is, so that another process says and writes the same of it.
PickledFlight pickled(const Flight& flight) {
  PickledColumns columns;
  for (const auto& [header, values, owner, first_text, logged] : flight.columns()) {
    std::optional<std::pair<std::size_t, std::string>> text;
    if (first_text) text.emplace(first_text->row, first_text->text);
    columns.emplace_back(header, read_only_array(values, owner), std::move(text), logged);
  }
  return {flight.name(), flight.sha256(), std::move(columns), maneuvers(flight), flight.notes()};
}

Flight unpickled(const PickledFlight& state) {
  const auto& [name, sha256, columns, labels, notes] = state;
  Flight flight(name, sha256);
  for (const auto& [header, values, text, logged] : columns) {
    std::optional<Flight::Cell> first_text;
    if (text) first_text = Flight::Cell{text->first, text->second};
    auto [span, owner] = view_array(values);
    const bool renamed = !logged.empty();
    flight.view(renamed ? logged : header, span, std::move(owner), std::move(first_text));
    if (renamed) flight.rename(logged, header);
  }
  if (!labels.empty()) flight.label(labels);
  for (const std::string& note : notes) flight.note(note);
  return flight;
}

/// Opens an output and lets it go, which leaves nothing; not a pipe, whose reader would take that
/// for the end. Throws Error where it can't be written.
void check_output(const std::string& file) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_other(status)) return;
  const OutputFile opened(file);
}

Flight join_logs(const Flight& measured, const Flight& other, const std::string& how,
                 double offset) {
  return join_rates(measured, other, {.how = how, .offset = offset});
}

void define_flights(py::module_& module) {
  py::class_<Flight>(module, "Flight")
      .def(py::init([](std::string name, std::string sha256) {
             return Flight(std::move(name), std::move(sha256)).number_lines({});
           }),
           "name"_a, "sha256"_a = "")
      .def("note", [](Flight& self, std::string text) { self.note(std::move(text)); })
      .def_property_readonly("notes", &Flight::notes)
      .def("view", &view, "header"_a, "values"_a.noconvert())
      .def("label",
           [](Flight& self, std::vector<std::string> labels) { self.label(std::move(labels)); })
      .def("column", &column)
      .def("list_columns", &Flight::list_columns)
      .def_property_readonly("name", &Flight::name)
      .def_property_readonly("sha256", &Flight::sha256)
      .def_property_readonly("rows", &Flight::rows)
      .def_property_readonly("headers", &headers)
      .def_property_readonly("maneuvers", &maneuvers)
      .def(py::pickle(&pickled, &unpickled));
  module.def("write_whole", &write_whole, WithoutGil());
  module.def("check_output", &check_output);
  module.def("check_not_input", [](const std::string& output, const std::string& input) {
    check_not_input(output, input);
  });
  module.def(
      "read_csv",
      [](const std::string& file, std::string delimiter, std::string decimal) {
        return read_csv(file, {}, 0, {std::move(delimiter), std::move(decimal)});
      },
      "file"_a, "delimiter"_a = "", "decimal"_a = "", WithoutGil());
  module.def("join_rates", &join_logs, WithoutGil());
  module.def(
      "stream_csv",
      [](const std::string& file, const std::string& folder, std::string delimiter,
         std::string decimal) {
        return stream_csv(file, folder, {}, 0, {std::move(delimiter), std::move(decimal)});
      },
      "file"_a, "folder"_a = "", "delimiter"_a = "", "decimal"_a = "", WithoutGil());
}

ResidualColumns residuals_on(const Calibration& calibration, const Flight& flight) {
  ResidualTable table;
  {
    const Released released;
    need_own_effects(calibration);
    table = tabulate_residuals(calibration, flight);
  }
  return residual_columns(std::move(table));
}

/// With an effect added where one is named.
Compared compare_flight(const Calibration& calibration, const Flight& flight,
                        const std::optional<std::string>& effect,
                        const std::vector<std::string>& references) {
  const Released released;
  need_own_effects(calibration);
  return compared(effect ? compare_with(calibration, flight, *effect)
                         : compare(calibration, flight, references));
}

Diagnosed diagnose_on(const Calibration& calibration, const Flight& flight,
                      const std::vector<PythonEffect>& own, const Injected& injected,
                      const DiagnosisOptions& asked) {
  const OwnEffects makers = own_effects(own, effect_kit(*calibration.probe));
  DiagnosisOptions options = with_threads(asked, calibration.options.fit.threads);
  options.progress = heard();
  const Released released;
  need_own_effects(calibration);
  return diagnosed(injected ? diagnose_with({injected->first, injected->second}, calibration,
                                            flight, makers, options)
                            : diagnose(calibration, flight, makers, options));
}

Stepped<Calibration> diagnose_stepwise_on(const Calibration& calibration, const Flight& flight,
                                          const std::vector<PythonEffect>& own,
                                          std::optional<std::size_t> most,
                                          const DiagnosisOptions& asked) {
  const OwnEffects makers = own_effects(own, effect_kit(*calibration.probe));
  StepwiseOptions options =
      stepwise_options(most, with_threads(asked, calibration.options.fit.threads));
  options.diagnosis.progress = heard();
  const Released released;
  need_own_effects(calibration);
  StepwiseCalibration result = diagnose_stepwise(calibration, flight, makers, options);
  std::string json = to_json(result);
  Page page = page_of(result);
  return stepped(std::move(result.calibration), std::move(result.course), std::move(json),
                 std::move(page));
}

/// {header: values}
py::typing::Dict<py::str, Array> apply_to(const Calibration& calibration, const Flight& flight) {
  const auto run = [&] {
    const Released released;
    need_own_effects(calibration);
    return apply(calibration, flight);
  };
  py::typing::Dict<py::str, Array> corrected;
  for (CorrectedColumn& column : run()) {
    corrected[py::str(column.header)] = adopt(std::move(column.values));
  }
  return corrected;
}

Applied apply_file(const Calibration& calibration, const std::string& file,
                   const std::string& output) {
  const Released released;
  need_own_effects(calibration);
  const bool is_joint = joint_setup(*calibration.probe) != nullptr;
  return apply_to_file(is_joint ? for_flight(calibration, read_csv(file)) : calibration, file,
                       output);
}

Calibration calibrate_probe(const Model& model, const Flight& flight, CalibrationOptions options,
                            const std::vector<PythonEffect>& own) {
  options.own_effects = own_effects(own, effect_kit(probe_of(model)));
  options.fit.progress = heard();
  const Released released;
  return calibrate(subject_of(model), flight, options);
}

/// Flights fitted together, and these joined.
std::pair<Calibration, Flight> calibrate_flights(const Model& model,
                                                 const std::vector<Flight>& flights,
                                                 const std::vector<std::string>& own,
                                                 CalibrationOptions options,
                                                 const std::vector<PythonEffect>& own_made) {
  options.own_effects = own_effects(own_made, effect_kit(probe_of(model)));
  options.fit.progress = heard();
  const Released released;
  std::vector<std::string> notes;  // calibrate_jointly() gives them with the calibration
  Flight joined = join_flights(flights, options.log, notes);
  return {calibrate_jointly(subject_of(model), flights, own, options), std::move(joined)};
}

/// A joint calibration on one flight, whose own parameters must be known where `known`.
Calibration on_flight(const Calibration& calibration, const Flight& flight, bool known) {
  const Calibration one = for_flight(calibration, flight);
  if (known) check_known(one, flight);
  return one;
}

Flight rejoin(const Calibration& calibration, const std::vector<Flight>& flights) {
  std::vector<std::string> notes;
  return rejoin_flights(calibration, flights, notes);
}

Certificate certify_on(const Calibration& calibration, const Flight& flight, double tolerance,
                       std::size_t boxes) {
  const Released released;
  return certify(
      calibration, flight,
      {.tolerance = tolerance, .boxes = boxes, .threads = calibration.options.fit.threads});
}

FoundIntervals intervals_on(const Calibration& calibration, const Flight& flight, double level,
                            const std::vector<std::string>& names) {
  const FitProgress progress = heard();
  const Released released;
  need_own_effects(calibration);
  return found_intervals(
      find_intervals(calibration, flight, {.level = level, .names = names, .progress = progress}));
}

FlightPrediction predict_flight(const Calibration& calibration, const Flight& flight,
                                double level) {
  const Released released;
  need_own_effects(calibration);
  return predict(calibration, flight, level);
}

Tracking track_on(const Calibration& calibration, const Flight& flight,
                  const FlightTrackOptions& options) {
  const Released released;
  need_own_effects(calibration);
  return tracking(track(calibration, flight, options));
}

Calibration add_to(const Calibration& base, const Flight& flight, const std::string& effect,
                   const std::vector<PythonEffect>& own) {
  const OwnEffects makers = own_effects(own, effect_kit(*base.probe));
  const FitProgress progress = heard();
  const Released released;
  need_own_effects(base);
  return add(base, flight, effect, makers, progress);
}

Calibration with_own_effects(Calibration calibration, const std::vector<PythonEffect>& own) {
  give_own_effects(calibration, own);
  return calibration;
}

void define_calibration_parts(py::module_& module) {
  BoundStruct<Derived>(
      module, "Derived",
      "A quantity that follows from the estimates, in `unit`; errors by the delta method.")
      .told()
      .comparable()
      .finish();

  using Entry = HistoryEntry;
  BoundStruct<Entry>(module, "HistoryEntry",
                     "One step of a chain of added effects; NaN where a number is undefined. "
                     "Errors are RMSE over all outputs together, on the rows of the new fit.")
      .told()
      .comparable()
      .finish();

  BoundStruct<Applied>(module, "Applied", "The result of apply_to_file().")
      .field("rows", &Applied::rows, "")
      .field("rows_left_empty", &Applied::rows_left_empty,
             "Nothing to calibrate: total below static pressure, or dropped.")
      .field("headers", &Applied::headers, "The columns added.")
      .field("notes", &Applied::notes, "One line each, for people.")
      .comparable()
      .finish();
}

/// As its app's page shows it.
FittedModel fit_of(const Calibration& calibration) {
  return fitted_model(calibration.fit, calibration.options.effects, page_of(calibration));
}

/// {name: {"sentence": str, key: number or list}}.
py::dict restated_of(const Calibration& calibration) {
  py::dict all;
  for (const Restatement& one : calibration.restated) {
    py::dict entry;
    entry["sentence"] = one.sentence;
    for (const auto& [key, values] : one.numbers) {
      entry[key.c_str()] = values.size() == 1 ? py::cast(values.front()) : py::cast(values);
    }
    all[one.name.c_str()] = entry;
  }
  return all;
}

/// The labels of a joint calibration's flights; none of another one.
std::vector<std::string> labels_of(const Calibration& calibration) {
  std::vector<std::string> labels;
  if (const JointSetup* const joint = joint_setup(*calibration.probe)) {
    for (const JoinedFlight& flight : joint->flights) labels.push_back(flight.label);
  }
  return labels;
}

void define_calibration(py::module_& module) {
  BoundStruct<FlightDeparture>(
      module, "FlightDeparture",
      "Whether a flight agrees with the others of a joint fit; NaN where nothing can be tested.")
      .field("flight", &FlightDeparture::flight, "Its label.")
      .field("p", &FlightDeparture::p,
             "Probability of a larger difference by chance, by Holm for the number of flights.")
      .field("parameter", &FlightDeparture::parameter,
             "Shared, the most different in standard errors; may be empty.")
      .field("difference", &FlightDeparture::difference,
             "The flight's own estimate less that of the others.")
      .field("standard_error", &FlightDeparture::standard_error, "");
  py::class_<DiagnosisOptions>(module, "DiagnosisOptions")
      .def(py::init([](int simulations, std::uint64_t seed, const std::string& pse,
                       const std::string& rule, std::vector<std::string> only,
                       std::map<std::string, double> error_budget, double within) {
             DiagnosisOptions options;
             options.simulations = simulations;
             options.seed = seed;
             options.pse = choice_of<PseBound>("pse", pse);
             options.rule = choice_of<DiagnosisRule>("rule", rule);
             options.only = std::move(only);
             options.error_budget = std::move(error_budget);
             options.within = within;
             return options;
           }),
           py::kw_only(), "simulations"_a, "seed"_a, "pse"_a, "rule"_a, "only"_a, "error_budget"_a,
           "within"_a);
  py::class_<Calibration> calibration(module, "Calibration");
  define_stepped<Calibration>(module, "SteppedCalibration");
  calibration.def_property_readonly("fit", &fit_of)
      .def_readonly("derived", &Calibration::derived)
      .def_property_readonly("restated", &restated_of)
      .def_readonly("history", &Calibration::history)
      .def_readonly("notes", &Calibration::notes)
      .def_readonly("departures", &Calibration::departures)
      .def_property_readonly("flights", &labels_of)
      .def("on_flight", &on_flight)
      .def("rejoin", &rejoin, WithoutGil())
      .def_property_readonly("file", [](const Calibration& self) { return self.flight.file; })
      .def("residuals", &residuals_on, "flight"_a)
      .def("compare", &compare_flight, "flight"_a, "effect"_a = std::nullopt,
           "references"_a = std::vector<std::string>())
      .def("diagnose", &diagnose_on)
      .def("diagnose_stepwise", &diagnose_stepwise_on)
      .def("intervals", &intervals_on)
      .def("certify", &certify_on)
      .def("predict", &predict_flight)
      .def("track", &track_on)
      .def("add", &add_to)
      .def("apply", &apply_to)
      .def("apply_to_file", &apply_file)
      .def_property_readonly("model", [](const Calibration& self) { return self.probe->name(); })
      .def(
          "command",
          [](const Calibration& self, const std::string& verb) {
            return command_of(self.probe->app(), verb);
          },
          "A verb of it, as a shell takes it.")
      .def_property_readonly(
          "unit",
          [](const Calibration& self) { return self.probe->model().tables().output_unit(); })
      .def("to_json", [](const Calibration& self) { return to_json(self); })
      .def("save", &write_calibration, WithoutGil());
}

}  // namespace

const std::shared_ptr<const Probe>& subject_of(const Model& model) {
  return model.probe != nullptr ? model.probe : model.own;
}

const Probe& probe_of(const Model& model) {
  if (const auto& probe = subject_of(model)) return *probe;
  throw Error("this model takes no flight; give its inputs and outputs as {name: array}");
}

void define_flight(py::module_& module) {
  module.def("hear_progress", [](const py::object& heard_by) { listener() = heard_by; });
  define_flights(module);
  define_calibration_parts(module);
  define_calibration(module);
  module.def("calibrate", &calibrate_probe);
  module.def("calibrate_jointly", &calibrate_flights);
  using Own = std::vector<PythonEffect>;
  using Asked = std::optional<Model>;  // where the calibration is of a model of the caller's own
  module.def("parse_calibration", [](const std::string& json, const std::string& source,
                                     const Own& own, const Asked& model) {
    return with_own_effects(model ? parse_calibration(json, source, subject_of(*model))
                                  : parse_calibration(json, source),
                            own);
  });
  module.def("read_calibration", [](const std::string& file, const Own& own, const Asked& model) {
    return with_own_effects(
        model ? read_calibration(file, subject_of(*model)) : read_calibration(file), own);
  });
}

}  // namespace sepcal::bindings
