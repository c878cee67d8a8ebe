// A made-up diagnosis with everything a report can show: an arm whose base yields, hidden behind a lower EI.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose::testing {

inline constexpr double kLength = 0.2;
inline constexpr double kNoise = 0.0005;

/// Deterministic normal numbers: the same on every C++ library.
class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  double operator()() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random_() >> 11) * 0x1p-53;
    return sum;
  }

 private:
  std::mt19937_64 random_;
};

/// Point at s of an arc bent by theta (rad over the whole length) towards phi, its base tilted the same way.
inline Eigen::Vector3d on_arc(double s, double theta, double phi, double tilt) {
  const double a = theta * s / kLength, k = theta / kLength;
  const double across = std::abs(theta) < 1e-6 ? 0.0 : (1.0 - std::cos(a)) / k;
  const double along = std::abs(theta) < 1e-6 ? s : std::sin(a) / k;
  const double x = std::cos(tilt) * across + std::sin(tilt) * along;
  const double z = std::cos(tilt) * along - std::sin(tilt) * across;
  return {x * std::cos(phi), x * std::sin(phi), z};
}

struct Bending {
  double theta, phi, tilt;
};

inline Bending bending(double chamber_1_pa, double chamber_2_pa) {
  const double x = 2.4e-5 * (chamber_1_pa - 0.5 * chamber_2_pa), y = 2.1e-5 * chamber_2_pa;
  const double theta = std::hypot(x, y);
  return {theta, std::atan2(y, x), 0.045 * theta};
}

/// What the baseline says: no tilt of the base, more bending instead.
inline Eigen::Vector3d without_tilt(double s, const Bending& b) {
  return on_arc(s, 1.052 * b.theta, b.phi, 0.0);
}

inline std::vector<Eigen::Vector3d> curve(const Bending& b, bool tilted) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= 40; ++i) {
    const double s = kLength * i / 40.0;
    points.push_back(tilted ? on_arc(s, b.theta, b.phi, b.tilt) : without_tilt(s, b));
  }
  return points;
}

/// Five rings and the base as they are, as seen, and as a model has them that lacks the tilt.
inline diagnose::Snapshot example_instant(const Bending& b, Noise& noise) {
  diagnose::Snapshot snapshot;
  for (int body = 0; body <= 5; ++body) {
    const double s = kLength * body / 5.0;
    Eigen::Vector3d p = on_arc(s, b.theta, b.phi, b.tilt);
    for (int c = 0; c < 3 && body > 0; ++c) p[c] += kNoise * noise();
    snapshot.measured.push_back(p);
    snapshot.bodies_before.push_back(without_tilt(s, b));
    snapshot.bodies_after.push_back(on_arc(s, b.theta, b.phi, 0.97 * b.tilt));
  }
  snapshot.backbone_before = curve(b, false);
  snapshot.backbone_after = curve(b, true);
  return snapshot;
}

