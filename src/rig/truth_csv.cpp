#include "softarm/rig/truth_csv.h"

#include <fmt/format.h>

#include <cmath>

namespace softarm::rig {

void write_truth_header(std::ostream& out, const Scenario& scenario) {
  std::string line = "stamp,M0,phi,EI,L,payload,payload_steadied,theta_tip,tip_x,tip_y,tip_z,Mx,My,vacuum";
  for (std::size_t i = 1; i <= scenario.arm.chambers.size(); ++i) line += fmt::format(",P_{}", i);
  for (std::size_t i = 1; i <= scenario.mocap.ring_fractions.size(); ++i)
    line += fmt::format(",ring_{0}_x,ring_{0}_y,ring_{0}_z", i);
  out << line << '\n';
}

void write_truth_row(std::ostream& out, const Truth& truth, double epoch_s) {
  const Eigen::Vector2d& m = truth.moment_nm;
  const Eigen::Vector3d& tip = truth.tip_base.p;
  // Nanoseconds, like the stamps of the recording; + 0.0 turns a negative zero into zero.
  std::string line =
      fmt::format("{:.9f},{},{},{},{},{},{:d},{},{},{},{},{},{},{}", epoch_s + truth.stamp_s, m.norm(),
                  std::atan2(m.y(), m.x()) + 0.0, truth.bending_stiffness_nm2, truth.length_m,
                  truth.payload_kg, static_cast<int>(truth.payload_steadied), truth.tip_angle_rad,
                  tip.x() + 0.0, tip.y() + 0.0, tip.z() + 0.0, m.x() + 0.0, m.y() + 0.0, truth.vacuum_pa);
  for (double p : truth.pressures_pa) line += fmt::format(",{}", p);
  for (const Pose& ring : truth.rings_base)
    line += fmt::format(",{},{},{}", ring.p.x() + 0.0, ring.p.y() + 0.0, ring.p.z() + 0.0);
  out << line << '\n';
}

}  // namespace softarm::rig
