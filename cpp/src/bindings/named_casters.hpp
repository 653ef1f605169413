// SPDX-License-Identifier: BSD-3-Clause
// How sepcal's small types cross: an enumeration as its word, things with names as {name: thing} in
// their order, an interval as (lower, upper).
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "sepcal/diagnosis.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/fit_many.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/stepwise.hpp"
#include "sepcal/profile.hpp"

namespace pybind11::detail {

template <class Enumeration, Enumeration... known>
struct WordCaster {
  PYBIND11_TYPE_CASTER(Enumeration, const_name("str"));

  bool load(handle source, bool convert) {
    make_caster<std::string> word;
    if (!word.load(source, convert)) return false;
    const auto take = [&](Enumeration one) {
      if (to_string(one) != cast_op<std::string&>(word)) return false;
      value = one;
      return true;
    };
    return (take(known) || ...);
  }

  static handle cast(Enumeration one, return_value_policy /*policy*/, handle /*parent*/) {
    return str(std::string(to_string(one))).release();
  }
};

/// {thing.*key: thing.*mapped}; the things have no other members.
template <class Thing, class Mapped, std::string Thing::* key, Mapped Thing::* mapped>
struct PairCaster {
  using List = std::vector<Thing>;
  PYBIND11_TYPE_CASTER(List,
                       const_name("dict[str, ") + make_caster<Mapped>::name + const_name("]"));

  bool load(handle source, bool /*convert*/) {
    if (!isinstance<dict>(source)) return false;
    value.clear();
    for (const auto& [word, one] : reinterpret_borrow<dict>(source)) {
      value.push_back({word.template cast<std::string>(), one.template cast<Mapped>()});
    }
    return true;
  }

  static handle cast(const List& things, return_value_policy /*policy*/, handle /*parent*/) {
    dict by_name;
    for (const Thing& thing : things) by_name[str(thing.*key)] = thing.*mapped;
    return by_name.release();
  }
};

/// {thing.*key: thing}
template <class Thing, std::string Thing::* key = &Thing::name>
struct NamedCaster {
  using List = std::vector<Thing>;
  PYBIND11_TYPE_CASTER(List, const_name("dict[str, ") + make_caster<Thing>::name + const_name("]"));

  bool load(handle source, bool /*convert*/) {
    if (!isinstance<dict>(source)) return false;
    value.clear();
    for (const auto& [word, thing] : reinterpret_borrow<dict>(source)) {
      value.push_back(thing.template cast<Thing>());
    }
    return true;
  }

