// SPDX-License-Identifier: BSD-3-Clause
#include "flight/aircraft/trajectory_effects.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "diagnosis/innovation_rows.hpp"
#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/catalogue/effect_candidates.hpp"
#include "sepcal/aircraft/rigid_aircraft.hpp"
#include "sepcal/detail/aircraft/path.hpp"
#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal::aircraft_log {
namespace {

using catalogue::EffectTable;
using Eigen::VectorXd;

const EffectTable& table_of(AircraftModel model) {
  return catalogue::trajectory_table(model == AircraftModel::path ? "path" : "aircraft");
}

/// Of the values that the record has.
std::vector<double> knots_over(const Record& record, const EffectName& spline) {
  if (!record.has(spline.base)) {
    throw Error("effect " + spline.text + ": the record has no column '" + spline.base +
                "' whose range the knots could share");
  }
  double lowest = infinity;
  double highest = -infinity;
  for (const Segment& segment : record.segments()) {
    for (const double value : record.column(spline.base).subspan(segment.first, segment.rows())) {
      if (std::isnan(value)) continue;
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
  }
  return even_knots(lowest, highest, spline.number);
}

EffectKit::Maker spline_maker(const std::string& text) {
  const EffectName name = parse_effect_name(text);
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    if (setting.knots.empty()) setting.knots = knots_over(record, name);
    const auto build = [name, knots = setting.knots, record](const BlockModel& without) {
      return with_spline(without, name.port, name.base, knots, record);
    };
    build(model);  // throws where there can be none
    Effect effect{.name = setting.name};
    effect.remodel = [build](const std::shared_ptr<const BlockModel>& without) {
      return build(*without);
    };
    return effect;
  };
}

EffectKit::Maker regressor_maker(const std::string& name) {
  const std::size_t open = name.find('[');
  if (open == std::string::npos || !name.ends_with(']')) {
    throw Error(name + " is no regressor; write it as COEFFICIENT[REGRESSOR]");
  }
  const std::string coefficient = name.substr(0, open);
  const std::string regressor = name.substr(open + 1, name.size() - open - 2);
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    with_regressor(model, coefficient, regressor, record);  // throws where there can be none
    Effect effect{.name = setting.name};
    effect.remodel = [coefficient, regressor,
                      record](const std::shared_ptr<const BlockModel>& without) {
      return with_regressor(*without, coefficient, regressor, record);
    };
    return effect;
  };
}

/// Of a path by output error the white noise that its readings tell: what the inertial unit has
/// adds up along it, and no residual forgets it. An output's is no less than a tenth of what is
/// left.
std::optional<PathNoise> noise_along(AircraftModel model, const Fit& fit,
                                     const LaidAircraft& laid) {
  if (fit.method == FitMethod::filter_error) return diagnosis::noise_of(fit, *laid.model);
  if (model != AircraftModel::path) return {};
  constexpr double least = 0.1;
  const auto noises = laid.model->process_noises();
  PathNoise noise{VectorXd::Zero(static_cast<Eigen::Index>(noises.size())),
                  VectorXd(static_cast<Eigen::Index>(fit.rmse.size()))};
  for (std::size_t k = 0; k < noises.size(); ++k) {
    const auto told = laid.fit.process_noise.find(noises[k].name);
    if (told != laid.fit.process_noise.end()) {
      noise.process[static_cast<Eigen::Index>(k)] = told->second;
    }
  }
  std::vector<std::string> outputs;
  for (const OutputValue& output : fit.rmse) outputs.push_back(output.name);
  const std::map<std::string, double> white = white_noise_of(laid.record, outputs);
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    noise.outputs[static_cast<Eigen::Index>(j)] =
        std::max(white.at(outputs[j]), least * fit.rmse[j].value);
  }
  return noise;
}

/// Driven by the flow or a rate, which answer to gusts that no sensor reads: what these do to the
/// air data follows them too. Scales, misalignments and the vane's place have effects of their own.
bool follows_motion(const std::string& effect) {
  const std::string driver = parse_effect_name(effect).base;
  return driver == "alpha" || driver == "beta" || driver == "q" || driver == "r";
}

/// The components that the model has a place for.
std::vector<Port::Component> places_in(const Tables& tables,
                                       const std::vector<Port::Component>& components) {
  const auto has = [](const std::vector<Variable>& table, const std::string& name) {
    return name.empty() || std::ranges::find(table, name, &Variable::name) != table.end();
  };
  std::vector<Port::Component> there;
  std::ranges::copy_if(components, std::back_inserter(there), [&](const Port::Component& each) {
    return has(tables.linear, each.linear) && has(tables.inputs, each.input);
  });
  return there;
}

}  // namespace

