// What an experiment is predicted to separate, against what it does when the virtual rig records it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "diagnose/screen.h"
#include "diagnose/separation.h"
#include "diagnose/weigh_experiments.h"
#include "effects/catalogue.h"
#include "looked.h"
#include "recorded_case.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {
namespace {

using testing::Looked;
using testing::recorded_case;
using testing::RecordedCase;

/// A model fitted to trials with one effect of the catalogue in it.
diagnose::Linearised fit_with(diagnose::JointModel& model, const diagnose::Linearised& baseline,
                              const std::string& id, const model::Values& start) {
  diagnose::JointParameters p = baseline.at;
  p.effects.push_back({effects::find(id), start});
  return model.fit(p, {}, &baseline.predicted);
}

/// A pair of effects, one of which is in the rig.
struct Pair {
  std::string truth, other;
  model::Values truth_start, other_start;
};

double measured(const RecordedCase& recorded, const Pair& pair, double inflation_of_truth) {
  Looked looked(recorded.arm, recorded.trials);
  const diagnose::Linearised right = fit_with(looked.model, looked.baseline, pair.truth, pair.truth_start);
  const diagnose::Linearised wrong = fit_with(looked.model, looked.baseline, pair.other, pair.other_start);
  return std::sqrt(std::max(0.0, wrong.square - right.square) / inflation_of_truth);
}

struct Predicted {
  double today = 0.0, with = 0.0, inflation = 1.0;
};

/// @param id of the experiment
Predicted predicted(const RecordedCase& recorded, const Pair& pair, const std::string& id) {
  Looked looked(recorded.arm, recorded.trials);
  const std::vector<diagnose::Explanation> list{
      {pair.truth, fit_with(looked.model, looked.baseline, pair.truth, pair.truth_start)},
      {pair.other, fit_with(looked.model, looked.baseline, pair.other, pair.other_start)}};
  Predicted out;
  out.inflation = diagnose::inflation(list[0].fit);
  std::vector<diagnose::Experiment> menu =
      diagnose::experiment_menu(recorded.arm, looked.prepared.trials, 0.1);
  const auto wanted =
      std::find_if(menu.begin(), menu.end(), [&](const diagnose::Experiment& e) { return e.id == id; });
  if (wanted == menu.end()) throw std::out_of_range(id);
  const diagnose::Separations all =
      diagnose::weigh_apart(looked.model, looked.baseline.at, list, {*wanted}, true, out.inflation, {});
  out.today = all.today(0, 1);
  out.with = all.with.at(0).value()(0, 1);
  return out;
}

/// Predicts the separation by an experiment, does it in the rig, and holds the two against each other.
void expect_confirmed(const RecordedCase& recorded, const Pair& pair, const std::string& id,
                      const std::function<void(rig::Scenario&)>& change) {
  const Predicted says = predicted(recorded, pair, id);
  EXPECT_GT(says.with, 6.0);
  EXPECT_GT(says.with, 1.3 * says.today);
  RecordedCase more = recorded;
  rig::Scenario next = recorded.truth.front();
  change(next);
  more.trials.push_back(testing::record(recorded.arm, next, "next"));
  const double today = measured(recorded, pair, says.inflation), then = measured(more, pair, says.inflation);
  ::testing::Test::RecordProperty("today", std::to_string(says.today) + " " + std::to_string(today));
  ::testing::Test::RecordProperty("then", std::to_string(says.with) + " " + std::to_string(then));
  EXPECT_LT(today, 2.0 * says.today + 4.0) << "the present trials";  // chance is worth a few
  EXPECT_GT(then, 0.5 * says.with);
  EXPECT_LT(then, 2.0 * says.with);
}

void mount_on_side(rig::Scenario& scenario) {
  // The base's x axis down.
  scenario.mount.q_mocap_base =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ());
}

/// Bends the arm; where it does so too much, or the arm does not hang, there is no equilibrium.
class GivesWay : public model::Effect {
 public:
  GivesWay(double at, bool only_hangs) : at_(at), only_hangs_(only_hangs) {
    info_.id = "gives_way";
    info_.parameters.resize(1);
    info_.parameters[0].symbol = "bend";
    info_.parameters[0].low = -2.0;
    info_.parameters[0].high = 2.0;
    info_.parameters[0].usual = 1.0;
  }
  const model::Info& info() const override { return info_; }
  void act(const arm::Arm&, const model::FineRod&, const model::Values& values, const model::Instant&,
           const model::Shape*, const model::Memory&, rod::Rod& rod) const override {
    for (rod::Segment& segment : rod.segments) segment.rest_curvature_per_m.y() += 2.0 * (values[0] - 1.0);
    const bool hangs = rod.gravity_m_s2.z() > 0.9 * rod.gravity_m_s2.norm();
    if (values[0] > at_ || (only_hangs_ && !hangs)) rod.gravity_m_s2.setConstant(NAN);
  }

 private:
  model::Info info_;
  const double at_;
  const bool only_hangs_;
};

class WithoutEquilibrium : public ::testing::Test {
 protected:
  diagnose::JointParameters with(const GivesWay& effect, double bend) const {
    diagnose::JointParameters p = looked_.baseline.at;
    p.effects.push_back({&effect, model::Values::Constant(1, bend)});
    return p;
  }

