#include "cable_model.h"

#include <fmt/format.h>

#include <cmath>

namespace softarm::app::validate {
namespace {

constexpr double kStiffnessNm2 = 0.007;
constexpr double kSmallestLoadKg = 0.01463, kLargestTipLoadKg = 0.02921;

}  // namespace

/// Their plane: x along the clamped tangent, y downwards. The arm's base frame: z along, x upwards.
published::CableArm cable_paper_arm(double stiffness_nm2, double pwm, double load_kg,
                                    double load_arclength_m) {
  const published::CableDrive drive;
  published::CableArm arm;
  arm.bending_stiffness_nm2 = stiffness_nm2;
  arm.length_m = kCableLengthM;
  arm.curvature_per_m = -published::curvature_per_m(drive, *published::cable_change_m(drive, pwm));
  arm.load_n = kGravity * load_kg;
  arm.load_arclength_m = load_arclength_m;
  return arm;
}

/// Their model at the marks, base frame.
std::vector<Eigen::Vector3d> cable_paper_shape(const published::CableArm& arm, published::CableLaw law,
                                               const arm::Arm& marks) {
  const published::CableShape shape = solve_cable(arm, law);
  std::vector<Eigen::Vector3d> points;
  if (shape.status != rod::SolveStatus::kConverged) return points;
  for (const arm::MeasuredBody& body : marks.bodies) {
    Eigen::Index i = 1;
    while (i + 1 < shape.s_m.size() && shape.s_m[i] < body.arclength_m) ++i;
    const double share = (body.arclength_m - shape.s_m[i - 1]) / (shape.s_m[i] - shape.s_m[i - 1]);
    const Eigen::Vector2d p = (1.0 - share) * shape.p_m.col(i - 1) + share * shape.p_m.col(i);
    points.emplace_back(-p.y(), 0.0, p.x());
  }
  return points;
}

Table cable_arithmetic() {
  Table table{"cable.arithmetic", "Does EI = 0.007 Pa m4 go with these loads?", {"ours"}, {}, {}};
  const auto add = [&](const std::string& what, Cell ours, const std::string& remark) {
    table.rows.push_back({what, "", {std::move(ours)}, remark});
  };
  for (double kg : {kCableFittingLoadKg, kSmallestLoadKg, kLargestTipLoadKg}) {
    const double deflection = kGravity * kg * std::pow(kCableLengthM, 3) / (3.0 * kStiffnessNm2);
    add(fmt::format("F L^3 / (3 EI), {:.2f} g at the tip (mm)", 1e3 * kg), cell("{:.0f}", 1e3 * deflection),
        fmt::format("{:.0f} % of the length: plainly visible", 100.0 * deflection / kCableLengthM));
  }
  const double inertia = M_PI / 4.0 * (std::pow(0.010, 4) - std::pow(0.0075, 4));
  add("E of the tube (MPa)", cell("{:.2f}", kStiffnessNm2 / inertia / 1e6),
      fmt::format("EI / I, I = pi/4 (10^4 - 7.5^4) = {:.0f} mm4: latex. The printed EI is plausible",
                  1e12 * inertia));
  add("EI that 14.63 g would bend by 1 % of L",
      cell("{:.3f}", kGravity * kSmallestLoadKg * kCableLengthM * kCableLengthM / 0.03),
      "N m2; only above that would the loads be invisible");
  add("own weight over the largest load", cell("{:.2f}", 0.128 * kCableLengthM / kCableFittingLoadKg),
      "30 g of tube (estimated: 0.93 g/cm3) against 39.2 g: (7) leaves it out");
  const published::CableDrive drive;
  add("bend without load at PWM 1665 (deg)",
      cell("{:.0f}", 180.0 / M_PI * kCableLengthM *
                         published::curvature_per_m(drive, *published::cable_change_m(drive, 1665.0))),
      "(5) with (15), the angle counted from PWM 1365");
  return table;
}

}  // namespace softarm::app::validate
