// The laws that are hidden in sections, against closed forms, and their tangents against differences.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../../src/rig/section_laws.h"
#include "../../src/rig/stretch_laws.h"

namespace softarm::rig {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kEi = 0.03;

/// A section under one law, whose moment is the whole one: EI u and what the law adds.
class Section {
 public:
  explicit Section(SectionLawPtr law) : law_(std::move(law)), memory_(law_->memory_size(), 0.0) {}

  /// Goes straight to a curvature. @return moment, N m
  Vector2d to(const Vector2d& curvature, double dt_s = 0.01, double core_nm2 = 0.0) {
    const SectionResponse response = ask(curvature, dt_s, core_nm2, memory_);
    memory_ = after_;
    last_ = curvature;
    last_core_nm2_ = core_nm2;
    stored_j_per_m = 0.5 * kEi * curvature.squaredNorm() + response.stored_j_per_m;
    return kEi * curvature + response.moment_nm;
  }

  /// The largest error of the tangent against central differences, relative to EI.
  double tangent_error(const Vector2d& curvature, double dt_s, double core_nm2) {
    constexpr double kStep = 1e-5;
    const std::vector<double> memory = memory_;
    const Matrix2d tangent = ask(curvature, dt_s, core_nm2, memory).tangent_nm2;
    Matrix2d difference;
    for (int i = 0; i < 2; ++i) {
      const Vector2d step = kStep * Vector2d::Unit(i);
      difference.col(i) = (ask(curvature + step, dt_s, core_nm2, memory).moment_nm -
                           ask(curvature - step, dt_s, core_nm2, memory).moment_nm) /
                          (2.0 * kStep);
    }
    return (tangent - difference).cwiseAbs().maxCoeff() / kEi;
  }

  double stored_j_per_m = 0.0;

 private:
  SectionResponse ask(const Vector2d& curvature, double dt_s, double core_nm2,
                      const std::vector<double>& memory) {
    SectionStep step;
    step.curvature = curvature;
    step.last_curvature = last_;
    step.dt_s = dt_s;
    step.stiffness_nm2 = kEi;
    step.core_stiffness_nm2 = core_nm2;
    step.last_core_stiffness_nm2 = last_core_nm2_;
    after_ = memory;
    SectionResponse response;
    law_->add(step, memory.data(), after_.data(), response);
    return response;
  }

