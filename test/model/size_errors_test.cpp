// What is made of the standard deviations of effects' numbers.
#include "model/size_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>
#include <vector>

#include "effects/catalogue.h"
#include "effects/drive_trials.h"

namespace softarm::model {
namespace {

/// Effects of which one number each, the first, has a standard deviation, with these correlations.
struct Numbers {
  std::vector<Present> effects;
  Eigen::MatrixXd correlations;
  Eigen::VectorXd sd;

  Numbers(std::vector<Present> given, const Eigen::MatrixXd& all)
      : effects(std::move(given)), correlations(all) {
    const Eigen::MatrixXd rows = Eigen::LLT<Eigen::MatrixXd>(all).matrixL();
    sd.resize(static_cast<Eigen::Index>(effects.size()));
    for (std::size_t e = 0; e < effects.size(); ++e) {
      const auto i = static_cast<Eigen::Index>(e);
      effects[e].correlated = Eigen::MatrixXd::Zero(effects[e].values.size(), rows.cols());
      effects[e].correlated.row(0) = rows.row(i);
      sd[i] = effects[e].sd[0];
    }
  }
  Eigen::MatrixXd covariance() const { return sd.asDiagonal() * correlations * sd.asDiagonal(); }
};

Present with_sd(const char* id, double value, double sd) {
  const Effect* effect = effects::find(id);
  Present present{effect, effects::testing::usual(*effect, 0.0)};
  present.values[0] = value;
  present.sd = Values::Zero(present.values.size());
  present.sd[0] = sd;
  return present;
}

/// By how much a standard deviation of an error moves the first number of each effect, by finite difference.
Eigen::VectorXd move_of(const SizeErrors& errors, int k, const std::vector<Present>& about) {
  Eigen::VectorXd move(static_cast<Eigen::Index>(about.size()));
  for (std::size_t e = 0; e < about.size(); ++e) {
    for (const Present& present : errors.effects(k)) {
      if (present.effect == about[e].effect)
        move[static_cast<Eigen::Index>(e)] = errors.scale(k) * (present.values[0] - about[e].values[0]);
    }
  }
  return move;
}

Eigen::MatrixXd covariance_by(const SizeErrors& errors, const std::vector<Present>& about) {
  const auto n = static_cast<Eigen::Index>(about.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < errors.count(); ++k) {
    const Eigen::VectorXd move = move_of(errors, k, about);
    sum += move * move.transpose();
  }
  return sum;
}

/// Three effects with room around their numbers.
std::vector<Present> three_effects() {
  return {with_sd("base_compliance", 0.3, 0.05), with_sd("tip_mass", 0.2, 0.03),
          with_sd("soft_spot", 0.1, 0.02)};
}

/// A place at the tip may be wrong towards the base alone: beyond the tip nothing is another place.
TEST(SizeErrors, APlaceAtTheTipIsOffInwards) {
  const arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  const double length_m = arm.total_length_m(), sd_m = 4e-3;
  for (const double place_m : {length_m, length_m - 0.2 * sd_m}) {
    Present wall{effects::find("contact"),
                 (Values(7) << 100.0, place_m, 0.0, 0.02, 0.0, 0.0, 0.0).finished()};
    wall.sd = (Values(5) << 0.0, sd_m, 0.0, 0.0, 0.0).finished();
    const SizeErrors errors(arm, {wall});
    ASSERT_EQ(errors.count(), 1);
    EXPECT_NEAR(errors.effects(0)[0].values[1], place_m - sd_m, 1e-12);
    EXPECT_NEAR(errors.scale(0), -1.0, 1e-12);
    EXPECT_NEAR(errors.leaning(Eigen::VectorXd::Constant(1, 2.0))[0].values[1], length_m, 1e-12);
    EXPECT_NEAR(errors.leaning(Eigen::VectorXd::Constant(1, -2.0))[0].values[1], place_m - 2.0 * sd_m, 1e-12);
  }
}

TEST(SizeErrors, CorrelatedNumbersErrAlongDirectionsThatMakeTheirCovariance) {
  const arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  Eigen::Matrix3d all;
  all << 1.0, -0.95, 0.3, -0.95, 1.0, -0.2, 0.3, -0.2, 1.0;
  const Numbers numbers(three_effects(), all);
  const SizeErrors errors(arm, numbers.effects);
  ASSERT_EQ(errors.count(), 3);
  const Eigen::MatrixXd covariance = numbers.covariance();
  EXPECT_TRUE(covariance_by(errors, numbers.effects).isApprox(covariance, 1e-9))
      << covariance_by(errors, numbers.effects) << "\n\n"
      << covariance;
  // The numbers of a lean are those of its errors together.
  const Eigen::Vector3d by_sd(0.5, -0.3, 0.8);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(3);
  for (int k = 0; k < 3; ++k) expected += by_sd[k] * move_of(errors, k, numbers.effects);
  for (const Present& present : errors.leaning(by_sd)) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (present.effect == numbers.effects[e].effect) {
        EXPECT_NEAR(present.values[0] - numbers.effects[e].values[0], expected[static_cast<Eigen::Index>(e)],
                    1e-12);
      }
    }
  }
}