  const RecordedCase recorded_ = recorded_case("{count_weights: [1]}", 14, 1, 6.0,
                                               "attitudes: [hanging], speeds: [0.5], payload_kg: [0, 0]");
  Looked looked_{recorded_.arm, recorded_.trials};
};

TEST_F(WithoutEquilibrium, ARivalIsBroughtNoFurtherThanTheArmBearsIt) {
  // It is the baseline at 1.
  const GivesWay bears(3.0, false), breaks(0.9, false);
  EXPECT_NEAR(fitted_to(looked_.model, looked_.baseline, with(bears, 0.5), 2).at.effects[0].values[0], 1.0,
              1e-3);
  const diagnose::Linearised stopped = fitted_to(looked_.model, looked_.baseline, with(breaks, 0.5), 2);
  EXPECT_LE(stopped.at.effects[0].values[0], 0.9);
  EXPECT_EQ(with_equilibrium(stopped), with_equilibrium(looked_.baseline));
}

TEST_F(WithoutEquilibrium, AnExperimentThatOneExplanationDoesNotBearIsNotWeighed) {
  std::vector<diagnose::Experiment> menu =
      diagnose::experiment_menu(recorded_.arm, looked_.prepared.trials, 0.1);
  menu.erase(std::remove_if(menu.begin(), menu.end(),
                            [](const diagnose::Experiment& e) {
                              return e.id != "attitude_side_down" && e.id != "together";
                            }),
             menu.end());
  ASSERT_EQ(menu.size(), 2U);
  const GivesWay bears(3.0, false), hangs(3.0, true);
  for (const GivesWay* effect : {&bears, &hangs}) {
    const std::vector<diagnose::Explanation> list{
        {"without", looked_.baseline},
        {"gives_way", fitted_to(looked_.model, looked_.baseline, with(*effect, 1.01), 0)}};
    const diagnose::Separations all =
        diagnose::weigh_apart(looked_.model, looked_.baseline.at, list, menu, false, 1.0, {});
    for (std::size_t i = 0; i < menu.size(); ++i)
      EXPECT_EQ(all.with[i].has_value(), effect == &bears || menu[i].id == "together") << menu[i].id;
  }
}

TEST(NextExperiment, TheArmOnItsSideTellsAMassAtTheTipFromAnotherDistribution) {
  const auto recorded = recorded_case("{count_weights: [0, 1], from: [tip_mass], size: [0.2, 0.3]}", 11, 2,
                                      24.0, "attitudes: [hanging], speeds: [0.5], payload_kg: [0, 0]");
  expect_confirmed(
      recorded,
      {"tip_mass", "mass_distribution", model::Values::Constant(1, 0.01), model::Values::Constant(1, 0.1)},
      "attitude_side_down", mount_on_side);
}

TEST(NextExperiment, FasterInputsTellALagOfThemFromTheClocksThoughTheArmSwings) {
  RecordedCase recorded = testing::drawn_case("{count_weights: [1]}", 12, 2, 24.0,
                                              "attitudes: [hanging], speeds: [0.5], payload_kg: [0, 0]");
  for (rig::Scenario& truth : recorded.truth) {
    rig::hide({"pressure_lag", "first_order", {{"time_constant_s", 0.1}}}, truth);
    recorded.trials.push_back(
        testing::record(recorded.arm, truth, "trial_" + std::to_string(recorded.trials.size() + 1)));
  }
  expect_confirmed(
      recorded,
      {"pressure_lag", "clock_offset", Eigen::Vector4d(0.1, 0.1, 1.0, 0.0), Eigen::Vector2d(0.1, 0.0)},
      "faster_2", [](rig::Scenario& next) {
        next.pressures.random->lowest_hz *= 2.0;
        next.pressures.random->highest_hz *= 2.0;
      });
}

TEST(NextExperiment, StifferByPressureTellsARestCurvatureFromZerosOfTheSensors) {
  const auto recorded = recorded_case("{count_weights: [0, 1], from: [rest_curvature], size: [0.5, 0.6]}", 13,
                                      2, 24.0, "attitudes: [hanging], speeds: [0.5], payload_kg: [0, 0]");
  expect_confirmed(recorded,
                   {"rest_curvature", "pressure_offset", Eigen::Vector3d::Zero(), model::Values::Zero(8)},
                   "together", [&](rig::Scenario& scenario) {
                     // As far as all of them went in the trials that there are.
                     std::vector<double> most(3, 0.0);
                     for (const trial::Trial& trial : recorded.trials) {
                       for (const trial::Frame& frame : trial.frames) {
                         for (std::size_t k = 0; k < frame.inputs.size(); ++k)
                           most[k] = std::max(most[k], frame.inputs[k].value_or(0.0));
                       }
                     }
                     const double level = *std::min_element(most.begin(), most.end());
                     scenario.pressures.random.reset();
                     scenario.pressures.ramp_s = 2.0;
                     scenario.pressures.schedule = {{0.0, std::vector<double>(3, 0.0)}};
                     for (int i = 0; i < 6; ++i) {
                       scenario.pressures.schedule.push_back({2.0 + 4.0 * i, std::vector<double>(3, level)});
                       scenario.pressures.schedule.push_back({4.0 + 4.0 * i, std::vector<double>(3, 0.0)});
                     }
                     scenario.duration_s = 32.0;
                   });
}

}  // namespace
}  // namespace softarm::diagnose
