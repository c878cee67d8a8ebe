#include "arm_cut.h"

#include <algorithm>
#include <cmath>

#include "hidden_rod.h"

namespace softarm::rig {
namespace {

constexpr double kSame = 1e-6;          // of the length: a payload there hangs at the segment's end
constexpr double kLeastPart = 2e-3;     // of the length: what is hidden cuts no smaller piece
constexpr double kElementsAtWall = 7;   // times as many, for where the arm lifts off lies between stations
constexpr double kElementsOfCore = 2;   // times as many: six a segment with the defaults
constexpr double kElementsOfYield = 4;  // likewise, for where a core begins to slip its curvature has a kink
constexpr int kSoftSpotElements = 8;    // two for each of its edges

/// The fractions within ]from, to[ where a segment is cut, ascending.
std::vector<double> cuts_within(const Scenario& scenario, double from, double to) {
  std::vector<double> cuts;
  const double payload = scenario.payload.schedule.empty() ? 1.0 : scenario.payload.fraction;
  if (payload - from > kSame * (to - from) && to - payload > kSame * (to - from)) cuts.push_back(payload);
  const std::vector<Stretch> whole = scenario.body.stretches();
  for (double place : hidden_places(scenario)) {
    if (std::any_of(whole.begin(), whole.end(), [place](const Stretch& s) { return s.holds(place); }))
      continue;
    const auto same = [place](double cut) { return std::abs(place - cut) < kLeastPart; };
    if (place > from && place < to && !same(from) && !same(to) &&
        std::none_of(cuts.begin(), cuts.end(), same))
      cuts.push_back(place);
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// How many times as many elements what is hidden needs.
double finer(const Scenario& scenario) {
  const BodySpec& body = scenario.body;
  if (body.wall && body.wall->everywhere) return kElementsAtWall;
  if (!core_slips(scenario)) return 1;
  return body.core->smooth ? kElementsOfCore : kElementsOfYield;
}

}  // namespace

bool core_slips(const Scenario& scenario) {
  const auto& core = scenario.body.core;
  return core && core->yield_per_m > 0.0 && core->yield_per_m * scenario.arm.length_m() < 2.0 * M_PI;
}

std::size_t Cut::ending_at(double fraction) const {
  const auto further = [fraction](const Part& a, const Part& b) {
    return std::abs(a.fraction - fraction) < std::abs(b.fraction - fraction);
  };
  return static_cast<std::size_t>(std::min_element(parts.begin(), parts.end(), further) - parts.begin());
}

Cut cut_arm(const Scenario& scenario) {
  const double length_m = scenario.arm.length_m();
  Cut cut;
  double begin = 0.0;
  for (std::size_t i = 0; i < scenario.arm.segments.size(); ++i) {
    const double share = scenario.arm.segments[i].length_m / length_m;
    std::vector<double> ends = cuts_within(scenario, begin, begin + share);
    ends.push_back(begin + share);
    double from = 0.0;
    for (double end : ends) {
      const double to = end == ends.back() ? 1.0 : (end - begin) / share;
      Part part{i, from, to - from, begin + from * share, begin + to * share};
      if (part.share < 1.0) part.least_elements = part.share < 0.12 ? 1 : 2;
      if (scenario.body.soft_spot && std::abs(part.middle() - scenario.body.soft_spot->centre_fraction) <
                                         0.5 * scenario.body.soft_spot->width_fraction)
        part.least_elements = kSoftSpotElements;
      cut.parts.push_back(part);
      from = to;
    }
    begin += share;
  }
  cut.payload_part = cut.ending_at(scenario.payload.schedule.empty() ? 1.0 : scenario.payload.fraction);
  return cut;
}

RitzRodParams rod_params(const Scenario& scenario, const Cut& cut) {
  RitzRodParams params;
  params.pieces.clear();
  for (const Part& part : cut.parts) {
    const SegmentSpec& segment = scenario.arm.segments[part.segment];
    RodPiece piece;
    piece.elements = part.share < 1.0
                         ? std::max(part.least_elements,
                                    static_cast<int>(std::ceil(scenario.numerics.elements * part.share)))
                         : scenario.numerics.elements;
    piece.elements = static_cast<int>(std::ceil(piece.elements * finer(scenario)));
    piece.share = part.share * segment.length_m / scenario.arm.length_m();
    piece.mass_kg = part.share * segment.mass_kg;
    piece.diameter_m = segment.diameter_m;
    piece.retardation_s = segment.retardation_s;
    params.pieces.push_back(piece);
  }
  params.payload_piece = cut.payload_part;
  params.tip_mass_kg = scenario.arm.tip_mass_kg;
  params.air_damping_n_s_m2 = scenario.arm.air_damping_n_s_m2;
  params.gravity_base_m_s2 =
      scenario.mount.q_mocap_base.conjugate() * Eigen::Vector3d(0.0, 0.0, -scenario.gravity_m_s2);
  params.kinked = core_slips(scenario);
  hide_in_rod(scenario, cut, params);
  return params;
}

std::vector<PieceInputs> piece_inputs(const Cut& cut, const std::vector<Actuation>& actuation) {
  std::vector<PieceInputs> pieces;
  for (const Part& part : cut.parts) {
    const Actuation& a = actuation[part.segment];
    PieceInputs piece;
    piece.length_m = part.share * a.length_m;
    piece.bending_stiffness_nm2 = a.bending_stiffness_nm2;
    piece.torsional_stiffness_nm2 = a.torsional_stiffness_nm2;
    // Bending towards phi is a turn about the axis at phi + 90 degrees.
    const Eigen::Vector2d moment_nm =
        a.moment_nm + (part.begin + 0.5 * part.share - 0.5) * a.moment_change_nm;
    piece.moment_section_nm = {-moment_nm.y(), moment_nm.x(), a.twist_moment_nm};
    piece.shear_stiffness_n = a.shear_stiffness_n;
    piece.axial_stiffness_n = a.axial_stiffness_n;
    piece.core_stiffness_nm2 = a.core_stiffness_nm2;
    pieces.push_back(piece);
  }
  return pieces;
}

}  // namespace softarm::rig