TEST(SizeErrors, ANumberWithoutCorrelationsErrsByItselfExactly) {
  const arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  Eigen::Matrix3d all = Eigen::Matrix3d::Identity();
  const auto expect_alone = [&](const SizeErrors& errors, int k, const Present& number) {
    EXPECT_EQ(errors.scale(k), 1.0);
    for (const Present& present : errors.effects(k)) {
      if (present.effect == number.effect) {
        EXPECT_EQ(present.values[0], number.values[0] + number.sd[0]);
      }
    }
  };
  // None is correlated, whether the file says so or not.
  for (const std::vector<Present>& effects : {three_effects(), Numbers(three_effects(), all).effects}) {
    const SizeErrors errors(arm, effects);
    ASSERT_EQ(errors.count(), 3);
    const std::vector<Present> in_their_order = in_order(effects);
    for (int k = 0; k < 3; ++k) {
      expect_alone(errors, k, in_their_order[static_cast<std::size_t>(k)]);
      EXPECT_EQ((move_of(errors, k, effects).array() != 0.0).count(), 1);
    }
  }
  // Two are; the third is not, and neither is one of the two where the other is not in the model.
  all(0, 1) = all(1, 0) = -0.9;
  const Numbers numbers(three_effects(), all);
  const SizeErrors errors(arm, numbers.effects);
  ASSERT_EQ(errors.count(), 3);
  EXPECT_TRUE(covariance_by(errors, numbers.effects).isApprox(numbers.covariance(), 1e-9));
  const SizeErrors of_two(arm, {numbers.effects[0], numbers.effects[2]});
  ASSERT_EQ(of_two.count(), 2);
  const std::vector<Present> in_their_order = in_order({numbers.effects[0], numbers.effects[2]});
  for (int k = 0; k < 2; ++k) expect_alone(of_two, k, in_their_order[static_cast<std::size_t>(k)]);
}

/// Two numbers of which only the sum matters: where one is known within its range, so is the other.
TEST(SizeErrors, NumbersThatMayBeAnywhereAreNotKnownWorseThanTheirRange) {
  const arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  const double range = 2.0, most = range / std::sqrt(12.0);  // of a tip mass
  Eigen::Matrix2d all;
  all << 1.0, -0.999, -0.999, 1.0;
  const Numbers numbers({with_sd("tip_mass", 1.0, 40.0), with_sd("base_compliance", 5.0, 1.0)}, all);
  const SizeErrors errors(arm, numbers.effects);
  const Eigen::MatrixXd covariance = covariance_by(errors, numbers.effects);
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), most, 1e-9);
  // Of a Gaussian: what the other leaves, and its share of that one's error.
  const double known = 1.0 - 0.999 * 0.999, share = 0.999 * most / 40.0;
  EXPECT_NEAR(covariance(1, 1), known + share * share, 1e-9);
  for (int k = 0; k < errors.count(); ++k) {
    for (const Present& present : errors.effects(k)) {
      const Parameter& parameter = present.effect->info().parameters[0];
      EXPECT_GE(present.values[0], parameter.low);
      EXPECT_LE(present.values[0], parameter.high);
    }
  }
}

/// Two sizes of which one can only grow where the other shrinks, both at nothing.
TEST(SizeErrors, NumbersAtTheirEndsStayInTheirRanges) {
  const arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  Eigen::Matrix2d all;
  all << 1.0, -0.9, -0.9, 1.0;
  for (const double at_sd : {0.0, 0.05, 0.5}) {
    const Numbers numbers(
        {with_sd("tip_mass", at_sd * 0.03, 0.03), with_sd("base_compliance", at_sd * 0.05, 0.05)}, all);
    const SizeErrors errors(arm, numbers.effects);
    ASSERT_EQ(errors.count(), 2);
    for (int k = 0; k < 2; ++k) {
      EXPECT_GT(move_of(errors, k, numbers.effects).norm(), 0.0);
      EXPECT_LE(std::abs(errors.scale(k)), 10.0);
      for (const Present& present : errors.effects(k)) EXPECT_GE(present.values[0], 0.0);
    }
    for (const Present& present : errors.leaning(Eigen::Vector2d(3.0, -3.0)))
      EXPECT_GE(present.values[0], 0.0);
  }
}

}  // namespace
}  // namespace softarm::model