inline diagnose::TrialCurves example_trial(const std::string& name, double speed_hz, unsigned seed) {
  diagnose::TrialCurves trial;
  trial.name = name;
  trial.frames = 7200;
  Noise noise(seed);
  double before_2 = 0.0, after_2 = 0.0, n = 0.0;
  const auto count = [](double distance, double& sum, double& most) {
    sum += distance;
    most = std::max(most, distance);
  };
  for (int i = 0; i < 360; ++i) {
    const double t = i / 6.0, turn = 2.0 * 3.14159265358979 * speed_hz * t;
    const double p1 = 25e3 * (1.0 - std::cos(turn)), p2 = 12e3 * (1.0 + std::sin(0.37 * turn + 0.1 * seed));
    const Bending b = bending(p1, p2);
    trial.t_s.push_back(t);
    trial.inputs["chamber_1"].push_back(p1);
    trial.inputs["chamber_2"].push_back(p2);
    trial.inputs["payload"].push_back(seed % 3 == 0 ? 0.05 : 0.0);
    for (int body = 1; body <= 5; ++body) {
      const double s = kLength * body / 5.0;
      const std::string ring = "ring_" + std::to_string(body);
      Eigen::Vector3d measured = on_arc(s, b.theta, b.phi, b.tilt);
      for (int c = 0; c < 3; ++c) measured[c] += kNoise * noise();
      const double before = (measured - without_tilt(s, b)).norm();
      const double after = (measured - on_arc(s, b.theta, b.phi, 0.97 * b.tilt)).norm();
      const bool lost = body == 4 && i > 130 && i < 150;
      trial.before_m[ring].push_back(lost ? std::optional<double>() : before);
      trial.after_m[ring].push_back(lost ? std::optional<double>() : after);
      before_2 += before * before, after_2 += after * after, n += 1.0;
      count(before, trial.mean_before_m, trial.max_before_m);
      count(after, trial.mean_after_m, trial.max_after_m);
      if (body < 5) continue;
      trial.tip_measured_m.emplace_back(measured);
      trial.tip_before_m.emplace_back(without_tilt(s, b));
      trial.tip_after_m.emplace_back(on_arc(s, b.theta, b.phi, 0.97 * b.tilt));
    }
    if (i % 36 == 0) {
      trial.film.push_back(example_instant(b, noise));
      trial.film.back().t_s = t;
    }
  }
  trial.rms_before_m = std::sqrt(before_2 / n);
  trial.rms_after_m = std::sqrt(after_2 / n);
  trial.mean_before_m /= n;
  trial.mean_after_m /= n;
  return trial;
}

inline std::vector<diagnose::Snapshot> example_snapshots() {
  std::vector<diagnose::Snapshot> snapshots;
  Noise noise(99);
  const std::vector<std::pair<std::string, std::pair<double, double>>> states{
      {"largest error before", {50e3, 8e3}}, {"typical", {24e3, 15e3}}, {"largest payload", {38e3, 22e3}}};
  for (const auto& [words, pressures] : states) {
    const Bending b = bending(pressures.first, pressures.second);
    diagnose::Snapshot snapshot = example_instant(b, noise);
    snapshot.trial = "slow_up";
    snapshot.description = words;
    snapshot.t_s = 12.5 + 4.0 * static_cast<double>(snapshots.size());
    snapshots.push_back(snapshot);
  }
  return snapshots;
}

inline diagnose::AlongArm example_along() {
  diagnose::AlongArm along;
  for (int body = 1; body <= 5; ++body) {
    const double x = body / 5.0;
    along.bodies.push_back("ring_" + std::to_string(body));
    along.s_m.push_back(kLength * x);
    along.before_m.emplace_back(1e-3 * (0.5 + 2.6 * x * x), 1e-3 * (0.5 + 0.2 * x), 1e-3 * (0.5 + 0.5 * x));
    along.after_m.emplace_back(1e-3 * (0.5 + 0.03 * x), 1e-3 * (0.5 + 0.02 * x), 1e-3 * 0.5);
    along.mean_before_m.emplace_back(1e-3 * 1.9 * x * x, 1e-4 * x, -4e-4 * x);
    along.mean_after_m.emplace_back(2e-5 * x, -1e-5, 1e-5 * x);
  }
  return along;
}

inline std::vector<diagnose::ParameterVariation> example_parameter_variation() {
  Noise noise(7);
  diagnose::ParameterVariation ei{"EI", "N m^2", "payload", "kg", {}, {}, {}, 3e-9};
  diagnose::ParameterVariation m0{"M0", "N m", "chamber_1", "Pa", {}, {}, {}, 0.002};
  diagnose::ParameterVariation length{"L", "m", "time", "s", {}, {}, {}, 0.41};
  for (int i = 0; i < 120; ++i) {
    const double x = i / 119.0;
    ei.x.push_back(0.1 * x);
    ei.value.push_back(0.0376 - 0.009 * x + 0.0012 * noise());
    ei.law.push_back(0.0344);
    m0.x.push_back(5e4 * x);
    m0.value.push_back(0.3 * x * (1.0 + 0.06 * x) + 0.004 * noise());
    m0.law.push_back(0.31 * x);
    length.x.push_back(600.0 * x);
    length.value.push_back(0.2 + 2e-4 * noise());
    length.law.push_back(0.2);
  }
  ei.sentence =
      "Relative to its law, EI is 24.0 % larger where the payload is 0.00 g than where it is 100 g.";
  return {ei, m0, length};
}

