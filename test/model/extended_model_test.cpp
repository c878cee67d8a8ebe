// The model with effects in it: absent ones, derivatives, stiff springs, motion.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "effects/body_table.h"
#include "effects/catalogue.h"

namespace softarm::effects {
namespace {

using body_testing::Case;
using body_testing::Condition;

class OfBody : public ::testing::TestWithParam<Case> {};

model::TrialData trial_for(const arm::Arm& arm, const Case& of) {
  const bool moves = find(of.id)->needs_motion();
  return body_testing::trial_of(arm, moves ? body_testing::swinging(arm) : body_testing::various(arm), moves);
}

TEST_P(OfBody, IsDescribed) {
  const model::Effect* effect = find(GetParam().id);
  ASSERT_NE(effect, nullptr);
  const model::Info& info = effect->info();
  EXPECT_EQ(info.id, GetParam().id);
  EXPECT_TRUE(std::islower(static_cast<unsigned char>(info.description.at(0)))) << info.description;
  EXPECT_EQ(info.parameters.size(), GetParam().small.size());
  EXPECT_FALSE(info.rivals.empty());
  for (const std::string& rival : info.rivals) EXPECT_NE(rival, info.id);
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    const model::Parameter& p = info.parameters[i];
    EXPECT_LT(p.low, p.high) << p.symbol;
    EXPECT_FALSE(p.symbol.empty() || p.unit.empty() || p.description.empty());
    if (static_cast<int>(i) < info.sizes) {
      EXPECT_LE(p.low, 0.0) << p.symbol;
      EXPECT_GT(p.usual, 0.0) << p.symbol;
    }
    EXPECT_LE(p.low, p.usual) << p.symbol;
    EXPECT_LE(p.usual, p.high) << p.symbol;
  }
}

TEST_P(OfBody, WithoutSizeIsTheBaseline) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  model::ExtendedModel model(arm);
  const model::Effect* effect = find(GetParam().id);
  const model::TrialData trial = trial_for(arm, GetParam());
  const model::Dynamics dynamics{true, 0.02};
  const Eigen::VectorXd baseline =
      body_testing::stacked(body_testing::predict(model, arm, {}, trial, dynamics));
  std::vector<model::Values> list = effect->grid(arm, model.rod());
  EXPECT_FALSE(list.empty());
  if (list.size() > 4) list.resize(4);
  for (const model::Values& values : list) {
    ASSERT_EQ(values.size(), static_cast<Eigen::Index>(effect->info().parameters.size()));
    EXPECT_TRUE(values.head(effect->info().sizes).isZero());
    for (Eigen::Index i = effect->info().sizes; i < values.size(); ++i) {
      EXPECT_GE(values[i], effect->info().parameters[static_cast<std::size_t>(i)].low);
      EXPECT_LE(values[i], effect->info().parameters[static_cast<std::size_t>(i)].high);
    }
    const Eigen::VectorXd with =
        body_testing::stacked(body_testing::predict(model, arm, {{effect, values}}, trial, dynamics));
    // Solved from another start where the shape is assumed first.
    EXPECT_LT((with - baseline).lpNorm<Eigen::Infinity>(), effect->needs_shape() ? 2e-9 : 1e-15);
  }
}

TEST_P(OfBody, ASmallOneDoesWhatItsSignatureSays) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  model::ExtendedModel model(arm);
  const model::TrialData trial = trial_for(arm, GetParam());
  const model::Dynamics dynamics{true, 0.02};
  const model::Effect* effect = find(GetParam().id);
  for (int i = 0; i < effect->info().sizes; ++i) {
    model::Values values = body_testing::values_of(GetParam().small);
    for (int k = 0; k < effect->info().sizes; ++k) {
      if (k != i) values[k] = 0.0;
    }
    const model::Present by{effect, values};
    const Eigen::VectorXd expected = body_testing::signature(model, arm, by, trial, dynamics);
    const Eigen::VectorXd difference =
        body_testing::stacked(body_testing::predict(model, arm, {by}, trial, dynamics)) -
        body_testing::stacked(body_testing::predict(model, arm, {}, trial, dynamics));
    EXPECT_GT(body_testing::rms(expected), 5e-7)
        << effect->info().parameters[static_cast<std::size_t>(i)].symbol;
    EXPECT_LT(body_testing::rms(difference - expected), 0.03 * body_testing::rms(expected) + 2e-8)
        << effect->info().parameters[static_cast<std::size_t>(i)].symbol;
  }
}

