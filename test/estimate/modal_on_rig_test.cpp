// An arm that is followed through its swings, on the rig's data: after steps of pressure, and after a hand
// has let go. The rig integrates the whole arm; it knows no modes.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include "frames.h"
#include "rig/simulator.h"
#include "trial/frame_assembler.h"

namespace softarm::estimate::testing::modal_on_rig {
namespace {

constexpr double kStartsAt_s = 100.0;
constexpr double kNoise_m = 3e-4;
constexpr double kEvery_s = 3.0;                   // something sets the arm swinging
constexpr double kSwing_s = 1.2, kAtRest_s = 2.3;  // after that

struct SwingTrial {
  std::vector<trial::Frame> frames;
  std::vector<rig::Truth> truth;  ///< one per frame
  std::vector<double> since_s;    ///< the last step, or the last time that a hand let go
};

enum class Cause { kStep, kHand };

/// Pressures that jump within 0.05 s, or weights that a slow hand takes along and drops half-way.
SwingTrial swinging(const arm::Arm& arm, Cause cause, std::uint64_t seed) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/trial_both.yaml");
  std::stringstream text;
  text << file.rdbuf();
  rig::Scenario spec = rig::parse_scenario(text.str(), "trial_both");
  spec.duration_s = 24.0;
  spec.seed = seed;
  spec.mount.q_mocap_base = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY());
  spec.pressures.random.reset();
  spec.pressures.schedule = {{0.0, {30e3, 0.0, 0.0}}};
  spec.pressures.steps = {{0.0, {0.0, 0.0, 0.0}}};
  spec.payload.publish = true;
  spec.payload.schedule = {{0.0, {0.15}}};
  std::mt19937_64 random(seed);
  double last_kg = 0.15;
  for (double t_s = 6.0; t_s < spec.duration_s - kEvery_s; t_s += kEvery_s) {
    if (cause == Cause::kStep) {
      const double a = uniform(random, -20e3, 20e3), b = uniform(random, 0.0, 20e3);
      spec.pressures.steps.push_back({t_s, {a, b, 0.0}});
    } else {
      last_kg = last_kg > 0.17 ? uniform(random, 0.06, 0.1) : uniform(random, 0.22, 0.28);
      spec.payload.schedule.push_back({t_s, {last_kg}});
    }
  }
  spec.mocap.ring_noise.position_sd_m = kNoise_m;
  spec.payload.ramp_s = 0.1;
  spec.payload.steady_s = 0.3;
  spec.payload.hand_damping_n_s_m = 40.0;
  rig::Simulator simulator(spec);
  trial::FrameAssembler assembler(arm);
  SwingTrial trial;
  double last_s = -1e9, steadied_s = -1e9;
  while (const auto sample = simulator.next()) {
    const rig::Truth& truth = sample->truth;
    if (truth.payload_steadied) steadied_s = truth.stamp_s;
    if (cause == Cause::kStep && truth.stamp_s >= 6.0)
      last_s = 6.0 + kEvery_s * std::floor((truth.stamp_s - 6.0) / kEvery_s);
    if (cause == Cause::kHand) last_s = steadied_s;
    trial.since_s.push_back(truth.stamp_s < 6.0 ? -1.0 : truth.stamp_s - last_s);
    trial.truth.push_back(truth);
    if (sample->payload) assembler.add_payload(kStartsAt_s + sample->payload->stamp_s, sample->payload->kg);
    for (const rig::InputSample& input : sample->inputs)
      assembler.add_input(input.number, kStartsAt_s + input.stamp_s, input.value);
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, kStartsAt_s + sample->stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
  }
  assembler.flush();
  trial.frames = assembler.take();
  return trial;
}

struct Error {
  double square = 0.0;
  int covered = 0, count = 0;
  void add(double error, double sd) {
    square += error * error;
    covered += std::abs(error) < 1.96 * sd;
    ++count;
  }
  double rms() const { return std::sqrt(square / std::max(1, count)); }
  double coverage() const { return static_cast<double>(covered) / std::max(1, count); }
};

struct Errors {
  Error swing, rest;
};