inline std::vector<diagnose::Candidate> example_ranking() {
  std::vector<diagnose::Candidate> ranking;
  const auto add = [&](const std::string& id, const std::string& words, diagnose::Finding finding,
                       double probability, double collinearity, double z, double size_mm) {
    diagnose::Candidate c;
    c.id = id;
    c.description = words;
    c.finding = finding;
    c.probability = probability;
    c.collinearity = collinearity;
    c.z = z;
    c.size_m = 1e-3 * size_mm;
    c.detectable = finding != diagnose::Finding::kCannotTell;
    c.symbol = "share";
    c.unit = "1";
    c.estimate = 0.01 * z;
    c.smallest_detectable = 0.03 / (1.05 - collinearity);
    if (ranking.size() < 5) c.log_score = 0.2 * z / (1.0 + static_cast<double>(ranking.size()));
    ranking.push_back(c);
  };
  add("base_compliance", "the base yields under load", diagnose::Finding::kPresent, 0.93, 0.88, 41.2, 2.1);
  add("hysteresis", "pressure and moment lag in a loop, at any speed", diagnose::Finding::kPresent, 0.88,
      0.35, 14.3, 0.7);
  add("rigid_ends", "stiff end caps", diagnose::Finding::kRival, 0.04, 0.91, 11.8, 0.5);
  add("shear", "the arm shears", diagnose::Finding::kRival, 0.02, 0.95, 6.0, 0.3);
  add("stiffness_taper", "EI falls or rises along the arm", diagnose::Finding::kAbsent, 0.004, 0.62, 1.1,
      0.05);
  add("clock_offset", "motion capture and pressures have different clocks", diagnose::Finding::kAbsent, 0.003,
      0.41, 0.6, 0.03);
  add("axial_compliance", "the arm stretches under load", diagnose::Finding::kTrivial, 0.002, 0.30, 2.4,
      0.04);
  add("creep", "it goes on bending during holds", diagnose::Finding::kAbsent, 0.001, 0.52, -0.3, 0.01);
  add("mullins", "stiffer on first loading", diagnose::Finding::kCannotTell, 0.001, 0.99, 0.2, 0.02);
  add("torsion", "twists under load or pressure", diagnose::Finding::kAbsent, 0.0, 0.12, 0.8, 0.02);
  add("tendon_friction", "tension falls along a tendon", diagnose::Finding::kNotOfThisArm, 0.0, 0.0, 0.0,
      0.0);
  return ranking;
}

inline std::vector<diagnose::NamedEffect> example_effects() {
  diagnose::NamedEffect base;
  base.id = "base_compliance";
  base.description = "the base yields under load";
  base.probability = 0.93;
  base.parameters = {{"K_base", "N m/rad", "rotational stiffness of the base", 5.21, 4.63, 5.88}};
  base.where.s_from_m = 0.0;
  base.where.s_to_m = 0.0;
  base.where.axis = "in_plane";
  base.where.when = "always";
  base.where.input = "payload";
  base.held_out_gain_m = 1.31e-3;
  base.confusable_with = {"rigid_ends", "shear"};
  base.sentence =
      "The arm's base turns with the load on it, by 1 deg for every 0.09 N m: its rotational stiffness is "
      "5.2 N "
      "m/rad (90 % interval 4.6 to 5.9).";
  diagnose::NamedEffect loop;
  loop.id = "hysteresis";
  loop.description = "pressure and moment lag in a loop, at any speed";
  loop.probability = 0.88;
  loop.parameters = {{"p_h", "Pa", "half width of the loop", 2480.0, 2210.0, 2760.0}};
  loop.where.s_from_m = 0.03;
  loop.where.s_to_m = 0.17;
  loop.where.axis = "in_plane";
  loop.where.when = "whenever a pressure turns round";
  loop.where.input = "chamber_1";
  loop.held_out_gain_m = 0.22e-3;
  return {base, loop};
}

