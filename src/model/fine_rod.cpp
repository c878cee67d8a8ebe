#include "fine_rod.h"

#include <algorithm>
#include <cmath>

#include "arm/stiffness_profile.h"
#include "math/so3.h"
#include "rod/actuation.h"

namespace softarm::model {
namespace {

using rod::ParameterKind;

constexpr int kFewestPieces = 3;

/// The part of a profile that lies on a piece.
std::vector<arm::StiffnessKnot> profile_of(const std::vector<arm::StiffnessKnot>& whole, const Piece& piece) {
  if (whole.empty()) return {};
  const double width = piece.fraction_to - piece.fraction_from;
  std::vector<arm::StiffnessKnot> part{{0.0, arm::stiffness_factor(whole, piece.fraction_from)}};
  for (const arm::StiffnessKnot& knot : whole) {
    if (knot.fraction > piece.fraction_from + 1e-9 && knot.fraction < piece.fraction_to - 1e-9)
      part.push_back({(knot.fraction - piece.fraction_from) / width, knot.factor});
  }
  part.push_back({1.0, arm::stiffness_factor(whole, piece.fraction_to)});
  return part;
}

}  // namespace

FineRod::FineRod(const arm::Arm& arm, int pieces) {
  const rod::Rod coarse = rod::make_rod(arm);
  layout_ = coarse;
  layout_.segments.clear();
  double begin = 0.0;
  for (std::size_t i = 0; i < coarse.segments.size(); ++i) {
    const rod::Segment& segment = coarse.segments[i];
    const int count =
        pieces == 1
            ? 1
            : std::max(kFewestPieces,
                       static_cast<int>(std::lround(pieces * segment.rest_length_m / arm.total_length_m())));
    for (int k = 0; k < count; ++k) {
      Piece piece;
      piece.segment = static_cast<int>(i);
      piece.fraction_from = static_cast<double>(k) / count;
      piece.fraction_to = static_cast<double>(k + 1) / count;
      piece.s_from_m = begin + piece.fraction_from * segment.rest_length_m;
      piece.s_to_m = begin + piece.fraction_to * segment.rest_length_m;
      rod::Segment part = segment;
      const double share = piece.fraction_to - piece.fraction_from;
      part.rest_length_m = piece.s_to_m - piece.s_from_m;
      part.length_m = share * segment.length_m;
      part.mass_kg = share * segment.mass_kg;
      part.stiffness_profile = profile_of(segment.stiffness_profile, piece);
      if (k > 0) part.joint_compliance = 0.0;
      layout_.segments.push_back(part);
      pieces_.push_back(piece);
    }
    begin += segment.rest_length_m;
  }
  // The sum of the pieces is what counts as the rod's end.
  const double end = layout_.rest_length_m();
  pieces_.back().s_to_m = end;
  for (rod::PointLoad& load : layout_.loads) load.s_m = std::min(load.s_m, end);
  for (const Piece& piece : pieces_) {
    rod::PointLoad load;
    load.s_m = std::min(piece.s_to_m, end);
    layout_.loads.push_back(load);
  }

  for (int j = 0; j < static_cast<int>(pieces_.size()); ++j) {
    for (const ParameterKind kind : {ParameterKind::kBendingCompliance, ParameterKind::kTorsionalCompliance,
                                     ParameterKind::kAxialCompliance, ParameterKind::kShearCompliance,
                                     ParameterKind::kLength, ParameterKind::kSegmentMass})
      parameters_.push_back({kind, j, 0});
    if (pieces_[static_cast<std::size_t>(j)].fraction_from == 0.0)
      parameters_.push_back({ParameterKind::kJointCompliance, j, 0});
    for (const int axis : {0, 1, 2}) parameters_.push_back({ParameterKind::kMoment, j, axis});
    for (const int axis : {0, 1, 2}) parameters_.push_back({ParameterKind::kRestCurvature, j, axis});
    for (const int axis : {0, 1}) parameters_.push_back({ParameterKind::kBendingAnisotropy, j, axis});
  }
  for (int load = 0; load < static_cast<int>(layout_.loads.size()); ++load) {
    if (load < kFirstStation) {
      parameters_.push_back({ParameterKind::kLoadMass, load, 0});
      for (const int axis : {0, 1, 2}) parameters_.push_back({ParameterKind::kLoadOffset, load, axis});
    } else {
      for (const int axis : {0, 1, 2}) parameters_.push_back({ParameterKind::kLoadForce, load, axis});
    }
  }
  for (const ParameterKind kind : {ParameterKind::kGravity, ParameterKind::kBaseRotation}) {
    for (const int axis : {0, 1, 2}) parameters_.push_back({kind, 0, axis});
  }
}

void FineRod::actuate(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& predictions,
                      const std::vector<arm::SegmentPrediction>& moments, rod::Rod& rod) const {
  for (std::size_t j = 0; j < pieces_.size(); ++j) {
    const Piece& piece = pieces_[j];
    const auto i = static_cast<std::size_t>(piece.segment);
    const Eigen::Vector2d actuation_nm =
        moments[i].moment_nm + predictions[i].bending_stiffness_nm2 * moments[i].curvature_per_m;
    rod::Segment& to = rod.segments[j];
    rod::actuate(arm.segments[i], predictions[i], actuation_nm, piece.fraction_to - piece.fraction_from, to);
    to.mass_kg = layout_.segments[j].mass_kg;
    to.rest_curvature_per_m = arm.segments[i].rest_curvature_per_m;
    if (piece.fraction_from == 0.0)
      to.joint_compliance = arm.segments[i].joint_compliance_rad_per_nm.value_or(0.0);
  }
}

double FineRod::share(double s_m, int station) const {
  const double here = station_m(station);
  const double below = station > 0 ? station_m(station - 1) : 0.0;
  if (s_m > below && s_m <= here) return (s_m - below) / (here - below);
  if (station + 1 < stations()) {
    const double above = station_m(station + 1);
    if (s_m > here && s_m < above) return (above - s_m) / (above - here);
  } else if (s_m > here) {
    return 1.0;
  }
  return 0.0;
}

void FineRod::add_force(double s_m, const Eigen::Vector3d& force_n, rod::Rod& rod) const {
  for (int i = 0; i < stations(); ++i) {
    if (const double part = share(s_m, i); part > 0.0)
      rod.loads[static_cast<std::size_t>(kFirstStation + i)].force_n += part * force_n;
  }
}

Eigen::VectorXd FineRod::station_masses_kg(const rod::Rod& rod) const {
  const Eigen::Index n = stations();
  Eigen::VectorXd masses = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double half = 0.5 * rod.segments[static_cast<std::size_t>(j)].mass_kg;
    masses[j] += half;
    if (j > 0) masses[j - 1] += half;
  }
  masses[n - 1] += rod.loads[rod::kTipMassLoad].mass_kg;
  const rod::PointLoad& payload = rod.loads[rod::kPayloadLoad];
  for (int j = 0; j < stations(); ++j) masses[j] += share(payload.s_m, j) * payload.mass_kg;
  return masses;
}

