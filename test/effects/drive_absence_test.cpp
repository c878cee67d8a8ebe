// What holds for every effect on inputs or with memory: absent it is not there, small it acts in proportion,
// and whatever its values nothing but numbers comes out.
#include <set>

#include "drive_trials.h"
#include "effects/catalogue.h"

namespace softarm::effects::testing {
namespace {

const std::set<std::string> kIds{
    "clock_offset",      "pressure_offset",     "pressure_lag",      "pressure_leak",
    "hysteresis",        "pressure_dead_zone",  "gain_nonlinearity", "chamber_bulge",
    "chamber_mismatch",  "pressure_stiffening", "radial_expansion",  "pressure_elongation",
    "vacuum_shortening", "vacuum_gain",         "tendon_friction",   "creep",
    "mullins",           "jamming_memory",      "jamming_yield",     "drift",
    "temperature",       "flow_limit",          "axial_memory",      "tendon_slack",
    "tendon_length",     "supply_sag",          "clock_drift"};

/// All chambers move at three speeds, the vacuum comes and goes.
model::TrialData busy_trial(const arm::Arm& arm, double duration_s) {
  const auto rows = static_cast<Eigen::Index>(arm.inputs.scalars.size());
  return made_up(
      arm, duration_s,
      [&arm, rows, duration_s](double t_s) {
        Eigen::VectorXd u(rows);
        const double begun = std::min(1.0, t_s), hz = 0.1 + 0.5 * std::pow(t_s / duration_s, 2);
        for (Eigen::Index i = 0; i < rows; ++i) {
          const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(i)].kind;
          const double wave = 0.5 - 0.5 * std::cos(2.0 * M_PI * hz * t_s + 2.0 * static_cast<double>(i));
          u[i] = kind == arm::InputKind::kPressure  ? begun * 25e3 * wave
                 : kind == arm::InputKind::kTension ? begun * 6.0 * wave
                 : kind == arm::InputKind::kVacuum
                     ? 60e3 * std::clamp(2.0 * (t_s - 0.3 * duration_s), 0.0, 1.0)
                     : begun * wave;
        }
        return u;
      },
      0.05);
}

struct Arena {
  explicit Arena(arm::Arm a) : arm(std::move(a)), trial(busy_trial(arm, 8.0)), model(arm) {
    baseline = predict(model, arm, {}, trial, quasi_static(), true);
  }
  arm::Arm arm;
  model::TrialData trial;
  model::ExtendedModel model;
  std::vector<model::Predicted> baseline;
};

Arena& chambers() {
  static Arena arena(shipped_arm("semi_physical_200mm"));
  return arena;
}
Arena& tendons() {
  static Arena arena(tendon_arm());
  return arena;
}
Arena& cables() {
  static Arena arena(shipped_arm("cable_235mm"));
  return arena;
}
Arena& sections() {
  static Arena arena(arm_in_sections());
  return arena;
}
Arena& arena_of(const model::Effect& effect) {
  if (effect.applies_to(chambers().arm)) return chambers();
  if (effect.applies_to(tendons().arm)) return tendons();
  return effect.applies_to(cables().arm) ? cables() : sections();
}

std::vector<const model::Effect*> effects() {
  std::vector<const model::Effect*> list;
  for (const auto& effect : effects::catalogue()) {
    if (kIds.count(effect->info().id)) list.push_back(effect.get());
  }
  return list;
}

double distance_m(const std::vector<model::Predicted>& a, const std::vector<model::Predicted>& b) {
  return (positions(a) - positions(b)).colwise().norm().maxCoeff();
}

TEST(DrivesAndMemory, AreAllInTheCatalogue) {
  EXPECT_EQ(effects().size(), kIds.size());
  for (const model::Effect* effect : effects()) {
    const model::Info& info = effect->info();
    SCOPED_TRACE(info.id);
    ASSERT_GE(info.sizes, 1);
    ASSERT_LE(static_cast<std::size_t>(info.sizes), info.parameters.size());
    EXPECT_TRUE(std::islower(static_cast<unsigned char>(info.description.at(0))));
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
      const model::Parameter& parameter = info.parameters[k];
      EXPECT_LT(parameter.low, parameter.high) << parameter.symbol;
      EXPECT_FALSE(parameter.description.empty() || parameter.unit.empty()) << parameter.symbol;
      if (static_cast<int>(k) < info.sizes) {
        EXPECT_GT(parameter.usual, 0.0) << parameter.symbol;
        EXPECT_LE(parameter.low, 0.0) << parameter.symbol;
      }
    }
    const Arena& arena = arena_of(*effect);
    ASSERT_TRUE(effect->applies_to(arena.arm));
    for (const model::Values& values : effect->grid(arena.arm, arena.model.rod())) {
      ASSERT_EQ(values.size(), static_cast<Eigen::Index>(info.parameters.size()));
      for (Eigen::Index k = 0; k < values.size(); ++k) {
        const model::Parameter& parameter = info.parameters[static_cast<std::size_t>(k)];
        EXPECT_TRUE(k < info.sizes ? values[k] == 0.0
                                   : values[k] >= parameter.low && values[k] <= parameter.high)
            << parameter.symbol;
      }
    }
  }
}

