// "Semi-Physical Modeling of Soft Pneumatic Actuators With Stiffness Tuning": Table 1 recovered from 20
// trials, Table 2 on ten more.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "experiment.h"
#include "math/parallel.h"
#include "papers.h"
#include "published/published.h"
#include "published/pull.h"
#include "softarm/identify/identify.h"

namespace softarm::app::validate {
namespace {

constexpr std::uint64_t kSemiPhysicalPaper = 1;
constexpr double kPayloadKg = 0.2;
constexpr int kFrames = 5;  // measured of each condition
constexpr std::array<const char*, 2> kQualityNames{"ideal", "real-like"};

/// One line of Table 1, in its unit.
struct Constant {
  const char *name, *published, *pattern;
  double scale;  ///< from SI
};
constexpr std::array<Constant, 9> kConstants{{{"a1 + a2 (mm/kPa)", "0.658", "*.chamber_1.elongation", 1e6},
                                              {"a3 + a4 (mm/kPa)", "0.405", "*.chamber_2.elongation", 1e6},
                                              {"a5 + a6 (mm/kPa)", "1.482", "*.chamber_3.elongation", 1e6},
                                              {"b1 (N m2)", "0.027", "*.bending_stiffness.base", 1.0},
                                              {"b2 (N m2/kPa)", "0.0003", "*.per_min_pressure", 1e3},
                                              {"b3 (N m2/kPa)", "0.0013", "*.per_jamming_pressure", 1e3},
                                              {"c1 (N m/kPa)", "0.0061", "*.chamber_1.moment_gain", 1e3},
                                              {"c2 (N m/kPa)", "0.0078", "*.chamber_2.moment_gain", 1e3},
                                              {"c3 (N m/kPa)", "0.0065", "*.chamber_3.moment_gain", 1e3}}};

double value_in(const arm::Arm& arm, const Constant& constant) {
  return constant.scale * identify::value_of(arm, identify::matching(arm, {constant.pattern}).front());
}

/// The start of the fit knows nothing of the chambers' differences.
arm::Arm start_of(arm::Arm arm) {
  arm::Segment& segment = arm.segments.front();
  segment.bending_stiffness.base_nm2 = 0.04;
  segment.bending_stiffness.per_min_pressure_nm2_per_pa = 0.0;
  segment.bending_stiffness.per_jamming_pressure_nm2_per_pa = 0.8e-6;
  for (arm::Chamber& chamber : segment.chambers) {
    chamber.moment_gain_nm_per_pa = 6e-6;
    chamber.near_elongation_m_per_pa = 5e-7;
    chamber.far_elongation_m_per_pa = 0.0;
  }
  return arm;
}

/// Section 4.1: pressures of 10 to 50 kPa, each with a 30 % chance of none, the core jammed in half of the
/// cases; without load and with 200 g.
std::vector<Hold> draw_pair(Draw& draw) {
  Hold hold;
  for (int i = 0; i < 3; ++i) {
    const double pressure = draw.uniform(10e3, 50e3);
    hold.pressures_pa.push_back(draw.chance(0.3) ? 0.0 : pressure);
  }
  hold.vacuum_pa = draw.chance(0.5) ? 60e3 : 0.0;
  Hold loaded = hold;
  loaded.payload_kg = kPayloadKg;
  return {hold, loaded};
}

/// The printed model's shape at the bodies, base frame: constant moment from the laws, (14) to (17).
std::optional<std::vector<Eigen::Vector3d>> printed_shape(const arm::Arm& arm, const arm::InputValues& inputs,
                                                          double payload_kg) {
  const auto law = arm::predict_segment(arm, arm.segments.front(), inputs);
  if (!law) return std::nullopt;
  const arm::Segment& segment = arm.segments.front();
  published::PublishedArm model;
  model.moment_nm = law->moment_nm.norm();
  model.direction_rad = std::atan2(law->moment_nm.y(), law->moment_nm.x());
  model.bending_stiffness_nm2 = law->bending_stiffness_nm2;
  model.length_m = law->length_m;
  model.payload_n = kGravity * payload_kg;
  model.weight_n = kGravity * segment.mass_per_length_kg_m * segment.length_m;
  published::PublishedOptions options;
  options.nodes = 301;
  options.relaxation = published::settling_relaxation(model);
  const published::PublishedShape shape =
      published::solve_published(model, published::LoadLaw::kPrinted, options);
  if (shape.status != rod::SolveStatus::kConverged) return std::nullopt;
  std::vector<Eigen::Vector3d> points;
  for (const arm::MeasuredBody& body : arm.bodies)
    points.emplace_back(
        shape.p_m.col(std::lround(body.arclength_m / segment.length_m * (options.nodes - 1))));
  return points;
}

/// Errors of one model on the ten trials, m, one per frame.
struct Errors {
  std::vector<double> all, unloaded, loaded;
  std::size_t none = 0;  ///< frames for which the model has no shape
  void add(double error_m, double payload_kg) {
    all.push_back(error_m);
    (payload_kg > 0.0 ? loaded : unloaded).push_back(error_m);
  }
};

struct FitOutcome {
  identify::Result ours;
  std::optional<published::ThreeTruths> theirs;
  std::string failure;  ///< of their procedure
  Errors our_errors, their_errors;
  double largest_angle_rad = 0.0, largest_length_m = 0.0, moving_m = 0.0;
  std::vector<std::vector<double>> rows;
};

/// What the rig measured in so many pairs of trials. The same conditions for both qualities.
std::vector<std::vector<Held>> record_pairs(Quality quality, const arm::Arm& arm, const Settings& settings,
                                            std::size_t trials) {
  rig::Scenario scenario = shipped_scenario("semi_physical_200mm");
  if (quality == Quality::kRealLike) make_real_like(scenario, 0.0, 0.0);
  Draw draw(seed_of(settings.seed, kSemiPhysicalPaper, 0));
  std::vector<std::vector<Hold>> pairs;
  for (std::size_t i = 0; i < trials; ++i) pairs.push_back(draw_pair(draw));
  std::vector<std::vector<Held>> held(pairs.size());
  math::in_parallel(pairs.size(), settings.jobs, [&](std::size_t i) {
    HoldTiming timing;
    timing.frames = kFrames;
    timing.dwell_s = 6.0;
    held[i] = run_holds(
        scenario, arm, pairs[i],
        seed_of(settings.seed, kSemiPhysicalPaper, 100 + i + 1000 * static_cast<std::uint64_t>(quality)),
        timing);
  });
  return held;
}

/// Errors of both models on trials that neither was fitted to.
void compare_models(Quality quality, const std::vector<trial::Trial>& trials,
                    const identify::FrameChoice& choice, FitOutcome& result) {
  for (const identify::FrameComparison& frame : identify::compare(result.ours.arm, trials, choice)) {
    result.our_errors.add(frame.error_m, frame.payload_kg);
    double their_error = std::nan("");
    if (result.theirs) {
      const auto shape = printed_shape(result.theirs->arm, frame.inputs, frame.payload_kg);
      if (shape) {
        double sum = 0.0;
        for (const identify::BodyComparison& body : frame.bodies)
          sum += ((*shape)[static_cast<std::size_t>(body.body)] - body.measured_p_base).norm();
        their_error = sum / static_cast<double>(frame.bodies.size());
        result.their_errors.add(their_error, frame.payload_kg);
      } else {
        ++result.their_errors.none;
      }
    }
    result.rows.push_back({static_cast<double>(quality), static_cast<double>(frame.trial + 1),
                           frame.payload_kg, *frame.inputs[0], *frame.inputs[1], *frame.inputs[2],
                           *frame.inputs[3], frame.error_m, their_error});
  }
}

FitOutcome experiment(Quality quality, const Settings& settings, std::size_t fitted, std::size_t checked) {
  const arm::Arm arm = start_of(shipped_arm("semi_physical_200mm"));
  const std::vector<std::vector<Held>> held = record_pairs(quality, arm, settings, fitted + checked);
  FitOutcome result;
  std::vector<trial::Trial> trials;
  identify::Options options;
  options.frames.frames_per_trial = 0;
  options.frames.prefer_static = false;
  for (std::size_t i = 0; i < held.size(); ++i) {
    trials.push_back({fmt::format("trial_{:02}", i + 1), {}});
    for (const Held& h : held[i]) {
      trials.back().frames.insert(trials.back().frames.end(), h.frames.begin(), h.frames.end());
      result.moving_m = std::max(result.moving_m, h.moving_m);
      result.largest_angle_rad = std::max(result.largest_angle_rad, h.truth.tip_angle_rad);
      result.largest_length_m = std::max(result.largest_length_m, h.truth.segments.front().length_m);
    }
    if (i >= fitted) options.held_out.push_back(trials.back().name);
  }
  result.ours = identify::identify(arm, trials, options);

  const std::vector<trial::Trial> fit_trials(trials.begin(), trials.begin() + static_cast<long>(fitted));
  const std::vector<trial::Trial> check_trials(trials.begin() + static_cast<long>(fitted), trials.end());
  try {
    result.theirs = published::fit_three_truths(arm, published::find_pulls(arm, fit_trials),
                                                published::LoadLaw::kPrinted, false);
  } catch (const std::invalid_argument& e) {
    result.failure = e.what();
  }
  compare_models(quality, check_trials, options.frames, result);
  return result;
}

using FitOutcomes = std::array<FitOutcome, 2>;

Table table_1(const FitOutcomes& outcomes) {
  Table table{"semi_physical.table_1", "Table 1: the constants, from 20 trials", {}, {}, {}};
  for (const char* name : kQualityNames) {
    table.columns.push_back(fmt::format("{}: identify", name));
    table.columns.push_back(fmt::format("{}: their procedure", name));
  }
  const arm::Arm truth = shipped_arm("semi_physical_200mm");
  for (const Constant& constant : kConstants) {
    Row row{constant.name, constant.published, {}, ""};
    const double true_value = value_in(truth, constant);
    for (const FitOutcome& o : outcomes) {
      const identify::ConstantRef ref = identify::matching(truth, {constant.pattern}).front();
      const auto found = std::find_if(o.ours.constants.begin(), o.ours.constants.end(), [&](const auto& c) {
        return c.ref.kind == ref.kind && c.ref.index == ref.index;
      });
      const double value = constant.scale * found->value;
      row.ours.push_back({fmt::format("{:.4g} +- {:.1g} ({:+.1f} %)", value, constant.scale * found->sd,
                                      100.0 * (value / true_value - 1.0)),
                          value});
      if (o.theirs) {
        const double theirs = value_in(o.theirs->arm, constant);
        row.ours.push_back(
            {fmt::format("{:.4g} ({:+.1f} %)", theirs, 100.0 * (theirs / true_value - 1.0)), theirs});
      } else {
        row.ours.push_back({"none", {}});
      }
    }
    table.rows.push_back(row);
  }
  table.notes = {
      "The rig's arm has the printed constants. Identify: all frames together, exact statics, from a start "
      "that knows "
      "nothing of the chambers' differences (gains 0.006, elongations 0.5, b1 0.04, b2 0, b3 0.0008). Their "
      "procedure: "
      "length and angle of the circle from base to tip, EI from the change of that angle by 200 g with (2) "
      "and (17), "
      "least squares on each law by itself; all as printed. Near and far elongations (a1 and a2) cannot be "
      "separated "
      "by shapes: equation (6) has only their sums."};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const FitOutcome& o = outcomes[i];
    if (o.theirs)
      table.notes.push_back(fmt::format(
          "{}: {} of 20 pulls identify a stiffness by their procedure; it leaves {:.1f} mm of "
          "length and {:.4f} N m2 of EI unexplained (rms).",
          kQualityNames[i], o.theirs->pulls, 1e3 * o.theirs->length_rms_m, o.theirs->stiffness_rms_nm2));
    if (!o.failure.empty()) table.notes.push_back(fmt::format("{}: {}", kQualityNames[i], o.failure));
    if (!o.ours.undetermined.empty())
      table.notes.push_back(fmt::format("{}: {}", kQualityNames[i], o.ours.undetermined.front().sentence));
  }
  return table;
}

Table table_2(const FitOutcomes& outcomes) {
  Table table{
      "semi_physical.table_2", "Table 2: error of the shape on ten trials that were not fitted", {}, {}, {}};
  std::vector<const Errors*> columns;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    table.columns.push_back(fmt::format("{}: ours", kQualityNames[i]));
    table.columns.push_back(fmt::format("{}: theirs", kQualityNames[i]));
    columns.push_back(&outcomes[i].our_errors);
    columns.push_back(&outcomes[i].their_errors);
  }
  const double length_m = shipped_arm("semi_physical_200mm").total_length_m();
  const auto add = [&](const char* what, const char* published, const std::string& remark,
                       const std::function<double(const Errors&)>& value) {
    Row row{what, published, {}, remark};
    for (const Errors* errors : columns) {
      const double e = value(*errors);
      row.ours.push_back(std::isfinite(e)
                             ? Cell{fmt::format("{:.2f} cm, {:.2f} %", 100.0 * e, 100.0 * e / length_m), e}
                             : Cell{"none", {}});
    }
    table.rows.push_back(row);
  };
  add("mean", "0.85 cm, 4.49 %", "theirs is percent of 19 cm, ours of 20",
      [](const Errors& e) { return statistics(e.all).mean; });
  add("median", "0.5 cm, 2.63 %", "", [](const Errors& e) { return statistics(e.all).median; });
  add("maximum", "3.1 cm, 16.3 %", "", [](const Errors& e) { return statistics(e.all).maximum; });
  add("minimum", "0.13 cm, 0.68 %", "", [](const Errors& e) { return statistics(e.all).minimum; });
  add("mean, no load", "", "", [](const Errors& e) { return statistics(e.unloaded).mean; });
  add("mean, 200 g", "", "", [](const Errors& e) { return statistics(e.loaded).mean; });
  table.notes = {
      "Mean distance of the three points from the shape predicted from pressures, vacuum and payload alone; "
      "100 frames. "
      "Theirs: the constants of their procedure with the load moments (14), (17) as printed."};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    table.notes.push_back(fmt::format(
        "{}: tip angles up to {:.0f} deg, lengths up to {:.0f} mm; rings moved by at most {:.2f} mm while "
        "measured; {} "
        "frames without a shape by their model.",
        kQualityNames[i], 180.0 / M_PI * outcomes[i].largest_angle_rad, 1e3 * outcomes[i].largest_length_m,
        1e3 * outcomes[i].moving_m, outcomes[i].their_errors.none));
  }
  return table;
}

