// SPDX-License-Identifier: BSD-3-Clause
#include "track_arguments.hpp"

#include "option_values.hpp"

namespace sepcal::app {

void TrackArguments::add_to(CLI::App& verb) {
  verb.add_option(
          "--method", method_,
          "rls: recursive least squares linearised at the start; ekf, iekf: the extended "
          "and the iterated extended filter; srif: as square-root information; rml: "
          "recursive maximum likelihood, which estimates the noises' sizes too; rft: recursive "
          "Fourier transform, of linear models over a band")
      ->type_name("HOW")
      ->capture_default_str();
  verb.add_option("--changes", changes_,
                  "for ekf, iekf and srif, parameters that jump in flight: ignore them; find the "
                  "first and say when it jumped; follow each and go on")
      ->type_name("HOW")
      ->capture_default_str();
  verb.add_option("--forgetting", options_.how.forgetting,
                  "forgetting factor, above 0, at most 1: each new row multiplies the weight of "
                  "older ones by it")
      ->type_name("MU")
      ->capture_default_str();
  verb.add_option("--memory", options_.how.memory,
                  "for rls, ekf, iekf and srif, instead of --forgetting: how many rows count; "
                  "fewer do while innovations are larger than expected")
      ->type_name("ROWS");
  verb.add_option("--band", band_, "for rft: the band of frequencies [Hz]; otherwise 0.1:2")
      ->type_name("LOW:HIGH");
  add_whole_number(verb, "--every", options_.how.every,
                   "for rml: the number of samples between steps of the parameters");
  add_whole_number(verb, "--start-rows", options_.start_rows,
                   "fits the first N rows and goes on after them; 0: starts from the fit of "
                   "another flight");
  add_deviations(verb, "--walk", walk_,
                 "lets a parameter change on the way, a random walk of SD [unit/sqrt(s)]");
}

void TrackArguments::add_to_aircraft(CLI::App& verb) {
  add_to(verb);
  verb.add_option("--second", second_,
                  "for a two-step fit: how the coefficients are estimated along the path: rls, "
                  "ekf, srif or rft; --forgetting, --memory, --band and --changes apply to them")
      ->type_name("HOW")
      ->capture_default_str();
}

void TrackArguments::add_to_sensor(CLI::App& verb) {
  add_to(verb);
  add_deviations(verb, "--noise", noise_,
                 "standard deviation of an output; otherwise that of the start; may be repeated");
  verb.add_option(
          "--own", own_,
          "with --start-rows: parameters of this flight alone, as \"wind\"; the others begin "
          "as the calibration has them")
      ->type_name("P,P");
}

FlightTrackOptions TrackArguments::resolve() const {
  FlightTrackOptions options = options_;
  options.how.method = choice_of<TrackMethod>("--method", method_);
  options.second = choice_of<TrackMethod>("--second", second_);
  options.how.changes = choice_of<TrackChanges>("--changes", changes_);
  options.how.walk = parse_deviations("--walk", walk_);
  options.how.noise = parse_deviations("--noise", noise_);
  if (!band_.empty()) options.how.band = parse_band(band_);
  if (!own_.empty()) options.own = split(own_, ',');
  return options;
}

}  // namespace sepcal::app
