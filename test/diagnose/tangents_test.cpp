// Bodies' tangents in the joint model: their derivatives, what they add, and clusters that are mounted askew.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "looked.h"
#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

constexpr double kAskew_rad = 2.0 * M_PI / 180.0;

/// Of this arm's bodies only the last one's orientation is usable.
constexpr int kTip = 3;

testing::RecordedCase clean_case() {
  return testing::recorded_case("{count_weights: [1]}", 41, 3, 10.0);
}

std::vector<trial::Trial> without_orientations(std::vector<trial::Trial> trials) {
  for (trial::Trial& trial : trials) {
    for (trial::Frame& frame : trial.frames) {
      for (trial::BodyObservation& seen : frame.bodies) seen.q_mocap.reset();
    }
  }
  return trials;
}

/// The clusters of one body turned about x of their section.
std::vector<trial::Trial> with_body_askew(std::vector<trial::Trial> trials, int body) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(kAskew_rad, Eigen::Vector3d::UnitX()));
  for (trial::Trial& trial : trials) {
    for (trial::Frame& frame : trial.frames) {
      for (trial::BodyObservation& seen : frame.bodies)
        if (seen.body == body && seen.q_mocap) seen.q_mocap = *seen.q_mocap * turn;
    }
  }
  return trials;
}

Eigen::VectorXd sd_of(const Linearised& at) {
  const Eigen::Index n = at.information.rows();
  return at.information.ldlt().solve(Eigen::MatrixXd::Identity(n, n)).diagonal().cwiseSqrt();
}

TEST(Tangents, TheirNoiseIsThatOfTheRecording) {
  const testing::RecordedCase drawn = clean_case();
  const model::Prepared prepared = model::prepare(drawn.arm, drawn.trials);
  const double truth_rad = drawn.truth.front().mocap.ring_noise.orientation_sd_rad;
  ASSERT_GT(truth_rad, 0.0);
  // Three coordinates share the noise of two axes.
  EXPECT_NEAR(prepared.white_sd_rad[kTip], std::sqrt(2.0 / 3.0) * truth_rad, 0.1 * truth_rad);
  EXPECT_TRUE(model::prepare(drawn.arm, without_orientations(drawn.trials))
                  .trials.front()
                  .blocks.front()
                  .tangents.empty());
}

TEST(Tangents, DerivativesAreThoseOfWholePredictions) {
  const testing::RecordedCase drawn = clean_case();
  testing::Looked looked(drawn.arm, drawn.trials);
  using Derivatives = JointModel::Derivatives;
  const Linearised chained =
      looked.model.linearise(looked.baseline.at, &looked.baseline.predicted, Derivatives::kShapesHeld);
  const Linearised whole =
      looked.model.linearise(looked.baseline.at, &looked.baseline.predicted, Derivatives::kWhole);
  // Inertia is held in the first, which the fastest trial shows.
  for (std::size_t t = 0; t + 1 < looked.prepared.trials.size(); ++t) {
    Eigen::Index rows = 0;
    for (const model::Block& block : looked.prepared.trials[t].blocks)
      rows += 3 * static_cast<Eigen::Index>(block.tangents.size());
    ASSERT_GT(rows, 0);
    const Eigen::MatrixXd a = chained.derivative[t].bottomRows(rows),
                          b = whole.derivative[t].bottomRows(rows);
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      EXPECT_LT((a.col(j) - b.col(j)).norm(), 0.06 * b.col(j).norm() + 1e-6)
          << "trial " << t << ", unknown " << j;
  }
}

TEST(Tangents, TellMoreOfTheConstants) {
  const testing::RecordedCase drawn = clean_case();
  testing::Looked with(drawn.arm, drawn.trials), without(drawn.arm, without_orientations(drawn.trials));
  const auto constants = static_cast<Eigen::Index>(with.model.constants().size());
  ASSERT_EQ(with.baseline.columns.size(), without.baseline.columns.size() + 2);
  const Eigen::VectorXd a = sd_of(with.baseline).head(constants), b = sd_of(without.baseline).head(constants);
  EXPECT_LT((a.array() / b.array()).maxCoeff(), 1.01);
  EXPECT_LT((a.array() / b.array()).minCoeff(), 0.95);
}

TEST(Tangents, AnAskewClusterIsFoundAndMovesNoConstant) {
  const testing::RecordedCase drawn = clean_case();
  testing::Looked straight(drawn.arm, drawn.trials), askew(drawn.arm, with_body_askew(drawn.trials, kTip));
  const Eigen::MatrixXd found = askew.baseline.at.mounts - straight.baseline.at.mounts;
  for (Eigen::Index b = 0; b < found.cols(); ++b) {
    EXPECT_NEAR(found(0, b), b == kTip ? kAskew_rad : 0.0, 0.05 * kAskew_rad) << b;
    EXPECT_NEAR(found(1, b), 0.0, 0.05 * kAskew_rad) << b;
  }
  const Eigen::VectorXd sd = sd_of(straight.baseline);
  for (Eigen::Index j = 0; j < askew.baseline.at.constants.size(); ++j)
    EXPECT_LT(std::abs(askew.baseline.at.constants[j] - straight.baseline.at.constants[j]),
              sd[j] * straight.baseline.columns[static_cast<std::size_t>(j)].scale)
        << j;
}

}  // namespace
}  // namespace softarm::diagnose
