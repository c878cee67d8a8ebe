// Choice of frames and trials, derivatives, errors, the prior, and what is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "arm/arm_writer.h"
#include "identify/law_model.h"
#include "synthetic.h"

namespace softarm::identify {
namespace {

using testing::find;

std::vector<trial::Trial> paper_trials(const arm::Arm& truth, std::uint64_t seed, int trials = 30) {
  std::mt19937_64 random(seed);
  testing::Protocol protocol;
  protocol.trials = trials;
  protocol.draw = testing::paper_inputs;
  return testing::make_trials(truth, protocol, random);
}

struct NothingRecorded : arm::RecordedInputs {
  std::vector<double> values(const std::string&) const override { return {}; }
  std::string load_advice() const override { return {}; }
};

class Derivatives : public ::testing::TestWithParam<const char*> {};

TEST_P(Derivatives, OfEveryBodyByEveryConstantAgreeWithFiniteDifferences) {
  arm::Arm arm = testing::shipped(GetParam());
  for (arm::MeasuredBody& body : arm.bodies) body.orientation_usable = body.kind == arm::BodyKind::kRing;
  for (arm::Segment& segment : arm.segments) {
    for (arm::Chamber& chamber : segment.chambers) {
      chamber.near_elongation_m_per_pa *= 0.1;
      // One that bends nothing has no saturation that shows.
      if (chamber.moment_gain_nm_per_pa == 0.0) chamber.moment_gain_nm_per_pa = 1e-6;
    }
  }
  arm::MeasuredBody skin = arm.bodies.back();
  skin.name = "skin";
  skin.kind = arm::BodyKind::kSkinMarker;
  skin.angle_rad = 0.7;
  skin.radius_m = 0.02;
  arm.bodies.push_back(skin);
  const std::vector<identify::ConstantRef> constants = identify::constants_of(arm);
  const int count = static_cast<int>(constants.size());
  Eigen::VectorXd theta(count), step(count);
  const NothingRecorded nothing;
  for (int j = 0; j < count; ++j) {
    const identify::ConstantRef& c = constants[static_cast<std::size_t>(j)];
    theta[j] = identify::value_of(arm, c);
    step[j] = 1e-4 * (theta[j] != 0.0 ? std::abs(theta[j]) : identify::allowed_range(arm, c).high * 1e-2);
    // What the arm does not state may be many times what an arm has: a hundredth of what matters, below.
    if (!is_stated(arm, c))
      step[j] =
          1e-2 / 30.0 *
          arm::spec_of(c.kind).scale(arm.segments[static_cast<std::size_t>(c.segment)], c.index, nothing);
  }
  trial::StaticFrame frame;
  for (const arm::ScalarInput& input : arm.inputs.scalars)
    frame.inputs.push_back((input.kind == arm::InputKind::kTension ? 1.1
                            : input.kind == arm::InputKind::kAngle ? 0.3
                                                                   : 2e4) *
                           (1.0 + 0.2 * static_cast<double>(frame.inputs.size())));
  frame.payload_kg = 0.03;
  frame.gravity_base = {3.0, -4.0, 8.0};
  for (int i = 0; i < static_cast<int>(arm.bodies.size()); ++i) frame.bodies.emplace_back().body = i;

  identify::LawModel model(arm, constants);
  const auto at = [&](const Eigen::VectorXd& values) {
    identify::Prediction prediction;
    std::optional<model::Equilibrium> equilibrium;
    model.set(values);
    EXPECT_TRUE(model.predict(frame, equilibrium, prediction));
    return prediction;
  };
  const identify::Prediction here = at(theta);
  const double length = arm.total_length_m();
  for (int j = 0; j < count; ++j) {
    // The solver's positions are good to 1e-6 of the length: steps must be large against it.
    const double h = 30.0 * step[j];
    Eigen::VectorXd up = theta, down = theta;
    up[j] += h;
    down[j] -= h;
    const identify::Prediction above = at(up), below = at(down);
    double largest = 0.0;
    for (int k = 0; k < here.p.cols(); ++k) {
      const Eigen::Vector3d dp = (above.p.col(k) - below.p.col(k)) / 2.0;
      const Eigen::Vector3d dt = (above.tangent.col(k) - below.tangent.col(k)) / 2.0;
      const double p_error = (dp - h * here.dp.block<3, 1>(3 * k, j)).norm();
      const double t_error = (dt - h * here.dtangent.block<3, 1>(3 * k, j)).norm();
      EXPECT_LT(p_error, 1e-3 * dp.norm() + 2e-7 * length)
          << identify::name_of(arm, constants[static_cast<std::size_t>(j)]);
      EXPECT_LT(t_error, 1e-3 * dt.norm() + 2e-6)
          << identify::name_of(arm, constants[static_cast<std::size_t>(j)]);
      largest = std::max(largest, dp.norm());
    }
    EXPECT_LT(((above.laws - below.laws) / 2.0 - h * here.dlaws.col(j)).norm(),
              1e-4 * (above.laws - below.laws).norm() + 1e-12);
    const identify::ConstantKind kind = constants[static_cast<std::size_t>(j)].kind;
    const bool another_knot = kind == identify::ConstantKind::kByPressure;
    if (!another_knot) {
      EXPECT_GT(largest, 0.0) << identify::name_of(arm, constants[static_cast<std::size_t>(j)]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, Derivatives,
                         ::testing::Values("semi_physical_200mm", "hybrid_85mm", "cable_235mm", "two_segment",
                                           "single_chamber_85mm", "online_200mm", "tendon_trunk", "pouch_arm",
                                           "pouch_arm_one_segment"));

TEST(HeldOut, EveryThirdTrialUnlessNamedOrDrawn) {
  const arm::Arm arm = testing::pneumatic_arm();
  const std::vector<trial::Trial> trials = paper_trials(arm, 1, 12);
  const auto held = [&](const identify::Options& options) {
    std::set<std::string> names;
    for (const identify::TrialSummary& trial : identify::identify(arm, trials, options).trials) {
      if (trial.held_out) names.insert(trial.name);
    }
    return names;
  };
  identify::Options options;
  EXPECT_EQ(held(options), (std::set<std::string>{"trial_3", "trial_6", "trial_9", "trial_12"}));
  options.seed = 7;
  const auto drawn = held(options);
  EXPECT_EQ(drawn.size(), 4u);
  EXPECT_EQ(held(options), drawn) << "the same seed, the same trials";
  options.seed = 8;
  EXPECT_NE(held(options), drawn);
  options.held_out = {"trial_5"};
  EXPECT_EQ(held(options), std::set<std::string>{"trial_5"});
  options.held_out = {"trial_55"};
  EXPECT_THROW(identify::identify(arm, trials, options), std::invalid_argument);
  options.held_out.clear();
  options.held_out_share = 0.0;
  EXPECT_TRUE(held(options).empty());
  EXPECT_EQ(identify::identify(arm, {trials[0], trials[1]}).held_out.frames, 0u)
      << "two trials are both needed";
}

TEST(HeldOut, EachInItsTurnIsWhatHoldingItOutByNameGives) {
  const arm::Arm arm = testing::pneumatic_arm();
  const std::vector<trial::Trial> trials = paper_trials(arm, 3, 4);
  identify::Options options;
  options.leave_one_out = true;
  double last = 0.0;
  const identify::Result all = identify::identify(arm, trials, options, [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_EQ(last, 1.0);
  EXPECT_EQ(all.held_out.frames, 0u) << "the fit itself is to all";
  ASSERT_EQ(all.left_out_one.size(), 4u);
  std::size_t frames = 0;
  for (const identify::TrialSummary& trial : all.left_out_one) frames += trial.after.frames;
  EXPECT_EQ(all.left_out_one_after.frames, frames);
  identify::Options by_name;
  by_name.held_out = {trials[2].name};
  const identify::Result one = identify::identify(arm, trials, by_name);
  EXPECT_TRUE(all.left_out_one[2].held_out);
  EXPECT_EQ(all.left_out_one[2].after.mean_m, one.held_out.mean_m);
  EXPECT_EQ(all.left_out_one[2].after.maximum_m, one.held_out.maximum_m);
  EXPECT_THAT(describe(all), ::testing::HasSubstr("each trial by the fit to the others"));
  EXPECT_THAT(to_json(all), ::testing::HasSubstr("\"leave_one_out\""));
  options.held_out = by_name.held_out;
  EXPECT_THROW(identify::identify(arm, trials, options), std::invalid_argument);
  options.held_out.clear();
  EXPECT_THROW(identify::identify(arm, {trials[0]}, options), std::invalid_argument);
}

TEST(HeldOut, HeldOutFramesDoNotChangeTheFit) {
  const arm::Arm arm = testing::pneumatic_arm();
  std::vector<trial::Trial> trials = paper_trials(arm, 2, 12);
  identify::Options options;
  options.held_out = {"trial_4"};
  const identify::Result first = identify::identify(arm, trials, options);
  for (trial::Frame& frame : trials[3].frames) {
    for (trial::BodyObservation& body : frame.bodies) body.p_mocap.x() += 0.01;
  }
  const identify::Result second = identify::identify(arm, trials, options);
  for (std::size_t j = 0; j < first.constants.size(); ++j)
    EXPECT_EQ(first.constants[j].value, second.constants[j].value);
  EXPECT_NEAR(second.held_out.mean_m, 0.01, 0.002);
  EXPECT_LT(first.held_out.mean_m, 0.002);
  EXPECT_EQ(first.held_out.frames, 2u);
}

TEST(Errors, AreThoseOfTheirDefinition) {
  std::vector<identify::FrameComparison> frames(4);
  const double errors[] = {0.004, 0.001, 0.002, 0.009};
  for (std::size_t i = 0; i < 4; ++i) frames[i].error_m = errors[i];
  const identify::ShapeError error = identify::summarise(frames, 0.2);
  EXPECT_DOUBLE_EQ(error.mean_m, 0.004);
  EXPECT_DOUBLE_EQ(error.median_m, 0.003);
  EXPECT_DOUBLE_EQ(error.maximum_m, 0.009);
  EXPECT_DOUBLE_EQ(error.minimum_m, 0.001);
  EXPECT_DOUBLE_EQ(error.percent(error.mean_m), 2.0);
  EXPECT_EQ(identify::summarise({}, 0.2).frames, 0u);
}

TEST(Errors, OfAKnownShiftAreTheShift) {
  arm::Arm arm = testing::pneumatic_arm();
  testing::FrameMaker maker(arm);
  trial::Trial trial{"one", {*maker.make({2e4, 0.0, 1e4, 0.0}, 0.1, testing::hanging())}};
  EXPECT_LT(identify::shape_error(arm, {trial}).mean_m, 1e-6);
  trial.frames[0].bodies[0].p_mocap.y() += 0.003;
  trial.frames[0].bodies[2].p_mocap.z() -= 0.006;
  EXPECT_NEAR(identify::shape_error(arm, {trial}).mean_m, 0.003, 1e-6) << "the mean over three bodies";
}

TEST(Frames, WithoutPayloadInputsOrBaseAreCountedNotUsed) {
  const arm::Arm arm = testing::pneumatic_arm();
  std::vector<trial::Trial> trials = paper_trials(arm, 3, 6);
  identify::Options options;
  options.held_out_share = 0.0;
  trials[0].frames[0].payload_kg.reset();
  trials[1].frames[0].inputs[1].reset();
  trials[2].frames[0].bodies.clear();
  const identify::Result result = identify::identify(arm, trials, options);
  EXPECT_EQ(result.frames, 9u);
  EXPECT_EQ(result.left_out.at("payload not known"), 1u);
  EXPECT_EQ(result.left_out.at("inputs missing or beyond the laws"), 1u);
  EXPECT_EQ(result.left_out.at("no body seen"), 1u);
  for (trial::Trial& trial : trials) {
    for (trial::Frame& frame : trial.frames) frame.payload_kg.reset();
  }
  try {
    identify::identify(arm, trials, options);
    ADD_FAILURE() << "nothing can be fitted";
  } catch (const identify::IdentifyError& error) {
    EXPECT_NE(std::string(error.what()).find("payload not known"), std::string::npos) << error.what();
  }
  arm::Arm assumed = arm;
  assumed.payload.default_kg = 0.0;
  EXPECT_EQ(identify::identify(assumed, trials, options).left_out.count("payload not known"), 0u);
}

TEST(Frames, AtRestAndSpreadOverTheInputs) {
  const arm::Arm arm = testing::pneumatic_arm();
  testing::FrameMaker maker(arm);
  // 2 s at one pressure, 1 s on the way to another, 6 s there: 60 Hz.
  trial::Trial trial{"steps", {}};
  for (int i = 0; i < 540; ++i) {
    const double t = i / 60.0;
    const double p = 1e4 + 3e4 * std::clamp(t - 2.0, 0.0, 1.0);
    trial.frames.push_back(*maker.make({p, 0.0, 0.0, 0.0}, 0.0, testing::hanging()));
    trial.frames.back().stamp_ns = trial::to_nanoseconds(100.0 + t);
  }
  identify::FrameChoice choice;
  choice.frames_per_trial = 20;
  const auto chosen = compare(arm, {trial}, choice);
  ASSERT_EQ(chosen.size(), 20u);
  int low = 0, high = 0;
  for (const identify::FrameComparison& frame : chosen) {
    const double t = frame.stamp_s - 100.0;
    EXPECT_TRUE(t <= 2.1 || t >= 3.4) << t;
    (t < 2.5 ? low : high) += 1;
  }
  EXPECT_GE(low, 4) << "not in proportion to time alone";
  EXPECT_GE(high, 8);
  choice.prefer_static = false;
  bool on_the_way = false;
  for (const identify::FrameComparison& frame : compare(arm, {trial}, choice))
    on_the_way = on_the_way || (frame.stamp_s > 102.2 && frame.stamp_s < 102.9);
  EXPECT_TRUE(on_the_way);
}

TEST(Frames, AtRestThoughThePressureSensorsAreNoisy) {
  const arm::Arm arm = testing::pneumatic_arm();
  testing::FrameMaker maker(arm);
  std::mt19937_64 random(4);
  trial::Trial trial{"measured", {}};
  for (int i = 0; i < 160;
       ++i) {  // 3 s at one pressure, 2 s on the way, 3 s at another: 20 Hz, 600 Pa of noise
    const double t = i / 20.0;
    const double p = 1e4 + 3e4 * std::clamp((t - 3.0) / 2.0, 0.0, 1.0);
    trial.frames.push_back(*maker.make({p, 0.0, 0.0, 0.0}, 0.0, testing::hanging()));
    trial.frames.back().stamp_ns = trial::to_nanoseconds(t);
    for (int k = 0; k < 2; ++k) {
      double& input = *trial.frames.back().inputs[static_cast<std::size_t>(k)];
      input = std::max(0.0, input + testing::uniform(random, -1000.0, 1000.0));
    }
  }
  const auto chosen = compare(arm, {trial});
  ASSERT_GT(chosen.size(), 20u);
  for (const identify::FrameComparison& frame : chosen)
    EXPECT_TRUE(frame.stamp_s <= 3.3 || frame.stamp_s >= 4.9) << frame.stamp_s;
}

TEST(Frames, OfATrialThatMovesThroughoutAreNotThoseOfItsEndsAlone) {
  const arm::Arm arm = testing::pneumatic_arm();
  testing::FrameMaker maker(arm);
  trial::Trial trial{"moving", {}};
  for (int i = 0; i < 600; ++i) {  // a second of rest, a slow wave, a second of rest
    const double t = i / 60.0;
    const double wave = 0.5 - 0.5 * std::cos(2.0 * M_PI * std::clamp((t - 1.0) / 8.0, 0.0, 1.0));
    trial.frames.push_back(*maker.make({4e4 * wave, 1e4 * wave, 0.0, 0.0}, 0.1, testing::hanging()));
    trial.frames.back().stamp_ns = trial::to_nanoseconds(t);
  }
  double most = 0.0;
  for (const identify::FrameComparison& frame : compare(arm, {trial}))
    most = std::max(most, *frame.inputs[0]);
  EXPECT_GT(most, 3.5e4);
}

TEST(Prior, HoldsWhatTheLawsGetWrong) {
  const arm::Arm nominal = testing::pneumatic_arm();
  std::mt19937_64 random(11);
  const auto with_errors = [&](double gain_sd) {
    testing::Protocol protocol;
    protocol.trials = 1;
    protocol.repeats = 6;
    protocol.draw = [](std::mt19937_64& r) {
      return arm::InputValues{testing::uniform(r, 2e4, 5e4), testing::uniform(r, 0.0, 1e4), 0.0, 0.0};
    };
    std::vector<trial::Trial> trials;
    for (int t = 0; t < 24; ++t) {
      arm::Arm today = nominal;
      const double factor = 1.0 + gain_sd * testing::normal3(random).x();
      for (arm::Chamber& chamber : today.segments[0].chambers) chamber.moment_gain_nm_per_pa *= factor;
      trials.push_back(testing::make_trials(today, protocol, random).front());
    }
    return identify::identify(nominal, trials);
  };
  const identify::Result exact = with_errors(0.0), off = with_errors(0.05);
  EXPECT_TRUE(off.prior.enabled);
  EXPECT_TRUE(off.arm.estimator.prior.enabled);
  const double moment = 6.1e-6 * 3.5e4;  // typical
  const auto error = [&](const arm::LawPrior& p) {
    return std::hypot(p.moment_sd_nm, moment * p.moment_sd_rel);
  };
  EXPECT_GT(error(off.prior), 0.02 * moment);
  EXPECT_LT(error(off.prior), 0.10 * moment);
  EXPECT_LT(error(exact.prior), 0.5 * error(off.prior));
  EXPECT_LT(off.prior.moment_jitter_sd_nm, 0.3 * error(off.prior)) << "it lasts, it does not jitter";
  EXPECT_GE(exact.prior.bending_stiffness_sd_rel, 0.02) << "never trusted beyond the floor";
}

TEST(Output, TheWrittenArmPredictsWhatTheResultDoes) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml");
  std::stringstream text;
  text << file.rdbuf();
  const arm::Arm nominal = arm::parse_arm(text.str(), "online_200mm.yaml");
  std::mt19937_64 random(12);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.2, random);
  testing::Protocol protocol;
  protocol.trials = 15;
  protocol.draw = [&](std::mt19937_64& r) {
    arm::InputValues inputs;
    for (std::size_t i = 0; i < nominal.inputs.scalars.size(); ++i)
      inputs.push_back(testing::uniform(r, 0.0, 1.0) < 0.3 ? 0.0 : testing::uniform(r, 1e4, 5e4));
    return inputs;
  };
  const auto trials = testing::make_trials(truth, protocol, random);
  identify::Options options;
  options.also_free = {"length"};
  const identify::Result result = identify::identify(nominal, trials, options);
  const std::string written =
      arm::update_arm_text(text.str(), "online_200mm.yaml", result.arm, {"from a test"});
  const arm::Arm again = arm::parse_arm(written, "written.yaml");
  const auto expected = compare(result.arm, trials), found = compare(again, trials);
  ASSERT_EQ(expected.size(), found.size());
  ASSERT_EQ(expected.size(), 30u);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t k = 0; k < found[i].bodies.size(); ++k)
      EXPECT_LT((expected[i].bodies[k].predicted_p_base - found[i].bodies[k].predicted_p_base).norm(), 1e-8);
  }
  EXPECT_TRUE(again.estimator.prior.enabled);
  EXPECT_NEAR(again.estimator.prior.moment_sd_nm, result.prior.moment_sd_nm, 1e-9);
}

TEST(Output, SameInputSameOutputAndJsonHoldsIt) {
  const arm::Arm arm = testing::pneumatic_arm();
  const auto trials = paper_trials(arm, 4, 9);
  const identify::Result first = identify::identify(arm, trials), second = identify::identify(arm, trials);
  EXPECT_EQ(describe(first), describe(second));
  EXPECT_EQ(to_json(first), to_json(second));
  const auto json = nlohmann::json::parse(to_json(first));
  EXPECT_EQ(json.at("constants").size(), 9u);
  EXPECT_DOUBLE_EQ(json.at("constants")[0].at("value"), first.constants[0].value);
  EXPECT_DOUBLE_EQ(json.at("held_out").at("mean_m"), first.held_out.mean_m);
  EXPECT_EQ(json.at("correlation").size(), 9u);
  EXPECT_EQ(to_json(first).find("null"), std::string::npos) << "no NaN, no infinity";
}

TEST(Output, ProgressRunsFromNothingToOne) {
  const arm::Arm arm = testing::pneumatic_arm();
  double last = 0.0;
  identify::identify(arm, paper_trials(arm, 4, 9), {}, [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_EQ(last, 1.0);
}

TEST(Names, PatternsFindConstants) {
  const arm::Arm arm = testing::pneumatic_arm();
  EXPECT_EQ(identify::matching(arm, {"*.moment_gain"}).size(), 3u);
  EXPECT_EQ(identify::matching(arm, {"moment_gain"}).size(), 3u);
  EXPECT_EQ(identify::matching(arm, {"segment_1.length", "length"}).size(), 1u);
  EXPECT_EQ(identify::matching(arm, {"chamber_2.moment_gain"}).size(), 1u);
  EXPECT_EQ(identify::matching(arm, {"bending_stiffness.per_chamber_2"}).size(), 1u);
  EXPECT_EQ(identify::matching(arm, {"chambers.*"}).size(), 1u);
  const auto why = [&](const std::vector<std::string>& patterns) {
    try {
      identify::Options some;
      some.also_free = patterns;
      identify::identify(arm, paper_trials(arm, 4, 3), some);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(why({"mometn_gain"})
                .rfind("'mometn_gain' is no constant of the arm " + arm.name +
                           "; is 'moment_gain' meant? It has segment_1.",
                       0),
            0u)
      << why({"mometn_gain"});
  EXPECT_EQ(why({"*.chamber_1.sat*"}),
            "'*.chamber_1.sat*' frees nothing: the file of the arm " + arm.name +
                " gives none of segment_1.chamber_1.saturation; what it does not give is freed by its full "
                "name, such as segment_1.chamber_1.saturation");
  identify::Options options;
  options.held = {"*"};
  EXPECT_THROW(identify::identify(arm, paper_trials(arm, 4, 3), options), identify::IdentifyError);
  options.free = {"moment_gain"};
  options.held = {"segment_1.chamber_2.*"};
  EXPECT_EQ(identify::identify(arm, paper_trials(arm, 4, 3), options).constants.size(), 2u);
}

// Three arms that differ: the fit to two of them is farther from the third than the arm file is.
TEST(LeaveOneOut, KeepsTheArmFileWhereThatPredictsBetter) {
  const arm::Arm arm = testing::pneumatic_arm();
  std::mt19937_64 random(6);
  testing::Protocol protocol;
  protocol.trials = 1;
  protocol.draw = testing::paper_inputs;
  std::vector<trial::Trial> trials;
  for (const double gain : {0.5, 1.0, 1.5}) {
    arm::Arm other = arm;
    for (arm::Chamber& chamber : other.segments[0].chambers) chamber.moment_gain_nm_per_pa *= gain;
    trials.push_back(testing::make_trials(other, protocol, random).front());
    trials.back().name = "gain_" + std::to_string(gain);
  }
  Options options;
  options.leave_one_out = true;
  const Result result = identify(arm, trials, options);
  EXPECT_GT(result.left_out_one_after.mean_m, 1.1 * result.left_out_one_before.mean_m);
  EXPECT_LT(result.fitted.mean_m, 1.05 * result.fitted_before.mean_m);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(result.arm.segments[0].chambers[i].moment_gain_nm_per_pa,
              arm.segments[0].chambers[i].moment_gain_nm_per_pa);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_THAT(result.warnings.back(), ::testing::HasSubstr("NO BETTER THAN THE ARM FILE"));
}

}  // namespace
}  // namespace softarm::identify
