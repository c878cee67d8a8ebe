#include "math/so3.h"

#include <gtest/gtest.h>

#include <random>

namespace softarm {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return Vector3d(x, y, z).normalized();
}

/// Tiny ones, those around the switch between series and closed form, ordinary ones, and nearly half a turn.
constexpr double kAngles[] = {0.0,  1e-300, 1e-12, 1e-9, 1e-6, 9.9e-5, 1.01e-4, 9.9e-4,
                              1e-3, 1.1e-3, 0.1,   1.0,  2.0,  3.0,    3.14,    3.14159};

TEST(So3, SkewIsTheCrossProduct) {
  const Vector3d v(1.0, -2.0, 3.0), w(0.4, 5.0, -6.0);
  EXPECT_TRUE((math::skew(v) * w).isApprox(v.cross(w), 1e-15));
  EXPECT_TRUE((math::skew(v) + math::skew(v).transpose()).isZero());
}

TEST(So3, ExponentialTurnsByTheAngleAboutTheAxis) {
  std::mt19937_64 random(1);
  for (const double angle : kAngles) {
    const Vector3d axis = random_direction(random);
    const Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const Quaterniond q = math::exp_so3(angle * axis);
    EXPECT_NEAR(q.norm(), 1.0, 1e-15);
    EXPECT_LT((q.toRotationMatrix() - expected).norm(), 1e-14) << angle;
  }
}

TEST(So3, LogarithmInvertsTheExponential) {
  std::mt19937_64 random(2);
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d r = angle * random_direction(random);
      // The quaternion holds a tiny angle to full relative precision.
      EXPECT_LE((math::log_so3(math::exp_so3(r)) - r).norm(), 1e-14 * angle + (angle > 3.0 ? 1e-13 : 0.0))
          << angle;
    }
  }
}

TEST(So3, LogarithmIsThatOfTheRotationNotOfTheQuaternionsSign) {
  std::mt19937_64 random(3);
  for (const double angle : kAngles) {
    const Quaterniond q = math::exp_so3(angle * random_direction(random));
    const Quaterniond negative(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_TRUE(math::log_so3(negative).isApprox(math::log_so3(q), 1e-14)) << angle;
    EXPECT_LE(math::log_so3(q).norm(), M_PI + 1e-12);
  }
  EXPECT_NEAR(math::log_so3(math::exp_so3(4.0 * Vector3d::UnitX())).x(), 4.0 - 2.0 * M_PI, 1e-12);
}

TEST(So3, LeftJacobianInverseIsTheDerivativeOfTheLogarithm) {
  std::mt19937_64 random(4);
  for (const double angle : {0.0, 1e-8, 9e-4, 1.1e-3, 0.3, 1.5, 2.8}) {
    const Vector3d r = angle * random_direction(random);
    Matrix3d numeric;
    const double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      const Vector3d d = h * Vector3d::Unit(k);
      numeric.col(k) = (math::log_so3(math::exp_so3(d) * math::exp_so3(r)) -
                        math::log_so3(math::exp_so3(-d) * math::exp_so3(r))) /
                       (2.0 * h);
    }
    EXPECT_LT((math::left_jacobian_inverse(r) - numeric).norm(), 1e-8) << angle;
  }
}

}  // namespace
}  // namespace softarm
