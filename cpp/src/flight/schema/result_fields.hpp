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
    row("mean", &Misfit::mean,
        "Mean of z - model: a constant offset of this size would remove it.");
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
        "Share of the residual's variance that a straight line explains.");
    row("share_smooth", &ChannelMisfit::share_smooth,
        "Share that a natural spline with six even knots explains.");
    row("slope", &ChannelMisfit::slope, "Slope of the line.");
    row("slope_error", &ChannelMisfit::slope_error,
        "Standard error of the slope in the residual's own noise, rather too large.");
    row("unit", &ChannelMisfit::unit, "Unit of the slope.");
  }
};

template <>
struct ResultFields<Window> {
  template <class Row>
  static void each(const Row& row) {
    row("first_s", &Window::first_s, "Time of its first row.");
    row("last_s", &Window::last_s, "Time of its last row.");
    row("rows", &Window::rows, "");
    row("rmse", &Window::rmse, "{output: RMSE}.");
    row("mean", &Window::mean, "{output: mean of z - model}.");
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
        "Share of the mean square error due to different means.");
    row("theil_variance", &OutputValidation::theil_variance,
        "Share due to different standard deviations.");
    row("theil_covariance", &OutputValidation::theil_covariance,
        "Share left, due to what doesn't correlate: near 1 for a good model.");
  }
};

template <>
struct ResultFields<ReferenceMisfit> {
  template <class Row>
  static void each(const Row& row) {
    row("quantity", &ReferenceMisfit::quantity,
        R"("airspeed", "alpha", "mx"; "field": the calibrated field's strength.)");
    row("unit", &ReferenceMisfit::unit, "Unit of every number except the scales.");
    row("calibrated", &ReferenceMisfit::calibrated,
        R"(Column of the calibrated quantity, as apply writes it: "airspeed_cal_mps".)");
    row("reference", &ReferenceMisfit::reference, "Column of the reference in the log.");
    row("rows", &ReferenceMisfit::rows, "Rows that have both.");
    row("bias", &ReferenceMisfit::bias, "Mean of calibrated - reference.");
    row("bias_error", &ReferenceMisfit::bias_error,
        "Standard error of the bias; allows for a coloured difference.");
    row("rms", &ReferenceMisfit::rms, "RMS of the difference.");
    row("sd", &ReferenceMisfit::sd, "Standard deviation of the difference.");
    row("lag_one", &ReferenceMisfit::lag_one, "Correlation of neighbouring differences.");
    row("scale", &ReferenceMisfit::scale, "The scale in calibrated = offset + scale * reference.");
    row("scale_error", &ReferenceMisfit::scale_error, "Its standard error.");
    row("offset", &ReferenceMisfit::offset, "The offset in the same line.");
    row("offset_error", &ReferenceMisfit::offset_error, "Its standard error.");
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
        "The standard error to use. NaN where undefined: fixed, at a bound, singular.");
    row("standard_error_white", &Parameter::standard_error_white,
        "Standard error if the residuals were white.");
    row("standard_error_noise_model", &Parameter::standard_error_noise_model,
        "Standard error from a noise model of each output's residual.", Told::lately);
    row("standard_error_blocks", &Parameter::standard_error_blocks,
        "Standard error from leaving out blocks of the record; NaN with too few blocks.",
        Told::lately);
    row("unit", &Parameter::unit, "");
    row("lower", &Parameter::lower, "Lower bound; infinite if there is none.", Told::everywhere,
        Null::no_lower_end);
    row("upper", &Parameter::upper, "Upper bound; infinite if there is none.", Told::everywhere,
        Null::no_upper_end);
    row("at_bound", &Parameter::at_bound, "True if a bound stopped it.");
    row("fixed", &Parameter::fixed, "True if the fit held it.", Told::in_code);
  }
};

template <>
struct ResultFields<NoiseSize> {
  template <class Row>
  static void each(const Row& row) {
    row("name", &NoiseSize::name, R"("q_alpha" of a process noise, "r_alpha_m" of an output.)",
        Told::in_code);
    row("value", &NoiseSize::value,
        "Root of the spectral density; for an output, the standard deviation.", Told::everywhere,
        Null::refused);
    row("unit", &NoiseSize::unit, "");
    row("standard_error", &NoiseSize::standard_error,
        "NaN if the size was given or is at its floor.");
    row("at_floor", &NoiseSize::at_floor, "True if only the floor stopped it.");
  }
};