Eigen::VectorXd FineRod::values(const rod::Rod& rod) const {
  Eigen::VectorXd v(static_cast<Eigen::Index>(parameters_.size()));
  values(rod, v);
  return v;
}

void FineRod::values(const rod::Rod& rod, Eigen::Ref<Eigen::VectorXd> v) const {
  Eigen::Index k = 0;
  const auto put = [&](const Eigen::Vector3d& of) {
    v.segment<3>(k) = of;
    k += 3;
  };
  // In the order of the constructor.
  for (std::size_t j = 0; j < pieces_.size(); ++j) {
    const rod::Segment& segment = rod.segments[j];
    for (const double value :
         {segment.bending_compliance, segment.torsional_compliance, segment.axial_compliance,
          segment.shear_compliance, segment.length_m, segment.mass_kg})
      v[k++] = value;
    if (pieces_[j].fraction_from == 0.0) v[k++] = segment.joint_compliance;
    put(segment.moment_nm);
    put(segment.rest_curvature_per_m);
    for (const int axis : {0, 1}) v[k++] = segment.anisotropy[axis];
  }
  for (std::size_t load = 0; load < rod.loads.size(); ++load) {
    if (static_cast<int>(load) < kFirstStation) {
      v[k++] = rod.loads[load].mass_kg;
      put(rod.loads[load].offset_m);
    } else {
      put(rod.loads[load].force_n);
    }
  }
  put(rod.gravity_m_s2);
  put(math::log_so3((rod.q_base * layout_.q_base.conjugate()).normalized()));
}

}  // namespace softarm::model