TEST(DrivesAndMemory, ApplyOnlyWhereTheArmHasWhatTheyActOn) {
  const arm::Arm with_vacuum = chambers().arm, with_tendons = tendons().arm,
                 without = shipped_arm("online_200mm");
  for (const std::string id : {"vacuum_shortening", "vacuum_gain", "jamming_memory", "jamming_yield"}) {
    EXPECT_TRUE(find(id)->applies_to(with_vacuum)) << id;
    EXPECT_FALSE(find(id)->applies_to(without)) << id;
  }
  for (const std::string id :
       {"pressure_lag", "pressure_leak", "pressure_offset", "gain_nonlinearity", "pressure_dead_zone",
        "chamber_mismatch", "chamber_bulge", "pressure_stiffening", "radial_expansion", "pressure_elongation",
        "flow_limit", "supply_sag"}) {
    EXPECT_TRUE(find(id)->applies_to(without)) << id;
    EXPECT_FALSE(find(id)->applies_to(with_tendons)) << id;
  }
  EXPECT_TRUE(find("tendon_friction")->applies_to(with_tendons));
  EXPECT_FALSE(find("tendon_friction")->applies_to(without));
  EXPECT_TRUE(find("tendon_slack")->applies_to(cables().arm));
  EXPECT_FALSE(find("tendon_slack")->applies_to(with_tendons) || find("tendon_slack")->applies_to(without));
  EXPECT_TRUE(find("tendon_length")->applies_to(sections().arm));
  EXPECT_TRUE(find("tendon_length")->applies_to(shipped_arm("tendon_trunk")));
  // Tendons whose tensions are known bend what they pass through by these.
  for (const char* arm : {"cable_235mm", "two_segment", "hybrid_85mm"})
    EXPECT_FALSE(find("tendon_length")->applies_to(shipped_arm(arm))) << arm;
  // A cable and an incompressible arm: nothing changes its length.
  EXPECT_TRUE(find("axial_memory")->applies_to(without));
  EXPECT_FALSE(find("axial_memory")->applies_to(cables().arm));
  EXPECT_FALSE(find("chamber_mismatch")->applies_to(shipped_arm("single_chamber_85mm")));
  EXPECT_FALSE(find("supply_sag")->applies_to(shipped_arm("single_chamber_85mm")));
  for (const std::string id :
       {"hysteresis", "creep", "mullins", "drift", "temperature", "clock_offset", "clock_drift"}) {
    EXPECT_TRUE(find(id)->applies_to(without) && find(id)->applies_to(with_tendons)) << id;
  }
}

TEST(DrivesAndMemory, OfNoSizeAreTheBaseline) {
  for (const model::Effect* effect : effects()) {
    Arena& arena = arena_of(*effect);
    for (const model::Values& values : effect->grid(arena.arm, arena.model.rod())) {
      const std::vector<model::Predicted> with =
          predict(arena.model, arena.arm, {{effect, values}}, arena.trial);
      ASSERT_EQ(with.size(), arena.baseline.size());
      for (std::size_t k = 0; k < with.size(); ++k) {
        ASSERT_TRUE(with[k].solved);
        EXPECT_EQ(with[k].values, arena.baseline[k].values) << effect->info().id << " " << values.transpose();
      }
      // The shape is solved for again where it is looked at.
      EXPECT_LE(distance_m(with, arena.baseline), effect->needs_shape() ? 1e-8 : 0.0)
          << effect->info().id << " " << values.transpose();
      if (effect->info().sizes > 2) break;
    }
  }
}

/// To first order, by ExtendedModel::vary.
Eigen::Matrix3Xd first_order(Arena& arena, const model::Present& present) {
  const auto without = arena.model.vary(arena.arm, {}, quasi_static(), arena.trial, arena.baseline, false);
  const auto with =
      arena.model.vary(arena.arm, {present}, quasi_static(), arena.trial, arena.baseline, false);
  Eigen::Matrix3Xd out = with.seen - without.seen;
  Eigen::Index at = 0;
  for (std::size_t k = 0; k < arena.baseline.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd moved =
        arena.baseline[k].by_rod->seen.cast<double>() * (with.values.col(i) - without.values.col(i));
    out.middleCols(at, moved.size() / 3) +=
        Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, moved.size() / 3);
    at += moved.size() / 3;
  }
  return out;
}