inline diagnose::NamedEffect example_small_departure() {
  diagnose::NamedEffect ring;
  ring.id = "marker_slip";
  ring.description = "a ring sits elsewhere than the arm file says";
  ring.probability = 0.995;
  ring.parameters = {{"z_m", "m", "offset along the arm", 0.00031, 0.00022, 0.0004}};
  ring.where.s_from_m = 0.1;
  ring.where.s_to_m = 0.1;
  ring.held_out_gain_m = 0.02e-3;
  ring.share = 0.004;
  return ring;
}

inline diagnose::NamedEffect example_stand_in() {
  diagnose::NamedEffect memory;
  memory.id = "axial_memory";
  memory.description = "the arm keeps lengthening or shortening while its inputs are held";
  memory.probability = 0.004;
  memory.parameters = {{"time_s", "s", "time constant", 2.7, 1.2, 4.2}};
  memory.where.axis = "axial";
  memory.held_out_gain_m = 0.01e-3;
  memory.share = 0.001;
  return memory;
}

inline diagnose::DiscoveredLaw example_law() {
  diagnose::LawTerm lag;
  lag.goes_with = "chamber_2 minus its first-order lag of 1.00 s";
  lag.law = "M = (-1.20, 2.10) mN m (u - w) / (-14.1 kPa)";
  lag.symbols = "u: chamber_2; w follows it: 1.00 s dw/dt = u - w";
  lag.source =
      "line of first order; pneumatics of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft "
      "Robotics 2, 2015, doi:10.1089/soro.2014.0022";
  lag.unit = "Pa";
  lag.from = -14.1e3;
  lag.to = 12.3e3;
  lag.x_nm = {"x_nm", "N m", "towards x", -1.2e-3, -1.5e-3, -0.9e-3};
  lag.y_nm = {"y_nm", "N m", "towards y", 2.1e-3, 1.8e-3, 2.4e-3};
  lag.stability = 0.96;
  lag.sentence =
      "A moment that goes with chamber_2 minus its first-order lag of 1.00 s: 2.42 mN m towards 120 deg.";
  diagnose::LawTerm bend = lag;
  bend.goes_with = "the curvature";
  bend.law = "M = (-1.20 k + 2.10 R k) mN m / (9.70 1/m) (2 s / L - 1)";
  bend.symbols = "k: the curvature; R: a quarter turn about the arm's axis";
  bend.source = "S. S. Antman, Nonlinear Problems of Elasticity, 2005, doi:10.1007/0-387-27649-1";
  bend.unit = "1/m";
  bend.from = 0.0;
  bend.to = 9.7;
  bend.has_direction = bend.rises = true;
  diagnose::DiscoveredLaw law;
  law.terms = {lag, bend};
  law.held_out_mean_before_m = 1.6e-3;
  law.held_out_mean_after_m = 0.9e-3;
  law.held_out_max_before_m = 4.1e-3;
  law.held_out_max_after_m = 2.2e-3;
  law.share = 0.71;
  law.share_of_flexible = 0.83;
  law.sequences = 9;
  law.resembles = "pressure_lag";
  law.cosine = 0.91;
  law.sentence =
      "What no effect of the catalogue explains goes with chamber_2 minus its first-order lag of 1.00 s and "
      "the curvature.";
  law.source =
      "stability selection: N. Meinshausen, P. Buhlmann, J. R. Stat. Soc. B 72, 2010, "
      "doi:10.1111/j.1467-9868.2010.00740.x";
  return law;
}

