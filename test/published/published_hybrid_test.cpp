// The hybrid arm: against a closed form, against whole-section statics integrated here, the printed signs
// against both, and how far the production model's linear tendons are from the exact ones.
#include "published/published_hybrid.h"

#include <ceres/tiny_solver.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "math/tiny_solver_tolerance.h"

namespace softarm::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kModulus = 640e3;  // bends the arm by 90 degrees at 3 N

Vector3d tip(const published::HybridArm& arm, const published::HybridLoad& load, published::HybridLaw law,
             int steps = 100) {
  const published::HybridShape shape = published::solve_hybrid(arm, load, law, {steps});
  EXPECT_EQ(shape.status, rod::SolveStatus::kConverged);
  return shape.status == rod::SolveStatus::kConverged ? Vector3d(shape.p_m.rightCols<1>())
                                                      : Vector3d::Constant(1e3);
}

Vector3d solver_tip(const published::HybridArm& arm, const published::HybridLoad& load) {
  const rod::Rod rod = published::linear_rod(arm, load);
  rod::Solver solver(rod, {arm.length_m}, {});
  EXPECT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  return solver.station(0).p;
}

/// The paper's arm with its own weight (0.096 N) across it.
published::HybridArm heavy_arm() {
  published::HybridArm arm = published::hybrid_paper_arm(kModulus);
  arm.weight_n = {0.06, -0.05, 0.056};
  return arm;
}

/// Statics of whole sections: N(s) is known; M(0) is sought such that M(L) = 0. Strains from N and M at every
/// point.
class WholeSections {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = 3, NUM_PARAMETERS = 3 };

  WholeSections(const published::HybridArm& arm, const published::HybridLoad& load)
      : arm_(arm), load_(load) {}

  Vector3d tip() const {
    ceres::TinySolver<WholeSections> solver;
    solver.options.gradient_tolerance = 0.0;
    math::set_function_tolerance(solver.options, 0.0);
    solver.options.parameter_tolerance = 1e-15;
    solver.options.cost_threshold = 1e-26;
    solver.options.max_num_iterations = 60;
    Vector3d moment = Vector3d::Zero();  // in units of EI / L
    solver.Solve(*this, &moment);
    EXPECT_LT(integrate(moment).second.norm(), 1e-10);
    return integrate(moment).first;
  }

  bool operator()(const double* at, double* residuals, double* jacobian) const {
    const Vector3d moment(at[0], at[1], at[2]);
    Eigen::Map<Vector3d>{residuals} = integrate(moment).second;
    for (int i = 0; jacobian && i < 3; ++i) {
      const Vector3d step = 1e-5 * Vector3d::Unit(i);
      Eigen::Map<Vector3d>(jacobian + 3 * i) =
          (integrate(moment + step).second - integrate(moment - step).second) / 2e-5;
    }
    return true;
  }

 private:
  using State = std::array<double, 15>;  // p, R, M

  /// Position of the tip, moment there in units of EI / L.
  std::pair<Vector3d, Vector3d> integrate(const Vector3d& moment) const {
    const double unit = arm_.bending_stiffness_nm2 / arm_.length_m;
    State state{};
    Eigen::Map<Matrix3d>(state.data() + 3).setIdentity();
    Eigen::Map<Vector3d>(state.data() + 12) = unit * moment;
    boost::numeric::odeint::runge_kutta4<State> stepper;
    const double step = arm_.length_m / 100;
    const auto rate = [this](const State& x, State& dx, double s) { differentiate(x, dx, s); };
    for (int i = 0; i < 100; ++i) stepper.do_step(rate, state, i * step, step);
    return {Vector3d(state.data()), Vector3d(state.data() + 12) / unit};
  }

  void differentiate(const State& x, State& dx, double s) const {
    const Eigen::Map<const Matrix3d> rotation(x.data() + 3);
    const Vector3d whole = load_.tip_force_n + (1.0 - s / arm_.length_m) * arm_.weight_n;
    const Vector3d force = rotation.transpose() * whole;
    const Vector3d moment = rotation.transpose() * Eigen::Map<const Vector3d>(x.data() + 12);
    const Vector3d extension(1.0 / arm_.shear_stiffness_n, 1.0 / arm_.shear_stiffness_n,
                             1.0 / arm_.axial_stiffness_n);
    const Vector3d bending(1.0 / arm_.bending_stiffness_nm2, 1.0 / arm_.bending_stiffness_nm2,
                           1.0 / arm_.torsional_stiffness_nm2);
    Vector3d u = Vector3d::Zero(), v = Vector3d::UnitZ();
    Vector3d u_before = Vector3d::Ones();
    // The tendons' directions depend on the strains, by a tenth or so.
    for (int i = 0; i < 60 && (u - u_before).norm() > 1e-14 * u.norm(); ++i) {
      u_before = u;
      Vector3d n = force + load_.pressure_pa * arm_.chamber_area_m2 * Vector3d::UnitZ();
      Vector3d m = moment;
      for (std::size_t k = 0; k < arm_.tendons.size(); ++k) {
        const double azimuth = arm_.tendons[k].azimuth_rad;
        const Vector3d r = arm_.tendons[k].offset_m * Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0);
        const Vector3d pull = load_.tension_n[k] * (v + u.cross(r)).normalized();
        n -= pull;
        m -= r.cross(pull);
      }
      u = bending.cwiseProduct(m);
      v = Vector3d::UnitZ() + extension.cwiseProduct(n);
    }
    const Vector3d dp = rotation * v;
    Eigen::Map<Vector3d>(dx.data()) = dp;
    for (int i = 0; i < 3; ++i)
      Eigen::Map<Vector3d>(dx.data() + 3 + 3 * i) = rotation * u.cross(Vector3d::Unit(i));
    Eigen::Map<Vector3d>(dx.data() + 12) = -dp.cross(whole);
  }

  published::HybridArm arm_;
  published::HybridLoad load_;
};

