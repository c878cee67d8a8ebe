// Fits with one effect more.
#include "diagnose/refits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnose/floor.h"
#include "diagnose/policy.h"
#include "diagnose/screen.h"
#include "diagnose/unseen.h"
#include "effects/catalogue.h"
#include "looked.h"
#include "recorded_case.h"
#include "started.h"

namespace softarm::diagnose {
namespace {

/// A fit without effects, from constants that are off, and one with an effect that is not there, from where
/// it is.
TEST(Refits, WhatARefitGainsByBetterConstantsIsNotItsEffects) {
  const testing::RecordedCase drawn = testing::recorded_case("{count_weights: [1]}", 43, 3, 10.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const std::vector<Screened> screened = screen(looked.model, looked.baseline, 0, [](double) {});
  const Screened& absent = *std::min_element(screened.begin(), screened.end(),
                                             [](const Screened& a, const Screened& b) { return a.z < b.z; });
  const Standing good{looked.baseline, unseen(looked.model, looked.baseline)};
  const std::vector<Refitted> refitted = {refit(looked.model, good, absent)};
  EXPECT_FALSE(at_better_constants(looked.model, good, refitted));

  JointParameters off = looked.baseline.at;
  Eigen::VectorXd x = looked.baseline.unknowns();
  x[0] += 1.0;
  set_unknown(off, looked.baseline.columns[0], x[0]);
  Standing poor;
  poor.fit = looked.model.linearise(off, &looked.baseline.predicted);
  ASSERT_GT(poor.fit.square, 1.5 * good.fit.square);
  const std::optional<Standing> better = at_better_constants(looked.model, poor, refitted);
  ASSERT_TRUE(better);
  EXPECT_TRUE(better->fit.at.effects.empty());
  EXPECT_NEAR(better->fit.square, good.fit.square, 0.01 * good.fit.square);
}

/// What the screen expects to first order is far beyond what helps, as on an arm that bends much.
TEST(Refits, ThatBeginTooFarAwayEndNoFarWorseThanWithoutTheirEffect) {
  const testing::RecordedCase drawn = testing::recorded_case("{count_weights: [1]}", 43, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const Standing alone{looked.baseline, unseen(looked.model, looked.baseline)};
  for (Screened& s : screen(looked.model, looked.baseline, 0, [](double) {})) {
    SCOPED_TRACE(s.effect->info().id);
    s.absorbed *= 10.0;
    for (Eigen::Index k = 0; k < s.effect->info().sizes; ++k) {
      const model::Parameter& size = s.effect->info().parameters[static_cast<std::size_t>(k)];
      s.values[k] = std::clamp(s.values[k] + 5.0 * size.usual, size.low, size.high);
    }
    EXPECT_LT(refit(looked.model, alone, s).fit.square, 1.25 * looked.baseline.square);
  }
}

/// What is there, begun so far away that few steps do not bring it back, beside one that has come to its end
/// and leads.
TEST(Refits, GoOnUntilNoneThatHasNotConvergedWouldLead) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [contact], size: [0.6, 1.0]}", 8, 4, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const Standing alone{looked.baseline, unseen(looked.model, looked.baseline)};
  std::vector<Refitted> refitted;
  for (Screened& s : screen(looked.model, looked.baseline, 0, [](double) {})) {
    if (s.effect->info().id != "contact") continue;
    s.absorbed *= 10.0;
    s.values[0] *= 5.0;
    s.values[2] += 0.6;
    refitted.assign(2, refit(looked.model, alone, s));
  }
  ASSERT_EQ(refitted.size(), 2U);
  ASSERT_FALSE(refitted[0].converged);
  refitted[1].converged = true;
  const double leads = refitted[1].fit.square *= 0.9;
  finish_leaders(looked.model, alone, refitted);
  EXPECT_LT(refitted[0].fit.square, leads);
  EXPECT_EQ(refitted[1].fit.square, leads);
}

/// A wall, looked for on the wrong side of the arm; and a hose that grows taut, which does nearly the same.
TEST(Refits, WhatIsAlikeIsFittedFromWhereTheOtherEnded) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [contact], size: [0.6, 1.0]}", 8, 4, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const Standing alone{looked.baseline, unseen(looked.model, looked.baseline)};
  std::vector<Screened> screened = screen(looked.model, looked.baseline, 0, [](double) {});
  const auto refit_of = [&](const std::string& id) {
    return refit(looked.model, alone, *std::find_if(screened.begin(), screened.end(), [&](const Screened& s) {
                   return s.effect->info().id == id;
                 }));
  };
  const Refitted hose = refit_of("tether");
  for (Screened& s : screened)
    if (s.effect->info().id == "contact") s.values[2] += M_PI;
  const Refitted astray = refit_of("contact");
  ASSERT_LT(hose.fit.square, 0.9 * astray.fit.square);