TEST_P(OfBody, ALargeOneIsSolved) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  model::ExtendedModel model(arm);
  const model::TrialData trial = trial_for(arm, GetParam());
  const auto path = body_testing::predict(
      model, arm, {body_testing::present(GetParam().id, body_testing::values_of(GetParam().large))}, trial,
      {true, 0.02}, true);
  for (const model::Predicted& now : path) {
    EXPECT_TRUE(now.p.allFinite());
    EXPECT_TRUE(now.by_rod->seen.allFinite());
    EXPECT_LT(now.p.colwise().norm().maxCoeff(), 2.0 * arm.total_length_m());
  }
}

INSTANTIATE_TEST_SUITE_P(Effects, OfBody, ::testing::ValuesIn(body_testing::body_cases()),
                         [](const auto& which) { return std::string(which.param.id); });

TEST(Catalogue, IdsAreTheirOwnAndAllOfBodyAreThere) {
  std::vector<std::string> ids;
  for (const auto& effect : effects::catalogue()) ids.push_back(effect->info().id);
  std::vector<std::string> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
  for (const Case& of : body_testing::body_cases())
    EXPECT_EQ(std::count(ids.begin(), ids.end(), of.id), 1) << of.id;
  EXPECT_EQ(find("no_such_effect"), nullptr);
}

class OnEveryArm : public ::testing::TestWithParam<const char*> {};