TEST(PublishedHybrid, ArithmeticOfTheConstants) {
  // Printed: E = 28.8 kPa, EA = 3.05 N, EI = 2.92e-5 N m^2. 3 N on one tendon make 411 /m, 35 rad over the
  // length, and leave 2 % of it.
  const published::HybridArm printed = published::hybrid_paper_arm(28.8e3);
  EXPECT_NEAR(printed.axial_stiffness_n, 3.0536, 1e-3);
  EXPECT_NEAR(printed.bending_stiffness_nm2, 2.920e-5, 1e-8);
  EXPECT_NEAR(3.0 * 0.004 / printed.bending_stiffness_nm2 * 0.085, 34.9, 0.1);
  // A right angle at 3 N takes 22 times that.
  const double stiffness = 3.0 * 0.004 * 0.085 / (0.5 * M_PI);
  EXPECT_NEAR(stiffness, 6.494e-4, 1e-7);
  EXPECT_NEAR(stiffness / printed.bending_stiffness_nm2 * 28.8e3, 640.5e3, 500.0);
}

TEST(PublishedHybrid, OneTendonAloneBendsToAnArc) {
  const published::HybridArm arm = published::hybrid_paper_arm(kModulus);
  for (const published::HybridLaw law : {published::HybridLaw::kPrinted, published::HybridLaw::kStatics}) {
    for (const int tendon : {0, 1, 2}) {
      published::HybridLoad load{{0.0, 0.0, 0.0}};
      load.tension_n[tendon] = 3.0;
      const published::HybridShape shape = published::solve_hybrid(arm, load, law, {50});
      ASSERT_EQ(shape.status, rod::SolveStatus::kConverged);
      const double angle = 3.0 * 0.004 / arm.bending_stiffness_nm2 * 0.085;
      const double radius = 0.085 * (1.0 - 3.0 / arm.axial_stiffness_n) / angle;
      const double azimuth = tendon * 2.0 * M_PI / 3.0;
      const Vector3d expected(radius * (1.0 - std::cos(angle)) * std::cos(azimuth),
                              radius * (1.0 - std::cos(angle)) * std::sin(azimuth), radius * std::sin(angle));
      EXPECT_LT((shape.p_m.rightCols<1>() - expected).norm(), 1e-8);
    }
  }
}

