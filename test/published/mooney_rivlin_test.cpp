// The tangent modulus of the hybrid paper against the derivative of its stress, and both against the uniaxial
// law; what the papers' constants make of either.
#include "published/mooney_rivlin.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace softarm::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const arm::MooneyRivlin kHybrid{18.8e3, -14e3};         // Table 2
const arm::MooneyRivlin kSingleChamber{-209e3, 277e3};  // slides, by the names of the constants
const arm::MooneyRivlin kSingleByFormula{277e3,
                                         -209e3};  // slides, by their formula: c01 is the constant term

Matrix3d cauchy_green(double strain) {
  return 2.0 * published::published_strain({strain, 0.0, 0.0}, 0.0) + Matrix3d::Identity();
}

double axial_stress_pa(const arm::MooneyRivlin& material, double strain) {
  const auto stress = published::published_stress_pa(material, cauchy_green(strain));
  return stress ? (*stress)(0, 0) : std::numeric_limits<double>::quiet_NaN();
}

TEST(MooneyRivlin, UniaxialLawIsThatOfTheStrainEnergy) {
  for (const arm::MooneyRivlin& material : {kHybrid, kSingleChamber, kSingleByFormula}) {
    for (const double stretch : {0.9, 1.0, 1.1, 1.5}) {
      const auto energy = [&](double l) {
        const double i1 = l * l + 2.0 / l;
        const double i2 = 2.0 * l + 1.0 / (l * l);
        return material.c10_pa * (i1 - 3.0) + material.c01_pa * (i2 - 3.0);
      };
      const double h = 1e-4;
      const double first = (energy(stretch + h) - energy(stretch - h)) / (2.0 * h);
      const double second = (energy(stretch + h) - 2.0 * energy(stretch) + energy(stretch - h)) / (h * h);
      EXPECT_NEAR(material.nominal_stress_pa(stretch), first, 0.05);
      EXPECT_NEAR(material.cauchy_stress_pa(stretch), stretch * first, 0.05);
      EXPECT_NEAR(material.tangent_modulus_pa(stretch), second, 0.5);
    }
    EXPECT_NEAR(material.tangent_modulus_pa(1.0), material.initial_modulus_pa(), 1e-9);
  }
}

TEST(MooneyRivlin, PrintedModulusIsTheDerivativeOfThePrintedStress) {
  for (const arm::MooneyRivlin& material : {kHybrid, kSingleChamber}) {
    for (const double strain : {-0.2, -0.03, 0.0, 0.08, 0.4}) {
      const double h = 1e-5;
      const double stretch_step = std::sqrt(1.0 + 2.0 * (strain + h)) - std::sqrt(1.0 + 2.0 * (strain - h));
      const double slope =
          (axial_stress_pa(material, strain + h) - axial_stress_pa(material, strain - h)) / stretch_step;
      EXPECT_NEAR(*published::published_modulus_pa(material, strain), slope, 1e-6 * std::abs(slope) + 1e-3);
      // lambda_1 of the paper: the root of the largest eigenvalue of C (of the axial one in compression).
      const Vector3d eigenvalues =
          Eigen::SelfAdjointEigenSolver<Matrix3d>(cauchy_green(strain)).eigenvalues();
      EXPECT_NEAR(strain < 0.0 ? eigenvalues[0] : eigenvalues[2], 1.0 + 2.0 * strain, 1e-12);
    }
  }
}