template <>
struct ResultFields<Derived> {
  template <class Row>
  static void each(const Row& row) {
    row("name", &Derived::name, "", Told::in_code);
    row("value", &Derived::value, "");
    row("standard_error", &Derived::standard_error,
        "NaN if a parameter that it depends on has none.");
    row("standard_error_white", &Derived::standard_error_white,
        "Standard error if the residuals were white.");
    row("standard_error_noise_model", &Derived::standard_error_noise_model,
        "Standard error from a noise model of each output's residual.", Told::lately);
    row("standard_error_blocks", &Derived::standard_error_blocks,
        "Standard error from leaving out blocks of the record; NaN with too few blocks.",
        Told::lately);
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
    row("predicted_drop", &HistoryEntry::predicted_drop,
        "Predicted drop of the RMSE, 1 - after / before.");
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
    row("rows", &LogNote::rows, "Number of rows concerned.");
    row("first_s", &LogNote::first_s,
        "Time of the first of these rows; NaN if all rows are concerned.");
    row("last_s", &LogNote::last_s, "Time of the last.");
    row("found", &LogNote::found, "What was found.");
    row("effect", &LogNote::effect, "How it changes the result.");
    row("advice", &LogNote::advice, "How to mend it.");
  }
};

/// All but what is by coefficient, and the sentence.
template <>
struct ResultFields<EffectFinding> {
  template <class Row>
  static void each(const Row& row) {
    using Finding = EffectFinding;
    row("name", &Finding::name, "Name to give to add().");
    row("drivers", &Finding::drivers, "Channels that drive it.");
    row("shapes", &Finding::shapes, R"(Shapes found by a scan: {"bias_step.t0": 41.2}.)");
    row("p_value", &Finding::p_value, "p of this effect alone, corrected for its scan.");
    row("log10_p", &Finding::log10_p, "log10 of p_value, which may be too small for a float.");
    row("p_adjusted", &Finding::p_adjusted, "p after Holm's correction; decides the verdict.");
    row("p_listed", &Finding::p_listed,
        "p after Benjamini and Hochberg's correction; orders the list.");
    row("share_after_selection", &Finding::share_after_selection,
        "Share of the estimates left after allowing for the choice of this effect.");
    row("outputs", &Finding::outputs, "Outputs that it can reach; all if they share parameters.");
    row(
        "partial_f", [](auto& self) -> auto& { return self.structure.partial_f; },
        "Partial F of stepwise regression, which takes residuals for white; sums of squares over "
        "`outputs`, each in units of its RMSE in the fit.");
    row(
        "sse", [](auto& self) -> auto& { return self.structure.sse; },
        "Sum of squared errors without it.");
    row(
        "sse_reduction", [](auto& self) -> auto& { return self.structure.sse_reduction; },
        "Reduction of sse by its orthogonal function.");
    row(
        "pse", [](auto& self) -> auto& { return self.structure.pse; },
        "Predicted square error, SSE/N + 2 s2max p/N.");
    row(
        "pse_without", [](auto& self) -> auto& { return self.structure.pse_without; },
        "Predicted square error without it.");
    row(
        "r_squared", [](auto& self) -> auto& { return self.structure.r_squared; },
        "Coefficient of determination with it.");
    row(
        "r_squared_without", [](auto& self) -> auto& { return self.structure.r_squared_without; },
        "Coefficient of determination without it.");
    row("predicted_drop", &Finding::predicted_drop,
        "Predicted drop of the RMSE over these outputs, 1 - after / before.");
    row("held_out_gain", &Finding::held_out_gain, "The same drop on rows held out.");
    row("held_out_before", &Finding::held_out_before, "RMSE of the rows held out, without it.");
    row("held_out_after", &Finding::held_out_after, "RMSE of the rows held out, with it.");
    row("held_out_passed", &Finding::held_out_passed,
        "True if the mean gain of a block exceeds its standard error.");
    row("held_out_interleaved", &Finding::held_out_interleaved,
        "True if interleaved blocks were held out, not whole segments.");
    row("held_out_refitted", &Finding::held_out_refitted,
        "True if the gain comes from fits with it and without it, not from one step.");
    row("is_fitted", &Finding::is_fitted, "True if the estimates come from a fit with it.");
    row("excuse", &Finding::excuse,
        "How many times the sensors' usual drift it would take to look like this effect.");
    row("visibility", &Finding::visibility,
        "Sine of the angle to the model's own columns; below 0.05 the flight can't show at least a "
        "part of it.");
    row("absorbed_by", &Finding::absorbed_by, "Shift of each parameter if the effect is ignored.");
    row("status", &Finding::status,
        R"("found", "slow_change", "undecided", "not_seen", "cannot_be_seen".)");
    row("beside", &Finding::beside,
        R"(Next to the first found: "equivalent", "fades", "counts"; "untried" for the others.)");
  }
};

