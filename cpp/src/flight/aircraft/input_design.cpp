// SPDX-License-Identifier: BSD-3-Clause
// Inputs to be flown, as columns by their headers.
#include <fmt/format.h>

#include "base/page.hpp"
#include "flight/files/csv_cells.hpp"
#include "flight/json/output_values.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/frequency.hpp"

namespace sepcal {

using base::Page;
using base::page;

namespace {

std::vector<std::string> names_of(const Amplitudes& amplitudes) {
  if (amplitudes.empty()) throw Error("no input is named; give one with its largest deflection");
  std::vector<std::string> names{"time_s"};
  for (const auto& [name, amplitude] : amplitudes) {
    if (name.empty()) throw Error("an input has no name; give its column, as elevator_rad");
    for (const std::string& other : names) {
      if (name == other) {
        throw Error(
            fmt::format("the column '{}' would stand twice; name the input otherwise", name));
      }
    }
    names.push_back(name);
  }
  names.erase(names.begin());
  return names;
}

}  // namespace

InputDesign design_multisines(const Amplitudes& amplitudes, const MultisineOptions& options) {
  InputDesign design;
  design.kind = "multisine";
  design.inputs = names_of(amplitudes);
  std::vector<double> sizes;
  for (const auto& [name, amplitude] : amplitudes) sizes.push_back(amplitude);
  Multisines made = multisines(sizes, options);
  design.time = std::move(made.time);
  design.signals = std::move(made.signals);
  design.peak_factors = std::move(made.peak_factors);
  for (const std::vector<int>& harmonics : made.harmonics) {
    std::vector<double>& frequencies = design.frequencies.emplace_back();
    for (const int k : harmonics) frequencies.push_back(k / options.duration);
  }
  return design;
}

InputDesign design_steps(const Amplitudes& amplitudes, const StepsOptions& options) {
  InputDesign design;
  design.kind = "3-2-1-1";
  design.inputs = names_of(amplitudes);
  if (amplitudes.size() > 1) {
    throw Error("3-2-1-1 is of one input; make one for each, or a multisine for all at once");
  }
  StepInput made = three_two_one_one(amplitudes.front().second, options);
  design.signals = Eigen::Map<const Eigen::VectorXd>(made.signal.data(),
                                                     static_cast<Eigen::Index>(made.signal.size()));
  design.time = std::move(made.time);
  design.step = made.step;
  design.share = made.share;
  return design;
}

void write_csv(const InputDesign& design, OutputFile& target) {
  std::string line = "time_s";
  for (const std::string& input : design.inputs) {
    line += ',';
    files::append_text(line, input);
  }
  target.write(line + "\n");
  for (std::size_t row = 0; row < design.time.size(); ++row) {
    line.clear();
    files::append_number(line, design.time[row]);
    for (Eigen::Index i = 0; i < design.signals.cols(); ++i) {
      line += ',';
      files::append_number(line, design.signals(static_cast<Eigen::Index>(row), i));
    }
    target.write(line + "\n");
  }
}

std::string to_text(const InputDesign& design, Detail /*detail*/) {
  Page text = page("{}: {} rows, {:.6g} s\n", design.kind, design.time.size(), design.time.back());
  for (std::size_t i = 0; i < design.peak_factors.size(); ++i) {
    const std::vector<double>& frequencies = design.frequencies[i];
    text += page("  {}: {} frequencies from {:.4g} to {:.4g} Hz, relative peak factor {:.3f}\n",
                 design.inputs[i], frequencies.size(), frequencies.front(), frequencies.back(),
                 design.peak_factors[i]);
  }
  if (design.kind == "3-2-1-1") {
    text += page("  {}: steps of {:.4g} s, {:.0f} % of the energy within the band\n",
                 design.inputs.front(), design.step, 100.0 * design.share);
  }
  return text.text();
}

std::string to_json(const InputDesign& design) {
  using json::Json;
  Json root = {{"schema_version", schema_version},
               {"kind", design.kind},
               {"rows", design.time.size()},
               {"duration", design.time.back()}};
  root["inputs"] = Json::object();
  for (std::size_t i = 0; i < design.inputs.size(); ++i) {
    Json& input = root["inputs"][design.inputs[i]];
    if (i < design.peak_factors.size()) {
      input = {{"frequencies", design.frequencies[i]}, {"peak_factor", design.peak_factors[i]}};
    } else {
      input = {{"step", design.step}, {"share_in_band", design.share}};
    }
  }
  return json::text_of(root);
}

}  // namespace sepcal
