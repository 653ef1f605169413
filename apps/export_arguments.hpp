// SPDX-License-Identifier: BSD-3-Clause
// The options of export that both apps share.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "sepcal/flight/export.hpp"

namespace sepcal::app {

class ExportArguments {
 public:
  /// Adds the options to `verb`; they fill this object, which must outlive the parsing.
  void add_to(CLI::App& verb);

  /// Throws Error for a text that doesn't mean anything.
  ExportOptions resolve() const;

 private:
  std::string target_;
  std::string device_id_;
  std::string in_use_;
  std::string airspeed_sensor_;
  std::string cal_air_;
  std::string logged_airspeed_;
  std::string mounting_;
  std::string rotation_;
  std::optional<std::uint32_t> sensor_;
  ExportOptions options_;  // what needs no more than CLI11's reading
};

}  // namespace sepcal::app
