// The whole rig: sensors, messages, determinism, truth.
#include "rig/simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <vector>

#include "rig/hidden.h"
#include "rig/scenario_text.h"
#include "rig/truth_csv.h"

namespace softarm::rig {
namespace {

/// With coarse steps, to be cheap.
Scenario coarse_scenario() {
  Scenario s = parse_scenario(kScenarioText, "case.yaml");
  s.numerics.max_step_s = 1.0 / 240.0;
  return s;
}

std::vector<Sample> run(Simulator& simulator) {
  std::vector<Sample> samples;
  while (std::optional<Sample> sample = simulator.next()) samples.push_back(*sample);
  return samples;
}

/// Everything measured and true, to the last digit.
std::string text_of(const Scenario& s) {
  Simulator simulator(s);
  std::ostringstream out;
  out.precision(17);
  for (const Sample& sample : run(simulator)) {
    write_truth_row(out, sample.truth);
    for (const auto& body : sample.bodies)
      if (body)
        out << body->p.transpose() << ' ' << body->q.coeffs().transpose() << '\n';
      else
        out << "lost\n";
    for (const InputSample& p : sample.inputs)
      out << p.stamp_s << ' ' << topic_of(p.kind, p.number) << ' ' << p.value << '\n';
    if (sample.payload) out << sample.payload->stamp_s << ' ' << sample.payload->kg << '\n';
  }
  return out.str();
}

TEST(Simulator, SameSeedSameBytes) {
  Scenario s = coarse_scenario();
  const std::string one = text_of(s);
  EXPECT_EQ(one, text_of(s));
  s.seed = 5;
  EXPECT_NE(one, text_of(s));
}

TEST(Simulator, FramesAndStamps) {
  Simulator simulator(coarse_scenario());
  ASSERT_TRUE(simulator.frame_count());
  EXPECT_EQ(simulator.body_names(), (std::vector<std::string>{"base", "ring_1", "ring_2"}));
  const std::vector<Sample> samples = run(simulator);
  ASSERT_EQ(samples.size(), *simulator.frame_count());
  ASSERT_EQ(samples.size(), 1201u);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_NEAR(samples[k].stamp_s, static_cast<double>(k) / 120.0, 1e-12);
    EXPECT_EQ(samples[k].bodies.size(), 3u);
  }
  EXPECT_FALSE(simulator.next());

  Scenario endless = coarse_scenario();
  endless.duration_s = 0.0;
  EXPECT_FALSE(Simulator(endless).frame_count());
}

TEST(Simulator, DropoutsAreCountedAndHaveTheirProbability) {
  Simulator simulator(coarse_scenario());
  std::size_t lost = 0, all = 0;
  for (const Sample& sample : run(simulator))
    for (const auto& body : sample.bodies) {
      ++all;
      if (!body) ++lost;
    }
  EXPECT_EQ(lost, simulator.dropouts());
  const double expected = 0.1 * static_cast<double>(all), sd = std::sqrt(expected * 0.9);
  EXPECT_NEAR(static_cast<double>(lost), expected, 4.0 * sd);

  Scenario without = coarse_scenario();
  without.mocap.dropout_probability = 0.0;
  Simulator complete(without);
  run(complete);
  EXPECT_EQ(complete.dropouts(), 0u);
}

TEST(Simulator, MocapSeesTheTruthThroughTheMountWithTheStatedNoise) {
  const Scenario s = coarse_scenario();
  Simulator simulator(s);
  double position = 0.0, orientation = 0.0, base = 0.0, mean = 0.0;
  int count = 0, base_count = 0;
  for (const Sample& sample : run(simulator)) {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& body = sample.bodies[i + 1];
      if (!body) continue;
      const Pose& truth = sample.truth.rings_base[i];
      const Eigen::Vector3d error = body->p - (s.mount.p_mocap_base + s.mount.q_mocap_base * truth.p);
      position += error.squaredNorm();
      mean += error.sum();
      const double angle = (s.mount.q_mocap_base * truth.q).angularDistance(body->q);
      orientation += angle * angle;
      ++count;
    }
    if (sample.bodies[0]) {
      base += (sample.bodies[0]->p - s.mount.p_mocap_base).squaredNorm();
      ++base_count;
    }
  }
  ASSERT_GT(count, 2000);
  EXPECT_NEAR(std::sqrt(position / (3.0 * count)), 0.5e-3, 0.02e-3);
  EXPECT_NEAR(mean / (3.0 * count), 0.0, 5.0 * 0.5e-3 / std::sqrt(3.0 * count));
  EXPECT_NEAR(std::sqrt(orientation / (3.0 * count)), 0.01, 4e-4);
  EXPECT_NEAR(std::sqrt(base / (3.0 * base_count)), 0.05e-3, 0.003e-3);
}

