// Correlations of the effects' numbers: from a fit into the arm file and back.
#include "diagnose/stated_correlations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "arm/arm_writer.h"
#include "diagnose/extended_arm.h"
#include "effects/catalogue.h"
#include "math/linear_algebra.h"
#include "model/prepared_trial.h"
#include "recorded_case.h"
#include "softarm/effects/arm_effects.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;

int written(const MatrixXd& stated) {
  return static_cast<int>((stated.array() != 0.0).count() - stated.rows()) / 2;
}

/// Digits behind the point of its longest number.
int digits(const MatrixXd& stated) {
  int most = 0;
  for (Eigen::Index i = 0; i < stated.size(); ++i) {
    int n = 0;
    while (std::abs(std::remainder(std::pow(10.0, n) * stated.data()[i], 1.0)) > 1e-6 && n < 12) ++n;
    most = std::max(most, n);
  }
  return most;
}

/// The ratio of variances of the mixture for which it differs most from 1.
double largest_ratio(const MatrixXd& stated, const MatrixXd& correlations) {
  math::CholeskyFactor measure;
  measure.compute(correlations);
  const MatrixXd half = measure.whiten(stated);
  const Eigen::VectorXd ratios = math::eigensystem_of(measure.whiten(half.transpose())).values;
  return std::max(ratios.maxCoeff(), 1.0 / ratios.minCoeff());
}

/// Of n numbers of which one mixture has this share of the variance that it would have.
MatrixXd drawn(int n, double known, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  MatrixXd a(n, n);
  for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = normal(random);
  MatrixXd covariance = a * a.transpose() + 0.1 * MatrixXd::Identity(n, n);
  const Eigen::VectorXd mixture = a.col(0).normalized();
  const Eigen::VectorXd with = covariance * mixture;
  covariance -= (1.0 - known) / mixture.dot(with) * with * with.transpose();
  const Eigen::VectorXd over_sd = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return over_sd.asDiagonal() * covariance * over_sd.asDiagonal();
}

TEST(StatedCorrelations, AreFewAndShortWhereThatSaysTheSame) {
  MatrixXd usual(3, 3);
  usual << 1.0, -0.8312, 0.0731, -0.8312, 1.0, 0.0218, 0.0731, 0.0218, 1.0;
  const MatrixXd stated = stated_correlations(usual);
  EXPECT_EQ(stated(0, 1), -0.83);
  EXPECT_EQ(stated(1, 0), -0.83);
  EXPECT_EQ(stated(0, 2), 0.0);
  EXPECT_EQ(stated(1, 2), 0.0);
  EXPECT_EQ(stated(2, 2), 1.0);
}

TEST(StatedCorrelations, HaveTheDigitsThatASureMixtureNeeds) {
  MatrixXd sure(2, 2);
  sure << 1.0, -0.99963, -0.99963, 1.0;
  const MatrixXd stated = stated_correlations(sure);
  EXPECT_LT(std::abs(stated(0, 1)), 1.0);
  EXPECT_NEAR(1.0 + stated(0, 1), 1.0 - 0.99963, 0.25 * (1.0 - 0.99963));
  EXPECT_LE(digits(stated), 5);
  // Small ones stand where they matter: with 0.09 left out there would be no such numbers.
  MatrixXd three(3, 3);
  three << 1.0, 0.9995, 0.09, 0.9995, 1.0, 0.115, 0.09, 0.115, 1.0;
  EXPECT_NE(stated_correlations(three)(0, 2), 0.0);
}

TEST(StatedCorrelations, SayTheSameOfWhateverIsDrawn) {
  std::mt19937_64 random(3);
  for (const int n : {2, 3, 5, 8}) {
    for (const double known : {1.0, 1e-1, 1e-2, 1e-3}) {
      for (int draw = 0; draw < 10; ++draw) {
        const MatrixXd correlations = drawn(n, known, random);
        const MatrixXd stated = stated_correlations(correlations);
        EXPECT_LE(largest_ratio(stated, correlations), 1.3) << n << " numbers, " << known;
        EXPECT_LE(written(stated), n * (n - 1) / 2);
      }
    }
  }
}