Table arithmetic() {
  Table table{"semi_physical.arithmetic", "What the printed constants make of the arm", {"ours"}, {}, {}};
  const arm::Arm arm = shipped_arm("semi_physical_200mm");
  const auto at = [&](double p1, double p2, double p3, double vacuum) {
    return *arm::predict_segment(arm, arm.segments.front(), {1e3 * p1, 1e3 * p2, 1e3 * p3, 1e3 * vacuum});
  };
  const auto add = [&](const char* what, Cell ours, const std::string& remark) {
    table.rows.push_back({what, "", {std::move(ours)}, remark});
  };
  add("length at 3 x 50 kPa (mm)", cell("{:.0f}", 1e3 * at(50, 50, 50, 0).length_m),
      "200 + 50 (0.658 + 0.405 + 1.482): (6) reduces to L0 + sum P_i (a_near + a_far)");
  add("stretch at 3 x 50 kPa", cell("{:.0f} %", 100.0 * (at(50, 50, 50, 0).length_m / 0.2 - 1.0)),
      "a silicone arm of this make stretches by a few per cent: the printed elongations are doubtful");
  add("a_near + a_far for 2.6 % there (mm/kPa)", cell("{:.4f}", 1e3 * 0.026 * 0.2 / 150.0),
      "of each chamber, a plausible size; the printed ones are 0.85 on average, 24 times as much");
  const double degrees = 180.0 / M_PI;
  const arm::SegmentPrediction one = at(50, 0, 0, 0);
  add("bend by chamber 1 at 50 kPa (deg)",
      cell("{:.0f}", degrees * one.moment_nm.norm() / one.bending_stiffness_nm2 * one.length_m),
      "without loads; their Figure 5 shows 90: gains and stiffness go together");
  add("same, arm not stretched (deg)",
      cell("{:.0f}", degrees * one.moment_nm.norm() / one.bending_stiffness_nm2 * 0.2), "");
  add("EI, nothing on (N m2)", cell("{:.3f}", at(0, 0, 0, 0).bending_stiffness_nm2), "b1");
  add("EI, 3 x 50 kPa and 60 kPa of vacuum (N m2)", cell("{:.3f}", at(50, 50, 50, 60).bending_stiffness_nm2),
      "b1 + b2 50 + b3 (60 + 50)");
  add("side chambers alone, equal: direction (deg)",
      cell("{:.0f}", degrees * std::atan2(0.0, at(0, 20, 20, 0).moment_nm.x())),
      "with equal gains opposite to chamber 1. The printed sign of the third chamber's M_y in (11) makes "
      "both side "
      "chambers push the same way, cos and sin of 120 deg: the geometry is used");
  return table;
}

}  // namespace

Result semi_physical(const Settings& settings, Progress& progress) {
  const std::size_t fitted = settings.quick ? 10 : 20, checked = settings.quick ? 4 : 10;
  FitOutcomes outcomes;
  for (std::size_t q = 0; q < outcomes.size(); ++q) {
    progress.line(fmt::format("semi_physical: {} trials of the {} arm", fitted + checked, kQualityNames[q]));
    outcomes[q] = experiment(static_cast<Quality>(q), settings, fitted, checked);
  }
  Series series{
      "semi_physical_shapes",
      {"real_like", "trial", "payload_kg", "p1_pa", "p2_pa", "p3_pa", "vacuum_pa", "ours_m", "theirs_m"},
      {}};
  for (const FitOutcome& o : outcomes) series.rows.insert(series.rows.end(), o.rows.begin(), o.rows.end());
  progress.advance(kSemiPhysical_s, 0);
  return {"semi_physical",
          "Semi-Physical Modeling of Soft Pneumatic Actuators With Stiffness Tuning",
          {arithmetic(), table_1(outcomes), table_2(outcomes)},
          {series}};
}

}  // namespace softarm::app::validate
