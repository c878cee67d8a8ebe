// The published model: against closed forms, against the exact solver, and how far its load law is from
// statics.
#include "published/published.h"

#include <ceres/tiny_solver.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "rod/rods.h"

namespace softarm::rod {
namespace {

constexpr double kGravity = 9.81;

/// The online paper's arm (0.2 m, 0.2 kg) at the case that the design notes name: 0.3 N m, 0.23 kg.
published::PublishedArm heavy_arm(published::Mounting mounting) {
  published::PublishedArm arm;
  arm.moment_nm = 0.3;
  arm.bending_stiffness_nm2 = 0.038;
  arm.length_m = 0.2;
  arm.payload_n = 0.23 * kGravity;
  arm.weight_n = 0.2 * kGravity;
  arm.mounting = mounting;
  return arm;
}

published::PublishedOptions settling(const published::PublishedArm& arm, int nodes = 100) {
  published::PublishedOptions options;
  options.nodes = nodes;
  options.relaxation = published::settling_relaxation(arm);
  options.tolerance_rad = 1e-12;
  return options;
}

rod::Rod exact_rod(const published::PublishedArm& arm) {
  rod::Rod rod = testing::plain_rod(arm.length_m, arm.bending_stiffness_nm2);
  rod.gravity_m_s2 = {0.0, 0.0, arm.mounting == published::Mounting::kStanding ? -kGravity : kGravity};
  rod.segments[0].mass_kg = arm.weight_n / kGravity;
  rod.segments[0].moment_nm = {-arm.moment_nm * std::sin(arm.direction_rad),
                               arm.moment_nm * std::cos(arm.direction_rad), 0.0};
  rod.loads[0].mass_kg = arm.payload_n / kGravity;
  return rod;
}

/// Positions at L/4 ... L (3 x 4) by the exact solver.
Eigen::Matrix3Xd exact_points(const published::PublishedArm& arm) {
  const rod::Rod rod = exact_rod(arm);
  Eigen::Matrix3Xd points(3, 4);
  rod::Solver solver(rod, {0.25 * arm.length_m, 0.5 * arm.length_m, 0.75 * arm.length_m, arm.length_m}, {});
  EXPECT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  for (int i = 0; i < 4; ++i) points.col(i) = solver.station(i).p;
  return points;
}

/// The same by the published iteration; nodes - 1 is a multiple of 4.
Eigen::Matrix3Xd published_points(const published::PublishedArm& arm, published::LoadLaw law, int nodes) {
  const published::PublishedShape shape = published::solve_published(arm, law, settling(arm, nodes));
  EXPECT_EQ(shape.status, rod::SolveStatus::kConverged);
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Constant(3, 4, 1e3);
  if (shape.status != rod::SolveStatus::kConverged) return points;
  for (int i = 0; i < 4; ++i) points.col(i) = shape.p_m.col((nodes - 1) / 4 * (i + 1));
  return points;
}

double tip_gap(const published::PublishedArm& arm) {
  const Eigen::Matrix3Xd printed = published_points(arm, published::LoadLaw::kPrinted, 401);
  return (printed - published_points(arm, published::LoadLaw::kStatics, 401)).col(3).norm();
}

TEST(Published, NoLoadsGiveACircle) {
  for (const published::LoadLaw law : {published::LoadLaw::kPrinted, published::LoadLaw::kStatics}) {
    for (const double direction : {0.0, 2.5, -1.2}) {
      published::PublishedArm arm = heavy_arm(published::Mounting::kHanging);
      arm.payload_n = arm.weight_n = 0.0;
      arm.direction_rad = direction;
      const published::PublishedShape shape = published::solve_published(arm, law);
      ASSERT_EQ(shape.status, rod::SolveStatus::kConverged);
      EXPECT_EQ(shape.iterations, 1);
      ASSERT_EQ(shape.p_m.cols(), 100);
      const double curvature = arm.moment_nm / arm.bending_stiffness_nm2;
      for (int i = 0; i < 100; ++i) {
        const double angle = curvature * shape.s_m[i];
        EXPECT_NEAR(shape.theta_rad[i], angle, 1e-12);
        const double w = (1.0 - std::cos(angle)) / curvature;
        const Eigen::Vector3d p{std::cos(direction) * w, std::sin(direction) * w,
                                std::sin(angle) / curvature};
        EXPECT_LT((shape.p_m.col(i) - p).norm(), 3e-5 * arm.length_m) << i;
        EXPECT_NEAR(shape.w_m[i], w, 3e-5 * arm.length_m);
      }
    }
  }
}

TEST(Published, StaticsAgreeWithTheExactSolver) {
  for (const published::Mounting mounting : {published::Mounting::kStanding, published::Mounting::kHanging}) {
    for (const double moment : {0.05, 0.3, 0.5}) {
      published::PublishedArm arm = heavy_arm(mounting);
      arm.moment_nm = moment;
      arm.direction_rad = 0.7;
      const double error = (published_points(arm, published::LoadLaw::kStatics, 401) - exact_points(arm))
                               .colwise()
                               .norm()
                               .maxCoeff();
      EXPECT_LT(error, 1e-4 * arm.length_m) << "moment " << moment;
    }
  }
}

TEST(Published, ConvergesAtSecondOrderWithTheNodes) {
  for (const published::Mounting mounting : {published::Mounting::kStanding, published::Mounting::kHanging}) {
    const published::PublishedArm arm = heavy_arm(mounting);
    const Eigen::Matrix3Xd exact = exact_points(arm);
    std::vector<double> errors;
    for (const int nodes : {41, 81, 161}) {
      errors.push_back((published_points(arm, published::LoadLaw::kStatics, nodes) - exact).col(3).norm());
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2.0, 0.05);
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2.0, 0.05);
  }
}

// w' = sin theta turns the integral of (3) into W / (2 L) [w(L) - w(s)]^2.
TEST(Published, PrintedLawFulfilsItsEquations) {
  for (const published::Mounting mounting : {published::Mounting::kStanding, published::Mounting::kHanging}) {
    const published::PublishedArm arm = heavy_arm(mounting);
    const published::PublishedShape shape =
        published::solve_published(arm, published::LoadLaw::kPrinted, settling(arm, 801));
    ASSERT_EQ(shape.status, rod::SolveStatus::kConverged);
    const double sign = mounting == published::Mounting::kStanding ? 1.0 : -1.0;
    for (int i = 0; i <= 800; ++i) {
      const double beyond = shape.w_m[800] - shape.w_m[i];
      const double loads = arm.payload_n * std::sin(shape.theta_rad[800]) * beyond +
                           0.5 * arm.weight_n / arm.length_m * beyond * beyond;
      EXPECT_NEAR(arm.bending_stiffness_nm2 * shape.curvature_per_m[i], arm.moment_nm + sign * loads, 1e-5);
    }
  }
}

TEST(Published, LoadsBendAStandingArmFurtherAndAHangingOneLess) {
  for (const published::LoadLaw law : {published::LoadLaw::kPrinted, published::LoadLaw::kStatics}) {
    published::PublishedArm arm = heavy_arm(published::Mounting::kStanding);
    const double free_angle = arm.moment_nm / arm.bending_stiffness_nm2 * arm.length_m;
    const published::PublishedShape standing = published::solve_published(arm, law, settling(arm));
    arm.mounting = published::Mounting::kHanging;
    const published::PublishedShape hanging = published::solve_published(arm, law, settling(arm));
    ASSERT_EQ(standing.status, rod::SolveStatus::kConverged);
    ASSERT_EQ(hanging.status, rod::SolveStatus::kConverged);
    EXPECT_GT(standing.theta_rad[99], free_angle + 0.5);
    EXPECT_LT(hanging.theta_rad[99], free_angle - 0.5);
    EXPECT_GT(hanging.theta_rad[99], 0.0);
  }
}

// The design notes say 36 mm without length, weight or mounting. Only a standing arm is that far off.
TEST(Published, PrintedLawPutsTheTipElsewhereThanStatics) {
  EXPECT_NEAR(tip_gap(heavy_arm(published::Mounting::kStanding)), 0.0348, 0.0003);
  EXPECT_NEAR(tip_gap(heavy_arm(published::Mounting::kHanging)), 0.0095, 0.0003);
}

TEST(Published, IterationThatDoesNotSettleIsReported) {
  const auto expect_refused = [](const published::PublishedArm& arm, published::LoadLaw law) {
    published::PublishedOptions options;
    options.max_iterations = 5000;
    const published::PublishedShape shape = published::solve_published(arm, law, options);
    EXPECT_EQ(shape.status, rod::SolveStatus::kNoConvergence);
    EXPECT_EQ(shape.iterations, 5000);
    EXPECT_TRUE(std::isfinite(shape.largest_tip_angle_rad));
    EXPECT_EQ(shape.p_m.cols() + shape.theta_rad.size() + shape.w_m.size() + shape.s_m.size() +
                  shape.curvature_per_m.size(),
              0);
    EXPECT_EQ(published::solve_published(arm, law, settling(arm)).status, rod::SolveStatus::kConverged);
  };
  expect_refused(heavy_arm(published::Mounting::kHanging), published::LoadLaw::kStatics);
  expect_refused(heavy_arm(published::Mounting::kHanging), published::LoadLaw::kPrinted);
  expect_refused(heavy_arm(published::Mounting::kStanding), published::LoadLaw::kPrinted);
  // The paper's condition, a tip angle under 180 degrees on the way, does not save a hanging arm.
  EXPECT_LT(published::solve_published(heavy_arm(published::Mounting::kHanging), published::LoadLaw::kStatics)
                .largest_tip_angle_rad,
            3.1);
}

TEST(Published, TooFewIterationsAreReported) {
  const published::PublishedArm arm = heavy_arm(published::Mounting::kHanging);
  published::PublishedOptions options = settling(arm);
  options.max_iterations = 5;
  const published::PublishedShape shape =
      published::solve_published(arm, published::LoadLaw::kStatics, options);
  EXPECT_EQ(shape.status, rod::SolveStatus::kNoConvergence);
  EXPECT_EQ(shape.iterations, 5);
}

TEST(Published, InvalidInputIsTyped) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto expect_invalid = [](const published::PublishedArm& arm,
                                 const published::PublishedOptions& options) {
    const published::PublishedShape shape =
        published::solve_published(arm, published::LoadLaw::kPrinted, options);
    EXPECT_EQ(shape.status, rod::SolveStatus::kInvalidInput);
    EXPECT_EQ(shape.p_m.cols(), 0);
  };
  const auto with = [](double published::PublishedArm::*member, double value) {
    published::PublishedArm arm = heavy_arm(published::Mounting::kHanging);
    arm.*member = value;
    return arm;
  };
  for (const auto member :
       {&published::PublishedArm::moment_nm, &published::PublishedArm::direction_rad,
        &published::PublishedArm::bending_stiffness_nm2, &published::PublishedArm::length_m,
        &published::PublishedArm::payload_n, &published::PublishedArm::weight_n}) {
    for (const double value : {nan, inf}) expect_invalid(with(member, value), {});
    if (member != &published::PublishedArm::direction_rad) expect_invalid(with(member, -0.1), {});
  }
  expect_invalid(with(&published::PublishedArm::bending_stiffness_nm2, 0.0), {});
  expect_invalid(with(&published::PublishedArm::length_m, 0.0), {});