TEST(DrivesAndMemory, ActInProportionWhenSmall) {
  for (const model::Effect* effect : effects()) {
    const model::Info& info = effect->info();
    Arena& arena = arena_of(*effect);
    double largest = 0.0;
    for (const model::Values& values : effect->grid(arena.arm, arena.model.rod())) {
      for (int size = 0; size < info.sizes; ++size) {
        model::Values small = values;
        small[size] = 0.01 * info.parameters[static_cast<std::size_t>(size)].usual;
        const std::vector<model::Predicted> with =
            predict(arena.model, arena.arm, {{effect, small}}, arena.trial);
        const Eigen::Matrix3Xd full = positions(with) - positions(arena.baseline);
        const Eigen::Matrix3Xd linear = first_order(arena, {effect, small});
        // Near its steep flank the first loading is not linear for long.
        const double tolerance = info.id == "mullins" ? 0.06 : 0.015;
        EXPECT_LE((full - linear).norm(), tolerance * full.norm() + 1e-8)
            << info.id << " " << small.transpose() << ": " << full.norm();
        largest = std::max(largest, full.colwise().norm().maxCoeff());
      }
    }
    // A hundredth of the usual size.
    EXPECT_TRUE(largest > 5e-7 && largest < 2e-3) << info.id << " " << largest;
  }
}

/// What drives the arm need not be worked out again for an effect that leaves it as it is; for one that does
/// not, what it does would be lost.
TEST(DrivesAndMemory, WhatIsDrivenAlikeIsVariedAlike) {
  int driving = 0, others = 0;
  for (const model::Effect* effect : effects()) {
    Arena& arena = arena_of(*effect);
    const std::string beside = effect->info().id == "clock_offset" ? "payload_scale" : "clock_offset";
    const model::Present drives{find(beside), usual(*find(beside))};
    const std::vector<model::Predicted> base =
        predict(arena.model, arena.arm, {drives}, arena.trial, quasi_static(), true);
    const std::vector<model::Present> both{drives, {effect, usual(*effect)}};
    const auto varied = [&](bool alike) {
      return arena.model.vary(arena.arm, both, quasi_static(), arena.trial, base, alike);
    };
    const auto alike = varied(true), anew = varied(false);
    EXPECT_EQ(alike.seen, anew.seen) << effect->info().id;
    EXPECT_EQ(alike.values == anew.values, !effect->drives()) << effect->info().id;
    ++(effect->drives() ? driving : others);
  }
  EXPECT_TRUE(driving > 5 && others > 5) << driving << " " << others;
}

TEST(DrivesAndMemory, OfTheirUsualSizeLeaveAnEquilibrium) {
  for (const model::Effect* effect : effects()) {
    Arena& arena = arena_of(*effect);
    const std::vector<model::Predicted> with =
        predict(arena.model, arena.arm, {{effect, usual(*effect)}}, arena.trial);
    EXPECT_TRUE(std::all_of(with.begin(), with.end(), [](const model::Predicted& p) { return p.solved; }))
        << effect->info().id;
  }
}

TEST(DrivesAndMemory, GiveNumbersAtTheEndsOfTheirRanges) {
  const std::vector<Arena*> arenas{&chambers(), &tendons()};
  for (const model::Effect* effect : effects()) {
    const model::Info& info = effect->info();
    Arena& arena = arena_of(*effect);
    arm::Arm arm = arena.arm;
    model::TrialData trial = arena.trial;
    trial.blocks.resize(20);
    const auto check = [&](const model::Values& values) {
      const std::vector<model::Predicted> with = predict(arena.model, arm, {{effect, values}}, trial);
      for (const model::Predicted& p : with) {
        EXPECT_TRUE(!p.solved || (p.p.allFinite() && p.values.allFinite())) << info.id << values.transpose();
      }
      const auto varied =
          arena.model.vary(arm, {{effect, values}}, quasi_static(), trial, arena.baseline, false);
      EXPECT_TRUE(varied.values.allFinite() && varied.seen.allFinite()) << info.id << values.transpose();
    };
    model::Values low = usual(*effect), high = low;
    for (int k = 0; k < info.sizes; ++k) {
      low[k] = info.parameters[static_cast<std::size_t>(k)].low;
      high[k] = info.parameters[static_cast<std::size_t>(k)].high;
    }
    check(low);
    check(high);
    for (auto k = static_cast<std::size_t>(info.sizes); k < info.parameters.size(); ++k) {
      for (const double end : {info.parameters[k].low, info.parameters[k].high}) {
        model::Values values = usual(*effect);
        values[static_cast<Eigen::Index>(k)] = end;
        check(values);
      }
    }
  }
}

TEST(DrivesAndMemory, BeginAnewAfterAGap) {
  Arena& arena = chambers();
  model::TrialData gapped = arena.trial;
  gapped.blocks[40].begins = true;
  model::TrialData rest = gapped;
  rest.blocks.erase(rest.blocks.begin(), rest.blocks.begin() + 40);
  for (const std::string id : {"creep", "axial_memory", "mullins", "jamming_memory", "jamming_yield"}) {
    const model::Present present{find(id), usual(*find(id))};
    const std::vector<model::Predicted> whole = predict(arena.model, arena.arm, {present}, gapped);
    const std::vector<model::Predicted> alone = predict(arena.model, arena.arm, {present}, rest);
    for (std::size_t k = 0; k < alone.size(); ++k)
      EXPECT_LT((whole[40 + k].p - alone[k].p).norm(), 1e-6) << id << " " << k;
  }
}

}  // namespace
}  // namespace softarm::effects::testing