/// Relative errors of EI, or errors of the payload in kg.
Errors errors_of(const arm::Arm& arm, const arm::EstimatorOptions& options, const SwingTrial& trial) {
  estimate::Estimator estimator(arm, options);
  estimator.set_backbone_points(0);
  Errors errors;
  for (std::size_t i = 0; i < trial.frames.size(); ++i) {
    trial::Frame frame = trial.frames[i];
    const rig::Truth& truth = trial.truth[i];
    const bool of_stiffness = options.unknown == arm::Unknown::kStiffness;
    if (!of_stiffness) frame.payload_kg.reset();
    const estimate::Estimate& e = estimator.estimate(frame);
    const double since_s = trial.since_s[i];
    Error* to = since_s > 0.02 && since_s < kSwing_s ? &errors.swing
                : since_s > kAtRest_s                ? &errors.rest
                                                     : nullptr;
    if (to == nullptr || e.status != Status::kOk) continue;
    const double ei = truth.segments[0].bending_stiffness_nm2;
    if (of_stiffness && e.segments[0].sd_bending_stiffness_nm2)
      to->add(*e.segments[0].bending_stiffness_nm2 / ei - 1.0, *e.segments[0].sd_bending_stiffness_nm2 / ei);
    if (!of_stiffness && e.sd_payload_kg) to->add(*e.payload_kg - truth.payload_kg, *e.sd_payload_kg);
  }
  return errors;
}

struct Case {
  const char* name;
  Cause cause;
  arm::Unknown unknown;
  double window_s;
  friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }
};

class ModalOnRig : public ::testing::TestWithParam<Case> {};

TEST_P(ModalOnRig, ASwingIsNoStiffnessAndNoPayload) {
  const Case& c = GetParam();
  arm::Arm arm = placed_exactly(paper_arm());
  arm.payload.range_kg = {-5.0, 5.0};
  for (arm::MeasuredBody& body : arm.bodies) body.position_sd_m = kNoise_m;
  Error swing[2], rest[2];
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const SwingTrial trial = swinging(arm, c.cause, seed);
    ASSERT_EQ(trial.frames.size(), trial.truth.size());
    for (const auto dynamics : {arm::Dynamics::kStatic, arm::Dynamics::kModal}) {
      arm::EstimatorOptions options = arm.estimator;
      options.unknown = c.unknown;
      options.window_s = c.window_s;
      options.dynamics = dynamics;
      const Errors errors = errors_of(arm, options, trial);
      const auto add = [](const Error& more, Error& to) {
        to.square += more.square;
        to.covered += more.covered;
        to.count += more.count;
      };
      add(errors.swing, swing[dynamics == arm::Dynamics::kModal]);
      add(errors.rest, rest[dynamics == arm::Dynamics::kModal]);
    }
  }
  std::printf(
      "%-24s swing: rms %.4f -> %.4f, covers %3.0f -> %3.0f %% of %d; rest: %.4f -> %.4f, %3.0f -> %3.0f "
      "%%\n",
      c.name, swing[0].rms(), swing[1].rms(), 100.0 * swing[0].coverage(), 100.0 * swing[1].coverage(),
      swing[1].count, rest[0].rms(), rest[1].rms(), 100.0 * rest[0].coverage(), 100.0 * rest[1].coverage());
  ASSERT_GT(swing[1].count, 1000);
  ASSERT_GT(rest[1].count, 300);
  EXPECT_LT(swing[1].rms(), 0.5 * swing[0].rms());
  EXPECT_GE(swing[1].coverage(), 0.90);
  EXPECT_LE(swing[1].coverage(), 0.97);
  // Nothing is worse near rest: neither the error nor, against the 95 % that intervals promise, the cover.
  EXPECT_LT(rest[1].rms(), 1.05 * rest[0].rms());
  EXPECT_GE(rest[1].coverage(), 0.93);
}

INSTANTIATE_TEST_SUITE_P(
    Frames, ModalOnRig,
    ::testing::Values(Case{"stiffness_step", Cause::kStep, arm::Unknown::kStiffness, 0.0},
                      Case{"stiffness_hand", Cause::kHand, arm::Unknown::kStiffness, 0.0},
                      Case{"payload_step", Cause::kStep, arm::Unknown::kPayload, 0.0},
                      Case{"payload_hand", Cause::kHand, arm::Unknown::kPayload, 0.0}),
    [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace softarm::estimate::testing::modal_on_rig
