// SPDX-License-Identifier: BSD-3-Clause
// The way of a result: to its file first, then to standard output, for people or as JSON; notes to
// standard error.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "manners.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/residuals.hpp"
#include "terminal.hpp"

namespace sepcal::app {

inline Detail detail_of(bool explain) {
  return explain || manners().verbose ? Detail::explained : Detail::brief;
}

/// 0 converged, 4 not identifiable, 5 not converged.
int exit_code(FitStatus status);

/// Whether a file of that name is there to be read; what can't be told is not.
bool is_there(const std::string& file);

/// Prints JSON where it is wanted, else the page.
void give(bool json, const std::string& told, const std::string& page);

/// Writes the table to `target`, which is called `output`, and says so.
void deliver_residuals(const ResidualTable& table, const std::string& output, OutputFile& target);

class Delivery {
 public:
  struct Wishes {
    std::string output;    // the file of -o, or empty
    bool json = false;     // on standard output
    bool explain = false;  // the whole message of the fit
  };

  /// The file is opened before the work, so that one that can't be written is refused at once.
  /// Throws Error where -o names one of `inputs` or can't be written.
  Delivery(Wishes wishes, const std::vector<std::string>& inputs);

  template <class Result>
  void deliver(const Result& result) {
    tell_notes(result.notes);
    deliver(to_json(result), to_text(result, detail_of(wishes_.explain)));
  }

  void deliver(const std::string& json, const std::string& page);

 private:
  Wishes wishes_;
  std::optional<OutputFile> file_;
};

}  // namespace sepcal::app
