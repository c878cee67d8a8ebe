#include "hidden_rod.h"

#include <cmath>

#include "point_loads.h"
#include "section_laws.h"
#include "stretch_laws.h"

namespace softarm::rig {
namespace {

constexpr double kRigid = 1e4;               // times the stiffness: the bending of a cap is not to be seen
constexpr double kStiffnessWithPlay = 50.0;  // N m / rad, of a base that has play but is not said to yield

/// 0 below 0, 1 above 1, with two continuous derivatives.
double smooth_step(double x) {
  if (x <= 0.0) return 0.0;
  return x >= 1.0 ? 1.0 : x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

double spot_ratio(const SoftSpot& spot, double fraction) {
  const double from_edge =
      0.5 - std::abs(fraction - spot.centre_fraction) / spot.width_fraction;  // of the width
  if (spot.bell)
    return from_edge > 0.0 ? 1.0 - 0.5 * spot.share * (1.0 - std::cos(2.0 * M_PI * from_edge)) : 1.0;
  return 1.0 - spot.share * smooth_step(4.0 * from_edge);
}

/// Whether a part belongs to an end cap.
bool is_cap(const Scenario& scenario, const Part& part) {
  if (!scenario.body.rigid_ends) return false;
  const double length_m = scenario.arm.length_m();
  return part.middle() * length_m < scenario.body.rigid_ends->base_m ||
         (1.0 - part.middle()) * length_m < scenario.body.rigid_ends->tip_m;
}

/// The part's bending stiffness over that of its segment for a joint that it is.
double joint_ratio(const Scenario& scenario, const Part& part) {
  const SegmentSpec& segment = scenario.arm.segments[part.segment];
  if (!segment.joint || (part.begin + 0.5 * part.share) * segment.length_m > segment.joint->length_m)
    return 1.0;
  return 1.0 /
         (1.0 + segment.stiffness_base_nm2 / (segment.joint->stiffness_nm_per_rad * segment.joint->length_m));
}

bool sections_differ(const BodySpec& body) {
  return body.stiffness_taper != 0.0 || body.actuation_taper != 0.0 || body.soft_spot || body.rigid_ends;
}

std::function<SectionRatios(double)> sections(const Scenario& scenario, const Part& part) {
  const BodySpec body = scenario.body;
  const bool cap = is_cap(scenario, part);
  const double joint = joint_ratio(scenario, part);
  // By the part's middle: its ends are the neighbours' as well.
  const double half = part.begin + 0.5 * part.share < 0.5 ? -1.0 : 1.0;
  return [body, part, cap, joint, half](double fraction) {
    const double within_segment = 2.0 * (part.begin + part.share * fraction) - 1.0;
    SectionRatios ratios;
    ratios.bending = 1.0 + body.stiffness_taper * (body.stiffness_steps ? half : within_segment);
    if (body.soft_spot)
      ratios.bending *=
          spot_ratio(*body.soft_spot, part.first_fraction + (part.fraction - part.first_fraction) * fraction);
    if (cap) ratios.bending *= kRigid;
    ratios.twist = ratios.bending;
    ratios.bending *= joint;
    ratios.actuation =
        cap ? 0.0 : joint * (1.0 + body.actuation_taper * (body.actuation_steps ? half : within_segment));
    return ratios;
  };
}

SectionLawPtr creep_law(const Creep& creep) {
  // Of the standard linear solid: curvature grows by `share` with the time `time_s` under a held moment.
  const double relaxing = creep.share / (1.0 + creep.share),
               relaxation_s = creep.time_s / (1.0 + creep.share);
  if (!creep.several_times) return maxwell_branches({{relaxing, relaxation_s}});
  std::vector<MaxwellBranch> branches;
  constexpr int kBranches = 5;
  for (int i = 0; i < kBranches; ++i)
    branches.push_back({relaxing / kBranches, relaxation_s * std::pow(10.0, i - kBranches / 2)});
  return maxwell_branches(branches);
}

std::vector<SectionLawPtr> laws(const BodySpec& body, const Part& part) {
  std::vector<SectionLawPtr> all;
  if (body.stiffening)
    all.push_back(body.stiffening->gent ? gent_stiffening(body.stiffening->beta_m2)
                                        : cubic_stiffening(body.stiffening->beta_m2));
  if (body.softening)
    all.push_back(body.softening->wrinkling
                      ? wrinkling_softening(body.softening->share, body.softening->knee_per_m)
                      : oval_softening(body.softening->share, body.softening->knee_per_m));
  if (body.creep) all.push_back(creep_law(*body.creep));
  if (body.hysteresis) all.push_back(bouc_wen(body.hysteresis->height_per_m, body.hysteresis->yield_per_m));
  if (body.first_loading)
    all.push_back(
        mullins(body.first_loading->share, body.first_loading->scale_per_m, body.first_loading->recovers));
  if (body.core) all.push_back(jammed_core({body.core->memory, body.core->yield_per_m, body.core->smooth}));
  if (body.plane_stiffness && part.middle() < body.plane_stiffness->to_fraction)
    all.push_back((body.plane_stiffness->gradual ? rib_stiffness : plane_stiffness)(
        body.plane_stiffness->azimuth_rad, body.plane_stiffness->share));
  if (body.one_sided_softness && part.middle() < body.one_sided_softness->to_fraction)
    all.push_back((body.one_sided_softness->gradual ? one_sided_folds : one_sided_softness)(
        body.one_sided_softness->azimuth_rad, body.one_sided_softness->share));
  return all;
}

/// What the part answers as a whole, where it is a stretch that does.
SectionLawPtr stretch_law(const BodySpec& body, const Part& part) {
  if (body.kink && body.kink->stretch.holds(part.middle())) return kink_law(*body.kink);
  if (body.joint_play && body.joint_play->stretch.holds(part.middle()))
    return joint_play_law(body.joint_play->play_rad);
  return nullptr;
}

/// Whether the part is a coupling of its own material.
bool is_coupling(const BodySpec& body, const Part& part) {
  return body.joint_play && body.joint_play->play_rad > 0.0 && body.joint_play->stretch.holds(part.middle());
}

Eigen::Vector3d towards(double azimuth_rad) {
  return {std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0};
}

RodLoad tether_load(const Tether& tether, double length_m, const Eigen::Vector3d& gravity, std::size_t tip) {
  const Eigen::Vector3d anchor =
      length_m * Eigen::Vector3d::UnitZ() + tether.anchor_distance_m * towards(tether.anchor_azimuth_rad);
  if (!tether.hose) return {spring_to(anchor, tether.stiffness_n_per_m), tip};
  return {hose_to(anchor, tether.anchor_distance_m + tether.slack_m, tether.stiffness_n_per_m,
                  tether.hose_kg * gravity),
          tip};
}

RodLoad wall_load(const Wall& wall, const Cut& cut) {
  constexpr double kPatchM = 0.02;  // of arm, whose stiffness against the rough wall is the wall's
  constexpr double kDampingSPerM = 1.0;
  Plane plane;
  plane.normal = std::cos(wall.inclination_rad) * towards(wall.azimuth_rad) +
                 std::sin(wall.inclination_rad) * Eigen::Vector3d::UnitZ();
  plane.distance_m = wall.distance_m;
  if (!wall.everywhere) return {spring_wall(plane, wall.stiffness_n_per_m), cut.ending_at(wall.fraction)};
  if (wall.post_radius_m > 0.0) {
    constexpr double kDragSPerM = 1.0;
    const Eigen::Vector2d centre =
        (wall.distance_m + wall.post_radius_m) * towards(wall.azimuth_rad).head<2>();
    return {
        round_post({centre, wall.post_radius_m, wall.stiffness_n_per_m / kPatchM, wall.friction, kDragSPerM}),
        std::nullopt};
  }
  return {rough_wall({plane, wall.stiffness_n_per_m / kPatchM, kDampingSPerM, wall.friction}), std::nullopt};
}

/// Mass of the part, its taper, and what of the lump is at its end.
void distribute_mass(const Scenario& scenario, const Cut& cut, RitzRodParams& params) {
  const BodySpec& body = scenario.body;
  double lump_kg = 0.0;
  for (std::size_t j = 0; j < cut.parts.size(); ++j) {
    const Part& part = cut.parts[j];
    RodPiece& piece = params.pieces[j];
    if (body.mass_taper != 0.0) {
      const double mean = 1.0 + body.mass_taper * (2.0 * part.begin + part.share - 1.0);
      piece.mass_kg *= mean;
      piece.mass_slope = body.mass_taper * part.share / mean;
    }
    if (body.mass_lump) {
      lump_kg += body.mass_lump->share * piece.mass_kg;
      piece.mass_kg *= 1.0 - body.mass_lump->share;
    }
  }
  if (body.mass_lump) params.pieces[cut.ending_at(body.mass_lump->fraction)].end_mass_kg = lump_kg;
}

}  // namespace

std::vector<double> hidden_places(const Scenario& scenario) {
  const BodySpec& body = scenario.body;
  const double length_m = scenario.arm.length_m();
  std::vector<double> places;
  if (body.rigid_ends) {
    places.push_back(body.rigid_ends->base_m / length_m);
    places.push_back(1.0 - body.rigid_ends->tip_m / length_m);
  }
  if (body.soft_spot) {
    places.push_back(body.soft_spot->centre_fraction - 0.5 * body.soft_spot->width_fraction);
    places.push_back(body.soft_spot->centre_fraction + 0.5 * body.soft_spot->width_fraction);
  }
  double begin_m = 0.0;
  for (const SegmentSpec& segment : scenario.arm.segments) {
    if (segment.joint) places.push_back((begin_m + segment.joint->length_m) / length_m);
    if (body.stiffness_steps || body.actuation_steps)
      places.push_back((begin_m + 0.5 * segment.length_m) / length_m);
    begin_m += segment.length_m;
  }
  if (body.mass_lump) places.push_back(body.mass_lump->fraction);
  if (body.plane_stiffness) places.push_back(body.plane_stiffness->to_fraction);
  if (body.one_sided_softness) places.push_back(body.one_sided_softness->to_fraction);
  if (body.wall && !body.wall->everywhere) places.push_back(body.wall->fraction);
  for (const Stretch& stretch : body.stretches()) {
    places.push_back(stretch.from);
    places.push_back(stretch.to);
  }
  if (scenario.input_path.tendon_friction) {
    // The moment of rubbing tendons falls along a segment, here in steps.
    constexpr int kSteps = 4;
    double begin = 0.0;
    for (const SegmentSpec& segment : scenario.arm.segments) {
      const double share = segment.length_m / length_m;
      for (int k = 1; k < kSteps; ++k) places.push_back(begin + share * k / kSteps);
      begin += share;
    }
  }
  return places;
}

void hide_in_rod(const Scenario& scenario, const Cut& cut, RitzRodParams& params) {
  const BodySpec& body = scenario.body;
  for (std::size_t j = 0; j < cut.parts.size(); ++j) {
    if (sections_differ(body) || joint_ratio(scenario, cut.parts[j]) != 1.0)
      params.pieces[j].sections = sections(scenario, cut.parts[j]);
    if (!is_coupling(body, cut.parts[j])) params.pieces[j].laws = laws(body, cut.parts[j]);
    params.pieces[j].stretch = stretch_law(body, cut.parts[j]);
  }
  distribute_mass(scenario, cut, params);
  params.tip_mass_kg += body.tip_mass_kg;

  params.base_stiffness_nm_per_rad = body.base_stiffness_nm_per_rad;
  params.base_play_rad = body.base_play_rad;
  params.base_bush = body.base_bush;
  if (body.base_play_rad > 0.0 && !body.base_stiffness_nm_per_rad)
    params.base_stiffness_nm_per_rad = kStiffnessWithPlay;
  const double tilt = body.base_tilt_rad.norm();
  if (tilt > 0.0) params.base_attitude = Eigen::AngleAxisd(tilt, body.base_tilt_rad / tilt);
  const double off = body.gravity_tilt_rad.norm();
  if (off > 0.0) {
    Eigen::Vector3d gravity_mocap;
    gravity_mocap << std::sin(off) / off * body.gravity_tilt_rad, -std::cos(off);
    params.gravity_base_m_s2 =
        scenario.mount.q_mocap_base.conjugate() * (scenario.gravity_m_s2 * gravity_mocap);
  }

  params.payload_offset_section_m = body.payload_offset_m;
  if (body.tether)
    params.loads.push_back(
        tether_load(*body.tether, scenario.arm.length_m(), params.gravity_base_m_s2, cut.parts.size() - 1));
  if (body.wall) params.loads.push_back(wall_load(*body.wall, cut));
  params.draught_grows = body.draught && body.draught->sheltered;
}

}  // namespace softarm::rig