  std::vector<Refitted> refitted{hose, astray};
  refit_what_is_alike(looked.model, alone, screened, refitted);
  ASSERT_EQ(refitted.size(), 2U);
  EXPECT_EQ(refitted[0].fit.square, hose.fit.square);
  EXPECT_LT(refitted[1].fit.square, 1.05 * hose.fit.square);
  const double wall = refitted[1].fit.square;
  // One that had no refit of its own; one that is the better; and where nothing is alike.
  refitted = {hose};
  refit_what_is_alike(looked.model, alone, screened, refitted);
  ASSERT_EQ(refitted.size(), 2U);
  EXPECT_EQ(refitted[1].effect, astray.effect);
  EXPECT_EQ(refitted[1].fit.square, wall);
  refitted = {hose, astray};
  refitted[1].fit.square = 0.9 * hose.fit.square;
  refit_what_is_alike(looked.model, alone, screened, refitted);
  EXPECT_EQ(refitted[1].fit.square, 0.9 * hose.fit.square);
  refitted = {refit_of("tip_mass")};
  refit_what_is_alike(looked.model, alone, screened, refitted);
  EXPECT_EQ(refitted.size(), 1U);
}

/// Effects of which one, a wall, answers to the shape.
class SharedDerivatives : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedDerivatives, LeadWhereOnesOwnDo) {
  const testing::RecordedCase drawn = testing::recorded_case(
      std::string("{count_weights: [0, 1], from: [") + GetParam() + "], size: [0.6, 1.0]}", 6, 4, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const std::vector<Screened> screened = screen(looked.model, looked.baseline, 0, [](double) {});
  const auto at = std::find_if(screened.begin(), screened.end(),
                               [&](const Screened& s) { return s.effect->info().id == GetParam(); });
  ASSERT_NE(at, screened.end());
  Standing shares{looked.baseline, unseen(looked.model, looked.baseline)};
  ASSERT_TRUE(shares.fit.complete);
  Standing alone = shares;
  alone.fit.complete = false;
  const Refitted shared = refit(looked.model, shares, *at), own = refit(looked.model, alone, *at);
  // A step by them overshoots at the wall: from there on it has its own.
  EXPECT_EQ(shared.fit.predicted[0][0].by_rod == looked.baseline.predicted[0][0].by_rod,
            std::string(GetParam()) != "contact");
  EXPECT_NE(own.fit.predicted[0][0].by_rod, looked.baseline.predicted[0][0].by_rod);
  const Linearised by_shared = standing_on(looked.model, shared.fit).fit,
                   by_own = standing_on(looked.model, own.fit).fit;
  EXPECT_NEAR(by_shared.square, by_own.square, 1e-3 * by_own.square);
  const Eigen::VectorXd off = by_shared.unknowns() - by_own.unknowns();
  EXPECT_LT(std::sqrt(off.dot(by_own.information * off)), 1.0) << "standard deviations";
}

INSTANTIATE_TEST_SUITE_P(Effects, SharedDerivatives,
                         ::testing::Values("base_compliance", "payload_scale", "contact"),
                         [](const auto& which) { return std::string(which.param); });

/// A mass at the tip; a hose that may pull there and weighs, which is nearly the same; and creep, which is
/// not.
TEST(Refits, EvidenceOfThoseThatLeadIsByDerivativesOfTheirOwn) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [tip_mass], size: [0.9, 1.0]}", 6, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const Standing alone{looked.baseline, unseen(looked.model, looked.baseline)};
  std::vector<Refitted> refitted;
  for (const Screened& s : screen(looked.model, looked.baseline, 0, [](double) {}))
    if (const std::string& id = s.effect->info().id; id == "tip_mass" || id == "tether" || id == "creep")
      refitted.push_back(refit(looked.model, alone, s));
  ASSERT_EQ(refitted.size(), 3U);
  const auto named = [&](const std::string& id) -> Refitted& {
    return *std::find_if(refitted.begin(), refitted.end(),
                         [&](const Refitted& r) { return r.effect->info().id == id; });
  };
  const auto off = [&](const Refitted& r) {
    const Linearised own =
        looked.model.linearise(r.fit.at, &r.fit.predicted, JointModel::Derivatives::kShapesHeld, true);
    return (own.derivative[0] - r.fit.derivative[0]).norm() / own.derivative[0].norm();
  };
  // As where the whole step by derivatives of the model without it helps.
  Linearised& hose = named("tether").fit;
  ASSERT_TRUE(looked.baseline.complete);
  hose = looked.model.linearise(hose.at, &hose.predicted, JointModel::Derivatives::kShapesHeld, true,
                                &looked.baseline);
  EXPECT_TRUE(named("tip_mass").fit.own_derivatives);
  EXPECT_FALSE(hose.own_derivatives);
  EXPECT_GT(off(named("tether")), 5e-3);
  linearise_leaders(looked.model, alone, refitted);
  EXPECT_LT(off(named("tether")), 1e-3);
  EXPECT_TRUE(named("tether").fit.own_derivatives);

  for (Refitted& r : refitted) r.fit.own_derivatives = false;
  linearise_leaders(looked.model, alone, refitted);
  EXPECT_TRUE(named("tip_mass").fit.own_derivatives);
  EXPECT_FALSE(named("creep").fit.own_derivatives) << "explains next to nothing";
}

