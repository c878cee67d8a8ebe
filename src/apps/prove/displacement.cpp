#include "displacement.h"

#include <cmath>

#include "diagnose/joint_model.h"
#include "signal.h"

namespace softarm::prove {

using model::Present;

namespace {

double product(const Residuals& a, const Residuals& b) {
  double sum = 0.0;
  for (std::size_t t = 0; t < a.size(); ++t) {
    for (const auto& [key, displacement] : a[t]) {
      const auto other = b[t].find(key);
      if (other != b[t].end()) sum += displacement.dot(other->second);
    }
  }
  return sum;
}

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
    Displacement one{effects[e].effect->info().id, {}, 0.0};
    // What is predicted with it, less what is without: residuals the other way round.
    one.by = at_whole_seconds(differences(predictions.with(others), all));
    const double square = product(one.by, one.by);
    const int sizes = effects[e].effect->info().sizes;
    for (int k = 0; k < sizes && square > 0.0 && effects[e].sd.size() > k; ++k) {
      if (effects[e].values[k] == 0.0) continue;
      std::vector<Present> without = effects;
      without[e].values[k] = 0.0;
      const Residuals by_size = at_whole_seconds(differences(predictions.with(without), all));
      one.relative_sd +=
          std::pow(effects[e].sd[k] / effects[e].values[k] * product(by_size, one.by) / square, 2);
    }
    one.relative_sd = std::sqrt(one.relative_sd);
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