bool acts_along(AircraftModel model, const std::string& effect) {
  if (model == AircraftModel::path) return true;
  if (model == AircraftModel::aero) return false;
  if (is_spline(effect)) return true;
  const EffectTable& table = table_of(model);
  return table.find_effect(effect) != nullptr ||
         table.find_port(effect.substr(0, effect.find('['))) != nullptr;
}

std::string describe_along(AircraftModel model, const std::string& effect) {
  std::string sentence;
  for (const std::string& part : split_effects(effect)) {
    if (!sentence.empty()) sentence += ", and ";
    const bool is_regressor = !acts_along(model, part) || is_spline(part);
    sentence +=
        is_regressor ? describe_regressor(part) : catalogue::describe_effect(table_of(model), part);
  }
  return sentence;
}

std::vector<std::string> list_along(const AircraftFit& fitted, const LaidAircraft& laid,
                                    const Flight& flight) {
  const AircraftModel model = fitted.options.model;
  std::vector<std::string> names = catalogue::list_candidates(
      table_of(model), trajectory_kit(model, laid.base->tables()), laid.record, flight);
  std::erase_if(names, follows_motion);
  // A spline and a power that do the same have the equation's own coefficients elsewhere.
  const std::vector<std::string> products =
      products_among(list_regressors(laid.equations, laid.record, flight));
  names.insert(names.end(), products.begin(), products.end());
  const std::vector<EffectSetting>& has = fitted.options.calibration.effects;
  std::erase_if(names, [&](const std::string& name) {
    return std::ranges::find(has, name, &EffectSetting::name) != has.end();
  });
  return names;
}

DiagnosedFit diagnosed_trajectory(const AircraftFit& fitted, const Fit& fit,
                                  const LaidAircraft& laid, const Flight& flight,
                                  const std::vector<std::string>& asked) {
  const AircraftModel model = fitted.options.model;
  if (fitted.options.trajectory.scales_about_start) {
    throw Error(
        "diagnose follows a trajectory step by step, which a scale about the start does not allow; "
        "fit without --scale-about-start (scales_about_start) first");
  }
  EffectKit kit = trajectory_kit(model, laid.base->tables());
  std::vector<std::string> regressors = list_regressors(laid.equations, laid.record, flight);
  for (const std::string& effect : asked) {
    for (const std::string& part : split_effects(effect)) {
      if (!acts_along(model, part) || is_spline(part)) regressors.push_back(part);
    }
  }
  const std::vector<EffectSetting> own = effects_along(fitted.options, laid.effects);
  for (const EffectSetting& effect : own) {
    if (is_spline(effect.name)) regressors.push_back(effect.name);
  }
  add_regressors(regressors, kit);
  return {.model = laid.base,
          .kit = std::move(kit),
          .effects = own,
          .record = laid.record,
          .rows = laid.record.segments(),
          .fit = fit,
          .noise = noise_along(fitted.options.model, fit, laid)};
}

Promise promise_along(const AircraftFit& fitted, const Flight& flight, const AircraftFit& next,
                      const std::string& effect) {
  if (fitted.options.model == AircraftModel::aero || fitted.options.band) return {};
  try {
    LaidAircraft laid = lay(flight, options_on(fitted, flight));
    need_every_reading(laid, "a promise");
    const Fit fit = fit_on(flight, fitted, laid);
    const DiagnosedFit along = diagnosed_trajectory(fitted, fit, laid, flight, {effect});
    return promise(along, effect, next.fit.by_name(), fitted.options.calibration.fit.threads);
  } catch (const Error&) {
    return {};
  }
}

EffectKit trajectory_kit(AircraftModel model, const Tables& tables) {
  EffectKit kit = catalogue::kit_of(table_of(model));
  for (Port& port : kit.ports) port.components = places_in(tables, port.components);
  std::erase_if(kit.ports, [](const Port& port) { return port.components.empty(); });
  return kit;
}

void add_regressors(const std::vector<std::string>& names, EffectKit& kit) {
  for (const std::string& name : names) {
    kit.own[name] = is_spline(name) ? spline_maker(name) : regressor_maker(name);
  }
}

}  // namespace sepcal::aircraft_log
