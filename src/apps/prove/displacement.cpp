#include "displacement.h"

#include <cmath>

#include "diagnose/joint_model.h"
#include "signal.h"

namespace softarm::prove {

using model::Present;

namespace {

/// Predicts all trials with some effects or others.
class Predictions {
 public:
  Predictions(const arm::Arm& arm, const std::vector<trial::Trial>& trials, unsigned jobs)
      : prepared_(model::prepare(arm, trials)), model_(arm, prepared_.trials, jobs) {}

  Residuals with(const std::vector<Present>& effects) {
    diagnose::JointParameters parameters = model_.start();
    parameters.effects = effects;
    std::vector<std::vector<model::Predicted>> predicted;
    model_.predict(parameters, nullptr, predicted);
    return residuals_of(prepared_.trials, predicted);
  }

 private:
  const model::Prepared prepared_;
  diagnose::JointModel model_;
};

}  // namespace

std::vector<Displacement> displacements(const arm::Arm& arm, const std::vector<Present>& effects,
                                        const std::vector<trial::Trial>& trials, unsigned jobs) {
  Predictions predictions(arm, trials, jobs);
  const Residuals all = predictions.with(effects);
  std::vector<Displacement> list;
  for (std::size_t e = 0; e < effects.size(); ++e) {
    std::vector<Present> others = effects;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(e));
    Displacement one{effects[e].effect->info().id, {}, std::nullopt};
    // What is predicted with it, less what is without: residuals the other way round.
    one.by = at_whole_seconds(differences(predictions.with(others), all));
    const double size = effects[e].values[0];
    if (effects[e].effect->info().sizes == 1 && effects[e].sd.size() > 0 && effects[e].sd[0] > 0.0 &&
        size != 0.0)
      one.relative_sd = effects[e].sd[0] / std::abs(size);
    list.push_back(std::move(one));
  }
  return list;
}

nlohmann::ordered_json rows_of(const Residuals& displacement) {
  nlohmann::ordered_json trials = nlohmann::ordered_json::array();
  for (const auto& trial : displacement) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const auto& [key, moved] : trial) {
      nlohmann::ordered_json row{std::llround(static_cast<double>(key.first) * kTick_s), key.second};
      for (int i = 0; i < 3; ++i) row.push_back(std::llround(1e6 * moved[i]));
      rows.push_back(std::move(row));
    }
    trials.push_back(std::move(rows));
  }
  return trials;
}

}  // namespace softarm::prove