  const published::PublishedArm arm = heavy_arm(published::Mounting::kHanging);
  published::PublishedOptions options;
  for (const int nodes : {-5, 0, 2, 1000001}) {
    options.nodes = nodes;
    expect_invalid(arm, options);
  }
  options = {};
  for (const double relaxation : {0.0, -0.5, 1.1, nan}) {
    options.relaxation = relaxation;
    expect_invalid(arm, options);
  }
  options = {};
  options.max_iterations = 0;
  expect_invalid(arm, options);
  options = {};
  for (const double tolerance : {0.0, -1e-9, nan, inf}) {
    options.tolerance_rad = tolerance;
    expect_invalid(arm, options);
  }
  EXPECT_EQ(published::solve_published(arm, published::LoadLaw::kPrinted, settling(arm, 3)).status,
            rod::SolveStatus::kConverged);
}

/// M_0, EI and L, each as a share of its true value, fitted by a load law to exact points.
class Fit {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = 12, NUM_PARAMETERS = 3 };

  Fit(const published::PublishedArm& truth, published::LoadLaw law)
      : truth_(truth), law_(law), points_(exact_points(truth)) {}

  bool operator()(const double* shares, double* residuals, double* jacobian) const {
    Eigen::Map<Eigen::Matrix<double, 12, 1>>{residuals} =
        residuals_mm(Eigen::Map<const Eigen::Vector3d>(shares));
    if (jacobian == nullptr) return true;
    for (int j = 0; j < 3; ++j) {
      const double step = 1e-5;
      const Eigen::Vector3d at = Eigen::Map<const Eigen::Vector3d>(shares);
      const Eigen::Vector3d by = step * Eigen::Vector3d::Unit(j);
      Eigen::Map<Eigen::Matrix<double, 12, 1>>{jacobian + 12 * j} =
          (residuals_mm(at + by) - residuals_mm(at - by)) / (2.0 * step);
    }
    return true;
  }

  /// @returns the shares; rms_mm is the distance left per point
  Eigen::Vector3d solve(double& rms_mm) const {
    ceres::TinySolver<Fit> solver;
    solver.options.max_num_iterations = 200;
    Eigen::Vector3d shares = Eigen::Vector3d::Ones();
    solver.Solve(*this, &shares);
    rms_mm = residuals_mm(shares).norm() / 2.0;
    return shares;
  }

 private:
  Eigen::Matrix<double, 12, 1> residuals_mm(const Eigen::Vector3d& shares) const {
    published::PublishedArm arm = truth_;
    arm.moment_nm *= shares[0];
    arm.bending_stiffness_nm2 *= shares[1];
    arm.length_m *= shares[2];
    const Eigen::Matrix3Xd difference = 1e3 * (published_points(arm, law_, 201) - points_);
    return Eigen::Map<const Eigen::Matrix<double, 12, 1>>(difference.data());
  }

  published::PublishedArm truth_;
  published::LoadLaw law_;
  Eigen::Matrix3Xd points_;
};

