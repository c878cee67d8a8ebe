// How a trial finds what effects remember: 0 is at rest, what is not acts, and it is forgotten.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "effects/drive_trials.h"
#include "model/online_effects.h"
#include "softarm/arm/laws.h"

namespace softarm::effects::testing {
namespace {

constexpr double kRate_hz = 20.0, kDuration_s = 14.0, kLast_s = 12.0;

struct Remembering {
  std::string id;
  std::vector<double> values;
  std::string arm;  ///< shipped; "tendons": tendon_arm()
  double pressure_pa = 20e3;
  double sizes[2] = {0.1, 0.2};  ///< of the first number, in standard deviations
  double straight = 0.15;        ///< what the smaller one may do besides half of what the other does, share
};

void PrintTo(const Remembering& one, std::ostream* out) {
  *out << one.id;
}

const std::vector<Remembering> kAll{
    {"hysteresis", {0.5, 1500.0, 0.0, 0.0}, "semi_physical_200mm"},
    {"hysteresis", {0.5, 1500.0, 0.0, 2.0}, "semi_physical_200mm"},
    {"hysteresis", {0.5, 1500.0, 1.0, 0.0}, "two_segment"},
    {"hysteresis", {0.5, 1500.0, 2.0, 0.0}, "tendons"},
    {"creep", {0.4, 1.0, 0.0, 0.0}, "two_segment"},
    {"creep", {0.4, 0.5, 1.0, 0.0}, "two_segment"},
    {"creep", {0.4, 1.0, 0.0, 1.0}, "two_segment"},
    // Bent at once beyond what the smaller start says, it forgets that at once.
    {"axial_memory", {0.4, 1.0, 0.0}, "semi_physical_200mm"},
    {"axial_memory", {0.4, 0.5, 1.0}, "semi_physical_200mm"},
    {"mullins", {0.3, 0.0, 1.0}, "semi_physical_200mm", 80e3, {0.3, 0.6}, 0.51},
    {"jamming_memory", {0.5}, "semi_physical_200mm"},
    {"jamming_yield", {0.5, 0.5, 1.0}, "semi_physical_200mm"},
    {"tendon_friction", {0.15, 0.15, 0.0}, "tendons", 0.0, {0.5, 1.0}, 0.15},
};

/// Every input up and down, at first not moving; the vacuum there from the beginning, and now and then gone.
Eigen::VectorXd inputs_at(const arm::Arm& arm, double pressure_pa, double t_s) {
  Eigen::VectorXd u(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
  const double moved_s = std::max(0.0, t_s - 1.0);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(i)].kind;
    const bool vacuum = kind == arm::InputKind::kVacuum;
    const double phase = vacuum ? M_PI : 1.5 * static_cast<double>(i + 1);
    const double wave = 0.5 - 0.5 * std::cos(2.0 * M_PI * 0.25 * moved_s + phase);
    u[i] = wave * (kind == arm::InputKind::kTension ? 3.0 : vacuum ? 40e3 : pressure_pa);
  }
  return u;
}

class StartsOf : public ::testing::TestWithParam<Remembering> {
 protected:
  StartsOf()
      : effect_(*find(GetParam().id)),
        arm_(GetParam().arm == "tendons" ? tendon_arm() : shipped_arm(GetParam().arm)),
        batch_(arm_),
        values_(Eigen::Map<const Eigen::VectorXd>(GetParam().values.data(),
                                                  static_cast<Eigen::Index>(GetParam().values.size()))),
        numbers_(effect_.starts(arm_, values_)),
        trial_(made_up(
            arm_, kDuration_s, [this](double t_s) { return inputs_at(arm_, GetParam().pressure_pa, t_s); },
            0.02, kRate_hz)) {}

  model::Present present(const Eigen::VectorXd& start) const { return {&effect_, values_, start}; }
  Eigen::VectorXd one(double size) const {
    Eigen::VectorXd start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(numbers_.size()));
    start[0] = size;
    return start;
  }
  /// What the first number does, block by block, at the body that it moves most, m.
  std::vector<double> moved_m(double size) {
    const auto with = predict(batch_, arm_, {present(one(size))}, trial_);
    const auto without = predict(batch_, arm_, {present({})}, trial_);
    std::vector<double> list;
    for (std::size_t k = 0; k < with.size(); ++k)
      list.push_back((with[k].p - without[k].p).colwise().norm().maxCoeff());
    return list;
  }

