// A discovered law in words: units, direction, range.
#include "diagnose/law_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "effects/catalogue.h"
#include "effects/learned_moment.h"
#include "softarm/arm/arm_file.h"

namespace softarm::diagnose {
namespace {

using effects::LearnedMoment;
using effects::Regressor;
using ::testing::HasSubstr;

model::Values values_of(Regressor of, double from, double to, double scale = 0.0) {
  model::Values values = model::Values::Zero(LearnedMoment::kCount);
  values[LearnedMoment::kX] = 3e-3;
  values[LearnedMoment::kY] = 4e-3;
  values[LearnedMoment::kOf] = static_cast<double>(of);
  values[LearnedMoment::kFirst] = 1.0;
  values[LearnedMoment::kSecond] = 2.0;
  values[LearnedMoment::kScale] = scale;
  values[LearnedMoment::kFrom] = from;
  values[LearnedMoment::kTo] = to;
  return values;
}

class LawWords : public ::testing::Test {
 protected:
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
};

TEST_F(LawWords, SayWhatAMomentGoesWith) {
  EXPECT_EQ(goes_with(arm, values_of(Regressor::kProduct, 0.0, 1e9)), "chamber_1 times chamber_2");
  model::Values square = values_of(Regressor::kProduct, 0.0, 1e9);
  square[LearnedMoment::kSecond] = 1.0;
  EXPECT_EQ(goes_with(arm, square), "the square of chamber_1");
  EXPECT_EQ(goes_with(arm, values_of(Regressor::kPlay, -1e3, 1e3, 2e3)),
            "how far a play of 2.00 kPa lags behind chamber_1");
  EXPECT_EQ(goes_with(arm, values_of(Regressor::kCurvatureLag, 0.0, 4.0, 15.0)),
            "the curvature minus its first-order lag of 15.0 s");
}

TEST_F(LawWords, ASizeIsThatAtTheFarEndOfTheRange) {
  const LawTerm up = law_term(arm, values_of(Regressor::kLag, -9e3, 14e3, 1.0), {1e-4, 1e-4}, 0.9);
  EXPECT_THAT(up.sentence,
              HasSubstr("5.00 mN m towards 53 deg at 14.0 kPa, the same all along the arm; learnt "
                        "between -9.00 kPa and 14.0 kPa"));
  EXPECT_DOUBLE_EQ(up.x_nm.value, 3e-3);
  EXPECT_NEAR(up.x_nm.high, 3e-3 + 1.6449e-4, 1e-9);
  const LawTerm down = law_term(arm, values_of(Regressor::kLag, -14e3, 9e3, 1.0), {1e-4, 1e-4}, 0.9);
  EXPECT_THAT(down.sentence, HasSubstr("5.00 mN m towards -127 deg at -14.0 kPa"));
  EXPECT_DOUBLE_EQ(down.y_nm.value, -4e-3);
}

TEST_F(LawWords, WhatHasADirectionGoesAlongItAndAcross) {
  model::Values values = values_of(Regressor::kCurvature, 0.0, 8.0);
  values[LearnedMoment::kRising] = 1.0;
  const LawTerm term = law_term(arm, values, {1e-4, 1e-4}, 0.9);
  EXPECT_TRUE(term.has_direction);
  EXPECT_THAT(term.sentence, HasSubstr("3.00 mN m along it and 4.00 mN m across it at 8.00 1/m, at the tip"));
}

TEST_F(LawWords, ATermIsAnEquation) {
  const auto law_of = [&](const model::Values& values) {
    const LawTerm term = law_term(arm, values, {1e-4, 1e-4}, 0.9);
    return term.law + "; " + term.symbols;
  };
  EXPECT_EQ(law_of(values_of(Regressor::kInput, 0.0, 4e4)),
            "M = (3.00, 4.00) mN m u / (40.0 kPa); u: chamber_1");
  EXPECT_EQ(law_of(values_of(Regressor::kProduct, 0.0, 9e8)),
            "M = (3.00, 4.00) mN m u v / (900 kPa^2); u: chamber_1; v: chamber_2");
  EXPECT_EQ(law_of(values_of(Regressor::kPlay, -1e3, 1e3, 2e3)),
            "M = (3.00, 4.00) mN m (u - P[u]) / (1.00 kPa); u: chamber_1; P: a play of 2.00 kPa");
  // As the sentence has it: the size is that at the range's end, which the term is divided by.
  EXPECT_EQ(
      law_of(values_of(Regressor::kLag, -14e3, 9e3, 1.0)),
      "M = (-3.00, -4.00) mN m (u - w) / (-14.0 kPa); u: chamber_1; w follows it: 1.00 s dw/dt = u - w");
  EXPECT_EQ(law_of(values_of(Regressor::kPayload, 0.0, 0.05)),
            "M = (3.00, 4.00) mN m m_p / (50.0 g); m_p: the payload");
  model::Values values = values_of(Regressor::kCurvature, 0.0, 8.0);
  values[LearnedMoment::kY] = -4e-3;
  values[LearnedMoment::kRising] = 1.0;
  EXPECT_EQ(law_of(values),
            "M = (3.00 k - 4.00 R k) mN m / (8.00 1/m) (2 s / L - 1); k: the curvature; R: a quarter turn "
            "about the arm's axis");
  values[LearnedMoment::kY] = -4e-6;  // of nothing it is no minus
  EXPECT_EQ(law_of(values).rfind("M = (3.00 k + 0.00 R k) mN m", 0), 0u) << law_of(values);
}

/// Of every input of every kind of arm, so that the page makes a link of it.
TEST_F(LawWords, EveryTermHasASourceWithALink) {
  const std::regex link(R"(\b(doi:10\.\d{4,}/[-\w.()/]+|isbn:\d{9}[\dX])$)");
  for (const char* name : {"online_200mm", "hybrid_85mm", "cable_235mm", "tendon_trunk"}) {
    const arm::Arm one = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/" + std::string(name) + ".yaml");
    const std::size_t inputs = one.inputs.scalars.size();
    for (int of = 0; of <= static_cast<int>(Regressor::kCurvature); ++of)
      for (std::size_t i = 0; i < inputs * inputs; ++i) {
        model::Values values = values_of(static_cast<Regressor>(of), 0.0, 1.0, 1.0);
        values[LearnedMoment::kFirst] = static_cast<double>(1 + i / inputs);
        values[LearnedMoment::kSecond] = static_cast<double>(1 + i % inputs);
        const LawTerm term = law_term(one, values, {1e-4, 1e-4}, 0.9);
        EXPECT_TRUE(std::regex_search(term.source, link)) << name << ": " << term.law << ": " << term.source;
      }
  }
  EXPECT_TRUE(std::regex_search(effects::learned_moment().info().source, link));
}

/// A form that the catalogue has is cited as there.
TEST_F(LawWords, ATermCitesWhatItsFormIsFrom) {
  const auto source_of = [&](const model::Values& values) {
    return law_term(arm, values, {1e-4, 1e-4}, 0.9).source;
  };
  EXPECT_THAT(source_of(values_of(Regressor::kPlay, -1e3, 1e3, 2e3)), HasSubstr("M. Brokate, J. Sprekels"));
  EXPECT_THAT(source_of(values_of(Regressor::kLag, -1e3, 1e3, 1.0)), HasSubstr("line of first order"));
  EXPECT_THAT(source_of(values_of(Regressor::kDriveLag, 0.0, 1e-2, 9.0)), HasSubstr("Viscoelasticity"));
  model::Values square = values_of(Regressor::kProduct, 0.0, 1e9);
  square[LearnedMoment::kSecond] = 1.0;
  EXPECT_EQ(source_of(square), effects::find("gain_nonlinearity")->info().source);
}

TEST_F(LawWords, OneTermIsOneSentenceSeveralAreListed) {
  DiscoveredLaw law;
  law.terms.push_back(law_term(arm, values_of(Regressor::kLag, -9e3, 14e3, 1.0), {1e-4, 1e-4}, 0.9));
  law.held_out_mean_before_m = 1.2e-3;
  law.held_out_mean_after_m = 0.7e-3;
  law.share = 0.62;
  law.share_of_flexible = 0.8;
  law.resembles = "pressure_lag";
  law.cosine = 0.93;
  const std::string one = sentence_of(law);
  EXPECT_THAT(
      one, HasSubstr("What no effect of the catalogue explains is a moment that goes with chamber_1 minus"));
  EXPECT_THAT(one,
              HasSubstr("It accounts for 62 % of what was left beyond the noise, 80 % of what a flexible "
                        "model learns from it: on input sequences that were not fitted, the mean error falls "
                        "from 1.20 mm to 0.70 mm. Its shape resembles that of pressure_lag (93 %)."));
  law.terms.push_back(law_term(arm, values_of(Regressor::kPayload, 0.0, 0.1), {1e-4, 1e-4}, 0.9));
  EXPECT_THAT(sentence_of(law), HasSubstr("explains goes with chamber_1 minus its first-order lag of 1.00 s "
                                          "and the payload. A moment that goes with chamber_1 minus"));
}

}  // namespace
}  // namespace softarm::diagnose
