// SPDX-License-Identifier: BSD-3-Clause
#include "diagnose_arguments.hpp"

#include <limits>

#include "option_values.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {

int exit_code(Verdict verdict) {
  switch (verdict) {
    case Verdict::adequate:
      return 0;
    case Verdict::effect_missing:
      return 3;
    default:
      return 6;
  }
}

void DiagnoseArguments::add_to(CLI::App& diagnose) {
  diagnose.add_flag("--auto", adds_,
                    "adds the advised effect, fits and diagnoses again until nothing passes; -o "
                    "then writes the fit");
  const auto read = [this](const std::string& text) {
    most_ = parse_whole_number("--most", text, std::numeric_limits<std::uint32_t>::max());
  };
  diagnose
      .add_option_function<std::string>("--most", read,
                                        "with --auto: the largest number of effects to add")
      ->type_name("N");
  diagnose
      .add_option("--only", only_,
                  "the candidates, in place of those that are known; may be repeated")
      ->type_name("E")
      ->take_all()
      ->allow_extra_args(false);
  diagnose
      .add_option("--error-budget", error_budget_,
                  "how far sensor errors drift at most, if you know it, in their units: "
                  "velocity=0.3,heading=0.05; the page names them")
      ->type_name("NAME=SIZE,...")
      ->delimiter(',');
  diagnose.add_option("--within", within_, "answers within this time and says what it skipped")
      ->type_name("SECONDS");
  diagnose
      .add_option("--pse", pse_,
                  "the noise bound in PSE, the predicted square error: sidpac, half the "
                  "measurement's variance, or classic, all of it")
      ->type_name("BOUND")
      ->capture_default_str();
  diagnose
      .add_option("--rule", rule_,
                  "how to decide: verdict, or partial-f, by stepwise regression: the largest "
                  "partial F from 20 on, one candidate at a time, as if residuals were white")
      ->type_name("RULE")
      ->capture_default_str();
  diagnose
      .add_option("--inject", inject_,
                  "puts an effect into the measurements first: would it have been found?")
      ->type_name("E=SIZE");
}

std::optional<SizedEffect> DiagnoseArguments::injected() const {
  if (inject_.empty()) return std::nullopt;
  SizedEffect injected = parse_sized_effect(inject_, "--inject");
  if (adds_) {
    throw Error("--inject and --auto exclude each other: what is injected is not in the log");
  }
  return injected;
}

StepwiseOptions DiagnoseArguments::resolve() const {
  if (most_ && !adds_) throw Error("--most is of --auto; give both, or leave it out");
  StepwiseOptions options;
  options.most = most_.value_or(options.most);
  options.diagnosis.only = only_;
  for (const std::string& given : error_budget_) {
    const auto [name, size] = parse_assignment("--error-budget", given, "NAME=SIZE");
    options.diagnosis.error_budget[name] = parse_value("--error-budget", size);
    if (!(options.diagnosis.error_budget[name] >= 0.0)) {
      throw Error("--error-budget " + given + ": the size must be 0 or more");
    }
  }
  if (!within_.empty()) {
    options.diagnosis.within = parse_value("--within", within_);
    if (!(options.diagnosis.within > 0.0)) {
      throw Error("--within " + within_ + ": give a number of seconds above 0");
    }
  }
  options.diagnosis.pse = choice_of<PseBound>("--pse", pse_);
  options.diagnosis.rule = choice_of<DiagnosisRule>("--rule", rule_);
  return options;
}

}  // namespace sepcal::app
