// SPDX-License-Identifier: BSD-3-Clause
// Fields of results that files and Python call alike, told once: JSON and the classes of Python
// with their documents follow. A new field is a member and a row here.
#pragma once

#include "sepcal/diagnosis.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/stepwise.hpp"

namespace sepcal::schema {

/// Where a field is told.
enum class Told {
  everywhere,
  in_code,  // and not in files, whose key or place says it
  lately,   // in files too, but not in those of before
};

/// What a null of a file means.
enum class Null { not_a_number, no_lower_end, no_upper_end, refused };

/// `each(row)` calls row(name, member, sentence[, told[, null]]) for each field, in the order of
/// files. A member is what std::invoke() takes with the result; of one that is computed it gives a
/// value in a reference's place.
template <class Result>
struct ResultFields;

template <>
struct ResultFields<Misfit> {
  template <class Row>
  static void each(const Row& row) {
    row("segment", &Misfit::segment,
        R"(Maneuver, or "120.0:180.5" [s] where there are no labels; empty: the whole.)");
    row("output", &Misfit::output, "");
    row("unit", &Misfit::unit, "", Told::in_code);
    row("rows", &Misfit::rows, "");
    row("rmse", &Misfit::rmse, "");
    row("mean", &Misfit::mean, "Of z - model: what a constant offset would explain.");
    row("lag_one", &Misfit::lag_one,
        "Correlation of neighbouring residuals, never across a segment's edge.");
  }
};

template <>
struct ResultFields<ChannelMisfit> {
  template <class Row>
  static void each(const Row& row) {
    row("driver", &ChannelMisfit::driver,
        R"("altitude_m"; "time", "alpha", "roll" for what the probe knows by itself.)");
    row("output", &ChannelMisfit::output, "");
    row("share_line", &ChannelMisfit::share_line,
        "Of the residual's variance that a straight line would explain.");
    row("share_smooth", &ChannelMisfit::share_smooth,
        "The same of a natural spline of six even knots.");
    row("slope", &ChannelMisfit::slope, "Of the line.");
    row("slope_error", &ChannelMisfit::slope_error,
        "Its standard error in the residual's own noise, rather too large.");
    row("unit", &ChannelMisfit::unit, "Of the slope.");
  }
};

template <>
struct ResultFields<Window> {
  template <class Row>
  static void each(const Row& row) {
    row("first_s", &Window::first_s, "Time of its first row.");
    row("last_s", &Window::last_s, "And of its last.");
    row("rows", &Window::rows, "");
    row("rmse", &Window::rmse, "By output.");
    row("mean", &Window::mean, "By output, of z - model.");
  }
};

template <>
struct ResultFields<OutputValidation> {
  template <class Row>
  static void each(const Row& row) {
    row("output", &OutputValidation::output, "", Told::in_code);
    row("r_squared", &OutputValidation::r_squared,
        "1 - sum (z - model)^2 / sum (z - mean z)^2; may be negative.");
    row("theil", &OutputValidation::theil,
        "Theil's inequality coefficient, rms(z - model) / (rms(z) + rms(model)): 0 exact, 1 "
        "worst.");
    row("theil_bias", &OutputValidation::theil_bias,
        "Share of the mean square by the difference of the means.");
    row("theil_variance", &OutputValidation::theil_variance,
        "By the difference of the standard deviations.");
    row("theil_covariance", &OutputValidation::theil_covariance,
        "The rest, by what doesn't correlate: near 1 of a good model.");
  }
};

template <>
struct ResultFields<ReferenceMisfit> {
  template <class Row>
  static void each(const Row& row) {
    row("quantity", &ReferenceMisfit::quantity,
        R"("airspeed", "alpha", "mx"; "field": the calibrated field's strength.)");
    row("unit", &ReferenceMisfit::unit, "Of all numbers but the scales.");
    row("calibrated", &ReferenceMisfit::calibrated, R"(What apply calls it: "airspeed_cal_mps".)");
    row("reference", &ReferenceMisfit::reference, "What the log calls the other.");
    row("rows", &ReferenceMisfit::rows, "In which both are there.");
    row("bias", &ReferenceMisfit::bias, "Mean of calibrated - reference.");
    row("bias_error", &ReferenceMisfit::bias_error,
        "Its standard error, which allows for a coloured difference.");
    row("rms", &ReferenceMisfit::rms, "Of the difference.");
    row("sd", &ReferenceMisfit::sd, "Of the difference about its mean.");
    row("lag_one", &ReferenceMisfit::lag_one, "Correlation of neighbouring differences.");
    row("scale", &ReferenceMisfit::scale, "Of calibrated = offset + scale * reference.");
    row("scale_error", &ReferenceMisfit::scale_error, "As bias_error.");
    row("offset", &ReferenceMisfit::offset, "");
    row("offset_error", &ReferenceMisfit::offset_error, "As bias_error.");
    row("scale_reversed", &ReferenceMisfit::scale_reversed,
        "One over the scale of the reference on the calibrated; noise of either makes them "
        "differ.");
  }
};

template <>
struct ResultFields<Parameter> {
  template <class Row>
  static void each(const Row& row) {
    row("name", &Parameter::name, "", Told::in_code);
    row("value", &Parameter::value, "", Told::everywhere, Null::refused);
    row("standard_error", &Parameter::standard_error,
        "The one to believe. NaN where undefined: fixed, at a bound, singular.");
    row("standard_error_white", &Parameter::standard_error_white,
        "What it would be if the residuals were white.");
    row("standard_error_noise_model", &Parameter::standard_error_noise_model,
        "By a noise model of each output's residual.", Told::lately);
    row("standard_error_blocks", &Parameter::standard_error_blocks,
        "By leaving out blocks of the record; NaN where too few tell.", Told::lately);
    row("unit", &Parameter::unit, "");
    row("lower", &Parameter::lower, "Its bounds; infinite where there is none.", Told::everywhere,
        Null::no_lower_end);
    row("upper", &Parameter::upper, "", Told::everywhere, Null::no_upper_end);
    row("at_bound", &Parameter::at_bound, "Whether a bound stopped it.");
    row("fixed", &Parameter::fixed, "Whether it was held.", Told::in_code);
  }
};

template <>
struct ResultFields<NoiseSize> {
  template <class Row>
  static void each(const Row& row) {
    row("name", &NoiseSize::name, R"("q_alpha" of a process noise, "r_alpha_m" of an output.)",
        Told::in_code);
    row("value", &NoiseSize::value,
        "Root of the spectral density; of an output the standard deviation.", Told::everywhere,
        Null::refused);
    row("unit", &NoiseSize::unit, "");
    row("standard_error", &NoiseSize::standard_error, "NaN: given, or at its floor.");
    row("at_floor", &NoiseSize::at_floor, "Nothing but the floor stopped it.");
  }
};

template <>
struct ResultFields<Derived> {
  template <class Row>
  static void each(const Row& row) {
    row("name", &Derived::name, "", Told::in_code);
    row("value", &Derived::value, "");
    row("standard_error", &Derived::standard_error,
        "NaN where that of a parameter it depends on is.");
    row("standard_error_white", &Derived::standard_error_white,
        "What it would be if the residuals were white.");
    row("standard_error_noise_model", &Derived::standard_error_noise_model,
        "By a noise model of each output's residual.", Told::lately);
    row("standard_error_blocks", &Derived::standard_error_blocks,
        "By leaving out blocks of the record; NaN where too few tell.", Told::lately);
    row("unit", &Derived::unit, "");
  }
};

template <>
struct ResultFields<HistoryEntry> {
  template <class Row>
  static void each(const Row& row) {
    row("effect", &HistoryEntry::effect, R"(Several that were added together: "E1+E2".)");
    row("rmse_before", &HistoryEntry::rmse_before, "");
    row("rmse_after", &HistoryEntry::rmse_after, "");
    row("held_out_before", &HistoryEntry::held_out_before, "");
    row("held_out_after", &HistoryEntry::held_out_after, "");
    row("predicted_drop", &HistoryEntry::predicted_drop, "Of the RMSE, 1 - after / before.");
  }
};

template <>
struct ResultFields<LogNote> {
  template <class Row>
  static void each(const Row& row) {
    row("kind", &LogNote::kind, R"("held", "units", ...)");
    row("concern", &LogNote::concern,
        R"("wrong": a result is, or there is none; "matters": estimates or their errors suffer; )"
        R"("slight": good to know.)");
    row("columns", &LogNote::columns, "");
    row("rows", &LogNote::rows, "Concerned.");
    row("first_s", &LogNote::first_s, "Time of the first of these rows; NaN: of all.");
    row("last_s", &LogNote::last_s, "And of the last.");
    row("found", &LogNote::found, "What it is.");
    row("effect", &LogNote::effect, "What it does to the result.");
    row("advice", &LogNote::advice, "What to do.");
  }
};

/// All but what is by coefficient, and the sentence.
template <>
struct ResultFields<EffectFinding> {
  template <class Row>
  static void each(const Row& row) {
    using Finding = EffectFinding;
    row("name", &Finding::name, "What add() takes.");
    row("drivers", &Finding::drivers, "Channels.");
    row("shapes", &Finding::shapes, R"(Of a scan: {"bias_step.t0": 41.2}.)");
    row("p_value", &Finding::p_value, "For itself, corrected for its scan.");
    row("log10_p", &Finding::log10_p, "Of the same, which may be too small for a float.");
    row("p_adjusted", &Finding::p_adjusted, "After Holm: for the verdict.");
    row("p_listed", &Finding::p_listed, "After Benjamini & Hochberg: for the list.");
    row("share_after_selection", &Finding::share_after_selection,
        "Of the estimates, allowing for the effect's choice.");
    row("outputs", &Finding::outputs, "That it can reach: all where they share parameters.");
    row(
        "partial_f", [](auto& self) -> auto& { return self.structure.partial_f; },
        "As stepwise regression has it, residuals taken for white; sums of squares over `outputs`, "
        "each in units of its RMSE in the fit.");
    row("sse", [](auto& self) -> auto& { return self.structure.sse; }, "Without it.");
    row(
        "sse_reduction", [](auto& self) -> auto& { return self.structure.sse_reduction; },
        "By orthogonal functions: what it takes of sse.");
    row(
        "pse", [](auto& self) -> auto& { return self.structure.pse; },
        "Predicted square error, SSE/N + 2 s2max p/N.");
    row(
        "pse_without", [](auto& self) -> auto& { return self.structure.pse_without; },
        "The same without it.");
    row(
        "r_squared", [](auto& self) -> auto& { return self.structure.r_squared; },
        "Of what is measured about its mean, with it.");
    row(
        "r_squared_without", [](auto& self) -> auto& { return self.structure.r_squared_without; },
        "The same without it.");
    row("predicted_drop", &Finding::predicted_drop,
        "Of the RMSE over these outputs, 1 - after / before.");
    row("held_out_gain", &Finding::held_out_gain, "The same on rows left out.");
    row("held_out_before", &Finding::held_out_before, "RMSE of rows left out.");
    row("held_out_after", &Finding::held_out_after, "The same with it.");
    row("held_out_passed", &Finding::held_out_passed,
        "The mean gain of a block exceeds its standard error.");
    row("held_out_interleaved", &Finding::held_out_interleaved,
        "Blocks in between, not whole segments, were left out.");
    row("held_out_refitted", &Finding::held_out_refitted,
        "By real fits with it and without, not by one step.");
    row("is_fitted", &Finding::is_fitted, "The estimates are those of a fit with it.");
    row("excuse", &Finding::excuse,
        "How many times too far noise would have to wander to look like it.");
    row("visibility", &Finding::visibility,
        "Below 0.05 the flight can't show at least a part of it.");
    row("absorbed_by", &Finding::absorbed_by, "How far ignoring it shifts each parameter.");
    row("status", &Finding::status,
        R"("found", "slow_change", "undecided", "not_seen", "cannot_be_seen".)");
    row("beside", &Finding::beside,
        R"(The first found: "equivalent", "fades", "counts"; "untried" of others.)");
  }
};

template <>
struct ResultFields<UnmeasuredCause> {
  template <class Row>
  static void each(const Row& row) {
    row("kind", &UnmeasuredCause::kind, R"("common_cause" or "spectral_line".)");
    row("sentence", [](auto& self) { return describe(self); }, "In plain words.");
    row("outputs", &UnmeasuredCause::outputs, "That show it.");
    row("p_value", &UnmeasuredCause::p_value, "For itself.");
    row("p_adjusted", &UnmeasuredCause::p_adjusted, "After Holm: for the verdict.");
    row("all_along", &UnmeasuredCause::all_along, "Strongest over the whole flight.");
    row("first_s", &UnmeasuredCause::first_s, "Of the rows where it is strongest [s].");
    row("last_s", &UnmeasuredCause::last_s, "");
    row("frequency_hz", &UnmeasuredCause::frequency, "NaN where none stands out.");
  }
};

template <>
struct ResultFields<ResidualNoise> {
  template <class Row>
  static void each(const Row& row) {
    row("output", &ResidualNoise::output, "", Told::in_code);
    row("unit", &ResidualNoise::unit, "");
    row("rmse", &ResidualNoise::rmse, "");
    row("lag_one", &ResidualNoise::lag_one, "Correlation of neighbouring rows.");
    row("ljung_box_p", &ResidualNoise::ljung_box_p,
        "Of 20 lags: small where the residual is not white.");
    row("noise", &ResidualNoise::noise, "Its NoiseModel.");
    row("floor", &ResidualNoise::floor, "What no model of the past predicts better.");
  }
};

template <>
struct ResultFields<DetectionLimit> {
  template <class Row>
  static void each(const Row& row) {
    row("port", &DetectionLimit::port, "", Told::in_code);
    row("size", &DetectionLimit::size, "Change over the whole flight.");
    row("unit", &DetectionLimit::unit, "");
  }
};

template <>
struct ResultFields<ErrorBound> {
  template <class Row>
  static void each(const Row& row) {
    row("name", &ErrorBound::name, "As `error_budget` of diagnose() takes it.", Told::in_code);
    row("size", &ErrorBound::size, "Standard deviation of each component, at most.");
    row("unit", &ErrorBound::unit, "");
  }
};

template <>
struct ResultFields<DiagnosisWork> {
  template <class Row>
  static void each(const Row& row) {
    row("screened", &DiagnosisWork::screened, "Candidates.");
    row("tested", &DiagnosisWork::tested, "By likelihood ratios, their noise estimated anew.");
    row("calibrated", &DiagnosisWork::calibrated, "By draws of the noise.");
    row("drawn", &DiagnosisWork::drawn, "These draws, of each noise.");
    row("refitted", &DiagnosisWork::refitted, "Models with a candidate that were fitted.");
    row("tried_on_some_rows", &DiagnosisWork::tried_on_some_rows,
        "The same to 400 rows, where a fit is far off.");
  }
};

template <>
struct ResultFields<StepwiseStep> {
  template <class Row>
  static void each(const Row& row) {
    row("effect", [](auto& self) -> auto& { return self.promised.name; }, "");
    row("outputs", [](auto& self) -> auto& { return self.promised.outputs; }, "That it can reach.");
    row("p_adjusted", [](auto& self) -> auto& { return self.promised.p_adjusted; }, "");
    row("partial_f", [](auto& self) -> auto& { return self.promised.structure.partial_f; }, "");
    row("pse", [](auto& self) -> auto& { return self.promised.structure.pse; }, "");
    row("pse_without", [](auto& self) -> auto& { return self.promised.structure.pse_without; }, "");
    row("r_squared", [](auto& self) -> auto& { return self.promised.structure.r_squared; }, "");
    row(
        "held_out_gain", [](auto& self) -> auto& { return self.promised.held_out_gain; },
        "Promised, on rows left out.");
    row(
        "predicted_drop", [](auto& self) -> auto& { return self.promised.predicted_drop; },
        "Promised, of the RMSE: 1 - after / before.");
    row("found_drop", [](auto& self) { return self.found_drop(); }, "");
    row("rmse_before", &StepwiseStep::rmse_before, "");
    row("rmse_after", &StepwiseStep::rmse_after, "");
    row("as_good", &StepwiseStep::as_good, "What would have done as well in its place.");
    row("dropped", &StepwiseStep::dropped, "What was added before and counts no more beside it.");
  }
};

}  // namespace sepcal::schema
