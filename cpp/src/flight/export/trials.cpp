// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/trials.hpp"

#include <algorithm>

#include "flight/export/bodies.hpp"
#include "flight/export/driver_names.hpp"
#include "flight/export/single_precision.hpp"
#include "flight/probes/mounting.hpp"

namespace sepcal::exporting {
namespace {

double setting_of(const Calibration& calibration, const char* name) {
  const auto settings = calibration.probe->settings();
  const auto found = settings.find(name);
  return found == settings.end() ? 0.0 : found->second.front();
}

bool is_total(const std::string& channel) { return channel == "pt" || channel == "pt_pa"; }
bool is_static(const std::string& channel) { return channel == "ps" || channel == "ps_pa"; }

/// 0, 1, 2 of "mx", "my", "mz", as a fit's record has them; -1 of another.
int axis_of(const std::string& channel) {
  return channel == "mx" ? 0 : channel == "my" ? 1 : channel == "mz" ? 2 : -1;
}

}  // namespace

Trials::Trials(const Calibration& calibration, const ProbeBody& body, const Correction& correction,
               bool single)
    : body_(body),
      correction_(correction),
      single_(single),
      k_alpha_(setting_of(calibration, "k_alpha")),
      k_beta_(setting_of(calibration, "k_beta")),
      turn_(probes::turn_by(mounting_of(calibration).value_or(Mounting{}))) {
  std::size_t column = 0;
  for (const Quantities& one : body.readings) {
    for (const std::string& header : one.headers) {
      std::vector<double> values;
      for (const std::vector<double>& trial : body.trials) values.push_back(trial[column]);
      columns_.emplace_back(header, std::move(values));
      ++column;
    }
  }
  for (const Driver& driver : correction.drivers) {
    if (!has(header_of(driver.channel))) {
      columns_.emplace_back(header_of(driver.channel), driver.trial);
      continue;
    }
    for (std::size_t row = 0; row < plain_rows; ++row) {
      set_channel(driver.channel, row, driver.trial[row]);
    }
  }
  outside_.assign(plain_rows, false);
  for (const Guard& guard : correction.guards) add_beyond(guard);
  for (std::size_t row = 0; row < rows(); ++row) {
    if (single_) round_row(row);
    outside_[row] = std::ranges::any_of(correction.guards, [&](const Guard& guard) {
      const double value = channel_at(guard.channel, row);
      return !(value >= guard.range.lower && value <= guard.range.upper);
    });
  }
}

bool Trials::reads(const std::string& header) const {
  return std::ranges::any_of(body_.readings, [&](const Quantities& one) {
    return std::ranges::find(one.headers, header) != one.headers.end();
  });
}

/// Whether the channel is of the flow's angles, of a probe that reads them.
bool Trials::is_flow_angle(const std::string& channel) const {
  return (channel == "alpha" || channel == "beta") && reads("dpa_pa");
}

bool Trials::has(const std::string& header) const {
  return std::ranges::any_of(columns_, [&](const auto& one) { return one.first == header; });
}

double& Trials::cell(const std::string& header, std::size_t row) {
  return std::ranges::find_if(columns_, [&](const auto& one) { return one.first == header; })
      ->second[row];
}

double Trials::cell(const std::string& header, std::size_t row) const {
  return std::ranges::find_if(columns_, [&](const auto& one) { return one.first == header; })
      ->second[row];
}

/// The column by which apply() finds a channel.
std::string Trials::header_of(const std::string& channel) const {
  if (channel == "roll" || channel == "pitch" || channel == "yaw") {
    return channel;  // no state of a correction: found by its whole name
  }
  const KnownChannel* const known = find_known(channel);
  if (known != nullptr) return std::string(known->argument);
  for (const Quantities& one : body_.readings) {
    for (const std::string& header : one.headers) {
      if (header.substr(0, header.rfind('_')) == channel) return header;
    }
  }
  return channel;
}

double Trials::channel_at(const std::string& channel, std::size_t row) const {
  if (is_flow_angle(channel)) {
    const double k = channel == "alpha" ? k_alpha_ : k_beta_;
    return cell(channel == "alpha" ? "dpa_pa" : "dpb_pa", row) /
           (k * (cell("pt_pa", row) - cell("ps_pa", row)));
  }
  if (const int axis = axis_of(channel); axis >= 0 && reads("mx_ut")) {
    return turn_.row(axis).dot(
        Eigen::Vector3d(cell("mx_ut", row), cell("my_ut", row), cell("mz_ut", row)));
  }
  return cell(header_of(channel), row);
}

void Trials::set_channel(const std::string& channel, std::size_t row, double value) {
  const double change = value - channel_at(channel, row);
  if (is_flow_angle(channel)) {
    const double k = channel == "alpha" ? k_alpha_ : k_beta_;
    cell(channel == "alpha" ? "dpa_pa" : "dpb_pa", row) =
        value * k * (cell("pt_pa", row) - cell("ps_pa", row));
  } else if (const int axis = axis_of(channel); axis >= 0 && reads("mx_ut")) {
    const Eigen::Vector3d added = turn_.row(axis).transpose() * change;
    cell("mx_ut", row) += added[0];
    cell("my_ut", row) += added[1];
    cell("mz_ut", row) += added[2];
  } else if (reads("pt_pa") && (is_total(channel) || is_static(channel))) {
    cell("pt_pa", row) += change;  // what the probe sees is their difference
    cell("ps_pa", row) += change;
  } else {
    cell(header_of(channel), row) = value;
  }
}

/// Rows like the first, a hundredth of the range above and below what the fit saw.
void Trials::add_beyond(const Guard& guard) {
  const double beyond = 0.01 * (guard.range.upper - guard.range.lower);
  for (const double value : {guard.range.upper + beyond, guard.range.lower - beyond}) {
    for (auto& [header, values] : columns_) values.push_back(values.front());
    outside_.push_back(true);
    set_channel(guard.channel, rows() - 1, value);
  }
}

void Trials::round_row(std::size_t row) {
  for (const Driver& driver : correction_.drivers) {
    const double value = channel_at(driver.channel, row);
    set_channel(driver.channel, row, driver.origin + to_single(value - driver.origin));
  }
  for (const Quantities& one : body_.readings) {
    if (one.is_difference) {
      double& first = cell(one.headers[0], row);
      const double second = cell(one.headers[1], row);
      first = second + to_single(first - second);
      continue;
    }
    for (const std::string& header : one.headers) cell(header, row) = to_single(cell(header, row));
  }
}

void Trials::drop(std::size_t row) {
  const auto at = static_cast<std::ptrdiff_t>(row);
  for (auto& [header, values] : columns_) values.erase(values.begin() + at);
  outside_.erase(outside_.begin() + at);
}

Flight Trials::flight() const {
  Flight flight("the self-test");
  for (const auto& [header, values] : columns_) flight.add(header, values);
  return flight;
}

std::vector<double> Trials::inputs(std::size_t row) const {
  std::vector<double> values;
  for (const Quantities& one : body_.readings) {
    if (one.is_difference) {
      values.push_back(cell(one.headers[0], row) - cell(one.headers[1], row));
      continue;
    }
    for (const std::string& header : one.headers) values.push_back(cell(header, row));
  }
  for (const Driver& driver : correction_.drivers) {
    values.push_back(channel_at(driver.channel, row) - driver.origin);
  }
  return values;
}

}  // namespace sepcal::exporting
