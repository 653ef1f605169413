// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "flight/text/status_text.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal {
namespace {

constexpr std::size_t most_shown = 12;
constexpr std::size_t most_unseen = 3;

/// Significant, and yet the rows left out are not predicted better.
bool is_refused(const EffectFinding& effect) {
  return effect.status == FindingStatus::not_seen && effect.p_adjusted < significant_below;
}

std::string percent(double fraction) {
  return std::isnan(fraction) ? "-" : fmt::format("{:.1f} %", 100.0 * fraction);
}

std::string probability(double p) {
  if (std::isnan(p)) return "-";
  return p >= 1e-99 ? fmt::format("{:.2g}", p) : "<1e-99";
}

std::string probability(const EffectFinding& effect) {
  return effect.status == FindingStatus::cannot_be_seen ? "-" : probability(effect.p_adjusted);
}

std::string_view in_words(const EffectFinding& effect) {
  if (effect.status == FindingStatus::found) return "FOUND";
  if (effect.status == FindingStatus::slow_change) return "slow change";
  if (effect.status == FindingStatus::undecided) return "undecided";
  return is_refused(effect) ? "not held out" : "not seen";
}

std::string estimates(const EffectFinding& effect) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, effect.coefficients.size()); ++k) {
    const Coefficient& coefficient = effect.coefficients[k];
    const std::string component = coefficient.name.substr(coefficient.name.rfind('.') + 1);
    text += effect.is_fitted ? fmt::format("{}{} {:.3g} +- {:.1g}", k == 0 ? "" : ", ", component,
                                           coefficient.estimate, coefficient.standard_error)
                             : fmt::format("{}{} about {:.2g}", k == 0 ? "" : ", ", component,
                                           coefficient.estimate);
    const bool is_last = k + 1 == std::min(most, effect.coefficients.size());
    const bool unit_changes = !is_last && effect.coefficients[k + 1].unit != coefficient.unit;
    if ((is_last || unit_changes) && coefficient.unit != "1") text += " " + coefficient.unit;
  }
  if (effect.coefficients.size() > most) text += ", ...";
  constexpr double told = 0.95;
  if (effect.share_after_selection < told) {
    text += fmt::format(" (chosen among many: more likely {:.2g} of that)",
                        effect.share_after_selection);
  }
  for (const auto& [name, value] : effect.shapes) {
    text += fmt::format(", {} {:.10g}", name.substr(name.rfind('.') + 1), value);
  }
  return text;
}

/// "-41.9 %"
std::string change(double from, double to) {
  const double change = 100.0 * (to / from - 1.0);
  return std::isfinite(change) ? fmt::format("{:+.1f} %", change) : "-";
}

/// As the verdict has it; then, where all is told, as stepwise regression has it.
std::string effect_row(const EffectFinding& effect, std::size_t width, Detail detail) {
  const std::string row =
      fmt::format("{:<{}}  {:<14} {:>9} {:>10} {:>10} {:>10.2f}", effect.name, width,
                  in_words(effect), probability(effect), percent(effect.predicted_drop),
                  percent(effect.held_out_gain), effect.visibility);
  if (detail == Detail::brief) return row + '\n';
  const Structure& structure = effect.structure;
  const std::string partial_f =
      std::isfinite(structure.partial_f) ? fmt::format("{:.3g}", structure.partial_f) : "-";
  return row + fmt::format(" {:>9} {:>9} {:>9}\n", partial_f,
                           change(structure.pse_without, structure.pse),
                           change(structure.sse, structure.sse - structure.sse_reduction));
}

