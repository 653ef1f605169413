// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/weighing.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "diagnosis/alternatives.hpp"
#include "diagnosis/finding.hpp"

namespace sepcal::diagnosis {
namespace {

/// One of several that take much of the error.
struct Standing {
  EffectFinding finding = {};
  double left = 1.0;  // of the error, on all rows or on rows held out, whichever is more
  bool is_line = false;
  bool is_flexible = false;  // a function of time of any form
  bool stands_in = false;
  std::tuple<std::size_t, int, std::size_t> complexity = {};
  bool is_as_good = false;
  bool is_as_sure = false;

  bool is_told() const { return is_as_good || is_as_sure; }
  auto order() const {
    return std::tuple(!is_as_good, !is_as_sure, stands_in, is_flexible, complexity, left);
  }
};

Standing place(CandidateTesting& testing, const EffectFinding& finding) {
  const Candidate& candidate = testing.room().make(finding.name);
  return {.finding = finding,
          .left = std::max(left_out(finding), 1.0 - finding.predicted_drop),
          .is_line = is_of_lines(candidate, 1),
          .is_flexible = is_flexible_in_time(candidate),
          .stands_in = candidate.stands_in,
          .complexity = complexity_of(candidate)};
}

/// The least that is left by those that are asked for.
template <class Asked>
double least_left(const std::vector<Standing>& all, Asked asked) {
  double least = infinity;
  for (const Standing& one : all) {
    if (asked(one)) least = std::min(least, one.left);
  }
  return least;
}

constexpr double about = 1.1;  // as much of the error

void find_as_good(std::vector<Standing>& all) {
  constexpr double clearly = 1.2;
  const double of_flexible = least_left(all, [](const Standing& one) { return one.is_flexible; });
  const double of_others = least_left(all, [](const Standing& one) { return !one.is_flexible; });
  const bool others_do = of_others <= clearly * of_flexible;
  for (Standing& one : all) {
    one.is_as_good = one.left <= about * (others_do ? of_others : of_flexible);
    one.is_flexible &= others_do;
  }
}

void find_as_sure(std::vector<Standing>& all) {
  constexpr double about_as_sure = 0.3;  // log10: within a factor of two
  double surest = 0.0;
  for (const Standing& one : all) {
    if (one.is_line) surest = std::min(surest, one.finding.log10_p);
  }
  const auto is_sure = [&](const Standing& one) {
    return one.is_line && one.finding.log10_p <= surest + about_as_sure;
  };
  const double least = least_left(all, is_sure);
  for (Standing& one : all) one.is_as_sure = is_sure(one) && one.left <= about * least;
}

}  // namespace

std::vector<EffectFinding*> choose_to_weigh(CandidateTesting& testing,
                                            std::vector<EffectFinding>& findings) {
  constexpr double worth_a_fit = 0.6 * objects_from;
  constexpr std::size_t most_of_any = 2;
  constexpr std::size_t most_of_simple = 4;
  std::vector<EffectFinding*> chosen;
  for (EffectFinding& finding : findings) {
    const bool is_open =
        finding.status == FindingStatus::not_seen || finding.status == FindingStatus::slow_change;
    if (is_open && finding.held_out_gain > worth_a_fit) chosen.push_back(&finding);
  }
  std::ranges::stable_sort(chosen, std::ranges::greater(), &EffectFinding::held_out_gain);
  std::vector<EffectFinding*> simple;
  const std::size_t of_any = std::min(most_of_any, chosen.size());
  std::copy_if(chosen.begin() + static_cast<std::ptrdiff_t>(of_any), chosen.end(),
               std::back_inserter(simple), [&](const EffectFinding* finding) {
                 return is_simple(testing.room().make(finding->name));
               });
  chosen.resize(of_any);
  if (testing.instruments()) std::ranges::stable_sort(simple, {}, &EffectFinding::log10_p);
  if (simple.size() > most_of_simple) simple.resize(most_of_simple);
  chosen.insert(chosen.end(), simple.begin(), simple.end());
  return chosen;
}

void put_simplest_first(CandidateTesting& testing, std::vector<EffectFinding>& findings) {
  const auto of_status = [](const EffectFinding& finding) {
    return finding.status == FindingStatus::slow_change ? 0
           : finding.status == FindingStatus::undecided ? 1
                                                        : 2;
  };
  std::ranges::stable_sort(findings, {}, of_status);
  if (findings.empty() || of_status(findings.front()) == 2) return;
  const FindingStatus asked = findings.front().status;
  const auto end = std::ranges::find_if_not(
      findings, [&](const EffectFinding& finding) { return finding.status == asked; });
  std::vector<Standing> all;
  for (auto at = findings.begin(); at != end; ++at) all.push_back(place(testing, *at));
  find_as_good(all);
  if (testing.instruments()) find_as_sure(all);  // else p says nothing of slow changes
  const auto is_both = [](const Standing& one) { return one.is_as_good && one.is_as_sure; };
  if (std::ranges::any_of(all, is_both)) {
    for (Standing& one : all) one.is_as_good = one.is_as_sure = is_both(one);
  }
  std::ranges::stable_sort(all, {}, &Standing::order);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k > 0 && all[k].is_told()) all[k].finding.beside = Beside::equivalent;
    findings[k] = std::move(all[k].finding);
  }
}

}  // namespace sepcal::diagnosis