TEST(MooneyRivlin, PrintedStressIsTheTraceFreePart) {
  // Of an incompressible bar, C = diag(l^2, 1/l, 1/l): two thirds of its Cauchy stress.
  for (const double stretch : {0.9, 1.0, 1.3}) {
    const Matrix3d c = Vector3d(stretch * stretch, 1.0 / stretch, 1.0 / stretch).asDiagonal();
    EXPECT_NEAR(published::invariants(c).i3, 1.0, 1e-12);
    EXPECT_NEAR(published::invariants(c).i1, stretch * stretch + 2.0 / stretch, 1e-12);
    EXPECT_NEAR(published::invariants(c).i2, 2.0 * stretch + 1.0 / (stretch * stretch), 1e-12);
    const auto stress = published::published_stress_pa(kHybrid, c);
    ASSERT_TRUE(stress);
    EXPECT_NEAR(stress->trace(), 0.0, 1e-8);
    EXPECT_NEAR((*stress)(0, 0), 2.0 / 3.0 * kHybrid.cauchy_stress_pa(stretch), 1e-8);
    EXPECT_NEAR((*stress)(0, 0) - (*stress)(1, 1), kHybrid.cauchy_stress_pa(stretch), 1e-8);
  }
}

TEST(MooneyRivlin, PrintedStrainLosesVolumeAtSecondOrder) {
  for (const double strain : {-0.1, 0.1, 0.3}) {
    const double loss = 3.0 * strain * strain - 2.0 * strain * strain * strain;
    EXPECT_NEAR(published::invariants(cauchy_green(strain)).i3, 1.0 - loss, 1e-12);
  }
  // v_1 itself, as printed, instead of v_1 - 1: no stress exists even at rest.
  EXPECT_FALSE(published::published_stress_pa(kHybrid, cauchy_green(1.0)));
}

TEST(MooneyRivlin, PrintedModulusIsTwoThirdsOfYoungs) {
  EXPECT_NEAR(*published::published_modulus_pa(kHybrid, 0.0), 19.2e3, 1e-6);
  EXPECT_NEAR(kHybrid.initial_modulus_pa(), 28.8e3, 1e-6);
  EXPECT_NEAR(*published::published_modulus_pa(kSingleChamber, 0.0) / kSingleChamber.initial_modulus_pa(),
              2.0 / 3.0, 1e-12);
  // Its sum of two products, taken at its word, is not even positive.
  EXPECT_NEAR(*published::published_chain_rule_modulus_pa(kHybrid, 0.0),
              -4.0 / 3.0 * 18.8e3 - 8.0 / 3.0 * 14e3, 1e-6);
}

// 40 kPa on the chamber (3 mm) of the hybrid arm's 12 mm wall.
TEST(MooneyRivlin, StiffeningOfTheHybridArmByPressure) {
  const double stress = 40e3 * 9.0 / (144.0 - 9.0);
  const auto stretch = kHybrid.stretch_at(stress);
  ASSERT_TRUE(stretch);
  EXPECT_NEAR(kHybrid.nominal_stress_pa(*stretch), stress, 1e-6);
  EXPECT_NEAR(*stretch, 1.08189, 1e-5);
  EXPECT_NEAR(kHybrid.tangent_modulus_pa(*stretch) / kHybrid.initial_modulus_pa(), 1.2386, 1e-4);
}

// Its wall holds no compression beyond 2.5 kPa (0.26 N): a tendon's 3 N have no stable stretch.
TEST(MooneyRivlin, HybridArmsConstantsAreUnstableInCompression) {
  EXPECT_GT(kHybrid.tangent_modulus_pa(0.86), 0.0);
  EXPECT_LT(kHybrid.tangent_modulus_pa(0.84), 0.0);
  EXPECT_TRUE(kHybrid.stretch_at(-2.3e3));
  EXPECT_FALSE(kHybrid.stretch_at(-2.6e3));
}

TEST(MooneyRivlin, OutOfRangeIsAbsent) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double strain : {-0.5, 1.0, -2.0, nan}) {
    EXPECT_FALSE(published::published_modulus_pa(kHybrid, strain));
    EXPECT_FALSE(published::published_chain_rule_modulus_pa(kHybrid, strain));
  }
  EXPECT_FALSE(published::published_stress_pa(kHybrid, Matrix3d::Constant(nan)));
  EXPECT_FALSE(published::published_stress_pa({nan, 0.0}, Matrix3d::Identity()));
}

}  // namespace
}  // namespace softarm::rod
