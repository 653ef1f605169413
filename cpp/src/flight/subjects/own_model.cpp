// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/own_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <deque>
#include <string_view>

#include "base/escaping.hpp"
#include "flight/probes/corrected_columns.hpp"
#include "flight/probes/record_builder.hpp"
#include "flight/subjects/own_effects.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using files::Unit;
using files::UnitKind;
using probes::ProbeQuantity;

/// How tables spell the units that are used inside.
struct Spelling {
  std::string_view unit;
  UnitKind kind;
};
constexpr std::array spellings{
    Spelling{"s", UnitKind::time},
    Spelling{"rad", UnitKind::angle},
    Spelling{"rad/s", UnitKind::rate},
    Spelling{"rad/s^2", UnitKind::angular_acceleration},
    Spelling{"m", UnitKind::length},
    Spelling{"m/s", UnitKind::speed},
    Spelling{"m/s^2", UnitKind::acceleration},
    Spelling{"kg", UnitKind::mass},
    Spelling{"N", UnitKind::force},
    Spelling{"Pa", UnitKind::pressure},
    Spelling{"uT", UnitKind::field},
    Spelling{"K", UnitKind::temperature},
    Spelling{"kg/m^3", UnitKind::density},
    Spelling{"1", UnitKind::share},
};

/// "degC" as headers end with it: degc; "V/K": vpk; "%": pct; "kΩ": kohm. Empty where it has
/// signs that no header spells.
std::string suffix_of(std::string unit) {
  if (unit == "%") return "pct";
  constexpr std::array<std::array<std::string_view, 2>, 5> signs{
      {{"\u00b5", "u"}, {"\u03bc", "u"}, {"\u03a9", "ohm"}, {"\u2126", "ohm"}, {"\u00b0", "deg"}}};
  for (const auto& [sign, letters] : signs) {
    const std::size_t at = unit.find(sign);
    if (at != std::string::npos) unit.replace(at, sign.size(), letters);
  }
  std::string suffix;
  for (const char c : unit) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte > 127) return "";
    if (c == '/') {
      suffix += 'p';
    } else if (std::isalnum(byte) != 0) {
      suffix += static_cast<char>(std::tolower(byte));
    }
  }
  return suffix;
}

/// What the model reads of a log, by its tables.
class OwnQuantities {
 public:
  explicit OwnQuantities(const Tables& tables) {
    list_.push_back({.name = "time", .kind = UnitKind::time});
    for (const Variable& input : tables.inputs) add(input);
    for (const Variable& output : tables.outputs) {
      add(output);
      std::ranges::find(list_, output.name, &ProbeQuantity::name)->is_measured = true;
    }
  }

  std::span<const ProbeQuantity> list() const { return list_; }

 private:
  void add(const Variable& variable) {
    if (std::ranges::find(list_, variable.name, &ProbeQuantity::name) != list_.end()) return;
    const auto known = std::ranges::find(spellings, variable.unit, &Spelling::unit);
    if (known != spellings.end()) {
      list_.push_back({.name = variable.name,
                       .kind = known->kind,
                       .bare = &files::known_units(known->kind).front()});
      return;
    }
    suffixes_.push_back(suffix_of(variable.unit));
    units_.push_back({suffixes_.back(), UnitKind::own});
    list_.push_back({.name = variable.name, .kind = UnitKind::own, .bare = &units_.back()});
  }

  std::deque<std::string> suffixes_;  // which units_ point to
  std::deque<Unit> units_;            // which list_ points to
  std::vector<ProbeQuantity> list_;
};

class OwnProbe final : public Probe {
 public:
  OwnProbe(std::string name, ModelSource source, LaidModel laid, LaidAlong lay = {})
      : name_(std::move(name)),
        source_(std::move(source)),
        app_(own_app),
        laid_(std::move(laid)),
        lay_(std::move(lay)),
        quantities_(laid_.model->tables()),
        effects_(subjects::own_effects(laid_)) {
    if (!source_.name.empty()) app_ += " --model " + base::file_in_shell(source_.name);
  }

