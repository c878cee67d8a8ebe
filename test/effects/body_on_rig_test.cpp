// Effects of body, boundary and load against the virtual rig: hidden there, and in the model at the same
// size.
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "drive_trials.h"
#include "effects/catalogue.h"

namespace softarm::effects::testing {
namespace {

enum class Mount { kHanging, kHorizontal, kWeightless };

struct HiddenInBody {
  const char* name;
  rig::HiddenChoice choice;
  std::vector<double> values;  ///< of the effect of the same id
  Mount mount = Mount::kHanging;
  double baseline_m = 1e-3;  ///< at least so far off without it
  double payload_kg = 0.1;
  double swings_m = 0.0;  ///< what else moves: a payload off the tip, an arm that bounces off
  friend std::ostream& operator<<(std::ostream& out, const HiddenInBody& h) { return out << h.name; }
};

constexpr double kDeg = M_PI / 180.0;

/// The rig's soft spot has smooth edges, a quarter of its width each: a sharp one that turns as much has this
/// share of its width.
double sharp_width(double share) {
  const int n = 2000;
  double edge = 0.0;
  for (int i = 0; i < n; ++i) {
    const double x = (i + 0.5) / n, step = x * x * x * (10.0 + x * (6.0 * x - 15.0));
    edge += (1.0 / (1.0 - share * step) - 1.0) / n;
  }
  return 0.5 + 0.5 * edge / (1.0 / (1.0 - share) - 1.0);
}

const std::vector<HiddenInBody>& hidden_in_body() {
  static const std::vector<HiddenInBody> list{
      {"stiffness_taper", {"stiffness_taper", "linear", {{"share", -0.25}}}, {-0.25}, Mount::kHorizontal},
      {"actuation_taper", {"actuation_taper", "linear", {{"share", 0.15}}}, {0.15}},
      {"soft_spot",
       {"soft_spot", "even", {{"centre_fraction", 0.4}, {"width_fraction", 0.2}, {"share", 0.4}}},
       {0.4, 0.08, 0.04 * sharp_width(0.4)}},
      {"rigid_ends", {"rigid_ends", "", {{"base_m", 0.012}, {"tip_m", 0.01}}}, {0.012, 0.01}},
      {"base_compliance",
       {"base_compliance", "", {{"stiffness_nm_per_rad", 5.0}}},
       {0.2},
       Mount::kHorizontal},
      {"base_tilt",
       {"base_tilt", "", {{"angle_deg", 1.0}, {"azimuth_deg", 40.0}}},
       {kDeg * std::cos(40.0 * kDeg), kDeg * std::sin(40.0 * kDeg)}},
      {"gravity_direction",
       {"gravity_direction", "", {{"angle_deg", 1.5}, {"azimuth_deg", 120.0}}},
       {1.5 * kDeg * std::cos(120.0 * kDeg), 1.5 * kDeg * std::sin(120.0 * kDeg)},
       Mount::kHorizontal,
       5e-4},
      {"axial_compliance", {"axial_compliance", "", {{"axial_stiffness_n", 100.0}}}, {0.01}},
      {"shear", {"shear", "", {{"shear_stiffness_n", 45.0}}}, {1.0 / 45.0}, Mount::kHorizontal},
      {"strain_stiffening",
       {"strain_stiffening", "cubic", {{"beta_m2", 1e-2}}},
       {1e-2},
       Mount::kHanging,
       5e-4},
      // The rig goes by the turn of the whole segment, the catalogue by the curvature of each section: alike
      // where nothing but the chambers bends the arm, and nothing stretches it.
      {"curvature_gain",
       {"curvature_gain", "", {{"share_per_rad", 0.15}}},
       {0.15},
       Mount::kWeightless,
       1e-3,
       0.0},
      {"contact",
       {"contact",
        "spring_wall",
        {{"stiffness_n_per_m", 100.0},
         {"distance_m", 0.01},
         {"azimuth_deg", 20.0},
         {"fraction", 0.7},
         {"inclination_deg", 0.0},
         {"friction", 0.0}}},
       {100.0, 0.14, 20.0 * kDeg, 0.01, 0.0, 0.0, 0.0},
       Mount::kHanging,
       1e-3,
       0.1,
       2e-4},
      {"tether",
       {"tether",
        "spring",
        {{"stiffness_n_per_m", 3.0},
         {"anchor_distance_m", 0.05},
         {"azimuth_deg", 90.0},
         {"slack_m", 0.0},
         {"hose_kg", 0.0}}},
       {3.0, 0.0, 0.0, 0.05, 0.0}},
      {"tether_hose",
       {"tether",
        "hose",
        {{"stiffness_n_per_m", 3.0},
         {"anchor_distance_m", 0.05},
         {"azimuth_deg", 90.0},
         {"slack_m", 0.01},
         {"hose_kg", 0.02}}},
       {3.0, 0.01, 0.0, 0.05, 0.06},
       Mount::kHorizontal},
      {"payload_offset",
       {"payload_offset", "", {{"axial_m", 0.02}, {"lateral_m", 0.01}, {"azimuth_deg", 60.0}}},
       {0.01 * std::cos(60.0 * kDeg), 0.01 * std::sin(60.0 * kDeg), 0.02},
       Mount::kHanging,
       1e-3,
       0.1,
       4e-5},
      {"tip_mass", {"tip_mass", "", {{"mass_kg", 0.015}}}, {0.015}, Mount::kHorizontal},
      {"mass_distribution",
       {"mass_distribution", "taper", {{"share", 0.3}, {"lump_fraction", 0.5}}},
       {0.3},
       Mount::kHorizontal,
       1e-3,
       0.0},
      {"payload_scale", {"payload_scale", "", {{"share", 0.1}}}, {0.1}, Mount::kHorizontal},
      {"torsion_under_load",
       {"torsion",
        "compliance",
        {{"stiffness_ratio", 0.6}, {"twist_deg", 0.0}, {"reference_pa", 50e3}, {"reference_n", 3.0}}},
       {1.0 / (0.6 * 0.027), 0.0},
       Mount::kHorizontal,
       5e-4},
      {"torsion_by_pressure",
       {"torsion",
        "pressure",
        {{"stiffness_ratio", 1.0}, {"twist_deg", 5.0}, {"reference_pa", 50e3}, {"reference_n", 3.0}}},
       {0.0, 5.0 * kDeg},
       Mount::kHanging,
       3e-4},
      {"rest_curvature",
       {"rest_curvature", "", {{"curvature_per_m", 0.3}, {"azimuth_deg", 50.0}, {"segment", 0.0}}},
       {0.3 * std::cos(50.0 * kDeg), 0.3 * std::sin(50.0 * kDeg), 0.0}},
      {"bending_plane_offset", {"bending_plane_offset", "", {{"angle_deg", 5.0}}}, {5.0 * kDeg}},
  };
  return list;
}

rig::Scenario scenario_of(const HiddenInBody& hidden) {
  rig::Scenario scenario = shipped_scenario("trial_10s");
  make_clean(scenario);
  scenario.duration_s = 6.0;
  scenario.mocap.rate_hz = 60.0;
  scenario.numerics.max_step_s = 1.0 / 480.0;
  scenario.payload.schedule = {{0.0, {hidden.payload_kg}}};
  if (hidden.mount == Mount::kWeightless) {
    scenario.gravity_m_s2 = 0.0;
    for (rig::ChamberSpec& chamber : scenario.arm.segments[0].chambers)
      chamber.near_elongation_m_per_pa = chamber.far_elongation_m_per_pa = 0.0;
  }
  if (hidden.mount == Mount::kHorizontal)
    scenario.mount.q_mocap_base = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY());
  return scenario;
}

arm::Arm arm_of(const HiddenInBody& hidden) {
  arm::Arm arm = shipped_arm("online_200mm");
  if (hidden.mount == Mount::kWeightless) {
    arm.gravity_m_s2.setZero();
    for (arm::Chamber& chamber : arm.segments[0].chambers)
      chamber.near_elongation_m_per_pa = chamber.far_elongation_m_per_pa = 0.0;
  }
  return arm;
}

/// Error where nothing is hidden: the rig's arm rings after the kinks of its pressures.
double ringing_m(const HiddenInBody& as, model::ExtendedModel& model, const arm::Arm& arm,
                 const model::Dynamics& dynamics) {
  static std::map<std::pair<Mount, double>, double> known;
  const auto key = std::make_pair(as.mount, as.payload_kg);
  if (known.count(key) == 0) {
    const model::TrialData trial = recorded(arm, scenario_of(as));
    known[key] = rms_m(predict(model, arm, {}, trial, dynamics), trial);
  }
  return known[key];
}

class InTheRigsBody : public ::testing::TestWithParam<HiddenInBody> {};

TEST_P(InTheRigsBody, IsPredictedAtItsSize) {
  const HiddenInBody& hidden = GetParam();
  const arm::Arm arm = arm_of(hidden);
  rig::Scenario scenario = scenario_of(hidden);
  rig::hide(hidden.choice, scenario);
  const model::TrialData trial = recorded(arm, scenario);
  model::ExtendedModel model(arm);
  const model::Dynamics dynamics{true, 0.02};
  const model::Values values = Eigen::Map<const Eigen::VectorXd>(
      hidden.values.data(), static_cast<Eigen::Index>(hidden.values.size()));
  const double without_m = rms_m(predict(model, arm, {}, trial, dynamics), trial);
  const auto path = predict(model, arm, {{find(hidden.choice.effect), values}}, trial, dynamics);
  for (const model::Predicted& now : path) EXPECT_TRUE(now.solved);
  const double with_m = rms_m(path, trial);
  const double ringing = ringing_m(hidden, model, arm, dynamics);
  EXPECT_LT(ringing, 2e-4);
  EXPECT_GT(without_m, hidden.baseline_m);
  EXPECT_LT(with_m, 1.25 * ringing + 1e-5 + hidden.swings_m);
  EXPECT_LT(with_m, 0.25 * without_m);
  RecordProperty("ringing_mm", std::to_string(1e3 * ringing));
  RecordProperty("without_mm", std::to_string(1e3 * without_m));
  RecordProperty("with_mm", std::to_string(1e3 * with_m));
}

INSTANTIATE_TEST_SUITE_P(Effects, InTheRigsBody, ::testing::ValuesIn(hidden_in_body()),
                         [](const auto& which) { return std::string(which.param.name); });

/// Errors of an arm on which the rig hides something, without and with an effect of the catalogue.
struct Errors {
  double without_m = 0.0, with_m = 0.0;
};
Errors errors_of(const HiddenInBody& hidden, const arm::Arm& arm,
                 const std::function<void(rig::Scenario&)>& change = nullptr) {
  rig::Scenario scenario = scenario_of(hidden);
  if (change) change(scenario);
  rig::hide(hidden.choice, scenario);
  const model::TrialData trial = recorded(arm, scenario);
  model::ExtendedModel model(arm);
  const model::Dynamics dynamics{true, 0.02};
  const model::Values values = Eigen::Map<const Eigen::VectorXd>(
      hidden.values.data(), static_cast<Eigen::Index>(hidden.values.size()));
  return {rms_m(predict(model, arm, {}, trial, dynamics), trial),
          rms_m(predict(model, arm, {{find(hidden.choice.effect), values}}, trial, dynamics), trial)};
}

arm::Arm stiffer(double factor) {
  arm::Arm arm = shipped_arm("online_200mm");
  arm::StiffnessLaw& law = arm.segments[0].bending_stiffness;
  law.base_nm2 *= factor;
  law.per_min_pressure_nm2_per_pa *= factor;
  law.per_jamming_pressure_nm2_per_pa *= factor;
  return arm;
}

TEST(OnTheRig, GainByTheTurnOfALoadedSegmentIsMostlyGainByCurvature) {
  const HiddenInBody hidden{"", {"curvature_gain", "", {{"share_per_rad", 0.15}}}, {0.15}};
  const Errors errors = errors_of(hidden, arm_of(hidden));
  EXPECT_GT(errors.without_m, 1e-3);
  EXPECT_LT(errors.with_m, 0.25 * errors.without_m);
}

TEST(OnTheRig, AStifferPlaneIsStifferAllRoundAndUneven) {
  // The rig: EI (1 + share) in the plane, EI across it.
  const double share = 0.3, mean = 1.0 + 0.5 * share, uneven = 0.5 * share / mean, azimuth = 50.0 * kDeg;
  const HiddenInBody hidden{
      "",
      {"plane_stiffness", "oval", {{"share", share}, {"azimuth_deg", 50.0}, {"to_fraction", 1.0}}},
      {uneven * std::cos(2.0 * azimuth), uneven * std::sin(2.0 * azimuth)}};
  const Errors errors = errors_of(hidden, stiffer(mean));
  EXPECT_GT(errors.without_m, 1e-3);
  EXPECT_LT(errors.with_m, 2e-4);
}

TEST(OnTheRig, ASideThatGivesWayIsOneSidedSoftnessInEitherForm) {
  // The rig: EI (1 - share) towards the side, at once or bit by bit, EI away from it and across it.
  const double azimuth_deg = 30.0;
  for (const auto& [form, share, softer] :
       {std::tuple("buckles", 0.3, 0.29), std::tuple("buckles", -0.3, -0.29),
        std::tuple("folds", 0.3, 0.2)}) {
    const HiddenInBody hidden{
        "",
        {"one_sided_softness", form, {{"share", share}, {"azimuth_deg", azimuth_deg}, {"to_fraction", 1.0}}},
        {softer, azimuth_deg * kDeg}};
    const Errors errors = errors_of(hidden, arm_of(hidden), [](rig::Scenario& scenario) {
      // Towards the side by the first chamber, away from it by the other two.
      scenario.pressures.random.reset();
      scenario.pressures.schedule = {{0.5, {40e3, 0.0, 0.0}}, {3.0, {0.0, 40e3, 40e3}}};
    });
    EXPECT_GT(errors.without_m, 1e-3) << form << " " << share;
    EXPECT_LT(errors.with_m, 0.25 * errors.without_m) << form << " " << share;
    RecordProperty("without_mm", std::to_string(1e3 * errors.without_m));
    RecordProperty("with_mm", std::to_string(1e3 * errors.with_m));
  }
}

TEST(OnTheRig, AClampWithPlayIsMostlyFreePlayInEitherForm) {
  for (const char* form : {"ring", "bush"}) {
    // What a spring of 50 N m / rad yields beyond the play is the rest.
    const HiddenInBody hidden{
        "", {"base_free_play", form, {{"play_deg", 1.0}}}, {1.15 * kDeg, 0.004}, Mount::kHorizontal};
    const Errors errors = errors_of(hidden, arm_of(hidden));
    EXPECT_GT(errors.without_m, 1e-3) << form;
    EXPECT_LT(errors.with_m, 0.3 * errors.without_m) << form;
    RecordProperty(std::string(form) + "_with_mm", std::to_string(1e3 * errors.with_m));
  }
}

TEST(OnTheRig, AWallThatWrinklesIsSofterBeyondAKnee) {
  const HiddenInBody hidden{
      "", {"curvature_softening", "wrinkling", {{"share", 0.6}, {"knee_per_m", 1.0}}}, {1.05, 1.6}};
  const Errors errors = errors_of(hidden, arm_of(hidden));
  EXPECT_GT(errors.without_m, 1e-3);
  EXPECT_LT(errors.with_m, 0.3 * errors.without_m);
  RecordProperty("without_mm", std::to_string(1e3 * errors.without_m));
  RecordProperty("with_mm", std::to_string(1e3 * errors.with_m));
}

/// The best of some values, of a law of the rig's that is another than the catalogue's.
Errors best_of(const HiddenInBody& hidden, const std::vector<std::vector<double>>& values,
               const std::function<void(rig::Scenario&)>& change = nullptr) {
  rig::Scenario scenario = scenario_of(hidden);
  if (change) change(scenario);
  rig::hide(hidden.choice, scenario);
  const arm::Arm arm = arm_of(hidden);
  model::TrialData trial = recorded(arm, scenario);
  trial.series.session_s = scenario.session_s;
  model::ExtendedModel model(arm);
  const model::Dynamics dynamics{true, 0.02};
  Errors errors;
  errors.without_m = errors.with_m = rms_m(predict(model, arm, {}, trial, dynamics), trial);
  for (const std::vector<double>& one : values) {
    const model::Values v =
        Eigen::Map<const Eigen::VectorXd>(one.data(), static_cast<Eigen::Index>(one.size()));
    const double rms = rms_m(predict(model, arm, {{find(hidden.choice.effect), v}}, trial, dynamics), trial);
    errors.with_m = std::min(errors.with_m, rms);
  }
  ::testing::Test::RecordProperty(hidden.name, std::to_string(1e3 * errors.without_m) + " mm without, " +
                                                   std::to_string(1e3 * errors.with_m) + " mm with");
  return errors;
}

TEST(OnTheRig, ASpaceThatTheCamerasStretchOrBowIsTheCataloguesInEitherForm) {
  const Errors axes =
      best_of({"axes", {"camera_scale", "axes", {{"share", 0.02}, {"height_ratio", 0.6}}}, {}},
              {{0.02, -0.008, 0.0}});
  EXPECT_GT(axes.without_m, 1e-3);
  EXPECT_LT(axes.with_m, 0.05 * axes.without_m);
  const Errors warming =
      best_of({"warming", {"camera_scale", "warming", {{"share", 0.02}, {"warms_s", 600.0}}}, {}},
              {{0.02, 0.0, 5.8}}, [](rig::Scenario& s) { s.session_s = 600.0; });
  EXPECT_GT(warming.without_m, 1e-3);
  EXPECT_LT(warming.with_m, 0.2 * warming.without_m);
  const Errors fading = best_of({"fading", {"camera_bow", "fading", {{"off", 0.02}, {"fades_m", 2.0}}}, {}},
                                {{0.01}, {0.012}, {0.014}});
  EXPECT_GT(fading.without_m, 1e-3);
  EXPECT_LT(fading.with_m, 0.35 * fading.without_m);
  const Errors lenses = best_of(
      {"lenses",
       {"camera_bow", "lenses", {{"off", 0.05}, {"ring_m", 3.0}, {"height_m", 2.5}, {"cameras", 8.0}}},
       {}},
      {{0.001}, {0.002}, {0.003}, {0.005}, {0.008}});
  EXPECT_GT(lenses.without_m, 3e-4);
  EXPECT_LT(lenses.with_m, 0.6 * lenses.without_m);
}

TEST(OnTheRig, ARingOnASkinIsTheCataloguesInEitherForm) {
  const Errors sleeve =
      best_of({"sleeve",
               {"skin_marker",
                "sleeve",
                {{"body", 3.0}, {"way_m2", 8e-4}, {"saturates_per_m", 20.0}, {"tilt_rad_m", 0.0}}},
               {}},
              {{6e-4, 0.0, 0.0, 3.0}, {7e-4, 0.0, 0.0, 3.0}});
  EXPECT_GT(sleeve.without_m, 5e-4);
  EXPECT_LT(sleeve.with_m, 0.35 * sleeve.without_m);
  const Errors patch = best_of(
      {"patch",
       {"skin_marker", "patch", {{"body", 3.0}, {"way_m2", 8e-4}, {"side_deg", 30.0}, {"patch_m", 0.03}}},
       {}},
      {{0.0, 8e-4 * std::cos(30.0 * kDeg), 8e-4 * 0.5, 3.0}});
  EXPECT_GT(patch.without_m, 5e-4);
  EXPECT_LT(patch.with_m, 0.35 * patch.without_m);
}

TEST(OnTheRig, FrictionOfAWallIsMostlyThatOfContactInEitherForm) {
  // Pressed against it by the first chamber, drawn along it to and fro by the other two.
  const auto drawn_along = [](rig::Scenario& s) {
    s.duration_s = 12.0;
    s.pressures.random.reset();
    s.pressures.schedule = {{0.0, {0.0, 0.0, 0.0}},   {0.5, {40e3, 0.0, 0.0}},  {3.0, {40e3, 15e3, 0.0}},
                            {5.0, {40e3, 0.0, 15e3}}, {7.0, {40e3, 15e3, 0.0}}, {9.0, {40e3, 0.0, 15e3}}};
    s.pressures.settle_s = 0.5;
    s.pressures.ramp_s = 1.5;
  };
  const std::map<std::string, double> numbers{{"stiffness_n_per_m", 300.0}, {"distance_m", 0.02},
                                              {"azimuth_deg", 0.0},         {"fraction", 1.0},
                                              {"inclination_deg", 0.0},     {"friction", 0.5}};
  for (const std::string form : {"rough_wall", "post"}) {
    auto values = numbers;
    if (form == "post") values["radius_m"] = 0.3;
    std::vector<std::vector<double>> smooth, rough;
    for (const double stiffness : {60.0, 120.0, 240.0})
      for (const double place : {0.17, 0.19})
        for (const double distance : {0.02, 0.022}) {
          smooth.push_back({stiffness, place, 0.0, distance, 0.0, 0.0, 0.0});
          for (const double friction : {0.2, 0.35, 0.5})
            rough.push_back({stiffness, place, 0.0, distance, friction, 0.0, 0.0});
        }
    const HiddenInBody hidden{form.c_str(), {"contact", form, values}, {}, Mount::kHanging, 1e-3, 0.0};
    const Errors without = best_of(hidden, smooth, drawn_along), with = best_of(hidden, rough, drawn_along);
    EXPECT_GT(without.without_m, 1e-3) << form;
    EXPECT_LT(without.with_m, 0.5 * without.without_m) << form;
    EXPECT_LT(with.with_m, 0.8 * without.with_m)
        << form << " friction explains a part of what a smooth one leaves";
    RecordProperty(form + "_mm", std::to_string(1e3 * without.without_m) + " without, " +
                                     std::to_string(1e3 * without.with_m) + " smooth, " +
                                     std::to_string(1e3 * with.with_m) + " rough");
  }
}

TEST(OnTheRig, AWallThatLagsMoreIsTheDelayOfInertia) {
  const arm::Arm arm = shipped_arm("online_200mm");
  rig::Scenario scenario = scenario_of({"slow wall", {}, {}});
  scenario.arm.segments[0].retardation_s = 0.08;
  const model::TrialData trial = recorded(arm, scenario);
  model::ExtendedModel model(arm);
  const model::Dynamics dynamics{true, 0.02};
  const double without_m = rms_m(predict(model, arm, {}, trial, dynamics), trial);
  const double with_m =
      rms_m(predict(model, arm, {{find("inertia"), Eigen::Vector2d(0.0, 0.06)}}, trial, dynamics), trial);
  EXPECT_GT(without_m, 5e-4);
  EXPECT_LT(with_m, 3e-4);
  EXPECT_LT(with_m, 0.3 * without_m);
}

}  // namespace
}  // namespace softarm::effects::testing
