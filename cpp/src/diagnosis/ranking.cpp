// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/ranking.hpp"

#include <algorithm>
#include <optional>

#include "diagnosis/family.hpp"

namespace sepcal::diagnosis {
namespace {

constexpr std::size_t most_families = 12;
constexpr std::size_t most_compared = 3;  // with the residual, not by their columns alone

const Trial& trial_of(const Comparisons& among, const EffectFinding& finding) {
  return *std::ranges::find_if(
      among.trials, [&](const Trial& trial) { return trial.candidate.name == finding.name; });
}

}  // namespace

void rank(std::vector<EffectFinding>& findings) {
  std::ranges::stable_sort(findings, [](const EffectFinding& a, const EffectFinding& b) {
    if (a.status != b.status) return a.status < b.status;
    return a.log10_p < b.log10_p;
  });
}

void prefer_simplest(const Comparisons& among, std::vector<EffectFinding>& findings) {
  if (findings.empty() || findings.front().status != FindingStatus::found) return;
  const Trial& first = trial_of(among, findings.front());
  if (!first.tested) return;
  const Family family(among.room, among.null, first, among.correlation);
  std::size_t simplest = 0;
  int freedom = first.freedom;
  for (std::size_t i = 1; i < findings.size() && findings[i].status == FindingStatus::found; ++i) {
    const Trial& other = trial_of(among, findings[i]);
    if (other.freedom >= freedom || !family.is_enough(other)) continue;
    simplest = i;
    freedom = other.freedom;
  }
  const auto begin = findings.begin();
  const auto chosen = begin + static_cast<std::ptrdiff_t>(simplest);
  std::rotate(begin, chosen, chosen + 1);
}

void find_families(const Comparisons& among, double threshold, base::ThreadPool& pool,
                   std::vector<EffectFinding>& findings) {
  for (std::size_t a = 0; a < std::min(most_families, findings.size()); ++a) {
    const Trial& first = trial_of(among, findings[a]);
    if (!first.visible) continue;
    std::optional<Family> family;
    if (a < most_compared && first.tested) {
      family.emplace(among.room, among.null, first, among.correlation);
    }
    std::vector<char> belongs(findings.size(), 0);
    pool.for_each(findings.size(), [&](std::size_t b) {
      const Trial& other = trial_of(among, findings[b]);
      if (b == a || !other.visible) return;
      const bool belong =
          are_alike(first, other, among.correlation) ||
          (family && (family->is_proxy(other, threshold) || family->is_rival(other)));
      belongs[b] = belong ? 1 : 0;
    });
    for (std::size_t b = 0; b < findings.size(); ++b) {
      if (belongs[b] != 0) findings[a].family.push_back(findings[b].name);
    }
  }
}

}  // namespace sepcal::diagnosis