// doc/published_model.md: EI drifts with the payload although the fit stays below the noise of the markers.
TEST(Published, PrintedLawFittedToExactPointsMovesTheStiffness) {
  struct Case {
    published::Mounting mounting;
    double payload_kg, stiffness_share;
  };
  for (const Case& c :
       {Case{published::Mounting::kStanding, 0.15, 0.698}, Case{published::Mounting::kStanding, 0.23, 0.503},
        Case{published::Mounting::kHanging, 0.15, 0.751}, Case{published::Mounting::kHanging, 0.23, 0.708}}) {
    published::PublishedArm truth = heavy_arm(c.mounting);
    truth.payload_n = c.payload_kg * kGravity;
    double rms_mm = 0.0;
    const Eigen::Vector3d printed = Fit(truth, published::LoadLaw::kPrinted).solve(rms_mm);
    EXPECT_NEAR(printed[1], c.stiffness_share, 0.003);
    EXPECT_NEAR(printed[2], 1.0, 0.002);
    EXPECT_LT(rms_mm, 0.2);
    const Eigen::Vector3d statics = Fit(truth, published::LoadLaw::kStatics).solve(rms_mm);
    EXPECT_NEAR(statics[1], 1.0, 0.002);
    EXPECT_LT(rms_mm, 0.005);
  }
}

}  // namespace
}  // namespace softarm::rod
