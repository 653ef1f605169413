// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <ranges>

#include "flight/export/approximation.hpp"
#include "flight/export/bodies.hpp"
#include "flight/export/exporter.hpp"
#include "flight/export/fit_for_use.hpp"
#include "flight/export/header_text.hpp"
#include "flight/export/held_rotation.hpp"
#include "flight/export/parameters.hpp"
#include "flight/export/provenance.hpp"
#include "flight/export/refusals.hpp"
#include "flight/export/tube_reader.hpp"
#include "flight/export/vehicle_notes.hpp"
#include "flight/files/sha256.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/verbs/driver_ranges.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace exporting;  // this room's own

namespace {

/// The flight that is given, or the one that the calibration names, where it is there unchanged.
class FlightAtHand {
 public:
  FlightAtHand(const Calibration& calibration, const Flight* given, bool one_of_several)
      : fitted_(calibration.flight), flight_(given), one_of_several_(one_of_several) {
    if (flight_ != nullptr || fitted_.sha256.empty()) return;
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(fitted_.file, unreadable)) return;
    Flight named = read_csv(fitted_.file, {}, 0, calibration.options.log.form());
    if (named.sha256() != fitted_.sha256) return;
    named_ = std::make_shared<const Flight>(std::move(named));
    flight_ = named_.get();
  }

  const Flight* find() const { return flight_; }

  /// Of flights that were fitted jointly.
  bool is_one_of_several() const { return one_of_several_; }

  /// Throws Error where there is none.
  const Flight& need(const std::string& for_what) const {
    if (flight_ != nullptr) return *flight_;
    throw Error(fmt::format(
        "{} takes the flight, and {} is not there as it was fitted; give the flight after the "
        "calibration",
        for_what, fitted_.file.empty() ? "the one of the fit" : fitted_.file));
  }

 private:
  FittedFlight fitted_;
  std::shared_ptr<const Flight> named_;
  const Flight* flight_;
  bool one_of_several_;
};

/// A number beside a name, as the header's names have it.
std::string header_name(const Calibration& calibration, const ExportOptions& options) {
  const std::string name(exporter_of(calibration).header_name);
  if (!options.sensor) return "sepcal_" + name;
  if (*options.sensor < 0) throw OptionError({Option{"sensor"}, " is below zero; count from 0"});
  return fmt::format("sepcal_{}_{}", name, *options.sensor);
}

std::string id_of(const Calibration& calibration) {
  const std::string json = to_json(calibration);
  files::Sha256 sha;
  sha.absorb(json.data(), json.size());
  return sha.finish();
}

/// Where drivers were seen, of a calibration from before it said so, as far as its flight is there.
void fill_ranges(Calibration& calibration, const FlightAtHand& at_hand) {
  const bool lacks = calibration.driver_ranges.empty() && !calibration.options.effects.empty();
  const Flight* const flight = at_hand.find();
  if (!lacks || flight == nullptr || calibration.flight.sha256.empty()) return;
  if (flight->sha256() != calibration.flight.sha256) return;
  const EffectiveFlight effective =
      verbs::with_effects_of(calibration, verbs::prepare(calibration, *flight));
  calibration.driver_ranges = verbs::ranges_of_drivers(
      *calibration.probe, calibration.options.effects,
      effective.prepared.record.select(calibration.options.fit.stage_two_segments));
}

void export_header(const Calibration& given, const Calibration& held, const std::string& id,
                   const ExportOptions& options, Exported& exported) {
  if (options.single) refuse_overflow(held);
  const Dialect dialect(options.target == ExportTarget::cpp, options.single,
                        header_name(held, options));
  std::vector<std::string> comment =
      provenance(fmt::format("The correction of {}", exporter_of(held).instrument), given, held);
  if (exported.approximation)
    std::ranges::copy(approximation_lines(*exported.approximation), std::back_inserter(comment));
  Header header = header_text(held, dialect, id, comment);
  exported.text = std::move(header.text);
  exported.left_to_others = std::move(header.left_to_others);
}

void write_parameters(const std::vector<std::string>& comment, const ExportOptions& options,
                      Exported& exported) {
  exported.text = options.target == ExportTarget::px4
                      ? px4_text(exported.parameters, comment)
                      : ardupilot_text(exported.parameters, comment);
}

/// What an autopilot holds, beside its parameters.
struct OnAutopilot {
  Approximation approximation;
  std::vector<std::string> told = {};  // what a person must know, a line each
};

OnAutopilot export_field(const Calibration& given, const Calibration& base,
                         const FlightAtHand& flight, const ExportOptions& asked,
                         Exported& exported) {
  if (asked.rotation == ExportRotation::refit) {
    flight.need("what an autopilot holds is fitted anew: that");
  }
  const std::optional<VehicleMounting> mounting = vehicle_mounting(base, asked);
  ExportOptions options = asked;
  if (mounting) options.mounting = mounting->angles;
  OnAutopilot there;
  Calibration held;
  there.approximation = hold_field(
      {given, base, flight.find(), flight.is_one_of_several(), mounting}, options, held, exported);
  const HeldField field = held_field(held);
  exported.parameters = options.target == ExportTarget::px4 ? px4_magnetometer(field, options)
                                                            : ardupilot_compass(field, options);
  exported.calibration = std::move(held);
  there.told = field_notes(given, exported, options, mounting);
  return there;
}

