// How finely an arm is cut for an effect: as finely as its answer asks for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "effects/drive_trials.h"
#include "model/instant_solver.h"

namespace softarm::model {
namespace {

constexpr int kFinest = 24, kInstants = 40;
constexpr double kStep_s = 0.1, kUsualSizes = 2.0;
constexpr double kSettled_m = 1e-7;
constexpr double kShare = 0.05;  // of what the effect does, as its size is known to

/// The bodies at each instant of a slow movement that the effect remembers, cut into so many pieces.
std::vector<Eigen::Matrix3Xd> moved(const arm::Arm& arm, const Present& present, int pieces) {
  InstantSolver solver(arm, Mesh{pieces, true, kSettled_m});
  std::vector<Memory> memories(1);
  Feedback feedback;
  const Motion no_motion;
  const Dynamics still{false, 0.0};
  std::vector<Eigen::Matrix3Xd> places;
  for (int k = 0; k < kInstants; ++k) {
    Predicted now;
    now.instant.t_s = kStep_s * k;
    now.instant.dt_s = k == 0 ? 0.0 : kStep_s;
    now.instant.inputs.resize(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
    for (Eigen::Index i = 0; i < now.instant.inputs.size(); ++i) {
      const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(i)].kind;
      const double largest = kind == arm::InputKind::kTension  ? 3.0
                             : kind == arm::InputKind::kVacuum ? 4e4
                                                               : 2e4;
      now.instant.inputs[i] =
          largest * (0.5 - 0.5 * std::cos(1.5 * now.instant.t_s + 1.5 * static_cast<double>(i)));
    }
    now.instant.moment_inputs = now.instant.inputs;
    now.instant.payload_kg = 0.08;
    now.instant.gravity_base = {9.80665, 0.0, 0.0};  // held out: bent most at the base
    const InstantSolver::Context context{arm, memories, still, no_motion, feedback};
    EXPECT_TRUE(solver.settle(context, {present}, nullptr, nullptr, now));
    Bodies bodies;
    solver.bodies_of_solution(bodies);
    places.push_back(bodies.p);
    present.effect->remember(arm, solver.fine, present.values, now.instant, now.shape, memories[0]);
  }
  return places;
}

double largest_m(const std::vector<Eigen::Matrix3Xd>& a, const std::vector<Eigen::Matrix3Xd>& b) {
  double most = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, (a[k] - b[k]).colwise().norm().maxCoeff());
  return most;
}

class MeshOfMemories : public ::testing::TestWithParam<std::string> {};

TEST_P(MeshOfMemories, FinerOneChangesLittleOfWhatTheEffectDoes) {
  const Effect& effect = *effects::find(GetParam());
  double largest_effect_m = 0.0;
  for (const std::string name : {"semi_physical_200mm", "online_200mm", "two_segment"}) {
    arm::Arm arm = effects::testing::shipped_arm(name);
    if (!effect.applies_to(arm)) continue;
    SCOPED_TRACE(name);
    const Info& info = effect.info();
    const FineRod fine(arm);
    for (Values values : effect.grid(arm, fine)) {
      for (int k = 0; k < info.sizes; ++k) {
        const Parameter& size = info.parameters[static_cast<std::size_t>(k)];
        values[k] = std::min(kUsualSizes * size.usual, size.high);
      }
      const Present present{&effect, values};
      const int pieces = Mesh::of({present}, kSettled_m).pieces;
      const std::vector<Eigen::Matrix3Xd> finest = moved(arm, present, kFinest);
      Present none = present;
      none.values.head(info.sizes).setZero();
      const double effect_m = largest_m(moved(arm, none, kFinest), finest);
      const double off_m = largest_m(moved(arm, present, pieces), finest);
      largest_effect_m = std::max(largest_effect_m, effect_m);
      EXPECT_LE(off_m, kShare * effect_m + kSettled_m) << pieces << " pieces, values " << values.transpose()
                                                       << "; of the effect's " << 1e3 * effect_m << " mm";
    }
  }
  EXPECT_GT(largest_effect_m, 1e-3) << "nothing was tested";
}

/// Those that remember and act all along the arm; what touches it holds places, however it is cut.
std::vector<std::string> memories() {
  std::vector<std::string> ids;
  for (const auto& effect : effects::catalogue()) {
    if (effect->remembers() && effect->varies_along() && effect->info().family != Family::kLoad)
      ids.push_back(effect->info().id);
  }
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, MeshOfMemories, ::testing::ValuesIn(memories()),
                         [](const ::testing::TestParamInfo<std::string>& one) { return one.param; });

}  // namespace
}  // namespace softarm::model
