// Trials for the tests of effects on inputs and with memory: made up, or by the virtual rig.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "model/extended_model.h"
#include "rig/hidden.h"
#include "rig/simulator.h"
#include "softarm/arm/arm_file.h"
#include "trial/frame_assembler.h"
#include "trial/trial_recorder.h"

namespace softarm::effects::testing {

inline arm::Arm shipped_arm(const std::string& name) {
  return arm::load_arm_file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/" + name + ".yaml");
}

inline const arm::Arm& arm() {
  static const arm::Arm loaded = shipped_arm("semi_physical_200mm");
  return loaded;
}
constexpr int kChamber1 = 0;  ///< input of this arm

/// The jammable arm with four tendons in place of its chambers.
inline arm::Arm tendon_arm() {
  arm::Arm arm = shipped_arm("online_200mm");
  arm.segments[0].chambers.clear();
  const std::vector<arm::ScalarInput> pressures = arm.inputs.scalars;
  arm.inputs.scalars.clear();
  for (int k = 0; k < 4; ++k) {
    const std::string name = "tendon_" + std::to_string(k + 1);
    arm.segments[0].tendons.push_back({name, 0.5 * M_PI * k, 0.012});
    arm::ScalarInput input;
    input.name = name;
    input.kind = arm::InputKind::kTension;
    arm.inputs.scalars.push_back(input);
  }
  return arm;
}

constexpr double kSectionGain = 5.0;  ///< of each cable of the arm in sections, 1/(m rad)

/// The arm with a cable in two segments of half its length, each with two cables at right angles and a servo
/// for each: those of the second pass through the first.
inline arm::Arm arm_in_sections() {
  arm::Arm arm = shipped_arm("cable_235mm");
  arm::ScalarInput servo = arm.inputs.scalars.at(0);
  arm::Segment half = arm.segments.at(0);
  half.length_m *= 0.5;
  half.length_range_m = {0.5 * half.length_range_m.low, 0.5 * half.length_range_m.high};
  half.cables.clear();
  arm.segments.clear();
  arm.inputs.scalars.clear();
  for (int i = 0; i < 2; ++i) {
    arm::Segment segment = half;
    segment.name = "segment_" + std::to_string(i + 1);
    for (int k = 0; k < 2; ++k) {
      servo.name = "servo_" + std::to_string(2 * i + k + 1);
      arm.inputs.scalars.push_back(servo);
      segment.cables.push_back({servo.name, 0.5 * M_PI * k, kSectionGain});
    }
    arm.segments.push_back(segment);
  }
  return arm;
}

using InputsAt = std::function<Eigen::VectorXd(double t_s)>;

/// A trial of an arm whose base frame has z along gravity (hanging), every body seen in every block.
inline model::TrialData made_up(const arm::Arm& arm, double duration_s, const InputsAt& inputs,
                                double payload_kg = 0.0, double rate_hz = 50.0, double block_s = 0.1) {
  model::TrialData trial;
  trial.name = "made_up";
  const auto count = static_cast<Eigen::Index>(duration_s * rate_hz);
  trial.series.t_s.resize(count);
  trial.series.inputs.resize(static_cast<Eigen::Index>(arm.inputs.scalars.size()), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    trial.series.t_s[i] = static_cast<double>(i) / rate_hz;
    trial.series.inputs.col(i) = inputs(trial.series.t_s[i]);
  }
  trial.series.moment_inputs = trial.series.inputs;
  trial.series.payload_kg = Eigen::VectorXd::Constant(count, payload_kg);
  const auto step = static_cast<std::size_t>(block_s * rate_hz + 0.5);
  for (std::size_t first = 0; first + step <= static_cast<std::size_t>(count); first += step) {
    model::Block block;
    block.first = first;
    block.last = first + step;
    block.begins = first == 0;
    block.gravity_base = {0.0, 0.0, 9.80665};
    for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
      model::Seen seen;
      seen.body = static_cast<int>(b);
      block.bodies.push_back(seen);
    }
    trial.blocks.push_back(block);
  }
  return trial;
}

/// One input goes 0, peak, 0, peak ... along straight lines; the others stay 0.
inline InputsAt triangles(const arm::Arm& arm, int row, double peak, double period_s, double begin_s = 1.0) {
  const auto rows = static_cast<Eigen::Index>(arm.inputs.scalars.size());
  return [=](double t_s) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(rows);
    const double x = std::max(0.0, t_s - begin_s) / period_s;
    u[row] = peak * (1.0 - std::abs(2.0 * (x - std::floor(x)) - 1.0));
    return u;
  };
}

/// Values of an effect: usual ones, its sizes times `scale`.
inline model::Values usual(const model::Effect& effect, double scale = 1.0) {
  const model::Info& info = effect.info();
  model::Values values(static_cast<Eigen::Index>(info.parameters.size()));
  for (std::size_t k = 0; k < info.parameters.size(); ++k)
    values[static_cast<Eigen::Index>(k)] =
        info.parameters[k].usual * (static_cast<int>(k) < info.sizes ? scale : 1.0);
  return values;
}

