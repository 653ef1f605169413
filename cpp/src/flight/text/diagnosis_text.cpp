// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "base/page.hpp"
#include "flight/text/number_text.hpp"
#include "flight/text/status_text.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal {

using base::joined;
using base::Page;
using base::page;

namespace {

constexpr std::size_t most_shown = 12;
constexpr std::size_t most_unseen = 3;

/// Significant, and yet the rows left out are not predicted better.
bool is_refused(const EffectFinding& effect) {
  return effect.status == FindingStatus::not_seen && effect.p_adjusted < significant_below;
}

bool is_unpredicted(const EffectFinding& effect) {
  return is_refused(effect) && !effect.held_out_passed;
}

/// Significant, and rows left out are predicted better, by next to nothing.
bool is_too_small(const EffectFinding& effect) {
  return is_refused(effect) && effect.held_out_passed && effect.held_out_gain < least_gain;
}

Page percent(double fraction) {
  return std::isnan(fraction) ? Page("-") : page("{:.1f} %", 100.0 * fraction);
}

Page probability(double p) {
  if (std::isnan(p)) return "-";
  return p >= 1e-99 ? page("{:.2g}", p) : Page("<1e-99");
}

Page probability(const EffectFinding& effect) {
  return effect.status == FindingStatus::cannot_be_seen ? Page("-")
                                                        : probability(effect.p_adjusted);
}

Page estimates(const EffectFinding& effect) {
  constexpr std::size_t most = 3;
  Page text;
  for (std::size_t k = 0; k < std::min(most, effect.coefficients.size()); ++k) {
    const Coefficient& coefficient = effect.coefficients[k];
    const std::string component = coefficient.name.substr(coefficient.name.rfind('.') + 1);
    text += effect.is_fitted
                ? page("{}{} {:.3g} +- {:.1g}", k == 0 ? "" : ", ", component, coefficient.estimate,
                       coefficient.standard_error)
                : page("{}{} about {:.2g}", k == 0 ? "" : ", ", component, coefficient.estimate);
    const bool is_last = k + 1 == std::min(most, effect.coefficients.size());
    const bool unit_changes = !is_last && effect.coefficients[k + 1].unit != coefficient.unit;
    if ((is_last || unit_changes) && coefficient.unit != "1") text += page(" {}", coefficient.unit);
  }
  if (effect.coefficients.size() > most) text += ", ...";
  constexpr double told = 0.95;
  if (effect.share_after_selection < told) {
    text += page(" (chosen among many: more likely {:.2g} of that)", effect.share_after_selection);
  }
  for (const auto& [name, value] : effect.shapes) {
    text += page(", {} {:.10g}", name.substr(name.rfind('.') + 1), value);
  }
  return text;
}

/// "-41.9 %"
Page change(double from, double to) {
  const double change = 100.0 * (to / from - 1.0);
  return std::isfinite(change) ? page("{:+.1f} %", change) : Page("-");
}

/// As stepwise regression has it.
Page regression_row(const EffectFinding& effect, std::size_t width) {
  const Structure& structure = effect.structure;
  return page("{:<{}}  {:<14} {:>9} {:>8} {:>9} {:>9}\n", effect.name, width,
              effect.status == FindingStatus::found ? "ENTERS" : status_in_words(effect),
              text::defined(structure.partial_f, "{:.4g}"),
              text::defined(structure.r_squared, "{:.4f}"),
              change(structure.pse_without, structure.pse),
              change(structure.sse, structure.sse - structure.sse_reduction));
}

/// As the verdict has it; then, where all is told, as stepwise regression has it.
Page effect_row(const EffectFinding& effect, std::size_t width, Detail detail) {
  const Page row = page("{:<{}}  {:<14} {:>9} {:>10} {:>10} {:>10.2f}", effect.name, width,
                        effect.status == FindingStatus::found ? "FOUND" : status_in_words(effect),
                        probability(effect), percent(effect.predicted_drop),
                        percent(effect.held_out_gain), effect.visibility);
  if (detail == Detail::brief) return row + "\n";
  const Structure& structure = effect.structure;
  const Page partial_f =
      std::isfinite(structure.partial_f) ? page("{:.3g}", structure.partial_f) : Page("-");
  return row + page(" {:>9} {:>9} {:>9}\n", partial_f, change(structure.pse_without, structure.pse),
                    change(structure.sse, structure.sse - structure.sse_reduction));
}

Page effect_rows(const FlightDiagnosis& result, Detail detail) {
  const std::vector<EffectFinding>& effects = result.diagnosis.effects;
  std::size_t width = 6;
  for (std::size_t i = 0; i < std::min(most_shown, effects.size()); ++i) {
    width = std::max(width, effects[i].name.size());
  }
  const bool by_f = result.diagnosis.rule == DiagnosisRule::partial_f;
  Page text = page("{:<{}}  {:<14}", "effect", width, "status");
  if (by_f) {
    text += page(" {:>9} {:>8} {:>9} {:>9}", "F", "R^2", "PSE", "SSE");
  } else {
    text += page(" {:>9} {:>10} {:>10} {:>10}", "p", "predicted", "held out", "visibility");
    if (detail != Detail::brief) text += page(" {:>9} {:>9} {:>9}", "F", "PSE", "SSE");
  }
  text += "\n";
  std::size_t shown = 0;
  bool some_unpredicted = false;
  bool some_small = false;
  std::size_t unseen = 0;
  for (const EffectFinding& effect : effects) {
    if (shown == most_shown || effect.status == FindingStatus::cannot_be_seen) break;
    if (effect.status == FindingStatus::not_seen && !is_refused(effect) && ++unseen > most_unseen) {
      break;
    }
    some_small = some_small || is_too_small(effect);
    some_unpredicted = some_unpredicted || is_unpredicted(effect);
    text += by_f ? regression_row(effect, width) : effect_row(effect, width, detail);
    ++shown;
  }
  const auto hidden =
      std::ranges::count(effects, FindingStatus::cannot_be_seen, &EffectFinding::status);
  const auto others = static_cast<std::ptrdiff_t>(effects.size() - shown) - hidden;
  if (others > 0) text += page("and {} more\n", others);
  if (some_unpredicted) {
    text +=
        "not held out: significant, but on rows held out it removes no more error than chance "
        "would\n";
  }
  if (some_small) {
    text +=
        "too small: significant, but it removes less than 1 % of the error on rows held out, as "
        "noise in the inputs can\n";
  }
  if (hidden > 0) {
    text += page("{} cannot be seen in this flight:", hidden);
    for (const EffectFinding& effect : effects) {
      if (effect.status == FindingStatus::cannot_be_seen) text += page(" {}", effect.name);
    }
    text += "\n";
  }
  return text;
}

/// Names in a line, the first few of them.
Page name_line(std::string_view what, std::vector<std::string> names) {
  constexpr std::size_t most = 8;
  if (names.empty()) return {};
  const std::size_t more = names.size() - std::min(most, names.size());
  names.resize(names.size() - more);
  const Page line = page("  {}: {}", what, joined(names, ", "));
  return more == 0 ? line + "\n" : line + page(" and {} more\n", more);
}

/// What the others are beside the first.
Page beside_rows(const Diagnosis& diagnosis) {
  const bool is_pair = split_effects(diagnosis.effects.front().name).size() > 1;
  return name_line("would do as well instead", list_beside(diagnosis, Beside::equivalent)) +
         name_line("not needed once it is in", list_beside(diagnosis, Beside::fades)) +
         name_line("needed as well", list_beside(diagnosis, Beside::counts)) +
         name_line(is_pair ? "pairs that explain it as well" : "or two causes at once",
                   diagnosis.pairs);
}

/// What noise would have to be to look like the effect that stands first.
Page excuse_row(const Diagnosis& diagnosis) {
  const double excuse = diagnosis.effects.front().excuse;
  if (std::isnan(excuse) || diagnosis.error_budget.empty()) return {};
  Page usual;
  for (const ErrorBound& bound : diagnosis.error_budget) {
    usual += page("{}{} {:.2g} {}", usual.empty() ? "" : ", ", bound.name, bound.size, bound.unit);
  }
  if (std::isinf(excuse)) return page("  no drift of the sensors looks like it ({})\n", usual);
  return excuse > 1.0
             ? page("  drift could explain it only at {:.0f} times the sensors' usual limit ({})\n",
                    excuse, usual)
             : page("  drift within the sensors' usual limit could look like it ({})\n", usual);
}

/// A flight's file as the shell takes it, or those of flights that were joined, "a.csv + b.csv".
std::string file_words(std::string_view files) {
  constexpr std::string_view between = " + ";
  const std::size_t at = files.find(between);
  std::string word = base::file_in_shell(files.substr(0, at));
  if (at == std::string_view::npos) return word;
  return word + " " + file_words(files.substr(at + between.size()));
}

Page best_effect(const FlightDiagnosis& result) {
  const EffectFinding& best = result.diagnosis.effects.front();
  Page text = page("\n{}: {}\n  {}\n", best.name, result.sentences.front(), estimates(best));
  text += excuse_row(result.diagnosis);
  text += beside_rows(result.diagnosis);
  if (result.injection) return text;  // there is nothing to add: it isn't in the log
  text += "\n";
  for (const std::string& reason : result.diagnosis.advice.withheld) {
    text += page("not to be added: {}\n", reason);
  }
  const std::string& effect = result.diagnosis.advice.effect;
  if (effect.empty()) return text;
  return text +
         page("next: {} {} {} {} -o NEXT.json\n", command_of(result.app, "add"),
              file_words(result.flight.file),
              base::file_in_shell(result.calibration.empty() ? "BASE.json" : result.calibration),
              base::in_shell(effect));
}

Page unexplained_rows(const Omnibus& omnibus) {
  Page text = page("\noffsets of {} by window, in standard errors:", omnibus.where);
  for (const auto& [window, sigmas] : omnibus.windows) {
    text += page(" {} {:.1f}", window, sigmas);
  }
  return text + "\n";
}

}  // namespace