TEST_P(OnEveryArm, UsualSizesAreSolvedAndMoveIt) {
  const arm::Arm arm = body_testing::shipped(GetParam());
  model::ExtendedModel model(arm);
  std::vector<Condition> conditions = body_testing::swinging(arm);
  for (Condition& condition : conditions) {
    condition.payload_kg = 0.02;
    condition.q_mocap_base = body_testing::horizontal();
    // Tendons that are pulled alike would not bend it.
    if (condition.inputs.size() > 2) condition.inputs[1] *= 2.0;
  }
  const model::TrialData trial = body_testing::trial_of(arm, conditions, true);
  const model::Dynamics dynamics{true, 0.02};
  const Eigen::VectorXd baseline =
      body_testing::stacked(body_testing::predict(model, arm, {}, trial, dynamics));
  for (const Case& of : body_testing::body_cases()) {
    SCOPED_TRACE(of.id);
    const model::Effect* effect = find(of.id);
    const bool axial_only =
        std::string(GetParam()) == "single_chamber_85mm" &&
        (effect->info().id == "actuation_taper" || effect->info().id == "bending_plane_offset" ||
         effect->info().id == "curvature_gain");
    EXPECT_EQ(effect->applies_to(arm), !axial_only) << "its chamber does not bend it";
    if (axial_only) continue;
    const std::vector<model::Values> grid = effect->grid(arm, model.rod());
    double most = 0.0;
    for (std::size_t g = 0; g < grid.size(); g += std::max<std::size_t>(1, grid.size() / 6)) {
      model::Values values = grid[g];
      for (int i = 0; i < effect->info().sizes; ++i)
        values[i] = effect->info().parameters[static_cast<std::size_t>(i)].usual;
      const auto path = body_testing::predict(model, arm, {{effect, values}}, trial, dynamics);
      const Eigen::VectorXd with = body_testing::stacked(path);
      ASSERT_TRUE(with.allFinite());
      most = std::max(most, (with - baseline).lpNorm<Eigen::Infinity>());
    }
    EXPECT_GT(most, 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, OnEveryArm,
                         ::testing::Values("online_200mm", "semi_physical_200mm", "single_chamber_85mm",
                                           "hybrid_85mm", "cable_235mm", "two_segment", "pouch_arm",
                                           "tendon_trunk"),
                         [](const auto& which) { return std::string(which.param); });

TEST(ExtendedModel, DerivativesByTheRodAgreeWithFiniteDifferences) {
  arm::Arm arm = body_testing::shipped("online_200mm");
  arm::MeasuredBody skin = arm.bodies[2];
  skin.name = "skin";
  skin.kind = arm::BodyKind::kSkinMarker;
  skin.angle_rad = 0.7;
  skin.radius_m = 0.02;
  arm.bodies.push_back(skin);
  model::ExtendedModel model(arm);
  const model::TrialData trial =
      body_testing::trial_of(arm, {{body_testing::inputs_of(arm, 0.8), 0.1, body_testing::horizontal()}});
  // Each change of the rod by way of an effect that makes it.
  const auto check = [&](const char* id, std::initializer_list<double> list) {
    const model::Present by = body_testing::present(id, body_testing::values_of(list));
    const Eigen::VectorXd expected = body_testing::signature(model, arm, by, trial);
    const Eigen::VectorXd difference = body_testing::stacked(body_testing::predict(model, arm, {by}, trial)) -
                                       body_testing::stacked(body_testing::predict(model, arm, {}, trial));
    EXPECT_LT((difference - expected).norm(), 0.01 * expected.norm()) << id;
  };
  check("base_tilt", {1e-3, 5e-4});
  check("torsion", {0.2, 1e-3});
  check("shear", {1e-4});
  check("axial_compliance", {1e-4});
  check("rest_curvature", {0.01, 0.02, 0.0});
  check("payload_offset", {1e-4, 1e-4, 1e-4});
}

// The arm gives way at its tip by about L^3 / (3 EI), 0.1 m/N: what is assumed is answered up to a hundred
// times over.
TEST(ExtendedModel, StiffSpringsAreSolvedAndHold) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  model::ExtendedModel model(arm);
  const model::TrialData trial = body_testing::trial_of(arm, body_testing::various(arm));
  const Eigen::Vector3d straight(0.0, 0.0, arm.total_length_m());
  const auto tip = [](const model::Predicted& now) { return now.shape.stations.back().p; };
  const auto free = body_testing::predict(model, arm, {}, trial);
  for (const double stiffness : {30.0, 100.0, 300.0}) {
    SCOPED_TRACE(stiffness);
    const auto held = body_testing::predict(
        model, arm,
        {body_testing::present("tether", body_testing::values_of({stiffness, 0.0, 0.0, 0.0, 0.0}))}, trial);
    for (std::size_t k = 0; k < held.size(); ++k) {
      EXPECT_LE((tip(held[k]) - straight).norm(), (tip(free[k]) - straight).norm() / 2.0 + 1e-4);
      // What the tip's section bears is the spring, and what hangs there.
      const Eigen::Vector3d weight =
          trial.series.payload_kg[static_cast<Eigen::Index>(k)] * trial.blocks[k].gravity_base;
      const Eigen::Vector3d pull = stiffness * (straight - tip(held[k]));
      EXPECT_LT((held[k].shape.stations.back().n - weight - pull).norm(), 2e-3 + 3e-6 * stiffness);
    }
  }
  const double distance = 0.015;
  for (const double stiffness : {30.0, 100.0, 300.0, 1000.0}) {
    SCOPED_TRACE(stiffness);
    for (const double azimuth : {0.0, 2.1, 4.2}) {
      const auto touching = body_testing::predict(
          model, arm,
          {body_testing::present("contact", body_testing::values_of({stiffness, 2.0 / 3.0 * 0.2, azimuth,
                                                                     distance, 0.0, 0.0, 0.0}))},
          trial);
      const Eigen::Vector3d to_wall(std::cos(azimuth), std::sin(azimuth), 0.0);
      double deepest = 0.0;
      for (const model::Predicted& now : touching)
        deepest = std::max(deepest, to_wall.dot(now.shape.stations[7].p) - distance);
      EXPECT_LT(deepest, 3.0 / stiffness) << "no more than 3 N press here";
      EXPECT_GT(deepest, 0.0);
    }
  }
}

/// Leaves the arm without an equilibrium in a time, and counts the instants of it that it was asked for.
class BearsNothing : public model::Effect {
 public:
  BearsNothing(double from_s, double to_s) : from_s_(from_s), to_s_(to_s) { info_.sizes = 0; }
  const model::Info& info() const override { return info_; }
  void act(const arm::Arm&, const model::FineRod&, const model::Values&, const model::Instant& now,
           const model::Shape*, const model::Memory&, rod::Rod& rod) const override {
    if (now.t_s < from_s_ || now.t_s > to_s_) return;
    rod.gravity_m_s2.setConstant(NAN);
    asked_s_.insert(now.t_s);
  }
  std::size_t asked() const { return asked_s_.size(); }

 private:
  model::Info info_;
  const double from_s_, to_s_;
  mutable std::set<double> asked_s_;
};

TEST(ExtendedModel, WhereNoEquilibriumIsFoundItIsLookedForAfterAsManyBlocksAgain) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  model::ExtendedModel model(arm);
  const Condition condition{body_testing::inputs_of(arm, 0.8)};
  for (const bool path : {true, false}) {
    SCOPED_TRACE(path ? "a path" : "each stands for itself");
    const model::TrialData trial =
        body_testing::trial_of(arm, std::vector<Condition>(100, condition), path, 0.1);
    // Blocks 3 to 80: without looking again for long it is looked for at 3, 4, 5, 7, 11, 19, 35, 67.
    const BearsNothing nothing(0.25, 8.05);
    std::vector<model::Predicted> out, nearby;
    model.predict(arm, {{&nothing, model::Values()}}, {false, 0.0}, trial, nullptr, out);
    EXPECT_EQ(nothing.asked(), path ? 8U : 78U);
    std::size_t lost = 0;
    for (const model::Predicted& block : out) lost += !block.solved;
    EXPECT_GE(lost, 78U);
    EXPECT_TRUE(out[2].solved && !out[3].solved && !out[80].solved);
    EXPECT_EQ(out[81].solved, !path);
    // Where it was lost for few blocks it is found at once.
    const BearsNothing shortly(0.25, 0.45);
    model.predict(arm, {{&shortly, model::Values()}}, {false, 0.0}, trial, nullptr, out);
    EXPECT_TRUE(!out[4].solved && out[5].solved && out[99].solved);
    // What nobody looked for says nothing of what comes after it.
    nearby = out;
    for (std::size_t k = 10; k < 40; ++k) nearby[k].solved = false;
    model.predict(arm, {}, {false, 0.0}, trial, &nearby, out, true);
    EXPECT_TRUE(!out[39].solved && out[40].solved && out[99].solved);
  }
}

