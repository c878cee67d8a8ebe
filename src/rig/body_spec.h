// What is hidden in the body of the arm: material, boundary, loads. Zero or absent: the arm is ideal.
//
// A fraction is one of the arm's length at zero input, from base to tip; an azimuth is one of the base frame
// (of the section, for what turns with the arm), 0 along x.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace softarm::rig {

/// EI is lower by a share within width_fraction about a centre, with smooth edges: a quarter of it each.
/// Bell: by that share at the centre alone, from which it fades as a cosine does.
struct SoftSpot {
  double centre_fraction = 0.5, width_fraction = 0.15, share = 0.0;
  bool bell = false;
};

/// End caps that do not bend and that no chamber acts on.
struct RigidEnds {
  double base_m = 0.0, tip_m = 0.0;
};

/// A share of the mass of every segment's is gathered at a place.
struct MassLump {
  double share = 0.0, fraction = 0.5;
};

/// M = EI u (1 + beta u^2), or Gent's law with the same beta: EI u / (1 - beta u^2).
struct Stiffening {
  double beta_m2 = 0.0;
  bool gent = false;
};

/// Under a held moment the curvature grows by a share, with one time constant or with several a decade apart.
struct Creep {
  double share = 0.0, time_s = 20.0;
  bool several_times = false;
};

/// Hysteresis of the material: adds EI height z, z the Bouc-Wen variable (between -1 and 1) that follows the
/// curvature with the yield curvature.
struct MaterialHysteresis {
  double height_per_m = 0.0, yield_per_m = 1.0;
};

/// Stiffer by a share where the material has not been bent so far yet.
struct FirstLoading {
  double share = 0.0, scale_per_m = 2.0;
  bool recovers = true;  ///< the stiffness comes back near the largest curvature
};

/// The jammed core's part of the bending stiffness.
struct JammedCore {
  double memory = 0.0;       ///< of the curvature at which it was jammed
  double yield_per_m = 0.0;  ///< elastic curvature at which it slips; 0: never
  bool smooth = false;
};

/// A stiffness that depends on the direction of bending, from the base up to a fraction.
struct SideStiffness {
  double azimuth_rad = 0.0, share = 0.0, to_fraction = 1.0;
  bool gradual = false;  ///< ribs that give way, a wall that folds bit by bit
};

/// At the tip, to an anchor beside the straight tip.
struct Tether {
  double stiffness_n_per_m = 0.0, anchor_azimuth_rad = 0.0, anchor_distance_m = 0.0;
  bool hose = false;  ///< pulls only when taut; half of its weight hangs at the tip
  double slack_m = 0.0, hose_kg = 0.0;
};

/// A wall beside the straight arm, distance_m from its axis towards an azimuth; inclined by 90 degrees it is
/// a floor at that distance from the base.
struct Wall {
  double stiffness_n_per_m = 0.0, distance_m = 0.03, azimuth_rad = 0.0;
  double fraction = 0.7;  ///< where alone the arm touches it, as a spring; see everywhere
  bool everywhere = false;
  double inclination_rad = 0.0, friction = 0.0;  ///< everywhere only
  double post_radius_m = 0.0;  ///< no plane, but a round post along the straight arm; everywhere only
};

/// A part of what is beyond a knee of the curvature meets nothing. Wrinkling: from the knee on the moment
/// goes to twice what it has there; else, oval: EI falls by a share, half of it at the knee.
struct Softening {
  double share = 0.0, knee_per_m = 1.0;
  bool wrinkling = false;
};

/// A short piece of the arm, from a fraction to a fraction.
struct Stretch {
  double from = 0.0, to = 0.0;
  bool holds(double fraction) const { return fraction > from && fraction < to; }
};

/// The wall of a stretch folds where it is bent to a curvature: then it is softer by a share in the plane in
/// which it was bent, until it is bent back to another curvature.
struct Kink {
  Stretch stretch;
  double share = 0.0, fold_per_m = 4.0, unfold_per_m = 2.4;
};

/// A coupling that turns freely so far to every side, where it holds. The stretch is what it takes the place
/// of, and gives way as that did.
struct JointPlay {
  Stretch stretch;
  double play_rad = 0.0;
};

/// Moving air: a force per length across the arm, horizontal, at random with a mean of nothing. An evenly
/// stiff arm would bend as far by force_n across its tip, root of the mean square.
struct Draught {
  double force_n = 0.0, correlation_s = 3.0;
  bool sheltered = false;  ///< nothing at the base, from where it grows with the way along the arm
};

struct BodySpec {
  double stiffness_taper = 0.0, actuation_taper = 0.0;    ///< a of 1 + a (2 s / L - 1), in each segment
  bool stiffness_steps = false, actuation_steps = false;  ///< 1 - a up to its middle, 1 + a beyond, instead
  double mass_taper = 0.0;
  std::optional<SoftSpot> soft_spot;
  std::optional<RigidEnds> rigid_ends;
  std::optional<MassLump> mass_lump;
  std::optional<Stiffening> stiffening;
  std::optional<Softening> softening;
  std::optional<Creep> creep;
  std::optional<MaterialHysteresis> hysteresis;
  std::optional<FirstLoading> first_loading;
  std::optional<JammedCore> core;
  std::optional<SideStiffness> plane_stiffness, one_sided_softness;
  std::optional<Kink> kink;
  std::optional<JointPlay> joint_play;

  /// The base turns under the load, though the measured body `base` does not: bending moment there over this.
  std::optional<double> base_stiffness_nm_per_rad;
  double base_play_rad = 0.0;  ///< so far it turns freely
  bool base_bush = false;      ///< of the play: in a bush, whose stop yields as Hertz's contact does
  Eigen::Vector3d base_tilt_rad = Eigen::Vector3d::Zero();     ///< rotation vector in the base frame
  Eigen::Vector2d gravity_tilt_rad = Eigen::Vector2d::Zero();  ///< towards x and y of the mocap frame
  Eigen::Vector3d payload_offset_m = Eigen::Vector3d::Zero();  ///< in the section frame
  double tip_mass_kg = 0.0;
  std::optional<Tether> tether;
  std::optional<Wall> wall;
  std::optional<Draught> draught;

  /// Those that answer as a whole: nothing else cuts them.
  std::vector<Stretch> stretches() const {
    std::vector<Stretch> all;
    if (kink) all.push_back(kink->stretch);
    if (joint_play) all.push_back(joint_play->stretch);
    return all;
  }
};

}  // namespace softarm::rig
