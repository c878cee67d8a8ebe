// Whole trials of the rig's demo, in which somebody changes the weight at the tip: how often a value that is
// called identifiable is far off, and what is said while the payload changes.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "frames.h"
#include "rig/simulator.h"
#include "softarm/arm/arm_file.h"
#include "trial/frame_assembler.h"

namespace softarm::estimate::testing::settling {
namespace {

constexpr double kFar_sd = 4.0;
constexpr double kFarShare = 0.003;   // of the identifiable values, at most
constexpr double kChange_s = 8.0;     // the scenario's payload changes every so often, first at that time,
constexpr double kSaidAfter_s = 0.1;  // ... and is made known in the middle of the change

struct DemoTrial {
  std::vector<trial::Frame> frames;
  std::vector<rig::Truth> truth;  ///< one per frame
};

arm::Arm demo_arm() {
  return arm::load_arm_file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml");
}

DemoTrial demo_trial(const arm::Arm& arm, std::uint64_t seed) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/demo.yaml");
  std::stringstream text;
  text << file.rdbuf();
  rig::Scenario scenario = rig::parse_scenario(text.str(), "demo");
  scenario.duration_s = 40.0;  // all of its changes, and once more the first
  scenario.seed = seed;
  rig::Simulator simulator(scenario);
  trial::FrameAssembler assembler(arm);
  DemoTrial trial;
  constexpr double kStart_s = 100.0;
  while (const auto sample = simulator.next()) {
    trial.truth.push_back(sample->truth);
    if (sample->payload) assembler.add_payload(kStart_s + sample->payload->stamp_s, sample->payload->kg);
    for (const rig::InputSample& input : sample->inputs)
      assembler.add_input(input.number, kStart_s + input.stamp_s, input.value);
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, kStart_s + sample->stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
  }
  assembler.flush();
  trial.frames = assembler.take();
  return trial;
}

/// Values of a trial's frames.
struct Count {
  int frames = 0, settling = 0, identifiable = 0, far = 0;
  int apart = 0, identifiable_apart = 0;  ///< frames without settling, and those of them with EI or payload
  int intervals_settling = 0, far_settling = 0;  ///< of EI and payload, whatever is said of them
  double slowest_s = 0.0;                        ///< from a change to the first frame that is marked
};

void add(double value, std::optional<double> sd, double truth, bool identifiable, Count& count) {
  if (!sd || !identifiable) return;
  ++count.identifiable;
  count.far += std::abs(value - truth) > kFar_sd * *sd;
}

void add_settling(double value, std::optional<double> sd, double truth, Count& count) {
  if (!sd) return;
  ++count.intervals_settling;
  count.far_settling += std::abs(value - truth) > kFar_sd * *sd;
}

void add(const Estimate& e, const rig::Truth& truth, Count& count) {
  ++count.frames;
  count.settling += e.settling;
  if (e.status != Status::kOk) return;
  const SegmentEstimate& s = e.segments[0];
  if (s.bending_stiffness_nm2 && e.payload_kg) {
    add(*s.bending_stiffness_nm2, s.sd_bending_stiffness_nm2, truth.segments[0].bending_stiffness_nm2,
        s.identifiable_stiffness, count);
    add(*s.moment_nm, s.sd_moment_nm, truth.segments[0].moment_nm.norm(), s.identifiable_moment, count);
    add(*e.payload_kg, e.sd_payload_kg, truth.payload_kg, e.identifiable_payload, count);
  }
  if (e.settling) {
    EXPECT_FALSE(s.identifiable_stiffness || s.identifiable_moment || e.identifiable_payload);
    EXPECT_EQ(s.stiffness_why_not, WhyNot::kSettling);
    add_settling(*s.bending_stiffness_nm2, s.sd_bending_stiffness_nm2,
                 truth.segments[0].bending_stiffness_nm2, count);
    add_settling(*e.payload_kg, e.sd_payload_kg, truth.payload_kg, count);
  } else {
    ++count.apart;
    count.identifiable_apart += s.identifiable_stiffness || e.identifiable_payload;
  }
}

Count estimated(const arm::Arm& arm, const DemoTrial& trial, bool told) {
  Estimator estimator(arm);
  Count count;
  double last_change_s = -1.0;
  bool marked = true;
  for (std::size_t i = 0; i < trial.frames.size(); ++i) {
    trial::Frame frame = trial.frames[i];
    if (!told) frame.payload_kg.reset();
    const Estimate& e = estimator.estimate(frame);
    const double t_s = trial.truth[i].stamp_s, change_s = kChange_s * std::floor(t_s / kChange_s + 1e-9);
    if (change_s > 0.0 && change_s != last_change_s) {
      // An estimated payload of a pose that hardly tells it may change unseen.
      EXPECT_TRUE(marked || !told) << "the change at " << last_change_s << " s";
      marked = false;
      last_change_s = change_s;
    }
    if (!marked && e.settling) {
      marked = true;
      count.slowest_s = std::max(count.slowest_s, t_s - change_s);
    }
    add(e, trial.truth[i], count);
  }
  return count;
}

/// What is said of trials, printed.
Count over_trials(const char* what, const arm::Arm& arm, bool told = true) {
  Count all;
  for (const std::uint64_t seed : {7, 8}) {
    const DemoTrial trial = demo_trial(arm, seed);
    EXPECT_EQ(trial.frames.size(), trial.truth.size());
    if (trial.frames.size() != trial.truth.size()) return all;
    const Count one = estimated(arm, trial, told);
    all.frames += one.frames;
    all.settling += one.settling;
    all.identifiable += one.identifiable;
    all.far += one.far;
    all.apart += one.apart;
    all.identifiable_apart += one.identifiable_apart;
    all.intervals_settling += one.intervals_settling;
    all.far_settling += one.far_settling;
    all.slowest_s = std::max(all.slowest_s, one.slowest_s);
  }
  const auto percent = [](int part, int of) { return 100.0 * part / std::max(1, of); };
  std::printf(
      "%s: %d of %d identifiable values (%.2f %%) more than 4 sd off; settling %.1f %% of the frames, %.2f "
      "%% of "
      "their intervals so far off; marked %.3f s after the change at most; of the others %.1f %% tell EI or "
      "payload\n",
      what, all.far, all.identifiable, percent(all.far, all.identifiable), percent(all.settling, all.frames),
      percent(all.far_settling, all.intervals_settling), all.slowest_s,
      percent(all.identifiable_apart, all.apart));
  return all;
}

TEST(Settling, OverAWholeDemoFewIdentifiableValuesAreFarOff) {
  const Count count = over_trials("EI, frame by frame", demo_arm());
  EXPECT_LT(count.far, kFarShare * count.identifiable);
  // Four changes in 40 s, each marked from the message on, for two seconds.
  EXPECT_LT(count.slowest_s, kSaidAfter_s + 0.01);
  EXPECT_NEAR(count.settling, count.frames * 4 * 2.0 / 40.0, 0.01 * count.frames);
  // It is not by calling nothing identifiable.
  EXPECT_GT(count.identifiable_apart, 0.6 * count.apart);
  // The intervals say by themselves what a changing payload leaves open.
  EXPECT_LT(count.far_settling, 0.01 * count.intervals_settling);
}

TEST(Settling, TheSameWithWindowAndPrior) {
  arm::Arm arm = demo_arm();
  arm.estimator.window_s = 0.5;
  arm.estimator.prior.enabled = true;
  const Count count = over_trials("EI, window and prior", arm);
  EXPECT_LT(count.far, kFarShare * count.identifiable);
  EXPECT_GT(count.identifiable_apart, 0.6 * count.apart);
  EXPECT_LT(count.far_settling, 0.01 * count.intervals_settling);
}

TEST(Settling, APayloadThatIsEstimatedIsUncertainWhereTheTopicSaysThatItChanges) {
  arm::Arm arm = demo_arm();
  arm.estimator.unknown = arm::Unknown::kPayload;
  const Count count = over_trials("payload, told when it changes", arm);
  EXPECT_LT(count.far, kFarShare * count.identifiable);
  EXPECT_GT(count.identifiable_apart, 0.3 * count.apart);
}

TEST(Settling, APayloadOfWhichNothingIsToldShowsByTheArmsMotion) {
  arm::Arm arm = demo_arm();
  arm.estimator.unknown = arm::Unknown::kPayload;
  const Count count = over_trials("payload, nothing told", arm, false);
  EXPECT_LT(count.far, 0.01 * count.identifiable);
  EXPECT_LT(count.slowest_s, 0.5);
  EXPECT_GT(count.identifiable_apart, 0.3 * count.apart);
}

}  // namespace
}  // namespace softarm::estimate::testing::settling