std::string effect_rows(const FlightDiagnosis& result, Detail detail) {
  const std::vector<EffectFinding>& effects = result.diagnosis.effects;
  std::size_t width = 6;
  for (std::size_t i = 0; i < std::min(most_shown, effects.size()); ++i) {
    width = std::max(width, effects[i].name.size());
  }
  std::string text = fmt::format("{:<{}}  {:<14} {:>9} {:>10} {:>10} {:>10}", "effect", width,
                                 "status", "p", "predicted", "held out", "visibility");
  if (detail != Detail::brief) text += fmt::format(" {:>9} {:>9} {:>9}", "F", "PSE", "SSE");
  text += '\n';
  std::size_t shown = 0;
  std::size_t refused = 0;
  std::size_t unseen = 0;
  for (const EffectFinding& effect : effects) {
    if (shown == most_shown || effect.status == FindingStatus::cannot_be_seen) break;
    if (effect.status == FindingStatus::not_seen && !is_refused(effect) && ++unseen > most_unseen) {
      break;
    }
    if (is_refused(effect)) ++refused;
    text += effect_row(effect, width, detail);
    ++shown;
  }
  const auto hidden =
      std::ranges::count(effects, FindingStatus::cannot_be_seen, &EffectFinding::status);
  const auto others = static_cast<std::ptrdiff_t>(effects.size() - shown) - hidden;
  if (others > 0) text += fmt::format("and {} more\n", others);
  if (refused > 0) {
    text += "not held out: significant, but rows left out gain no more than by chance\n";
  }
  if (hidden > 0) {
    text += fmt::format("{} cannot be seen in this flight:", hidden);
    for (const EffectFinding& effect : effects) {
      if (effect.status == FindingStatus::cannot_be_seen) text += " " + effect.name;
    }
    text += '\n';
  }
  return text;
}

/// Names in a line, the first few of them.
std::string name_line(std::string_view what, const std::vector<std::string>& names,
                      std::string_view between) {
  constexpr std::size_t most = 8;
  if (names.empty()) return {};
  const std::size_t shown = std::min(most, names.size());
  std::string line = fmt::format(
      "  {}: {}", what,
      fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), between));
  if (names.size() > shown) line += fmt::format(" and {} more", names.size() - shown);
  return line + '\n';
}

/// What the others are beside the first.
std::string beside_rows(const Diagnosis& diagnosis) {
  const bool is_pair = split_effects(diagnosis.effects.front().name).size() > 1;
  return name_line("would do as well instead", list_beside(diagnosis, Beside::equivalent), ", ") +
         name_line("fades once it is added", list_beside(diagnosis, Beside::fades), ", ") +
         name_line("counts beside it", list_beside(diagnosis, Beside::counts), ", ") +
         name_line(is_pair ? "pairs that explain it as well" : "or two causes at once",
                   diagnosis.pairs, ", ");
}

/// What noise would have to be to look like the effect that stands first.
std::string excuse_row(const Diagnosis& diagnosis) {
  const double excuse = diagnosis.effects.front().excuse;
  if (std::isnan(excuse) || diagnosis.wanders.empty()) return {};
  std::vector<std::string> bounds;
  for (const WanderBound& bound : diagnosis.wanders) {
    bounds.push_back(fmt::format("{} {:.2g} {}", bound.name, bound.size, bound.unit));
  }
  const std::string usual = fmt::format("{}", fmt::join(bounds, ", "));
  if (std::isinf(excuse)) return fmt::format("  no noise that wanders looks like it ({})\n", usual);
  return excuse > 1.0 ? fmt::format(
                            "  noise looks like it if it wanders {:.0f} times as far as such "
                            "sensors let it ({})\n",
                            excuse, usual)
                      : fmt::format(
                            "  noise that wanders as far as such sensors let it looks like "
                            "it ({})\n",
                            usual);
}

/// A flight's file as the shell takes it, or those of flights that were joined, "a.csv + b.csv".
std::string file_words(std::string files) {
  constexpr std::string_view between = " + ";
  std::string words;
  while (true) {
    const std::size_t at = files.find(between);
    const std::string file = files.substr(0, at);
    words += words.empty() ? "" : " ";
    words += file.find(' ') == std::string::npos ? file : "'" + file + "'";
    if (at == std::string::npos) return words;
    files.erase(0, at + between.size());
  }
}