  SectionLawPtr law_;
  std::vector<double> memory_, after_;
  Vector2d last_ = Vector2d::Zero();
  double last_core_nm2_ = 0.0;
};

TEST(HiddenSections, TangentsAreTheDerivativesOfTheMoments) {
  const std::vector<SectionLawPtr> laws{cubic_stiffening(1e-3),
                                        gent_stiffening(1e-3),
                                        oval_softening(0.4, 4.0),
                                        wrinkling_softening(0.4, 4.0),
                                        maxwell_branches({{0.1, 0.3}, {0.2, 1e4}}),
                                        bouc_wen(0.5, 1.5),
                                        mullins(0.2, 2.0, true),
                                        mullins(0.2, 2.0, false),
                                        jammed_core({0.8, 0.0, false}),
                                        jammed_core({0.8, 2.0, false}),
                                        jammed_core({0.0, 2.0, true}),
                                        plane_stiffness(0.4, 0.3),
                                        rib_stiffness(0.4, 0.3),
                                        one_sided_folds(0.4, 0.3),
                                        one_sided_softness(0.4, 0.3),
                                        kink_law({{}, 0.4, 4.0, 2.0})};
  for (std::size_t i = 0; i < laws.size(); ++i) {
    Section section(laws[i]);
    section.to({3.0, -5.0}, 0.01, 0.01);
    section.to({2.0, 7.0}, 0.01, 0.01);
    // On, back, across; far and near.
    for (const Vector2d& next : {Vector2d(2.5, 9.0), Vector2d(1.8, 6.0), Vector2d(-4.0, 7.5),
                                 Vector2d(2.0001, 7.02), Vector2d(20.0, 26.0)})
      EXPECT_LT(section.tangent_error(next, 0.01, 0.01), 1e-6) << i << ": " << next.transpose();
  }
}

TEST(HiddenSections, StiffeningAsPrinted) {
  for (double u : {0.5, 8.0, 15.0}) {
    EXPECT_NEAR(Section(cubic_stiffening(1e-3)).to({0.0, u}).y(), kEi * u * (1.0 + 1e-3 * u * u), 1e-12);
    EXPECT_NEAR(Section(gent_stiffening(1e-3)).to({0.0, u}).y(), kEi * u / (1.0 - 1e-3 * u * u), 1e-12);
  }
  // Beyond 0.9 of the square of the curvature at which chains are taut: along the tangent.
  const double last = std::sqrt(900.0), slope = (1.0 + 0.9) / 0.01;
  EXPECT_NEAR(Section(gent_stiffening(1e-3)).to({0.0, last + 2.0}).y(), kEi * (last * 10.0 + 2.0 * slope),
              1e-9);
}

TEST(HiddenSections, SofteningBeyondAKnee) {
  const double share = 0.4, knee = 4.0;
  for (const bool wrinkling : {false, true}) {
    Section section(wrinkling ? wrinkling_softening(share, knee) : oval_softening(share, knee));
    double work = 0.0, last = 0.0;
    for (int i = 1; i <= 3000; ++i) {
      const double u = 0.005 * i, x = u / knee;
      const double moment = section.to({0.0, u}).y();
      const double expected = !wrinkling ? u * (1.0 - share * x * x / (1.0 + x * x))
                              : x < 1.0  ? u
                                         : (1.0 - share) * u + share * knee * (2.0 - std::exp(1.0 - x));
      EXPECT_NEAR(moment, kEi * expected, 1e-12);
      EXPECT_GT(moment, last);
      work += 0.5 * (moment + last) * 0.005;
      last = moment;
    }
    EXPECT_NEAR(section.stored_j_per_m, work, 1e-6 * work);
  }
}

TEST(HiddenSections, StandardLinearSolidRelaxes) {
  const double share = 0.2, tau = 5.0, u = 6.0;
  Section section(maxwell_branches({{share, tau}}));
  const double jump_s = 1e-6;
  EXPECT_NEAR(section.to({0.0, u}, jump_s).y(), kEi * u, 1e-6 * kEi * u);
  double moment = 0.0;
  for (int i = 0; i < 50; ++i) moment = section.to({0.0, u}, tau / 50.0).y();
  EXPECT_NEAR(moment, kEi * u * (1.0 - share + share * std::exp(-1.0)), 1e-6 * kEi * u);
  for (int i = 0; i < 50; ++i) moment = section.to({0.0, u}, tau).y();
  EXPECT_NEAR(moment, kEi * u * (1.0 - share), 1e-9 * kEi * u);
  // Statics: come slowly and rested.
  EXPECT_NEAR(Section(maxwell_branches({{share, tau}})).to({0.0, u}, 0.0).y(), kEi * u * (1.0 - share),
              1e-15);
}

TEST(HiddenSections, SeveralRelaxationsAddUp) {
  Section section(maxwell_branches({{0.1, 0.5}, {0.15, 5.0}}));
  section.to({0.0, 4.0}, 1e-7);
  double moment = 0.0;
  for (int i = 0; i < 10; ++i) moment = section.to({0.0, 4.0}, 0.1).y();
  EXPECT_NEAR(moment, kEi * 4.0 * (0.75 + 0.1 * std::exp(-2.0) + 0.15 * std::exp(-0.2)), 1e-8);
}

TEST(HiddenSections, BoucWenAlongAnAxisAgainstFineIntegration) {
  // z' = u' (1 - z^2 (1/2 + 1/2 sgn(z u'))), integrated with steps of 1e-5; the sign alone gives the side.
  const double yield = 1.5, height = 0.5;
  Section section(bouc_wen(height, yield));
  double z = 0.0, u = 0.0;
  for (double target : {2.0, -3.0, -2.2, 4.0, 3.9}) {
    const int steps = 100000;
    const double du = (target - u) / steps / yield;
    for (int i = 0; i < steps; ++i) {
      const auto rate = [du](double at) { return at * du > 0.0 ? du * (1.0 - at * at) : du; };
      z += rate(z + 0.5 * rate(z));
    }
    u = target;
    EXPECT_NEAR(section.to({0.0, u}).y(), kEi * (u + height * z), 2e-5 * kEi) << target;
  }
  EXPECT_NEAR(section.to({0.0, 40.0}).y(), kEi * (40.0 + height), 1e-9);  // saturates
}

TEST(HiddenSections, BoucWenDoesNotDependOnTheStepsOfAStraightPath) {
  Matrix2d tangent;
  const Vector2d start(0.3, -0.5), path(1.2, 0.7);
  const Vector2d at_once = bouc_wen_along(start, path, tangent);
  Vector2d in_steps = start;
  for (int i = 0; i < 37; ++i) in_steps = bouc_wen_along(in_steps, path / 37.0, tangent);
  EXPECT_LT((at_once - in_steps).norm(), 1e-12);
  EXPECT_LT(at_once.norm(), 1.0);
}

TEST(HiddenSections, FirstLoadingIsStiffer) {
  const double share = 0.1, scale = 2.0;
  Section section(mullins(share, scale, true));
  EXPECT_NEAR(section.to({0.0, 5.0}).y(), 1.1 * kEi * 5.0, 1e-12);
  for (double u : {3.0, 0.0, 4.0})
    EXPECT_NEAR(section.to({0.0, u}).y(), kEi * u * (1.0 + share * std::erfc((25.0 - u * u) / 4.0)), 1e-12);
  EXPECT_NEAR(section.to({7.0, 0.0}).x(), 1.1 * kEi * 7.0, 1e-12);  // further than ever
  Section softened(mullins(share, scale, false));
  softened.to({0.0, 5.0});
  EXPECT_NEAR(softened.to({0.0, 3.0}).y(), kEi * 3.0 * (1.0 + share * std::exp(-2.5)), 1e-12);
}

TEST(HiddenSections, CoreKeepsTheCurvatureAtWhichItWasJammed) {
  const double core = 0.01;  // of kEi
  Section section(jammed_core({1.0, 0.0, false}));
  const Vector2d bent(2.0, 6.0);
  section.to(bent, 0.01, 0.0);
  EXPECT_LT((section.to(bent, 0.01, core) - (kEi - core) * bent).norm(), 1e-15);  // comes in without moment
  EXPECT_LT((section.to({0.0, 0.0}, 0.01, core) - -core * bent).norm(), 1e-15);   // holds on to the shape
  EXPECT_LT((section.to({0.0, 0.0}, 0.01, 0.5 * core) - -0.5 * core * bent).norm(), 1e-15);
  section.to({0.0, 0.0}, 0.01, 0.0);
  const Vector2d other(-3.0, 1.0);
  section.to(other, 0.01, 0.0);
  EXPECT_LT((section.to(other, 0.01, core) - (kEi - core) * other).norm(), 1e-15);  // forgotten
  // Vacuum bit by bit while it bends evenly: as if it had all come in the middle.
  Section gradual(jammed_core({1.0, 0.0, false}));
  for (int i = 1; i <= 50; ++i) gradual.to({0.0, 4.0 * i / 50.0}, 0.01, core * i / 50.0);
  EXPECT_NEAR(gradual.to({0.0, 0.0}, 0.01, core).y(), -core * 2.0, 1e-12);
  // Without memory it is the ideal core.
  Section ideal(jammed_core({0.0, 0.0, false}));
  ideal.to(bent, 0.01, 0.0);
  EXPECT_LT((ideal.to(bent, 0.01, core) - kEi * bent).norm(), 1e-15);
}

TEST(HiddenSections, CoreSlipsAtItsYieldMoment) {
  const double core = 0.01, yield = 2.0, rest = kEi - core;
  Section sharp(jammed_core({0.0, yield, false}));
  sharp.to({0.0, 0.0}, 0.01, core);
  EXPECT_NEAR(sharp.to({0.0, 1.5}, 0.01, core).y(), kEi * 1.5, 1e-15);
  EXPECT_NEAR(sharp.to({0.0, 8.0}, 0.01, core).y(), rest * 8.0 + core * yield, 1e-15);
  EXPECT_NEAR(sharp.to({0.0, 7.0}, 0.01, core).y(), rest * 7.0 + core * 1.0, 1e-15);  // elastic back
  EXPECT_NEAR(sharp.to({0.0, 0.0}, 0.01, core).y(), -core * yield, 1e-15);
  Section smooth(jammed_core({0.0, yield, true}));
  smooth.to({0.0, 0.0}, 0.01, core);
  EXPECT_NEAR(smooth.to({0.0, 1.5}, 0.01, core).y(), rest * 1.5 + core * yield * std::tanh(0.75), 1e-15);
  EXPECT_NEAR(smooth.to({0.0, 80.0}, 0.01, core).y(), rest * 80.0 + core * yield, 1e-12);
}

TEST(HiddenSections, CoreThatComesInWhereTheArmIsBentFarHoldsNoMoreThanItsYield) {
  const double core = 0.01, yield = 2.0, rest = kEi - core;
  for (const bool smooth : {false, true}) {
    Section section(jammed_core({0.0, yield, smooth}));
    section.to({0.0, 8.0}, 0.01, 0.0);
    EXPECT_NEAR(section.to({0.0, 8.0}, 0.01, core).y(), rest * 8.0 + core * yield, 1e-15) << smooth;
    EXPECT_NEAR(section.to({0.0, 8.1}, 0.01, core).y(), rest * 8.1 + core * yield, 1e-15) << smooth;
    EXPECT_NEAR(section.to({0.0, 8.0}, 0.01, core).y(), rest * 8.0 + core * (yield - 0.1), 1e-15) << smooth;
  }
}

TEST(HiddenSections, StiffnessByDirection) {
  const double azimuth = 0.7;
  const Vector2d towards(-std::sin(azimuth), std::cos(azimuth)), across(-towards.y(), towards.x());
  EXPECT_LT((Section(plane_stiffness(azimuth, 0.3)).to(5.0 * towards) - 1.3 * 5.0 * kEi * towards).norm(),
            1e-15);
  EXPECT_LT((Section(plane_stiffness(azimuth, 0.3)).to(5.0 * across) - 5.0 * kEi * across).norm(), 1e-15);
  // The onset over 0.5 / m leaves the parabola's half of it.
  EXPECT_LT((Section(one_sided_softness(azimuth, 0.3)).to(5.0 * towards) - kEi * (5.0 - 0.3 * 4.75) * towards)
                .norm(),
            1e-15);
  EXPECT_LT((Section(one_sided_softness(azimuth, 0.3)).to(-5.0 * towards) + 5.0 * kEi * towards).norm(),
            1e-15);
  // Ribs that give way over 8 / m, folds over 2 / m.
  const double ribbed = 5.0 + 0.3 * 8.0 * std::tanh(5.0 / 8.0),
               folded = 5.0 - 0.3 * (5.0 - 2.0 * (1.0 - std::exp(-2.5)));
  EXPECT_LT((Section(rib_stiffness(azimuth, 0.3)).to(5.0 * towards) - kEi * ribbed * towards).norm(), 1e-15);
  EXPECT_LT((Section(rib_stiffness(azimuth, 0.3)).to(5.0 * across) - 5.0 * kEi * across).norm(), 1e-15);
  EXPECT_LT((Section(one_sided_folds(azimuth, 0.3)).to(5.0 * towards) - kEi * folded * towards).norm(),
            1e-15);
  EXPECT_LT((Section(one_sided_folds(azimuth, 0.3)).to(-5.0 * towards) + 5.0 * kEi * towards).norm(), 1e-15);
}

TEST(HiddenSections, NothingGivesBackMoreThanItTook) {
  const std::vector<SectionLawPtr> laws{cubic_stiffening(1e-3),         gent_stiffening(1e-3),
                                        maxwell_branches({{0.3, 0.3}}), bouc_wen(1.0, 1.0),
                                        mullins(0.5, 2.0, true),        mullins(0.5, 2.0, false),
                                        jammed_core({1.0, 0.0, false}), jammed_core({0.0, 2.0, false}),
                                        jammed_core({0.0, 2.0, true}),  plane_stiffness(0.4, 0.3),
                                        rib_stiffness(0.4, 0.3),        one_sided_folds(0.4, 0.3),
                                        oval_softening(0.4, 4.0),       wrinkling_softening(0.4, 4.0),
                                        one_sided_softness(0.4, 0.3),   kink_law({{}, 0.4, 4.0, 2.0})};
  for (std::size_t i = 0; i < laws.size(); ++i) {
    Section section(laws[i]);
    Vector2d last = Vector2d::Zero(), moment = section.to(last, 1e-3, 0.01);
    double work = 0.0;
    const int steps = 20000;
    for (int k = 1; k <= steps; ++k) {
      const double t = 3.0 * k / steps;  // a rosette that begins and ends at 0
      const double size = 8.0 * std::sin(M_PI * t) * std::sin(0.5 * M_PI * t / 3.0 * 2.0);
      const Vector2d u = size * Vector2d(std::cos(2.0 * t), std::sin(2.0 * t));
      const Vector2d next = section.to(u, 1e-3, 0.01);
      work += 0.5 * (moment + next).dot(u - last);
      ASSERT_GT(work - section.stored_j_per_m, -1e-6) << i << " " << k;  // of up to 2 J/m
      last = u;
      moment = next;
    }
  }
}

}  // namespace
}  // namespace softarm::rig