  static handle cast(const List& things, return_value_policy /*policy*/, handle /*parent*/) {
    dict by_name;
    for (const Thing& thing : things) by_name[str(thing.*key)] = pybind11::cast(thing);
    return by_name.release();
  }
};

template <>
struct type_caster<sepcal::Concern>
    : WordCaster<sepcal::Concern, sepcal::Concern::wrong, sepcal::Concern::matters,
                 sepcal::Concern::slight> {};
template <>
struct type_caster<sepcal::FitStatus>
    : WordCaster<sepcal::FitStatus, sepcal::FitStatus::converged, sepcal::FitStatus::not_converged,
                 sepcal::FitStatus::not_identifiable> {};
template <>
struct type_caster<sepcal::FitMethod>
    : WordCaster<sepcal::FitMethod, sepcal::FitMethod::output_error,
                 sepcal::FitMethod::filter_error> {};

template <>
struct type_caster<sepcal::SecondStage>
    : WordCaster<sepcal::SecondStage, sepcal::SecondStage::automatic, sepcal::SecondStage::joint,
                 sepcal::SecondStage::projected> {};

template <>
struct type_caster<sepcal::IntervalEnd>
    : WordCaster<sepcal::IntervalEnd, sepcal::IntervalEnd::crossed, sepcal::IntervalEnd::bound,
                 sepcal::IntervalEnd::open, sepcal::IntervalEnd::failed> {};

template <>
struct type_caster<sepcal::Verdict>
    : WordCaster<sepcal::Verdict, sepcal::Verdict::adequate, sepcal::Verdict::effect_missing,
                 sepcal::Verdict::slow_change, sepcal::Verdict::unexplained> {};

template <>
struct type_caster<sepcal::FindingStatus>
    : WordCaster<sepcal::FindingStatus, sepcal::FindingStatus::found,
                 sepcal::FindingStatus::slow_change, sepcal::FindingStatus::undecided,
                 sepcal::FindingStatus::not_seen, sepcal::FindingStatus::cannot_be_seen> {};

template <>
struct type_caster<sepcal::Beside>
    : WordCaster<sepcal::Beside, sepcal::Beside::untried, sepcal::Beside::equivalent,
                 sepcal::Beside::fades, sepcal::Beside::counts> {};

template <>
struct type_caster<sepcal::PseBound>
    : WordCaster<sepcal::PseBound, sepcal::PseBound::sidpac, sepcal::PseBound::classic> {};

template <>
struct type_caster<sepcal::DiagnosisRule>
    : WordCaster<sepcal::DiagnosisRule, sepcal::DiagnosisRule::verdict,
                 sepcal::DiagnosisRule::partial_f> {};

template <>
struct type_caster<sepcal::StepwiseEnd>
    : WordCaster<sepcal::StepwiseEnd, sepcal::StepwiseEnd::nothing_found,
                 sepcal::StepwiseEnd::most_added, sepcal::StepwiseEnd::withheld,
                 sepcal::StepwiseEnd::fit_failed> {};

template <>
struct type_caster<sepcal::UnmeasuredKind>
    : WordCaster<sepcal::UnmeasuredKind, sepcal::UnmeasuredKind::common_cause,
                 sepcal::UnmeasuredKind::spectral_line> {};

template <>
struct type_caster<std::vector<sepcal::OutputValue>>
    : PairCaster<sepcal::OutputValue, double, &sepcal::OutputValue::name,
                 &sepcal::OutputValue::value> {};
template <>
struct type_caster<std::vector<sepcal::LeftOut>>
    : PairCaster<sepcal::LeftOut, std::string, &sepcal::LeftOut::name, &sepcal::LeftOut::reason> {};

template <>
struct type_caster<std::vector<sepcal::Parameter>> : NamedCaster<sepcal::Parameter> {};
template <>
struct type_caster<std::vector<sepcal::NoiseSize>> : NamedCaster<sepcal::NoiseSize> {};
template <>
struct type_caster<std::vector<sepcal::Derived>> : NamedCaster<sepcal::Derived> {};
template <>
struct type_caster<std::vector<sepcal::FlightFit>> : NamedCaster<sepcal::FlightFit> {};
template <>
struct type_caster<std::vector<sepcal::ProfileInterval>> : NamedCaster<sepcal::ProfileInterval> {};
template <>
struct type_caster<std::vector<sepcal::ErrorBound>> : NamedCaster<sepcal::ErrorBound> {};
template <>
struct type_caster<std::vector<sepcal::ResidualNoise>>
    : NamedCaster<sepcal::ResidualNoise, &sepcal::ResidualNoise::output> {};
template <>
struct type_caster<std::vector<sepcal::DetectionLimit>>
    : NamedCaster<sepcal::DetectionLimit, &sepcal::DetectionLimit::port> {};

template <>
struct type_caster<sepcal::Interval> {
  PYBIND11_TYPE_CASTER(sepcal::Interval, const_name("tuple[float, float]"));

  bool load(handle source, bool convert) {
    make_caster<std::pair<double, double>> ends;
    if (!ends.load(source, convert)) return false;
    const auto& [lower, upper] = cast_op<std::pair<double, double>>(ends);
    value = {lower, upper};
    return true;
  }

  static handle cast(const sepcal::Interval& interval, return_value_policy /*policy*/,
                     handle /*parent*/) {
    return make_tuple(interval.lower, interval.upper).release();
  }
};

}  // namespace pybind11::detail
