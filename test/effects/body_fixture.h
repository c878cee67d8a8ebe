// Trials made by hand for the tests of effects: conditions at rest, or a path in time.
#pragma once

#include <Eigen/Geometry>
#include <stdexcept>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "model/extended_model.h"
#include "softarm/arm/arm_file.h"

namespace softarm::effects::body_testing {

inline arm::Arm shipped(const std::string& name) {
  return arm::load_arm_file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/" + name + ".yaml");
}

inline Eigen::Quaterniond hanging() {
  return {0.0, 1.0, 0.0, 0.0};
}
inline Eigen::Quaterniond standing() {
  return Eigen::Quaterniond::Identity();
}
inline Eigen::Quaterniond horizontal() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY()));
}

/// What drives and loads the arm at one instant.
struct Condition {
  Eigen::VectorXd inputs;
  double payload_kg = 0.0;
  Eigen::Quaterniond q_mocap_base = hanging();
};

/// One block of one frame per condition, `dt_s` apart, all bodies seen.
/// @param path whether one lasts over to the next; else each stands for itself
inline model::TrialData trial_of(const arm::Arm& arm, const std::vector<Condition>& conditions,
                                 bool path = false, double dt_s = 0.1) {
  model::TrialData trial;
  trial.name = "made";
  const auto count = static_cast<Eigen::Index>(conditions.size());
  model::Series& series = trial.series;
  series.t_s = Eigen::VectorXd::LinSpaced(count, 0.0, dt_s * static_cast<double>(count - 1));
  series.inputs.resize(static_cast<Eigen::Index>(arm.inputs.scalars.size()), count);
  series.payload_kg.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Condition& now = conditions[static_cast<std::size_t>(i)];
    series.inputs.col(i) = now.inputs;
    series.payload_kg[i] = now.payload_kg;
    model::Block block;
    block.first = static_cast<std::size_t>(i);
    block.last = block.first + 1;
    block.begins = !path || i == 0;
    block.q_base_mocap = now.q_mocap_base.conjugate();
    block.gravity_base = block.q_base_mocap * arm.gravity_m_s2;
    block.base_in_mocap_m = {0.3, -0.2, 1.0};
    for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
      model::Seen seen;
      seen.body = static_cast<int>(b);
      seen.frames = 1;
      seen.white_sd_m = 5e-4;
      block.bodies.push_back(seen);
    }
    trial.blocks.push_back(block);
  }
  series.moment_inputs = series.inputs;
  return trial;
}

/// Inputs that bend any of the shipped arms: a level of each kind, more of the first than of the others.
inline Eigen::VectorXd inputs_of(const arm::Arm& arm, double level, std::size_t first = 0) {
  Eigen::VectorXd inputs(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    const arm::InputKind kind = arm.inputs.scalars[i].kind;
    const double full = kind == arm::InputKind::kTension ? 1.0 : kind == arm::InputKind::kAngle ? 0.4 : 3e4;
    const double share = kind == arm::InputKind::kVacuum ? 0.5 : i == first ? 1.0 : 0.25;
    inputs[static_cast<Eigen::Index>(i)] = level * share * full;
  }
  return inputs;
}

/// Prediction of a trial, all instants solved.
inline std::vector<model::Predicted> predict(model::ExtendedModel& model, const arm::Arm& arm,
                                             const std::vector<model::Present>& effects,
                                             const model::TrialData& trial,
                                             const model::Dynamics& dynamics = {false, 0.0},
                                             bool derivatives = false) {
  std::vector<model::Predicted> out;
  model.predict(arm, effects, dynamics, trial, nullptr, out);
  if (derivatives)
    model.differentiate(arm, effects, dynamics, trial,
                        std::vector<bool>(model.rod().parameters().size(), true), out);
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (!out[k].solved) throw std::runtime_error("instant " + std::to_string(k) + " is not solved");
  }
  return out;
}

/// All bodies of all instants below one another.
inline Eigen::VectorXd stacked(const std::vector<model::Predicted>& path) {
  Eigen::Index rows = 0;
  for (const model::Predicted& now : path) rows += now.p.size();
  Eigen::VectorXd all(rows);
  rows = 0;
  for (const model::Predicted& now : path) {
    all.segment(rows, now.p.size()) = Eigen::Map<const Eigen::VectorXd>(now.p.data(), now.p.size());
    rows += now.p.size();
  }
  return all;
}

inline model::Present present(const std::string& id, const model::Values& values) {
  const model::Effect* effect = find(id);
  if (effect == nullptr) throw std::invalid_argument("no effect " + id);
  return {effect, values};
}

/// Bodies moved by an effect against the baseline, one column per body of each instant.
inline Eigen::Matrix3Xd moved(model::ExtendedModel& model, const arm::Arm& arm, const model::Present& by,
                              const model::TrialData& trial, const model::Dynamics& dynamics = {false, 0.0}) {
  const Eigen::VectorXd difference =
      stacked(predict(model, arm, {by}, trial, dynamics)) - stacked(predict(model, arm, {}, trial, dynamics));
  return Eigen::Map<const Eigen::Matrix3Xd>(difference.data(), 3, difference.size() / 3);
}

/// What the change of an effect from the baseline does to the bodies, to first order.
inline Eigen::VectorXd signature(model::ExtendedModel& model, const arm::Arm& arm, const model::Present& by,
                                 const model::TrialData& trial,
                                 const model::Dynamics& dynamics = {false, 0.0}) {
  const std::vector<model::Predicted> base = predict(model, arm, {}, trial, dynamics, true);
  model::Values none = by.values;
  none.head(by.effect->info().sizes).setZero();
  const auto with = model.vary(arm, {by}, dynamics, trial, base, false);
  const auto without = model.vary(arm, {{by.effect, none}}, dynamics, trial, base, false);
  Eigen::VectorXd all(with.seen.size());
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < base.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd change =
        base[k].by_rod->seen.cast<double>() * (with.values.col(column) - without.values.col(column));
    all.segment(row, change.size()) = change;
    row += change.size();
  }
  const Eigen::MatrixXd seen = with.seen - without.seen;
  return all + Eigen::Map<const Eigen::VectorXd>(seen.data(), seen.size());
}

inline double rms(const Eigen::VectorXd& v) {
  return v.size() == 0 ? 0.0 : std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

}  // namespace softarm::effects::body_testing