/// Positions of all bodies in all blocks, 3 x ..., in the rod's base frame. Fails where there is none.
inline Eigen::Matrix3Xd positions(const std::vector<model::Predicted>& path) {
  Eigen::Index count = 0;
  for (const model::Predicted& p : path) count += p.solved ? p.p.cols() : 0;
  Eigen::Matrix3Xd out(3, count);
  Eigen::Index at = 0;
  for (const model::Predicted& p : path) {
    EXPECT_TRUE(p.solved) << "at " << p.instant.t_s << " s";
    if (!p.solved) continue;
    out.middleCols(at, p.p.cols()) = p.p;
    at += p.p.cols();
  }
  return out;
}

inline model::Dynamics quasi_static() {
  model::Dynamics dynamics;
  dynamics.inertia = false;
  return dynamics;
}

inline std::vector<model::Predicted> predict(model::ExtendedModel& model, const arm::Arm& arm,
                                             const std::vector<model::Present>& effects,
                                             const model::TrialData& trial,
                                             const model::Dynamics& dynamics = quasi_static(),
                                             bool derivatives = false) {
  std::vector<model::Predicted> path;
  model.predict(arm, effects, dynamics, trial, nullptr, path);
  if (derivatives)
    model.differentiate(arm, effects, dynamics, trial,
                        std::vector<bool>(model.rod().parameters().size(), true), path);
  return path;
}

/// Distance of the tip from the rod's axis, towards x, block by block.
inline std::vector<double> tip_x(const std::vector<model::Predicted>& path) {
  std::vector<double> x;
  for (const model::Predicted& p : path) x.push_back(p.shape.stations.back().p.x());
  return x;
}

// ---- by the rig ----

inline rig::Scenario shipped_scenario(const std::string& name) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/" + name + ".yaml");
  std::stringstream text;
  text << file.rdbuf();
  return rig::parse_scenario(text.str(), name);
}

/// Without noise, lost bodies or changes of payload.
inline void make_clean(rig::Scenario& scenario) {
  scenario.mocap.ring_noise = {};
  scenario.mocap.base_noise = {};
  scenario.mocap.dropout_probability = 0.0;
  scenario.payload.schedule = {{0.0, {0.0}}};
}

/// The rig's arm in sections, held out and wound up by all of its servos.
inline rig::Scenario scenario_in_sections() {
  rig::Scenario scenario = shipped_scenario("cable_235mm");
  make_clean(scenario);
  scenario.duration_s = 10.0;
  rig::SegmentSpec half = scenario.arm.segments.at(0);
  half.length_m *= 0.5;
  half.mass_kg *= 0.5;
  const double lever_m = half.cables.at(0).lever_m;
  half.cables.clear();
  scenario.arm.segments.assign(2, half);
  scenario.arm.servos = 4;
  for (int servo = 0; servo < 4; ++servo)
    scenario.arm.segments[static_cast<std::size_t>(servo / 2)].cables.push_back(
        {servo, 0.5 * M_PI * (servo % 2), lever_m, kSectionGain * half.length_m * lever_m});
  scenario.angles.random->min = {0.2, -0.4, 0.1, -0.3};
  scenario.angles.random->max = {1.0, 0.8, 0.9, 0.6};
  return scenario;
}

/// Runs the rig and records what it publishes.
inline trial::Trial recorded_trial(const arm::Arm& arm, const rig::Scenario& scenario,
                                   const std::string& name = "rig") {
  const double epoch_s = 100.0 + scenario.session_s;
  rig::Simulator simulator(scenario);
  trial::FrameAssembler assembler(arm);
  const auto row = [&](const rig::InputSample& input) {
    const arm::InputKind kind = input.kind == rig::InputKind::kVacuum   ? arm::InputKind::kVacuum
                                : input.kind == rig::InputKind::kTendon ? arm::InputKind::kTension
                                : input.kind == rig::InputKind::kServo  ? arm::InputKind::kAngle
                                                                        : arm::InputKind::kPressure;
    int left = input.number;
    for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
      if (arm.inputs.scalars[i].kind == kind && left-- == 0) return static_cast<int>(i);
    }
    return -1;
  };
  while (const auto sample = simulator.next()) {
    if (sample->payload) assembler.add_payload(epoch_s + sample->payload->stamp_s, sample->payload->kg);
    for (const rig::InputSample& input : sample->inputs)
      if (row(input) >= 0) assembler.add_input(row(input), epoch_s + input.stamp_s, input.value);
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, epoch_s + sample->mocap_stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
  }
  assembler.flush();
  trial::TrialRecorder recorder(arm, name);
  for (trial::Frame& frame : assembler.take()) recorder.add(std::move(frame));
  recorder.add(assembler.take_samples());
  return recorder.take();
}

/// The same, prepared for the model.
inline model::TrialData recorded(const arm::Arm& arm, const rig::Scenario& scenario) {
  const model::Prepared prepared = model::prepare(arm, {recorded_trial(arm, scenario)});
  return prepared.trials.at(0);
}

/// Root of the mean square distance of bodies from where they were seen, m.
inline double rms_m(const std::vector<model::Predicted>& path, const model::TrialData& trial) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (!path[k].solved || trial.blocks[k].set_aside) continue;
    for (std::size_t i = 0; i < trial.blocks[k].bodies.size(); ++i) {
      sum += (path[k].p.col(static_cast<Eigen::Index>(i)) - trial.blocks[k].bodies[i].p_base).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / std::max(count, 1));
}

}  // namespace softarm::effects::testing
