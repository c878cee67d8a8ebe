#include "truth_csv.h"

#include <fmt/format.h>

#include <cmath>

namespace softarm::rig {

void write_truth_header(std::ostream& out, const Scenario& scenario) {
  std::string line = "stamp,M0,phi,EI,L,payload,payload_steadied,theta_tip,tip_x,tip_y,tip_z,Mx,My,vacuum";
  for (int i = 1; i <= scenario.arm.chambers; ++i) line += fmt::format(",P_{}", i);
  for (std::size_t i = 1; i <= scenario.mocap.ring_fractions.size(); ++i)
    line += fmt::format(",ring_{0}_x,ring_{0}_y,ring_{0}_z", i);
  for (int i = 1; i <= scenario.arm.tendons; ++i) line += fmt::format(",T_{}", i);
  for (int i = 1; i <= scenario.arm.servos; ++i) line += fmt::format(",angle_{}", i);
  for (std::size_t i = 2; i <= scenario.arm.segments.size(); ++i)
    line += fmt::format(",M0_{0},phi_{0},EI_{0},L_{0},Mx_{0},My_{0}", i);
  out << line << '\n';
}

void write_truth_row(std::ostream& out, const Truth& truth, double epoch_s) {
  // + 0.0 turns a negative zero into zero.
  const auto segment = [](const SegmentTruth& s) {
    const Eigen::Vector2d& m = s.moment_nm;
    return fmt::format("{},{},{},{}", m.norm(), std::atan2(m.y(), m.x()) + 0.0, s.bending_stiffness_nm2,
                       s.length_m);
  };
  const auto moment = [](const SegmentTruth& s) {
    return fmt::format("{},{}", s.moment_nm.x() + 0.0, s.moment_nm.y() + 0.0);
  };
  const SegmentTruth& first = truth.segments.front();
  const Eigen::Vector3d& tip = truth.tip_base.p;
  // Nanoseconds, like the stamps of the recording.
  std::string line =
      fmt::format("{:.9f},{},{},{:d},{},{},{},{},{},{}", epoch_s + truth.stamp_s, segment(first),
                  truth.payload_kg, static_cast<int>(truth.payload_steadied), truth.tip_angle_rad,
                  tip.x() + 0.0, tip.y() + 0.0, tip.z() + 0.0, moment(first), truth.vacuum_pa);
  for (double p : truth.pressures_pa) line += fmt::format(",{}", p);
  for (const Pose& ring : truth.rings_base)
    line += fmt::format(",{},{},{}", ring.p.x() + 0.0, ring.p.y() + 0.0, ring.p.z() + 0.0);
  for (double t : truth.tensions_n) line += fmt::format(",{}", t);
  for (double a : truth.angles_rad) line += fmt::format(",{}", a);
  for (std::size_t i = 1; i < truth.segments.size(); ++i)
    line += fmt::format(",{},{}", segment(truth.segments[i]), moment(truth.segments[i]));
  out << line << '\n';
}

}  // namespace softarm::rig