TEST(Refits, WhatOthersDoBesideARefitIsWhatTheyDoAboutItsFit) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [tether], size: [0.9, 1.0]}", 6, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  testing::Started begun(looked);
  const Screened& tether = begun.of("tether");
  Refitted with = refit(looked.model, begun.alone, tether);
  looked.model.take_own_derivatives(with.fit);
  const std::vector<model::Present> all = candidates_of(begun.round);
  std::vector<model::Present> others = all;
  others.erase(others.begin() + (&tether - begun.round.screened.data()));
  const EvidenceData without = evidence_data(looked.model, begun.alone.fit, others, 0),
                     about_it = evidence_data(looked.model, with.fit, others, 0),
                     beside_it = evidence_of_refit(looked.model, with.fit, with.fit, all, 0);
  ASSERT_EQ(beside_it.effects.size(), about_it.effects.size());
  double most = 0.0;
  for (std::size_t e = 0; e < about_it.effects.size(); ++e) {
    ASSERT_EQ(beside_it.effects[e].effect, about_it.effects[e].effect);
    EXPECT_EQ(beside_it.effects[e].moves, about_it.effects[e].moves);
    EXPECT_EQ(beside_it.effects[e].left, about_it.effects[e].left);
    most = std::max(most, (about_it.effects[e].moves - without.effects[e].moves).norm() /
                              about_it.effects[e].moves.norm());
  }
  EXPECT_GT(most, 0.05) << "a pull changes what others do";

  // By the weights of another fit, half as large.
  Linearised half = with.fit;
  for (Eigen::VectorXd& weight : half.root_weight) weight *= 0.5;
  const EvidenceData weighed = evidence_of_refit(looked.model, with.fit, half, all, 0);
  EXPECT_TRUE(weighed.residual.isApprox(0.5 * about_it.residual, 1e-12));
  ASSERT_EQ(weighed.effects.size(), about_it.effects.size());
  for (std::size_t e = 0; e < about_it.effects.size(); ++e) {
    EXPECT_TRUE(weighed.effects[e].moves.isApprox(0.5 * about_it.effects[e].moves, 1e-12));
    const double left = about_it.effects[e].left;
    if (left < 1e-5)  // less than any background: what the hose's own weight takes up but for its prior
      EXPECT_LT(weighed.effects[e].left, 3e-5);
    else
      EXPECT_NEAR(weighed.effects[e].left, left, 0.05 * left) << "metres, whatever the weights";
  }
}

