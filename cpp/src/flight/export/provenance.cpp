// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/provenance.hpp"

#include <fmt/format.h>

#include <cmath>

namespace sepcal::exporting {
namespace {

std::string residual_of(const Calibration& calibration) {
  std::string text;
  for (const OutputValue& one : calibration.fit.rmse) {
    text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", one.name, one.value);
  }
  return fmt::format("{} {}", text, calibration.probe->model().tables().outputs.front().unit);
}

constexpr double rounding = 1e-9;  // what is off by less is off by the arithmetic

}  // namespace

std::vector<std::string> provenance(const std::string& what, const Calibration& given,
                                    const Calibration& held) {
  std::vector<std::string> lines{fmt::format("{}, made by sepcal {}", what, SEPCAL_VERSION)};
  if (!given.file.empty()) lines.push_back(fmt::format("calibration: {}", given.file));
  const FittedFlight& flight = held.flight;
  if (!flight.file.empty()) {
    lines.push_back(fmt::format("flight: {}{}{}", flight.file,
                                flight.sha256.empty() ? "" : ", sha256 ", flight.sha256));
  }
  lines.push_back(fmt::format("fit: {}, residuals {} in {} rows", to_string(held.fit.status),
                              residual_of(held), flight.rows_used));
  return lines;
}

std::vector<std::string> approximation_lines(const Approximation& approximation) {
  std::vector<std::string> lines;
  for (const std::string& dropped : approximation.dropped) lines.push_back("dropped: " + dropped);
  const bool compared = approximation.rows > 0;
  if (compared && !std::isnan(approximation.rotation_deg) &&
      std::isnan(approximation.heading_rms_deg)) {
    lines.emplace_back("heading: not known, as roll and pitch are not logged");
  }
  if (approximation.heading_largest_deg <= rounding) {
    lines.emplace_back("heading: the calibration's");
  } else if (!std::isnan(approximation.heading_rms_deg)) {
    lines.push_back(
        fmt::format("heading: rms {:.3g} deg, at most {:.3g} deg, off the calibration's",
                    approximation.heading_rms_deg, approximation.heading_largest_deg));
  }
  if (approximation.strength_rms_ut <= rounding) {
    lines.emplace_back("field's strength: the calibration's");
  } else if (!std::isnan(approximation.strength_rms_ut)) {
    lines.push_back(fmt::format("field's strength: rms {:.3g} uT off the calibration's",
                                approximation.strength_rms_ut));
  }
  if (!std::isnan(approximation.airspeed_rms_mps)) {
    lines.push_back(
        fmt::format("true airspeed: rms {:.3g} m/s, at most {:.3g} m/s, off the calibration's",
                    approximation.airspeed_rms_mps, approximation.airspeed_largest_mps));
  }
  if (!std::isnan(approximation.residual_before)) {
    lines.push_back(fmt::format("residual: {:.4g} {} before, {:.4g} {} after",
                                approximation.residual_before, approximation.residual_unit,
                                approximation.residual_after, approximation.residual_unit));
  }
  return lines;
}

std::vector<std::string> rotation_lines(const Exported& exported) {
  if (!exported.rotation) return {};
  const bool kept = *exported.rotation == ExportRotation::keep;
  std::vector<std::string> lines{
      kept ? "rotation keep: the calibration as it is, less its rotation"
           : "rotation refit: the symmetric matrix that fits the flight best"};
  if (!exported.other_approximation) return lines;
  const Approximation& other = *exported.other_approximation;
  std::string line = fmt::format("by {} instead:", kept ? "refit" : "keep");
  if (!std::isnan(other.heading_rms_deg)) {
    line += fmt::format(" heading rms {:.3g} deg, at most {:.3g} deg;", other.heading_rms_deg,
                        other.heading_largest_deg);
  }
  line += other.strength_rms_ut <= rounding
              ? " field's strength the calibration's;"
              : fmt::format(" field's strength rms {:.3g} uT;", other.strength_rms_ut);
  lines.push_back(
      fmt::format("{} residual {:.4g} {}", line, other.residual_after, other.residual_unit));
  return lines;
}

}  // namespace sepcal::exporting