TEST(StatedCorrelations, AreThoseOfACovarianceWhateverIsGiven) {
  // Known exactly, and to round-off less than nothing.
  for (const double value : {1.0, -1.0, 1.0 + 1e-12}) {
    MatrixXd exact = MatrixXd::Identity(3, 3);
    exact(0, 1) = exact(1, 0) = value;
    const MatrixXd stated = stated_correlations(exact);
    EXPECT_GT(math::eigensystem_of(stated).values[0], 0.0);
    EXPECT_GT(value * stated(0, 1), 0.99);
  }
  MatrixXd broken = MatrixXd::Identity(2, 2);
  broken(0, 1) = broken(1, 0) = std::nan("");
  EXPECT_TRUE(stated_correlations(broken).isIdentity(0.0));
  EXPECT_TRUE(stated_correlations(MatrixXd::Identity(1, 1)).isIdentity(0.0));
  EXPECT_EQ(stated_correlations(MatrixXd(0, 0)).size(), 0);
}

model::Present effect_of(const char* id, const std::vector<double>& values) {
  model::Present present{effects::find(id), Eigen::Map<const Eigen::VectorXd>(
                                                values.data(), static_cast<Eigen::Index>(values.size()))};
  return present;
}

/// Two effects in the arm file that the diagnosis was given, two that it found.
TEST(StatedCorrelations, ComeFromTheFitIntoTheFileAndFromThereIntoTheModel) {
  const testing::RecordedCase recorded = testing::recorded_case("{count_weights: [1]}", 3, 2, 8.0);
  std::vector<arm::EffectEntry> known{
      {"marker_slip", {{"x_m", 1e-3, 2e-4, {{1, "x_m", -0.83}}}, {"y_m", 0.0}, {"z_m", 0.0}, {"body", 2.0}}},
      {"marker_slip", {{"x_m", 2e-3, 3e-4}, {"y_m", 0.0}, {"z_m", 0.0}, {"body", 3.0}}}};
  const model::Prepared prepared = model::prepare(recorded.arm, recorded.trials);
  const JointModel model(recorded.arm, prepared.trials, 1, {}, {}, effects::effects_of(recorded.arm, known));
  Linearised fit;
  fit.at = model.start();
  fit.at.effects = {effect_of("creep", {0.2, 5.0, 0.5, 0.0}), effect_of("tip_mass", {0.05})};
  fit.columns = model.columns(fit.at);
  const auto n = static_cast<Eigen::Index>(fit.columns.size());
  const auto column_of = [&](int effect, int parameter) {
    for (std::size_t j = 0; j < fit.columns.size(); ++j) {
      const JointUnknown& c = fit.columns[j];
      if (c.kind == JointUnknown::Kind::kEffect && c.index == effect && c.parameter == parameter)
        return static_cast<Eigen::Index>(j);
    }
    throw std::logic_error("no such column");
  };
  MatrixXd covariance = 0.04 * MatrixXd::Identity(n, n);
  const Eigen::Index share = column_of(0, 0), time = column_of(0, 1), mass = column_of(1, 0);
  covariance(share, share) = 0.01;
  covariance(share, mass) = covariance(mass, share) = -0.912 * 0.1 * 0.2;
  covariance(share, time) = covariance(time, share) = 0.04 * 0.1 * 0.2;  // too small to be written
  covariance(0, mass) = covariance(mass, 0) = 0.3 * 0.2 * 0.2;           // with a constant
  const ExtendedArm extended = extended_arm(model, fit, covariance);
  ASSERT_EQ(extended.effects.size(), 4u);
  EXPECT_NEAR(extended.effects[2].numbers[0].sd.value(),
              0.1 * fit.columns[static_cast<std::size_t>(share)].scale, 1e-12);

  const arm::ArmText file = arm::read_arm_text(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml", {});
  const std::string text = arm::update_arm_text(file.text, file.source, extended.arm, extended.effects, {},
                                                "diagnose", "explained");
  EXPECT_NE(text.find("\neffects_correlations:  # of the errors of parameters with an sd\n"
                      "  - {of: marker_slip.1.x_m, with: {marker_slip.2.x_m: -0.83}}\n"
                      "  - {of: creep.share, with: {tip_mass.mass_kg: -0.91}}\n"),
            std::string::npos)
      << text.substr(text.rfind("\neffects:"));
  const std::vector<model::Present> read =
      effects::effects_of(recorded.arm, arm::parse_effect_entries(text, "extended"));
  ASSERT_EQ(read.size(), 4u);
  EXPECT_NEAR(model::correlation(read[2], 0, read[3], 0), -0.91, 1e-12);
  EXPECT_NEAR(model::correlation(read[0], 0, read[1], 0), -0.83, 1e-12);
  EXPECT_EQ(model::correlation(read[0], 0, read[3], 0), 0.0);
  EXPECT_EQ(model::correlation(read[2], 1, read[3], 0), 0.0);
}

}  // namespace
}  // namespace softarm::diagnose
