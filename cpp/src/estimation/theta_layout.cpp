// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/theta_layout.hpp"

#include <algorithm>
#include <cmath>

namespace sepcal::estimation {

using Eigen::Index;
using Eigen::VectorXd;

std::string process_noise_name(const Variable& noise) { return "q_" + noise.name; }
std::string output_noise_name(const Variable& output) { return "r_" + output.name; }

std::vector<Estimated> estimable_noises(const BlockModel& model, const FitOptions& options) {
  std::vector<Estimated> noises;
  for (const Variable& noise : model.process_noises()) {
    if (options.process_noise.contains(noise.name)) continue;
    noises.push_back({process_noise_name(noise), noise, Estimated::Kind::process_noise});
  }
  for (const Variable& output : model.tables().outputs) {
    if (options.noise.contains(output.name)) continue;
    noises.push_back({output_noise_name(output), output, Estimated::Kind::output_noise});
  }
  return noises;
}

VectorXd theta_of(const Fit& fit) {
  const VectorXd values = fit.values();
  VectorXd theta(values.size() + static_cast<Index>(fit.noise_sizes.size()));
  theta.head(values.size()) = values;
  for (std::size_t k = 0; k < fit.noise_sizes.size(); ++k) {
    theta[values.size() + static_cast<Index>(k)] = std::log(fit.noise_sizes[k].value);
  }
  return theta;
}

ThetaLayout::ThetaLayout(const BlockModel& model, const Problem& problem,
                         const InnovationModel& innovations)
    : model_(model),
      problem_(problem),
      innovations_(innovations),
      all_(model.tables().parameters()),
      n_(static_cast<Index>(all_.size())) {
  const auto& fixed = problem.options().fix;
  for (Index k = 0; k < size(); ++k) {
    const bool held =
        k < n_ ? fixed.contains(all_[static_cast<std::size_t>(k)].name) : is_given(k - n_);
    if (!held) free_.push_back(k);
  }
}

Index ThetaLayout::free_parameters() const {
  return std::ranges::count_if(free_, [this](Index k) { return k < n_; });
}

void ThetaLayout::hold_silent(const VectorXd& theta) {
  std::erase_if(free_, [&](Index k) { return k >= n_ && theta[k] == -infinity; });
}

std::string ThetaLayout::name_of(Index place) const {
  if (place < n_) return all_[static_cast<std::size_t>(place)].name;
  const Variable& at = noise(place - n_);
  return place - n_ < noises() ? process_noise_name(at) : output_noise_name(at);
}

std::vector<Estimated> ThetaLayout::estimated() const {
  std::vector<Estimated> estimated;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Index k = free_[i];
    if (k < n_) {
      estimated.push_back({name_of(k), problem_.parameters()[i]});
    } else {
      estimated.push_back(
          {name_of(k), noise(k - n_),
           k - n_ < noises() ? Estimated::Kind::process_noise : Estimated::Kind::output_noise});
    }
  }
  return estimated;
}

const Variable& ThetaLayout::noise(Index k) const {
  if (k < noises()) return model_.process_noises()[static_cast<std::size_t>(k)];
  return model_.tables().outputs[static_cast<std::size_t>(k - noises())];
}

bool ThetaLayout::is_given(Index k) const {
  const auto& given = k < noises() ? problem_.options().process_noise : problem_.options().noise;
  return given.contains(noise(k).name);
}

numerics::Box ThetaLayout::box(const VectorXd& floor) const {
  numerics::Box box{VectorXd::Constant(size(), -infinity), VectorXd::Constant(size(), infinity)};
  std::size_t next = 0;  // of the problem's parameters, which are the free ones
  for (const Index k : free_) {
    if (k >= n_) {
      box.lower[k] = floor[k - n_];
      continue;
    }
    box.lower[k] = problem_.parameters()[next].lower;
    box.upper[k] = problem_.parameters()[next].upper;
    ++next;
  }
  return box;
}

Prior ThetaLayout::prior() const {
  Prior whole{VectorXd::Zero(size()), VectorXd::Zero(size())};
  const std::vector<Prior> given = problem_.prior();
  for (Index i = 0; !given.empty() && i < free_parameters(); ++i) {
    const Index k = free_[static_cast<std::size_t>(i)];
    whole.mean[k] = given.front().mean[i];
    whole.weight[k] = given.front().weight[i];
  }
  return whole;
}

VectorXd ThetaLayout::given() const {
  const FitOptions& options = problem_.options();
  VectorXd theta = VectorXd::Zero(size());
  for (Index k = 0; k < n_; ++k) {
    const auto at = options.fix.find(all_[static_cast<std::size_t>(k)].name);
    if (at != options.fix.end()) theta[k] = at->second;
  }
  for (Index k = 0; k < size() - n_; ++k) {
    if (!is_given(k)) continue;
    const auto& given = k < noises() ? options.process_noise : options.noise;
    theta[n_ + k] = std::log(given.at(noise(k).name));
  }
  return theta;
}

VectorXd ThetaLayout::floor_of(const Fit& fit) const {
  constexpr double far = 1e-4;
  VectorXd floor(size() - n_);
  for (Index k = 0; k < floor.size(); ++k) {
    const NoiseSize& size = fit.noise_sizes[static_cast<std::size_t>(k)];
    floor[k] = std::log(size.value * (size.at_floor ? 1.0 : far));
  }
  return floor;
}

}  // namespace sepcal::estimation