TEST(Simulator, PressureMessagesHaveTheirOwnRateAndAreAbsolute) {
  Scenario s = coarse_scenario();
  s.vacuum.schedule = {{0.0, {40e3}}};
  Simulator simulator(s);
  std::vector<InputSample> messages;
  double last_frame = -1.0;
  for (const Sample& sample : run(simulator)) {
    for (const InputSample& p : sample.inputs) {
      EXPECT_GT(p.stamp_s, last_frame);
      EXPECT_LE(p.stamp_s, sample.stamp_s);
      messages.push_back(p);
    }
    last_frame = sample.stamp_s;
  }
  ASSERT_EQ(messages.size(), 501u * 4u);  // 50 Hz for 10 s, three chambers and the vacuum
  EXPECT_DOUBLE_EQ(messages[0].value, 101325.0);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    EXPECT_NEAR(messages[i].stamp_s, static_cast<double>(i / 4) / 50.0, 1e-12);
    if (i % 4 == 3) {
      EXPECT_EQ(messages[i].kind, InputKind::kVacuum);
      EXPECT_DOUBLE_EQ(messages[i].value, 101325.0 - 40e3);
    } else {
      EXPECT_EQ(messages[i].number, static_cast<int>(i % 4));
      EXPECT_GE(messages[i].value, 101325.0);
    }
  }
}

TEST(Simulator, PayloadIsPublishedOnceAndWhenItChangesOrNever) {
  Simulator simulator(coarse_scenario());
  std::vector<PayloadSample> seen;
  for (const Sample& sample : run(simulator))
    if (sample.payload) seen.push_back(*sample.payload);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_DOUBLE_EQ(seen[0].kg, 0.1);
  EXPECT_DOUBLE_EQ(seen[0].stamp_s, 0.0);
  EXPECT_DOUBLE_EQ(seen[1].kg, 0.2);
  EXPECT_NEAR(seen[1].stamp_s, 5.1, 1e-9);

  Scenario secret = coarse_scenario();
  secret.payload.publish = false;
  Simulator silent(secret);
  double carried = 0.0;
  for (const Sample& sample : run(silent)) {
    EXPECT_FALSE(sample.payload);
    carried = sample.truth.payload_kg;
  }
  EXPECT_DOUBLE_EQ(carried, 0.2);
}

TEST(Simulator, EachChamberBendsTheArmTowardsItsDirection) {
  for (std::size_t chamber = 0; chamber < 3; ++chamber) {
    Scenario s = coarse_scenario();
    s.payload.schedule.clear();
    s.pressures.random.reset();
    s.pressures.settle_s = 0.0;
    s.pressures.schedule = {{0.0, {0.0, 0.0, 0.0}}};
    s.pressures.schedule[0].values[chamber] = 20e3;
    s.duration_s = 6.0;
    Simulator simulator(s);
    const std::vector<Sample> samples = run(simulator);
    const Truth& truth = samples[samples.size() / 2].truth;
    const double direction = std::atan2(truth.tip_base.p.y(), truth.tip_base.p.x());
    EXPECT_GT(truth.tip_angle_rad, 0.3);
    EXPECT_NEAR(std::remainder(direction - s.arm.segments[0].chambers[chamber].direction_rad, 2.0 * M_PI),
                0.0, 0.01);
    // Hanging: mocap z of the tip lies below the mount.
    EXPECT_LT((s.mount.q_mocap_base * truth.tip_base.p).z(), 0.0);
  }
}

TEST(Simulator, TrialsStartAndEndAtRest) {
  Scenario s = coarse_scenario();
  s.pressures.settle_s = 2.0;
  Simulator simulator(s);
  const std::vector<Sample> samples = run(simulator);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_LT((samples[i].truth.tip_base.p - samples[0].truth.tip_base.p).norm(), 1e-9);
  const std::size_t last = samples.size() - 1;
  EXPECT_LT((samples[last].truth.tip_base.p - samples[last - 12].truth.tip_base.p).norm() * 10.0,
            2e-3);  // m/s
}