TEST(ExtendedModel, InertiaOfTheKnownMassesIsThatOfTheSwingingArm) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  model::ExtendedModel model(arm);
  const model::TrialData trial = body_testing::trial_of(arm, body_testing::swinging(arm), true);
  const auto still = body_testing::predict(model, arm, {}, trial);
  const auto moving = body_testing::predict(model, arm, {}, trial, {true, 0.0});
  // D'Alembert: the moment at the clamp changes by the moments of masses times accelerations.
  for (std::size_t k = 2; k + 2 < still.size(); ++k) {
    rod::Rod rod = model.rod().layout();
    rod.loads[rod::kPayloadLoad].mass_kg = 0.1;
    const Eigen::VectorXd masses = model.rod().station_masses_kg(rod);
    Eigen::Vector3d moment = Eigen::Vector3d::Zero(), weights = Eigen::Vector3d::Zero();
    for (std::size_t j = 0; j < still[k].shape.stations.size(); ++j) {
      const Eigen::Vector3d a = (still[k + 1].shape.stations[j].p - 2.0 * still[k].shape.stations[j].p +
                                 still[k - 1].shape.stations[j].p) /
                                0.01;
      const double mass = masses[static_cast<Eigen::Index>(j)];
      moment -= moving[k].shape.stations[j].p.cross(mass * a);
      weights += (moving[k].shape.stations[j].p - still[k].shape.stations[j].p)
                     .cross(mass * trial.blocks[k].gravity_base);
    }
    EXPECT_LT((moving[k].shape.base_moment_nm - still[k].shape.base_moment_nm - moment - weights).norm(),
              0.02 * moment.norm() + 1e-5);
    EXPECT_GT(moving[k].inertial_m, 0.0);
  }
}

}  // namespace
}  // namespace softarm::effects