std::string_view status_in_words(const EffectFinding& effect) {
  if (is_too_small(effect)) return "too small";
  if (is_unpredicted(effect)) return "not held out";
  switch (effect.status) {
    case FindingStatus::found:
      return "found";
    case FindingStatus::slow_change:
      return "slow change";
    case FindingStatus::undecided:
      return "undecided";
    case FindingStatus::not_seen:
      return "not seen";
    case FindingStatus::cannot_be_seen:
      break;
  }
  return "can't be seen";
}

std::string_view beside_in_words(const EffectFinding& effect) {
  switch (effect.beside) {
    case Beside::untried:
      break;
    case Beside::equivalent:
      return "as good instead";
    case Beside::fades:
      return "fades";
    case Beside::counts:
      return "counts too";
  }
  return "";
}

std::string to_text(const FlightDiagnosis& result, Detail detail) {
  const Diagnosis& diagnosis = result.diagnosis;
  Page text = page("{}: {} of {} rows of {}\n{}\n", result.model, result.flight.rows_used,
                   result.flight.rows, result.flight.file, verdict_sentence(result));
  if (!diagnosis.left_undone.empty()) {
    text += page("skipped for lack of time: {}\n", joined(diagnosis.left_undone, ", "));
  }
  for (const UnmeasuredCause& cause : diagnosis.unmeasured) text += page("{}\n", describe(cause));
  text += "\n";
  if (result.status != FitStatus::converged) {
    text += page("the status of the fit is {}\n{}\n", to_string(result.status),
                 text::sentence_lines(result.message, detail));
  }
  text += effect_rows(result, detail);
  if (diagnosis.verdict == Verdict::effect_missing) text += best_effect(result);
  if (diagnosis.verdict == Verdict::slow_change) {
    text += "\n" + excuse_row(diagnosis);
  }
  if (diagnosis.verdict == Verdict::slow_change || diagnosis.verdict == Verdict::unexplained) {
    text += name_line("would do as well instead", list_beside(diagnosis, Beside::equivalent));
  }
  if (diagnosis.verdict != Verdict::effect_missing) {
    for (const std::string& reason : diagnosis.advice.withheld) {
      text += page("not to be added: {}\n", reason);
    }
  }
  if (diagnosis.omnibus.significant) text += unexplained_rows(diagnosis.omnibus);
  if (diagnosis.verdict != Verdict::effect_missing && !diagnosis.limits.empty()) {
    Page shown;
    Page hidden;
    for (const DetectionLimit& limit : diagnosis.limits) {
      if (std::isfinite(limit.size)) {
        shown += page("  {} {:.2g}{}{}", limit.port, limit.size, limit.unit == "1" ? "" : " ",
                      limit.unit == "1" ? "" : limit.unit);
      } else {
        hidden += page("  {}", limit.port);
      }
    }
    text += "\n";
    if (!shown.empty()) {
      text += "smallest change over the flight that would have shown:" + shown + "\n";
    }
    if (!hidden.empty()) text += "no change of these would have shown:" + hidden + "\n";
  }
  if (diagnosis.verdict != Verdict::effect_missing && !result.missing_channels.empty()) {
    text += "not logged, and could explain more:";
    for (const std::string& channel : result.missing_channels) text += page(" {}", channel);
    text += "\n";
  }
  if (result.injection) {
    const Injection& injection = *result.injection;
    text += page("\ninjected {}: ", injection.effect);
    text += injection.rank == 0
                ? Page("cannot be seen in this flight\n")
                : page("would have been {} (rank {}, p {})\n", injection.found ? "found" : "missed",
                       injection.rank, probability(injection.p_adjusted));
  }
  return text.text();
}

}  // namespace sepcal
