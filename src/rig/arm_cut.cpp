#include "arm_cut.h"

#include <algorithm>
#include <cmath>

namespace softarm::rig {

Cut cut_arm(const Scenario& scenario) {
  constexpr double kSame = 1e-6;  // of the length
  const double length_m = scenario.arm.length_m();
  const double payload = scenario.payload.schedule.empty() ? 1.0 : scenario.payload.fraction;
  Cut cut;
  double begin = 0.0;
  for (std::size_t i = 0; i < scenario.arm.segments.size(); ++i) {
    const double share = scenario.arm.segments[i].length_m / length_m;
    const double first = std::clamp((payload - begin) / share, 0.0, 1.0);
    if (first > kSame && first < 1.0 - kSame) {
      cut.parts.push_back({i, first});
      cut.payload_part = cut.parts.size() - 1;
      cut.parts.push_back({i, 1.0 - first});
    } else {
      cut.parts.push_back({i, 1.0});
      if (first > 0.5) cut.payload_part = cut.parts.size() - 1;
    }
    begin += share;
  }
  return cut;
}

RitzRodParams rod_params(const Scenario& scenario, const Cut& cut) {
  RitzRodParams params;
  params.pieces.clear();
  for (const Part& part : cut.parts) {
    const SegmentSpec& segment = scenario.arm.segments[part.segment];
    RodPiece piece;
    piece.elements = part.share < 1.0
                         ? std::max(2, static_cast<int>(std::ceil(scenario.numerics.elements * part.share)))
                         : scenario.numerics.elements;
    piece.share = part.share * segment.length_m / scenario.arm.length_m();
    piece.mass_kg = part.share * segment.mass_kg;
    piece.diameter_m = segment.diameter_m;
    piece.retardation_s = segment.retardation_s;
    params.pieces.push_back(piece);
  }
  params.payload_piece = cut.payload_part;
  params.tip_mass_kg = scenario.arm.tip_mass_kg;
  params.air_damping_n_s_m2 = scenario.arm.air_damping_n_s_m2;
  params.base_stiffness_nm_per_rad = scenario.body.base_stiffness_nm_per_rad;
  params.gravity_base_m_s2 =
      scenario.mount.q_mocap_base.conjugate() * Eigen::Vector3d(0.0, 0.0, -scenario.gravity_m_s2);
  return params;
}

}  // namespace softarm::rig