TEST(JointModel, AFitThatComesNowhereNearIsGivenUpAfterTwoSteps) {
  const testing::RecordedCase drawn = testing::recorded_case("{count_weights: [1]}", 6, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  JointParameters off = looked.baseline.at;
  off.constants *= 2.0;
  JointModel::FitOptions how;
  how.tolerance = 1e-6;
  how.iterations = 12;
  const Linearised whole = looked.model.fit(off, how);
  EXPECT_FALSE(whole.given_up);
  how.most_square = 0.1 * whole.square;
  const Linearised given_up = looked.model.fit(off, how);
  EXPECT_TRUE(given_up.given_up);
  EXPECT_FALSE(given_up.converged);
  EXPECT_GT(given_up.square, whole.square) << "it ended before it was there";
  how.most_square = 100.0 * whole.square;
  EXPECT_FALSE(looked.model.fit(off, how).given_up) << "it is expected to come there";
}

TEST(EvidenceData, OfInertiaInModesAShareIsNotKnown) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [tip_mass], size: [0.9, 1.0]}", 6, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  std::vector<model::Present> all;
  for (const Screened& s : screen(looked.model, looked.baseline, 0, [](double) {}))
    all.push_back({s.effect, s.values});
  Linearised first_order = looked.baseline;
  for (const Signature& s : evidence_data(looked.model, first_order, all, 0).effects)
    EXPECT_EQ(s.unknown_sd, 0.0) << s.effect->info().id;
  std::vector<std::vector<model::Predicted>> path = looked.baseline.predicted;
  looked.model.find_modes(looked.baseline.at, path);
  looked.model.predict(looked.baseline.at, &path, path);
  Linearised in_modes =
      looked.model.linearise(looked.baseline.at, &path, JointModel::Derivatives::kShapesHeld, true);
  double most = 0.0;
  for (const Signature& s : evidence_data(looked.model, in_modes, all, 0).effects) {
    EXPECT_TRUE(s.unknown_sd == 0.0 || s.effect->info().id == "inertia");
    most = std::max(most, s.unknown_sd);
  }
  EXPECT_NEAR(most, looked.model.unknown().inertia / 0.5, 1e-12) << "usual sizes";
}

TEST(Refits, EvidenceIsMadeAgainOnlyOfWhatChangedAndIsTheSame) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [tip_mass], size: [0.9, 1.0]}", 6, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  testing::Started begun(looked);
  Round& round = begun.round;
  for (const char* id : {"tip_mass", "payload_scale"}) {
    round.refitted.push_back(refit(looked.model, begun.alone, begun.of(id)));
    looked.model.take_own_derivatives(round.refitted.back().fit);
    round.posterior = posterior_of(looked.model, begun.alone, round, 0);
  }
  ASSERT_TRUE(begun.alone.evidence);
  const auto from_nothing = [&] {
    begun.alone.evidence.reset();
    return posterior_of(looked.model, begun.alone, round, 0);
  };
  const auto is_from_nothing = [&](const Posterior& known) {
    const Posterior anew = from_nothing();
    for (const Screened& s : round.screened)
      EXPECT_NEAR(known.of(s.effect), anew.of(s.effect), 1e-9) << s.effect->info().id;
    EXPECT_GT(anew.of(round.refitted[0].effect), 0.5);
  };
  is_from_nothing(round.posterior);
  // With fewer candidates than it knows, and with more again.
  std::vector<Screened> out(round.screened.end() - 3, round.screened.end());
  round.screened.resize(round.screened.size() - out.size());
  const Posterior of_fewer = posterior_of(looked.model, begun.alone, round, 0);
  EXPECT_EQ(begun.alone.evidence->candidates.size(), round.screened.size());
  for (const Screened& s : out) EXPECT_EQ(of_fewer.of(s.effect), 0.0) << s.effect->info().id;
  is_from_nothing(of_fewer);
  round.screened.insert(round.screened.end(), out.begin(), out.end());
  is_from_nothing(posterior_of(looked.model, begun.alone, round, 0));
}

/// Linear about a fit without it, inertia seems to be there beside a dead zone; about a fit with it it does
/// not.
TEST(Refits, WhatSeemsProbableIsJudgedAboutItsOwnFit) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 1], from: [pressure_dead_zone], size: [0.6, 1.0]}", 8, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  Round linear;
  linear.screened = screen(looked.model, looked.baseline, 0, [](double) {});
  Standing alone{looked.baseline, unseen(looked.model, looked.baseline)};
  linear.posterior = posterior_of(looked.model, alone, linear, 0);
  const auto inertia = std::find_if(linear.screened.begin(), linear.screened.end(),
                                    [](const Screened& s) { return s.effect->info().id == "inertia"; });
  ASSERT_NE(inertia, linear.screened.end());

  Options options;
  options.refits = 0;  // but of what is probable
  options.most_effects = 1;
  const Selection selection =
      select(looked.model, looked.baseline, std::nullopt, options, [](double, const std::string&) {});
  const Round& first = selection.rounds.front();
  EXPECT_TRUE(std::any_of(first.refitted.begin(), first.refitted.end(),
                          [&](const Refitted& r) { return r.effect == inertia->effect; }));
  EXPECT_LT(first.posterior.of(inertia->effect), 0.5 * linear.posterior.of(inertia->effect));
}