  std::string_view name() const override { return name_; }
  std::string_view app() const override { return app_; }
  const ModelSource* source() const override { return source_.name.empty() ? nullptr : &source_; }
  const BlockModel& model() const override { return *laid_.model; }
  const catalogue::EffectTable& effects() const override { return effects_; }
  std::span<const ProbeQuantity> quantities() const override { return quantities_.list(); }
  std::map<std::string, std::vector<double>> settings() const override { return {}; }

  std::shared_ptr<const Probe> along(const Record& record) const override {
    if (!lay_) return nullptr;
    return std::make_shared<const OwnProbe>(name_, source_, lay_(&record), lay_);
  }

  std::vector<std::string> initial_states() const override { return laid_.initial_states; }

  const TrajectoryOptions* trajectory() const override { return lay_ ? &laid_.options : nullptr; }

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    probes::RecordBuilder builder(flight, quantities_.list(), log);
    builder.need({"time"});
    need_inputs(builder);
    for (const Variable& output : laid_.model->tables().outputs) builder.need({output.name});
    builder.keep_valid();
    builder.check_time();
    return builder.finish();
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    probes::RecordBuilder builder(flight, quantities_.list(), log);
    need_inputs(builder);
    builder.keep_valid();
    builder.offer({"time"});
    return builder.finish_readings();
  }

  bool predicts() const override { return true; }

  std::vector<std::string> corrected_headers() const override {
    std::vector<std::string> headers;
    for (const Variable& output : laid_.model->tables().outputs) {
      const auto quantity =
          std::ranges::find(quantities_.list(), output.name, &ProbeQuantity::name);
      const std::string_view suffix = quantity->bare->suffix;
      headers.push_back(suffix.empty() || suffix == "1"
                            ? output.name + "_fit"
                            : fmt::format("{}_fit_{}", output.name, suffix));
    }
    return headers;
  }

  std::vector<CorrectedColumn> correct(const ProbeReadings& readings,
                                       const Eigen::VectorXd& /*values*/,
                                       const ReadingEffects& /*effects*/) const override {
    return probes::empty_columns(corrected_headers(), readings.valid.size());
  }

 private:
  void need_inputs(probes::RecordBuilder& builder) const {
    for (const Variable& input : laid_.model->tables().inputs) {
      const bool may_lack = std::isfinite(input.absent);
      if (input.name == "time") continue;
      if (may_lack) {
        builder.offer({input.name});
      } else {
        builder.need({input.name});
      }
    }
  }

  std::string name_;
  ModelSource source_;
  std::string app_;
  LaidModel laid_;
  LaidAlong lay_;  // empty of a model without a state
  OwnQuantities quantities_;
  catalogue::EffectTable effects_;
};

void check_name(const std::string& name) {
  if (name.empty()) throw Error("a model of your own needs a name");
  if (!catalogue::effect_tables().contains(name)) return;
  throw Error("there is a probe '" + name + "' already; give your model another name");
}

}  // namespace

std::shared_ptr<const Probe> own_model(std::string name, std::shared_ptr<const BlockModel> model,
                                       ModelSource source) {
  check_name(name);
  if (model->new_carry() != nullptr) {
    throw Error("the model " + name + " carries a state from row to row; give what lays it along " +
                "a record (LaidAlong)");
  }
  const auto linear = static_cast<std::size_t>(model->tables().n_1());
  return std::make_shared<const OwnProbe>(
      std::move(name), std::move(source),
      LaidModel{.model = std::move(model), .initial_states = {}, .varying = linear});
}

std::shared_ptr<const Probe> own_model(std::string name, const LaidAlong& lay, ModelSource source) {
  check_name(name);
  return std::make_shared<const OwnProbe>(std::move(name), std::move(source), lay(nullptr), lay);
}

}  // namespace sepcal