TEST(PublishedHybrid, PressureAloneStretches) {
  published::HybridArm arm = published::hybrid_paper_arm(kModulus);
  const published::HybridLoad load{{0.0, 0.0, 0.0}, 40e3};
  const double stretch = 1.0 + 40e3 * arm.chamber_area_m2 / arm.axial_stiffness_n;
  for (const published::HybridLaw law : {published::HybridLaw::kPrinted, published::HybridLaw::kStatics}) {
    EXPECT_LT((tip(arm, load, law) - Vector3d(0.0, 0.0, 0.085 * stretch)).norm(), 1e-10);
  }
}

TEST(PublishedHybrid, SmallForceAtTheTipIsTheCantileverWithShear) {
  const published::HybridArm arm = published::hybrid_paper_arm(kModulus);
  published::HybridLoad load{{0.0, 0.0, 0.0}};
  load.tip_force_n = {0.0, 1e-5, 0.0};
  const double compliance =
      std::pow(0.085, 3) / (3.0 * arm.bending_stiffness_nm2) + 0.085 / arm.shear_stiffness_n;
  EXPECT_NEAR(tip(arm, load, published::HybridLaw::kStatics)[1], 1e-5 * compliance, 1e-5 * 1e-5 * compliance);
}

TEST(PublishedHybrid, StaticsAreThoseOfWholeSections) {
  const published::HybridArm arm = heavy_arm();
  for (published::HybridLoad load :
       {published::HybridLoad{{3.0, 0.0, 0.0}, 0.0}, published::HybridLoad{{0.0, 2.0, 1.0}, 20e3},
        published::HybridLoad{{0.5, 3.0, 3.0}, 40e3}}) {
    for (const Vector3d& force : {Vector3d(0.0, 0.0, 0.0), Vector3d(-0.04, 0.06, 0.03)}) {
      load.tip_force_n = force;
      EXPECT_LT((tip(arm, load, published::HybridLaw::kStatics) - WholeSections(arm, load).tip()).norm(),
                1e-9);
    }
  }
}

TEST(PublishedHybrid, ConvergesAtFourthOrder) {
  const published::HybridLoad load{{3.0, 1.0, 0.0}, 40e3};
  for (const published::HybridLaw law : {published::HybridLaw::kPrinted, published::HybridLaw::kStatics}) {
    const Vector3d exact = tip(heavy_arm(), load, law, 400);
    const double coarse = (tip(heavy_arm(), load, law, 8) - exact).norm();
    const double fine = (tip(heavy_arm(), load, law, 16) - exact).norm();
    EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.3);
    EXPECT_LT((tip(heavy_arm(), load, law) - exact).norm(), 1e-8);
  }
}

// At 40 kPa the wrong sign acts as a pull of 2 P A^ch = 0.57 N along the tip's tangent, six times EI / L^2:
// the arm curls.
TEST(PublishedHybrid, PrintedSignsMatterWithPressure) {
  const published::HybridArm arm = heavy_arm();
  published::HybridLoad load{{3.0, 0.0, 0.0}, 0.0};
  EXPECT_LT((tip(arm, load, published::HybridLaw::kPrinted) - tip(arm, load, published::HybridLaw::kStatics))
                .norm(),
            1e-12);
  load.pressure_pa = 40e3;
  EXPECT_NEAR(
      (tip(arm, load, published::HybridLaw::kPrinted) - tip(arm, load, published::HybridLaw::kStatics))
          .norm(),
      68.7e-3, 2e-4);
}