TEST(Refits, ThatAreUponTheSameEffectsAreKnownFromOthers) {
  const auto present = [](const char* id) {
    const model::Effect* one = effects::find(id);
    return model::Present{one, model::Values::Zero(static_cast<Eigen::Index>(one->info().parameters.size()))};
  };
  Refitted weight;
  weight.fit.at.effects = {present("tether"), present("tip_mass")};
  EXPECT_TRUE(is_upon(weight, {present("tether")}));
  EXPECT_FALSE(is_upon(weight, {present("contact")})) << "which took the hose's place since";
  EXPECT_FALSE(is_upon(weight, {present("tether"), present("tip_mass")}));
  EXPECT_FALSE(is_upon(weight, {}));
}

TEST(Refits, ManyEffectsAreLookedForOnlyWhereMuchIsLeft) {
  const testing::RecordedCase drawn = testing::recorded_case("{count_weights: [1]}", 43, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const double noise_m = std::sqrt(floor_of(looked.model).white_m2);
  const double small_m = kPolicy.words.small * looked.model.arm().total_length_m();
  Options options;
  options.most_effects = 7;
  Standing current;
  current.unseen.total_rms_m = std::hypot(noise_m, 1.01 * small_m);
  EXPECT_EQ(most_effects(looked.model, current, options), 7U);
  current.unseen.total_rms_m = std::hypot(noise_m, 0.99 * small_m);
  EXPECT_EQ(most_effects(looked.model, current, options), kPolicy.selection.few_effects);
  options.most_effects = 2;
  EXPECT_EQ(most_effects(looked.model, current, options), 2U);
  current.unseen.total_rms_m = 0.5 * noise_m;
  EXPECT_EQ(most_effects(looked.model, current, options), 2U);
}

TEST(Screen, ThatKnowsTheSignaturesOfTheModelBeforeFindsWhatOneFromNothingDoes) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 0, 1], from: [payload_scale, contact], size: [0.6, 1.0]}", 8, 4, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const auto nothing = [](double) {};
  KnownSignatures of_baseline;
  const testing::Started begun(looked);
  screen(looked.model, looked.baseline, 0, nothing, &of_baseline);
  const std::size_t tried = of_baseline.list.size();
  ASSERT_GT(tried, 2 * begun.round.screened.size());
  for (const char* id : {"payload_scale", "contact"}) {
    SCOPED_TRACE(id);
    KnownSignatures known = of_baseline;
    Linearised with = standing_on(looked.model, refit(looked.model, begun.alone, begun.of(id)).fit).fit;
    const std::vector<Screened> from_nothing = screen(looked.model, with, 0, nothing),
                                from_known = screen(looked.model, with, 0, nothing, &known);
    ASSERT_EQ(from_known.size(), from_nothing.size());
    EXPECT_LT(known.list.size(), tried) << "what is in the model is not tried";
    EXPECT_EQ(from_known.front().effect, from_nothing.front().effect);
    for (const Screened& one : from_nothing) {
      const auto same = std::find_if(from_known.begin(), from_known.end(),
                                     [&](const Screened& s) { return s.effect == one.effect; });
      ASSERT_NE(same, from_known.end());
      // Never made of another model's signatures; at worst at the second best of its grid.
      if (same->values == one.values) {
        EXPECT_NEAR(same->gain, one.gain, 1e-6 * one.gain + 1e-9) << one.effect->info().id;
      }
      EXPECT_LE(same->gain, one.gain * (1.0 + 1e-6) + 1e-9) << one.effect->info().id;
      EXPECT_GE(same->gain, 0.9 * one.gain - 10.0) << one.effect->info().id;
    }
  }
}

/// Steps of the fit are in these scales.
TEST(JointModel, AConstantOfNothingHasAScale) {
  arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/cable_235mm.yaml");
  ASSERT_FALSE(arm.segments[0].cables.empty());
  for (arm::Segment& segment : arm.segments)
    for (arm::Cable& cable : segment.cables) cable.curvature_gain_per_m_rad = 0.0;
  const JointModel model(arm, {}, 0);
  for (const JointUnknown& unknown : model.columns(model.start())) {
    EXPECT_GT(unknown.scale, 0.0) << unknown.index;
    EXPECT_TRUE(std::isfinite(unknown.start)) << unknown.index;
  }
}

}  // namespace
}  // namespace softarm::diagnose
