// What an arm feels of a payload that changes, and how that shows.
#include "estimate/payload_changes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "estimate/policy.h"

namespace softarm::estimate {
namespace {

constexpr auto& kPayload = kPolicy.payload;
constexpr double kArm_kg = 0.2, kFrame_s = 1.0 / 120.0, kStart_s = 1.6e9;

double sd_kg(const PayloadChanges& changes) {
  return std::sqrt(changes.variance_kg2());
}

TEST(PayloadChanges, WhatIsToldIsUncertainByTheChangeAndFades) {
  PayloadChanges changes(kArm_kg, false);
  const auto kg_at = [](double t_s) { return t_s < 1.0 ? 0.24 : 0.0; };
  for (int i = 0; i < 600; ++i) {
    const double t_s = i * kFrame_s;
    changes.tell(kStart_s + t_s, kg_at(t_s));
    const double since_s = t_s - 1.0;
    EXPECT_EQ(changes.settling(), since_s > -1e-9 && since_s < kPayload.settles_s - 1e-6) << t_s;
    EXPECT_NEAR(sd_kg(changes), since_s < -1e-9 ? 0.0 : 0.24 * std::exp(-since_s / kPayload.fades_s), 1e-6);
  }
}

TEST(PayloadChanges, TwoChangesAddUp) {
  PayloadChanges changes(kArm_kg, false);
  changes.tell(kStart_s, 0.0);
  changes.tell(kStart_s + 0.01, 0.3);
  changes.tell(kStart_s + 0.02, 0.7);
  EXPECT_NEAR(sd_kg(changes), 0.5, 0.01);
}

TEST(PayloadChanges, AScaleThatTremblesIsNoChange) {
  PayloadChanges changes(kArm_kg, false);
  for (int i = 0; i < 600; ++i) {
    changes.tell(kStart_s + i * kFrame_s, 0.2 + (i % 12 < 6 ? 2e-4 : -2e-4));
    EXPECT_FALSE(changes.settling());
    EXPECT_LT(sd_kg(changes), 2e-3);
  }
}

TEST(PayloadChanges, StatesOfRestAreEachByThemselves) {
  PayloadChanges changes(kArm_kg, false);
  for (int i = 0; i < 5; ++i) {
    changes.tell(kStart_s + 10.0 * i, 0.1 * i);
    EXPECT_FALSE(changes.settling());
    EXPECT_EQ(changes.variance_kg2(), 0.0);
  }
  changes.tell(kStart_s, 0.3);  // time went back
  EXPECT_FALSE(changes.settling());
  changes.tell(kStart_s, 0.2);  // frames of no time
  EXPECT_FALSE(changes.settling());
}

TEST(PayloadChanges, APayloadThatIsToldForTheFirstTimeHasNotChanged) {
  PayloadChanges changes(kArm_kg, false);
  changes.tell(kStart_s, std::nullopt);
  changes.tell(kStart_s + kFrame_s, 0.2);
  EXPECT_FALSE(changes.settling());
  changes.tell(kStart_s + 2.0 * kFrame_s, 0.3);
  EXPECT_TRUE(changes.settling());
  changes.forget();
  EXPECT_FALSE(changes.settling());
  EXPECT_EQ(changes.variance_kg2(), 0.0);
}

TEST(PayloadChanges, AnEstimatedPayloadShowsThatItChanges) {
  constexpr double kNoise_kg = 0.02;
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, kNoise_kg);
  PayloadChanges changes(kArm_kg, false);
  double first_s = -1.0, largest_kg = 0.0;
  for (int i = 0; i < 1200; ++i) {
    const double t_s = i * kFrame_s, since_s = t_s - 5.0;
    const double kg = 0.25 - (since_s > 0.0 ? 0.2 * (1.0 - std::exp(-since_s / 0.2)) : 0.0);
    changes.tell(kStart_s + t_s, std::nullopt);
    changes.see(kg + noise(random), kNoise_kg * kNoise_kg, true);
    if (since_s < 0.0) {
      EXPECT_FALSE(changes.settling()) << t_s;
    } else if (first_s < 0.0 && changes.settling()) {
      first_s = since_s;
    }
    largest_kg = std::max(largest_kg, sd_kg(changes));
    if (since_s > 0.1 && since_s < 1.0) {
      EXPECT_GT(sd_kg(changes), 0.04) << since_s;
    }
  }
  EXPECT_GT(first_s, 0.0);
  EXPECT_LT(first_s, 0.1);
  EXPECT_LT(largest_kg, 0.25);
  EXPECT_FALSE(changes.settling());
}

}  // namespace
}  // namespace softarm::estimate
