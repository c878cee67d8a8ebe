// Transforms, the base and its attitude.
#include <fmt/format.h>

#include <cmath>

#include "arm_parts.h"

namespace softarm::arm::yaml {
namespace {

constexpr double kRadPerDeg = M_PI / 180.0;
/// Four decimals are what people write; a larger error is a wrong number rather than rounding.
constexpr double kUnitNormTolerance = 1e-3;

Eigen::Quaterniond read_rotation(const Section& section) {
  if (section.has("quaternion_xyzw") && section.has("rpy_deg")) {
    section.fail("rpy_deg", "is given beside quaternion_xyzw; give one rotation only");
  }
  if (section.has("quaternion_xyzw")) {
    const Eigen::Vector4d xyzw = section.vector("quaternion_xyzw");
    if (!(std::abs(xyzw.norm() - 1.0) <= kUnitNormTolerance)) {
      section.fail_value("quaternion_xyzw",
                         fmt::format("has norm {:.4g}, outside the allowed range [{}, {}]", xyzw.norm(),
                                     1 - kUnitNormTolerance, 1 + kUnitNormTolerance));
    }
    return Eigen::Quaterniond(xyzw(3), xyzw(0), xyzw(1), xyzw(2)).normalized();
  }
  if (section.has("rpy_deg")) {
    const Eigen::Vector3d rpy = section.vector("rpy_deg") * kRadPerDeg;
    return Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX());
  }
  return Eigen::Quaterniond::Identity();
}

/// Rod frame (z: tangent, x: phi = 0) of an attitude named relative to gravity. The bending direction phi = 0
/// is the mocap frame's x for upright arms, and upwards for horizontal ones.
Eigen::Matrix3d attitude_rotation(const std::string& attitude, const Eigen::Vector3d& gravity_m_s2) {
  const Eigen::Vector3d down = gravity_m_s2.normalized();
  // Gravity may lie along x; then y serves as the horizontal reference.
  const Eigen::Vector3d reference =
      std::abs(down.x()) > 0.9 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d level = (reference - reference.dot(down) * down).normalized();
  Eigen::Vector3d x = level;
  Eigen::Vector3d z = down;
  if (attitude == "standing") z = -down;
  if (attitude == "horizontal") {
    z = level;
    x = -down;
  }
  Eigen::Matrix3d rotation;
  rotation << x, z.cross(x), z;
  return rotation;
}

Eigen::Isometry3d read_fixed(const Section& section, const Eigen::Vector3d& gravity_m_s2) {
  Eigen::Isometry3d pose = read_transform(section);
  if (!section.has("attitude")) return pose;
  if (section.has("quaternion_xyzw") || section.has("rpy_deg")) {
    section.fail("attitude", "is given beside a rotation; give one of them only");
  }
  const std::string attitude = section.word("attitude");
  if (gravity_m_s2.isZero(0.0)) {
    section.fail_value("attitude", "has no meaning without gravity; give quaternion_xyzw or rpy_deg");
  }
  pose.linear() = attitude_rotation(attitude, gravity_m_s2);
  return pose;
}

}  // namespace

Eigen::Isometry3d read_transform(const Section& section) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = read_rotation(section).toRotationMatrix();
  transform.translation() = Eigen::Vector3d(section.vector("position_m"));
  return transform;
}

Base read_base(const Section& section, const Eigen::Vector3d& gravity_m_s2) {
  Base base;
  if (section.has("body") == section.has("fixed")) {
    section.fail("body", section.has("body") ? "is given beside fixed; a base is either measured or fixed"
                                             : "is missing; give the measured body of the base, or fixed");
  }
  if (section.has("fixed")) {
    for (const char* const key : {"rod_in_body", "labelled_markers", "hold_last"}) {
      if (section.has(key)) section.fail(key, "applies to a base with a body only");
    }
    base.fixed_pose = read_fixed(section.section("fixed", fixed_base_keys()), gravity_m_s2);
    return base;
  }
  base.body = section.name("body", "/");
  base.rod_in_body = read_transform(section.section("rod_in_body", transform_keys()));
  base.labelled_markers = read_labelled_markers(section);
  base.hold_last = section.flag("hold_last");
  return base;
}

}  // namespace softarm::arm::yaml