std::string best_effect(const FlightDiagnosis& result) {
  const EffectFinding& best = result.diagnosis.effects.front();
  std::string text =
      fmt::format("\n{}: {}\n  {}\n", best.name, result.sentences.front(), estimates(best));
  text += excuse_row(result.diagnosis);
  text += beside_rows(result.diagnosis);
  if (result.injection) return text;  // there is nothing to add: it isn't in the log
  text += '\n';
  for (const std::string& reason : result.diagnosis.advice.withheld) {
    text += "not to be added: " + reason + '\n';
  }
  const std::string& effect = result.diagnosis.advice.effect;
  if (effect.empty()) return text;
  return text + fmt::format("next: {} add {} {} '{}' -o NEXT.json\n", result.app,
                            file_words(result.flight.file),
                            result.calibration.empty() ? "BASE.json" : result.calibration, effect);
}

std::string unexplained_rows(const Omnibus& omnibus) {
  std::string text = fmt::format("\noffsets of {} by window, in standard errors:", omnibus.where);
  for (const auto& [window, sigmas] : omnibus.windows) {
    text += fmt::format(" {} {:.1f}", window, sigmas);
  }
  return text + "\n";
}

}  // namespace

std::string to_text(const FlightDiagnosis& result, Detail detail) {
  const Diagnosis& diagnosis = result.diagnosis;
  std::string page =
      fmt::format("{}: {} of {} rows of {}\n{}\n", result.model, result.flight.rows_used,
                  result.flight.rows, result.flight.file, verdict_sentence(result));
  if (!diagnosis.left_undone.empty()) {
    page += fmt::format("there was no time for: {}\n", fmt::join(diagnosis.left_undone, ", "));
  }
  for (const UnloggedCause& cause : diagnosis.unlogged) page += describe(cause) + '\n';
  page += '\n';
  if (result.status != FitStatus::converged) {
    page += fmt::format("of a fit whose status is {}\n{}\n", to_string(result.status),
                        text::sentence_lines(result.message, detail));
  }
  page += effect_rows(result, detail);
  if (diagnosis.verdict == Verdict::effect_missing) page += best_effect(result);
  if (diagnosis.verdict == Verdict::slow_change) {
    page += '\n' + excuse_row(diagnosis) +
            name_line("would do as well instead", list_beside(diagnosis, Beside::equivalent), ", ");
  }
  if (diagnosis.verdict != Verdict::effect_missing) {
    for (const std::string& reason : diagnosis.advice.withheld) {
      page += "not to be added: " + reason + '\n';
    }
  }
  if (diagnosis.omnibus.significant) page += unexplained_rows(diagnosis.omnibus);
  if (diagnosis.verdict != Verdict::effect_missing && !diagnosis.limits.empty()) {
    std::string shown;
    std::string hidden;
    for (const DetectionLimit& limit : diagnosis.limits) {
      if (std::isfinite(limit.size)) {
        shown += fmt::format("  {} {:.2g} {}", limit.port, limit.size, limit.unit);
      } else {
        hidden += "  " + limit.port;
      }
    }
    page += '\n';
    if (!shown.empty())
      page += "a slow change over the flight would have shown from:" + shown + '\n';
    if (!hidden.empty()) page += "a slow change that this flight can't show:" + hidden + '\n';
  }
  if (diagnosis.verdict != Verdict::effect_missing && !result.missing_channels.empty()) {
    page += "not logged, and could explain more:";
    for (const std::string& channel : result.missing_channels) page += " " + channel;
    page += '\n';
  }
  if (result.injection) {
    const Injection& injection = *result.injection;
    page += fmt::format("\ninjected {}: ", injection.effect);
    page += injection.rank == 0 ? "cannot be seen in this flight\n"
                                : fmt::format("would have been {} (rank {}, p {})\n",
                                              injection.found ? "found" : "missed", injection.rank,
                                              probability(injection.p_adjusted));
  }
  return page;
}

}  // namespace sepcal