// An arm whose EI does not change with pressure, identified with the printed signs, seems to stiffen: the EI
// with which they bend it as far as it really bends.
TEST(PublishedHybrid, PrintedSignsMakeAnArmStiffenThatDoesNot) {
  const auto bend = [](const Vector3d& p) { return std::atan2(p[0], p[2]); };
  for (const auto& [pressure, ratio] :
       {std::pair(10e3, 1.29), std::pair(20e3, 1.52), std::pair(40e3, 1.90)}) {
    const published::HybridLoad load{{3.0, 0.0, 0.0}, pressure};
    const double seen =
        bend(tip(published::hybrid_paper_arm(kModulus), load, published::HybridLaw::kStatics, 20));
    const auto excess = [&, at = load](double factor) {
      published::HybridArm arm = published::hybrid_paper_arm(kModulus);
      arm.bending_stiffness_nm2 *= factor;
      arm.torsional_stiffness_nm2 *= factor;
      return bend(tip(arm, at, published::HybridLaw::kPrinted, 20)) - seen;
    };
    std::uintmax_t iterations = 40;
    const auto root = boost::math::tools::toms748_solve(
        excess, 0.9, 4.0, boost::math::tools::eps_tolerance<double>(12), iterations);
    EXPECT_NEAR(root.first, ratio, 0.01);
  }
}

// Three tendons one after the other (Fig. 6, Table 3), 0.1 N of weight along the arm and across it. What is
// left is the coupling of shear and twist by tendons that do not balance, which a moment does not know.
TEST(PublishedHybrid, LinearTendonsOfTheProductionModelAreCloseEnough) {
  published::HybridArm arm = published::hybrid_paper_arm(kModulus);
  const auto largest_gap_m = [&arm] {
    double largest = 0.0;
    for (const double pressure : {0.0, 40e3}) {
      for (const double share : {0.5, 1.0}) {
        for (const published::HybridLoad& load : {published::HybridLoad{{3.0 * share, 0.0, 0.0}, pressure},
                                                  published::HybridLoad{{3.0, 3.0 * share, 0.0}, pressure},
                                                  published::HybridLoad{{0.0, 3.0, 3.0 * share}, pressure}}) {
          const Vector3d exact = tip(arm, load, published::HybridLaw::kStatics, 40);
          largest = std::fmax(largest, (solver_tip(arm, load) - exact).norm());
        }
      }
    }
    return largest;
  };
  EXPECT_LT(largest_gap_m(), 1e-6);
  arm.weight_n = {0.0, 0.0, 0.1};
  EXPECT_LT(largest_gap_m(), 2e-6);
  arm.weight_n = {0.07, -0.07, 0.0};
  const double across = largest_gap_m();
  EXPECT_LT(across, 0.13e-3);
  EXPECT_GT(across, 0.05e-3);
}

TEST(PublishedHybrid, BadInputIsTyped) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expect_invalid = [](const published::HybridArm& arm, const published::HybridLoad& load) {
    const published::HybridShape shape = published::solve_hybrid(arm, load, published::HybridLaw::kStatics);
    EXPECT_EQ(shape.status, rod::SolveStatus::kInvalidInput);
    EXPECT_EQ(shape.p_m.cols() + shape.u_per_m.cols() + shape.v.cols() + shape.s_m.size(), 0);
  };
  const published::HybridArm good = heavy_arm();
  expect_invalid(good, {{1.0, 1.0}});
  expect_invalid(good, {{1.0, 1.0, -1.0}});
  expect_invalid(good, {{1.0, nan, 1.0}});
  expect_invalid(good, {{1.0, 1.0, 1.0}, nan});
  for (const double value : {nan, 0.0}) {
    for (const auto member :
         {&published::HybridArm::length_m, &published::HybridArm::bending_stiffness_nm2,
          &published::HybridArm::torsional_stiffness_nm2, &published::HybridArm::axial_stiffness_n,
          &published::HybridArm::shear_stiffness_n}) {
      published::HybridArm arm = good;
      arm.*member = value;
      expect_invalid(arm, {{1.0, 1.0, 1.0}});
    }
  }
}

}  // namespace
}  // namespace softarm::rod