template <>
struct ResultFields<UnmeasuredCause> {
  template <class Row>
  static void each(const Row& row) {
    row("kind", &UnmeasuredCause::kind, R"("common_cause" or "spectral_line".)");
    row("sentence", [](auto& self) { return describe(self); }, "In plain words.");
    row("outputs", &UnmeasuredCause::outputs, "Outputs that show it.");
    row("p_value", &UnmeasuredCause::p_value, "p of this cause alone.");
    row("p_adjusted", &UnmeasuredCause::p_adjusted,
        "p after Holm's correction; decides the verdict.");
    row("all_along", &UnmeasuredCause::all_along, "True if it is strongest over the whole flight.");
    row("first_s", &UnmeasuredCause::first_s, "Time of the first row where it is strongest [s].");
    row("last_s", &UnmeasuredCause::last_s, "Time of the last such row [s].");
    row("frequency_hz", &UnmeasuredCause::frequency, "NaN if no frequency stands out.");
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
        "p of the Ljung-Box test over 20 lags; small if the residual is not white.");
    row("noise", &ResidualNoise::noise, "NoiseModel of the residual.");
    row("floor", &ResidualNoise::floor,
        "RMSE that noise alone would leave: no model of the past predicts better.");
  }
};

template <>
struct ResultFields<DetectionLimit> {
  template <class Row>
  static void each(const Row& row) {
    row("port", &DetectionLimit::port, "", Told::in_code);
    row("size", &DetectionLimit::size, "Smallest change over the flight that would have shown.");
    row("unit", &DetectionLimit::unit, "");
  }
};

template <>
struct ResultFields<ErrorBound> {
  template <class Row>
  static void each(const Row& row) {
    row("name", &ErrorBound::name, "Name in `error_budget` of diagnose().", Told::in_code);
    row("size", &ErrorBound::size, "Largest standard deviation of each component.");
    row("unit", &ErrorBound::unit, "");
  }
};

template <>
struct ResultFields<DiagnosisWork> {
  template <class Row>
  static void each(const Row& row) {
    row("screened", &DiagnosisWork::screened, "Candidates that were screened.");
    row("tested", &DiagnosisWork::tested,
        "Candidates tested by likelihood ratios, each with noise estimated again.");
    row("calibrated", &DiagnosisWork::calibrated,
        "Candidates whose p was calibrated by draws of the noise.");
    row("drawn", &DiagnosisWork::drawn, "Draws of each noise.");
    row("refitted", &DiagnosisWork::refitted, "Fits of a model with a candidate.");
    row("tried_on_some_rows", &DiagnosisWork::tried_on_some_rows,
        "Of these, fits to 400 rows first, where the full fit is far off.");
  }
};

template <>
struct ResultFields<StepwiseStep> {
  template <class Row>
  static void each(const Row& row) {
    row("effect", [](auto& self) -> auto& { return self.promised.name; }, "");
    row(
        "outputs", [](auto& self) -> auto& { return self.promised.outputs; },
        "Outputs that it can reach.");
    row("p_adjusted", [](auto& self) -> auto& { return self.promised.p_adjusted; }, "");
    row("partial_f", [](auto& self) -> auto& { return self.promised.structure.partial_f; }, "");
    row("pse", [](auto& self) -> auto& { return self.promised.structure.pse; }, "");
    row("pse_without", [](auto& self) -> auto& { return self.promised.structure.pse_without; }, "");
    row("r_squared", [](auto& self) -> auto& { return self.promised.structure.r_squared; }, "");
    row(
        "held_out_gain", [](auto& self) -> auto& { return self.promised.held_out_gain; },
        "Gain that was promised on rows held out.");
    row(
        "predicted_drop", [](auto& self) -> auto& { return self.promised.predicted_drop; },
        "Drop of the RMSE that was promised, 1 - after / before.");
    row("found_drop", [](auto& self) { return self.found_drop(); }, "");
    row("rmse_before", &StepwiseStep::rmse_before, "");
    row("rmse_after", &StepwiseStep::rmse_after, "");
    row("as_good", &StepwiseStep::as_good, "Effects that would have done as well in its place.");
    row("dropped", &StepwiseStep::dropped, "Effects added before that no longer count beside it.");
  }
};

}  // namespace sepcal::schema