  const model::Effect& effect_;
  const arm::Arm arm_;
  model::ExtendedModel batch_;
  const model::Values values_;
  const std::vector<model::StartNumber> numbers_;
  const model::TrialData trial_;
};

TEST_P(StartsOf, NumbersHaveNamesAndSizes) {
  ASSERT_FALSE(numbers_.empty());
  for (const model::StartNumber& number : numbers_) {
    EXPECT_FALSE(number.name.empty());
    EXPECT_FALSE(number.unit.empty());
    EXPECT_GT(number.sd, 0.0);
  }
}

TEST_P(StartsOf, NothingIsAtRest) {
  for (const double moved : moved_m(0.0)) EXPECT_LT(moved, 1e-9);
}

TEST_P(StartsOf, ActsInProportionAndIsForgotten) {
  const std::vector<double> half = moved_m(GetParam().sizes[0]), whole = moved_m(GetParam().sizes[1]);
  const double largest = *std::max_element(whole.begin(), whole.end());
  EXPECT_GT(largest, 2e-5);
  EXPECT_NEAR(*std::max_element(half.begin(), half.end()) / largest, 0.5, GetParam().straight);
  for (std::size_t k = 0; k < whole.size(); ++k) {
    if (trial_.series.t_s[static_cast<Eigen::Index>(trial_.blocks[k].first)] < kLast_s) continue;
    EXPECT_LT(whole[k], 0.01 * largest) << "block " << k;
  }
}

/// Live, each number is a standard deviation of the curvature until it is forgotten.
TEST_P(StartsOf, IsNotKnownLiveUntilItIsForgotten) {
  arm::Arm arm = arm_;
  arm.gravity_m_s2 = {0.0, 0.0, 9.80665};
  model::OnlineEffects online(arm, {present({})});
  double first_rad2 = 0.0, last_rad2 = 0.0;
  for (Eigen::Index i = 0; i < trial_.series.t_s.size(); ++i) {
    const Eigen::VectorXd u = trial_.series.inputs.col(i);
    const auto& driven =
        online.begin(100.0 + trial_.series.t_s[i], arm::InputValues(u.data(), u.data() + u.size()), 0.02,
                     Eigen::Isometry3d::Identity());
    auto laws = arm::predict(arm, driven.inputs);
    const auto moments = arm::predict(arm, driven.moment_inputs);
    ASSERT_TRUE(laws && moments);
    for (std::size_t s = 0; s < laws->size(); ++s) {
      (*laws)[s].moment_nm = (*moments)[s].moment_nm;
      (*laws)[s].curvature_per_m = (*moments)[s].curvature_per_m;
    }
    double rad2 = 0.0;
    const auto variance = online.start_variance(*laws, 0.02);
    ASSERT_EQ(variance.size(), arm.segments.size());
    for (std::size_t s = 0; s < variance.size(); ++s) {
      ASSERT_TRUE(variance[s].allFinite());
      rad2 += variance[s].sum() * arm.segments[s].length_m * arm.segments[s].length_m;
    }
    if (trial_.series.t_s[i] < 3.0) first_rad2 = std::max(first_rad2, rad2);
    last_rad2 = rad2;
    ASSERT_TRUE(online.solve(*laws, 0.02));
    online.keep();
  }
  if (GetParam().id == "axial_memory") {  // of a length nothing is said live
    EXPECT_EQ(first_rad2, 0.0);
    return;
  }
  EXPECT_GT(std::sqrt(first_rad2), 1e-3);
  EXPECT_LT(std::sqrt(last_rad2), 0.02 * std::sqrt(first_rad2));
}

INSTANTIATE_TEST_SUITE_P(Memories, StartsOf, ::testing::ValuesIn(kAll),
                         [](const ::testing::TestParamInfo<Remembering>& one) {
                           return one.param.id + "_" + std::to_string(one.index);
                         });

TEST(Starts, EveryMemoryOfAMaterialHasThem) {
  for (const auto& effect : catalogue()) {
    // Where something holds the arm from outside, a trial finds it as it is when it touches.
    if (!effect->remembers() || effect->info().family == model::Family::kLoad) continue;
    const auto known = [&](const Remembering& one) { return one.id == effect->info().id; };
    EXPECT_TRUE(std::any_of(kAll.begin(), kAll.end(), known)) << effect->info().id;
  }
}

}  // namespace
}  // namespace softarm::effects::testing