OnAutopilot export_airspeed(const Calibration& given, const Calibration& base,
                            const FlightAtHand& at_hand, const ExportOptions& options,
                            Exported& exported) {
  const Flight& flight = at_hand.need("what an autopilot holds is fitted anew: that");
  std::vector<std::string> unused;
  const ReadFlight read =
      probes::read_for(*base.probe, flight, verbs::choice_for(base, flight, unused));
  const ChosenTubeReader chosen = choose_tube_reader(read.flight, options);
  FittedAirspeed fitted = fit_airspeed(base, flight, chosen.reader, options);
  if (!options.force) {
    check_fit_for_use(fitted.calibration, "what the autopilot can hold of the calibration");
  }
  exported.parameters = options.target == ExportTarget::px4
                            ? px4_airspeed(fitted.held, options)
                            : ardupilot_airspeed(fitted.held, chosen.reader, options);
  OnAutopilot there{.approximation = airspeed_approximation(given, fitted, chosen.reader, flight)};
  drop_bias(base, fitted.held, chosen.reader, there.approximation);
  there.told = airspeed_notes(chosen, options);
  exported.calibration = std::move(fitted.calibration);
  return there;
}

/// What the autopilot holds of `base`, and what that loses against `given`.
OnAutopilot export_parameters(const Calibration& given, const Calibration& base,
                              const FlightAtHand& flight, const ExportOptions& options,
                              Exported& exported) {
  check_held(base, options.target);
  const bool is_field = is_magnetometer(base);
  OnAutopilot there = is_field ? export_field(given, base, flight, options, exported)
                               : export_airspeed(given, base, flight, options, exported);
  for (const std::string& effect : options.without) {
    there.approximation.dropped.push_back("the effect " + effect);
  }
  exported.left_to_others = effects_on_the_world(base);
  return there;
}

/// The calibration without some of its effects: fitted, unless that is done of what an autopilot
/// holds alone.
void leave_out(const Calibration& given, const FlightAtHand& at_hand, const ExportOptions& options,
               Exported& exported) {
  const Flight& flight = at_hand.need("a fit without an effect");
  CalibrationOptions fewer = options_without(given, options.without, options.progress);
  if (!is_header(options.target) && !is_magnetometer(given)) {
    exported.calibration.options = std::move(fewer);
    return;
  }
  exported.calibration = verbs::calibrate(given.probe, verbs::prepare(given, flight), fewer);
  if (!options.force) check_fit_for_use(exported.calibration, "the fit without what is left out");
  Approximation approximation = refit_approximation(given, exported.calibration, flight);
  for (const std::string& effect : options.without)
    approximation.dropped.push_back("the effect " + effect);
  exported.approximation = std::move(approximation);
}

}  // namespace

Exported export_calibration(const Calibration& calibration, const Flight* flight,
                            const ExportOptions& options) {
  if (find_exporter(calibration.probe->name()) == nullptr) {
    throw Error(fmt::format(
        "{} has no correction to export; there is one of {}; read the parameters from the JSON",
        calibration.probe->name(), fmt::join(exported_probes(), ", ")));
  }
  refuse_homeless(calibration, options);
  refuse_idle(calibration, options);
  const Calibration given = of_one_flight(calibration, flight, options);
  check_without(given, options.without);
  if (!options.force) check_fit_for_use(given, "the calibration");
  const FlightAtHand at_hand(given, flight, joint_setup(*calibration.probe) != nullptr);
  Exported exported{.target = options.target, .calibration = given};
  if (flight != nullptr) verbs::note_other_flight(given, *flight, exported.notes);
  if (!options.without.empty()) leave_out(given, at_hand, options, exported);
  if (is_header(options.target)) {
    Calibration held = exported.calibration;
    const std::string id = id_of(options.without.empty() ? calibration : held);
    describe_correction(held, {false, false, {}});  // refuses what no flight mends
    fill_ranges(held, at_hand);
    export_header(given, held, id, options, exported);
    return exported;
  }
  const Calibration base = exported.calibration;
  OnAutopilot there = export_parameters(given, base, at_hand, options, exported);
  std::vector<std::string> comment =
      provenance(vehicle_title(exported.calibration, options), given, exported.calibration);
  std::ranges::copy(approximation_lines(there.approximation), std::back_inserter(comment));
  exported.approximation = std::move(there.approximation);
  std::ranges::copy(rotation_lines(exported), std::back_inserter(comment));
  std::ranges::copy(there.told, std::back_inserter(comment));
  std::ranges::copy(there.told, std::back_inserter(exported.notes));
  write_parameters(comment, options, exported);
  return exported;
}

Exported export_to_file(const Calibration& calibration, const Flight* flight,
                        const ExportOptions& options, const std::string& output) {
  if (!calibration.file.empty()) check_not_input(output, calibration.file);
  if (!calibration.flight.sha256.empty()) check_not_input(output, calibration.flight.file);
  if (flight != nullptr && !flight->sha256().empty()) check_not_input(output, flight->name());
  OutputFile file(output);
  Exported exported = export_calibration(calibration, flight, options);
  file.write(exported.text);
  file.commit();
  return exported;
}

}  // namespace sepcal