TEST(Simulator, MountAndGravityTurnTogether) {
  // About the vertical, nothing but the mocap poses may change.
  Scenario s = coarse_scenario();
  s.mocap = MocapSpec{};
  s.mocap.ring_noise = s.mocap.base_noise = PoseNoise{};
  s.mount.q_mocap_base =
      Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 0.4, 0.3).normalized()));
  s.mount.p_mocap_base.setZero();
  s.duration_s = 6.0;
  Simulator reference(s);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()));
  s.mount.q_mocap_base = turn * s.mount.q_mocap_base;
  Simulator turned(s);
  while (std::optional<Sample> one = reference.next()) {
    const std::optional<Sample> other = turned.next();
    ASSERT_TRUE(other);
    for (std::size_t i = 0; i < one->bodies.size(); ++i) {
      ASSERT_LT((turn * one->bodies[i]->p - other->bodies[i]->p).norm(), 1e-8);
      ASSERT_LT((turn * one->bodies[i]->q).angularDistance(other->bodies[i]->q), 1e-6);
    }
  }
}

/// Largest error of the tip with the usual numerics, m.
double numerical_error_m(Scenario s) {
  s.numerics = NumericsSpec{};
  Simulator coarse(s);
  s.numerics.elements += 2;
  s.numerics.max_step_s /= 4.0;
  Simulator fine(s);
  double worst = 0.0;
  while (const std::optional<Sample> one = coarse.next())
    worst = std::max(worst, (one->truth.tip_base.p - fine.next().value().truth.tip_base.p).norm());
  return worst;
}

TEST(Simulator, NumericalErrorIsFarBelowTheNoise) {
  Scenario s = coarse_scenario();
  s.duration_s = 8.0;  // the payload changes at 5
  EXPECT_LT(numerical_error_m(s), 0.02e-3);
}

TEST(Simulator, WhereASlewLimitMakesKinksInTimeTheErrorStaysAsSmall) {
  Scenario s = coarse_scenario();
  s.duration_s = 4.0;
  s.pressures.random.reset();
  s.pressures.settle_s = 0.2;
  s.pressures.ramp_s = 0.3;
  s.pressures.schedule = {{0.0, {5e3, 5e3, 5e3}}, {0.5, {45e3, 5e3, 5e3}}, {2.0, {5e3, 5e3, 5e3}}};
  hide({"flow_limit", "slew", {{"rise_pa_per_s", 15e3}, {"fall_pa_per_s", 20e3}}}, s);
  EXPECT_LT(numerical_error_m(s), 0.02e-3);
}

TEST(Simulator, LawsDrivenOutOfRangeAreReported) {
  Scenario s = coarse_scenario();
  s.arm.segments[0].stiffness_per_min_nm2_per_pa = -1e-5;
  s.pressures.random->min.assign(3, 10e3);
  Simulator simulator(s);
  try {
    run(simulator);
    FAIL() << "a negative stiffness was simulated";
  } catch (const SimulationError& error) {
    EXPECT_NE(std::string(error.what()).find("EI = -"), std::string::npos) << error.what();
  }
}

TEST(TruthCsv, RowsMatchTheHeader) {
  const Scenario s = coarse_scenario();
  Simulator simulator(s);
  std::optional<Sample> sample;
  for (int i = 0; i < 700; ++i) sample = simulator.next();
  ASSERT_TRUE(sample);
  std::ostringstream out;
  write_truth_header(out, s);
  write_truth_row(out, sample->truth, 1000.0);
  std::istringstream in(out.str());
  std::string header, row;
  ASSERT_TRUE(std::getline(in, header) && std::getline(in, row));
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream cell_stream(line);
    for (std::string cell; std::getline(cell_stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  const std::vector<std::string> names = split(header), cells = split(row);
  ASSERT_EQ(names.size(), cells.size());
  const auto value = [&](const std::string& name) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return std::stod(cells[i]);
    ADD_FAILURE() << "no column " << name;
    return 0.0;
  };
  const Truth& truth = sample->truth;
  EXPECT_NEAR(value("stamp"), 1000.0 + truth.stamp_s, 1e-9);
  EXPECT_EQ(value("M0"), truth.segments[0].moment_nm.norm());
  EXPECT_NEAR(value("M0") * std::sin(value("phi")), truth.segments[0].moment_nm.y(), 1e-12);
  EXPECT_EQ(value("EI"), truth.segments[0].bending_stiffness_nm2);
  EXPECT_EQ(value("L"), truth.segments[0].length_m);
  EXPECT_EQ(value("payload"), truth.payload_kg);
  EXPECT_EQ(value("tip_z"), truth.tip_base.p.z());
  EXPECT_EQ(value("P_3"), truth.pressures_pa[2]);
  EXPECT_EQ(value("ring_2_x"), truth.rings_base[1].p.x());
}

}  // namespace
}  // namespace softarm::rig
