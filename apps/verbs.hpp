// SPDX-License-Identifier: BSD-3-Clause
// What each verb does, once its arguments are read. Results go to their files first, then to
// standard output, for people or as JSON; notes and progress to standard error.
#pragma once

#include <string>

#include "diagnose_arguments.hpp"
#include "fit_arguments.hpp"
#include "instrument.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/export.hpp"
#include "sepcal/flight/joined_rates.hpp"
#include "sepcal/flight/track.hpp"
#include "sepcal/profile.hpp"

namespace sepcal::app {

struct Arguments {
  std::string flight;
  std::vector<std::string> more_flights;
  std::vector<std::string> own;  // of fit: each flight's own parameters
  std::string calibration;
  std::string output;
  std::string truth;
  std::string effect;
  std::vector<std::string> references;  // of compare
  std::string other;                    // of join: the log whose columns are brought
  RateJoining joining = {};             // of join
  bool json = false;
  bool explain = false;   // the whole message of the fit
  bool stream = false;    // of fit and apply
  bool certify = false;   // of fit
  FitArguments log = {};  // of check, and of a later verb whatever the calibration says
};

/// Each returns the exit code: 0, or what the fit's status (4 not identifiable, 5 not converged) or
/// the diagnosis says (3 a missing effect, 6 a slow change or unexplained). All throw Error for bad
/// input; nothing is written then.
class Verbs {
 public:
  Verbs(const Instrument& instrument, const Arguments& arguments)
      : instrument_(instrument), arguments_(arguments) {}

  int check() const;
  int fit(CalibrationOptions options) const;
  int compare() const;
  int residuals() const;
  int intervals(ProfileOptions asked) const;
  /// Where it adds, the calibration is the result, and its status goes before the verdict.
  int diagnose(const DiagnoseArguments& asked) const;
  int add() const;
  int apply() const;
  int track(const FlightTrackOptions& options) const;
  /// To the file of -o; `export` is a word of C++.
  int export_to(ExportOptions options) const;
  int simulate(SimulationOrder order) const;
  int join() const;
  int effects() const;

 private:
  /// Reads FLIGHT with its progress shown, by so many threads (0: one a core), as it is written by
  /// what was typed, or by `log` where nothing was.
  Flight read_flight(const LogChoice& log = {}, int threads = 0) const;
  Flight read_flight(const std::string& file, const LogChoice& log, int threads) const;
  /// FLIGHT and those after it.
  std::vector<Flight> read_flights(const LogChoice& log, int threads = 0) const;
  std::vector<std::string> flight_files() const;
  /// Those and CALIBRATION.
  std::vector<std::string> input_files() const;

  /// A calibration and what it is asked about: the flights of a joint fit, joined, or one flight
  /// with the calibration on it.
  struct Subject {
    Calibration calibration;
    Flight flight;
  };
  Subject read_subject() const;
  /// read_subject() where one flight of a joint fit won't do.
  Subject read_whole_subject() const;

  /// Reads CALIBRATION; the options that choose of the log and the probe's own override what it
  /// says.
  Calibration read_base() const;

  const Instrument& instrument_;
  const Arguments& arguments_;
};

}  // namespace sepcal::app