inline diagnose::Diagnosis example_diagnosis() {
  diagnose::Diagnosis d;
  d.arm = "online_200mm";
  d.version = "0.1.0";
  d.verdict = diagnose::Verdict::kExplained;
  d.summary =
      "The base yields under load and the chambers have hysteresis; together they explain what the model got "
      "wrong. "
      "A lower EI had hidden the base: the arm is 11 % stiffer than it seemed.";
  const std::vector<std::string> names{"slow_up",     "slow_side", "slow_down", "middle_up", "middle_side",
                                       "middle_down", "fast_up",   "fast_side", "fast_down"};
  double before_2 = 0.0, after_2 = 0.0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    d.trials.push_back(example_trial(names[i], i < 3 ? 0.03 : i < 6 ? 0.08 : 0.2, static_cast<unsigned>(i)));
    before_2 += std::pow(d.trials.back().rms_before_m, 2) / static_cast<double>(names.size());
    after_2 += std::pow(d.trials.back().rms_after_m, 2) / static_cast<double>(names.size());
  }
  d.noise_floor_m = std::sqrt(3.0) * kNoise;
  d.baseline = {0.97 * std::sqrt(before_2), std::sqrt(before_2),       0.8 * std::sqrt(before_2), 3e-3, 3.1,
                0.95 * std::sqrt(before_2), 0.98 * std::sqrt(before_2)};
  d.extended = {0.99 * std::sqrt(after_2), std::sqrt(after_2),       0.8 * std::sqrt(after_2), 1e-3, 5.6,
                0.95 * std::sqrt(after_2), 0.98 * std::sqrt(after_2)};
  d.ceiling_rms_m = 0.99 * d.extended.held_out_rms_m;
  d.explained_share = 0.98;
  d.effects = example_effects();
  d.extended_text = "format: 1\neffects: {}\n";
  d.next_command = "softarm estimate --arm report/arm_extended.yaml trial.bag";
  d.small_departures = {example_small_departure()};
  d.stand_ins = {example_stand_in()};
  d.discovered_law = example_law();
  d.ranking = example_ranking();
  d.before = {
      1e-12, 2e-9, 9.4, {{"chamber_1", 1e-8}, {"chamber_2", 0.03}, {"payload", 2e-14}, {"time", 0.6}}, {}};
  d.before.where.s_from_m = 0.0;
  d.before.where.s_to_m = 0.05;
  d.before.where.axis = "in_plane";
  d.before.where.input = "payload";
  d.after = {
      0.21, 0.34, 1.04, {{"chamber_1", 0.18}, {"chamber_2", 0.52}, {"payload", 0.11}, {"time", 0.7}}, {}};
  d.shifts = {{"EI", "N m^2", 0.0341, 0.0004, 0.0379, 0.0006},
              {"payload", "kg", 0.0571, 0.0021, 0.0502, 0.0014},
              {"chamber_1.moment_gain", "N m/Pa", 6.31e-6, 4e-8, 6.02e-6, 5e-8},
              {"length", "m", 0.2003, 0.0002, 0.2001, 0.0002}};
  d.next_experiment = diagnose::NextExperiment{
      "Hang the arm sideways and load it with 50 g, then 100 g, at zero pressure, and hold each for 10 s",
      {"base_compliance", "rigid_ends", "shear"},
      7.4};
  d.next_experiment->today = 0.8;
  d.next_experiment->sentence =
      "It would separate base_compliance, rigid_ends and shear from one another by 7.4 standard deviations; "
      "the present trials do so by 0.8.";
  d.next_experiment->menu = {{d.next_experiment->action, 7.4, {"rigid_ends", "shear"}, {}},
                             {"Record middle_down once more", 1.1, {"base_compliance", "shear"}, {}}};
  d.ladder = {{"instants", "every instant by itself: EI, M0, φ, L", 28800, 0.00052, 1.4},
              {"conditions", "one arm, EI free in each of 18 conditions", 28, 0.00083, 3.1},
              {"one_arm", "one arm", 11, 0.0021, 17.0}};
  d.ladder_sentence =
      "Fits of single instants explain the mismatch, one set of constants does not: it hides in the "
      "variation of the parameters.";
  d.notes = {"ring_4 was not seen for 3.3 s of each trial; those frames were used without it.",
             "middle_down: 14 frames with a time jump were left out."};
  d.input_units = {{"chamber_1", "Pa"}, {"chamber_2", "Pa"}, {"payload", "kg"}};
  d.along = example_along();
  d.snapshots = example_snapshots();
  d.parameter_variation = example_parameter_variation();
  return d;
}

}  // namespace softarm::diagnose::testing
