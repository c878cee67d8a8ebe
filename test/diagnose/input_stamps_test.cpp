// However the inputs of clean trials are logged, what is fitted to them is the same.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "effects/catalogue.h"
#include "looked.h"
#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

constexpr int kPoses_hz = 30, kFinest_hz = 10 * kPoses_hz;

struct Logging {
  const char* name;
  int every, first;  ///< of the finest samples
};

constexpr Logging kLoggings[] = {{"at the stamps of the poses", 10, 0},
                                 {"half a sample after the poses", 10, 5},
                                 {"at a tenth of the rate of the poses", 100, 0},
                                 {"at ten times the rate of the poses", 1, 0}};

/// The arm's constants fitted, and by how much the clocks differ.
struct Fitted {
  Eigen::VectorXd constants, sd;
  double offset_s = 0.0, offset_sd_s = 0.0;
};

Fitted fitted(const testing::RecordedCase& drawn, const Logging& logging) {
  std::vector<trial::Trial> trials;
  const auto logged = [&](const rig::InputSample& sample) {
    return (std::lround(sample.stamp_s * kFinest_hz) - logging.first) % logging.every == 0;
  };
  for (rig::Scenario scenario : drawn.truth) {
    scenario.mocap.rate_hz = kPoses_hz;
    scenario.pressures.rate_hz = kFinest_hz;
    // Slow against a tenth of the poses' rate: what straight lines cut off the curves lies below the noise.
    scenario.pressures.ramp_s = 12.0;
    scenario.pressures.random->lowest_hz = 0.02;
    scenario.pressures.random->highest_hz = 0.033;
    scenario.mocap.ring_noise.position_sd_m = 0.0016;
    trials.push_back(
        testing::record(drawn.arm, scenario, "trial_" + std::to_string(trials.size() + 1), logged));
  }
  testing::Looked looked(drawn.arm, trials);
  JointParameters parameters = looked.baseline.at;
  parameters.effects.push_back({effects::find("clock_offset"), Eigen::VectorXd::Zero(1)});
  const Linearised with = looked.model.fit(parameters, {}, &looked.baseline.predicted);

  Fitted out;
  out.constants = with.at.constants;
  out.sd = Eigen::VectorXd::Zero(out.constants.size());
  const auto n = static_cast<Eigen::Index>(with.columns.size());
  const Eigen::MatrixXd covariance = with.information.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  for (Eigen::Index j = 0; j < n; ++j) {
    const JointUnknown& column = with.columns[static_cast<std::size_t>(j)];
    const double sd = column.scale * std::sqrt(covariance(j, j));
    if (column.kind == JointUnknown::Kind::kConstant) out.sd[column.index] = sd;
    if (column.kind == JointUnknown::Kind::kEffect) out.offset_sd_s = sd;
  }
  out.offset_s = with.at.effects.at(0).values[0];
  return out;
}

TEST(InputStamps, CleanTrialsAreTheSameHoweverTheirInputsAreLogged) {
  const testing::RecordedCase drawn =
      testing::drawn_case("{count_weights: [1]}", 11, 2, 26.0,
                          "attitudes: [hanging, horizontal], speeds: [1], payload_kg: [0, 0.1]");
  const Fitted first = fitted(drawn, kLoggings[0]);
  EXPECT_LT(first.offset_sd_s, 0.5 / kPoses_hz) << "half a sample would not be seen";
  for (const Logging& logging : kLoggings) {
    const Fitted fit = &logging == kLoggings ? first : fitted(drawn, logging);
    SCOPED_TRACE(std::string(logging.name) + ": offset " + std::to_string(fit.offset_s) + " +/- " +
                 std::to_string(fit.offset_sd_s) + " s");
    EXPECT_LT(std::abs(fit.offset_s), 3.0 * fit.offset_sd_s);
    EXPECT_LT(std::abs(fit.offset_s - first.offset_s), first.offset_sd_s);
    for (Eigen::Index i = 0; i < fit.constants.size(); ++i)
      EXPECT_LE(std::abs(fit.constants[i] - first.constants[i]), first.sd[i]) << i;
  }
}

}  // namespace
}  // namespace softarm::diagnose
