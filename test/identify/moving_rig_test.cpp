// Frames in motion: what they leave of a quasi-static model is alike from one to the next, and intervals must
// allow for it. Trials of the virtual rig, whose arms move.
#include <cmath>
#include <random>

#include "effects/drive_trials.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {
namespace {

namespace rigged = effects::testing;

/// The truth of a constant, of the rig's own segment.
double truth_of(const ConstantRef& ref, const rig::SegmentSpec& segment) {
  const auto chamber = [&]() -> const rig::ChamberSpec& {
    return segment.chambers[static_cast<std::size_t>(ref.index)];
  };
  switch (ref.kind) {
    case ConstantKind::kMomentGain:
      return chamber().moment_gain_nm_per_pa;
    case ConstantKind::kElongation:
      return chamber().near_elongation_m_per_pa + chamber().far_elongation_m_per_pa;
    case ConstantKind::kBendingStiffness:
      return segment.stiffness_base_nm2;
    case ConstantKind::kPerMinPressure:
      return segment.stiffness_per_min_nm2_per_pa;
    default:
      throw std::logic_error("a constant of which the rig has none");
  }
}

struct MovingCoverage {
  int inside = 0, all = 0;
  double widest_gain = 0.0;  ///< sd of size
};

/// Of constants in their intervals of two standard deviations, over laboratories with arms of their own.
MovingCoverage coverage(double highest_hz) {
  const arm::Arm arm = rigged::shipped_arm("online_200mm");
  MovingCoverage result;
  for (std::uint64_t lab = 1; lab <= 3; ++lab) {
    std::mt19937_64 random(lab);
    std::uniform_real_distribution<double> share(0.85, 1.15);
    rig::Scenario scenario = rigged::shipped_scenario("demo");
    rig::SegmentSpec& segment = scenario.arm.segments[0];
    segment.stiffness_base_nm2 *= share(random);
    for (rig::ChamberSpec& chamber : segment.chambers) chamber.moment_gain_nm_per_pa *= share(random);
    scenario.duration_s = 20.0;
    scenario.pressures.random->highest_hz = highest_hz;
    std::vector<trial::Trial> trials;
    for (std::uint64_t t = 0; t < 4; ++t) {
      scenario.seed = 10 * lab + t;
      trials.push_back(rigged::recorded_trial(arm, scenario, "trial_" + std::to_string(t)));
    }
    Options options;
    options.frames.prefer_static = false;
    options.held_out_share = 0.0;
    const Result found = identify(arm, trials, options);
    for (const Constant& c : found.constants) {
      ++result.all;
      result.inside += std::abs(c.value - truth_of(c.ref, segment)) <= 2.0 * c.sd;
      if (c.ref.kind == ConstantKind::kMomentGain)
        result.widest_gain = std::max(result.widest_gain, c.sd / c.scale);
    }
  }
  return result;
}

/// By the residuals alone 22 and 16 of the 24 are.
TEST(MovingOnTheRig, IntervalsHoldTheTruth) {
  for (const auto& [highest_hz, widest] : {std::pair(0.12, 0.03), std::pair(0.5, 0.1)}) {
    const MovingCoverage found = coverage(highest_hz);
    EXPECT_EQ(found.all, 24);
    EXPECT_GE(found.inside, 23) << highest_hz;
    EXPECT_LT(found.widest_gain, widest) << highest_hz;
  }
}

}  // namespace
}  // namespace softarm::identify
