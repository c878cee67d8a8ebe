// The measured shape of an arm against its laws, as displacements of its bodies.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "softarm/estimate/estimator.h"
#include "softarm/rod/rod.h"

namespace softarm::monitor {

/// Displacements of all bodies of the arm, three rows each, base frame, m.
using Displacements = Eigen::VectorXd;

/// One frame's shape, cut into the pieces between the points of its backbone, and what the laws make of it.
/// Displacements are to first order: a curvature that differs by dk over a piece turns all that is beyond.
class MonitorShape {
 public:
  explicit MonitorShape(const arm::Arm& arm);

  /// Takes the shape of an estimate (five or more points of backbone).
  void set(const estimate::Estimate& estimate);
  /// Measured less predicted place of each body that was measured; others keep their value.
  /// @param predictions null: only the residual of the fit
  void discrepancy(const std::vector<arm::SegmentPrediction>* predictions, Displacements& e);

  // Displacements per unit of what may be wrong, at the shape and the predictions of the last discrepancy().

  /// By a curvature (1/m) of a segment about x or y of its sections (axis 0, 1), scaled by the profile.
  void by_curvature(int segment, int axis, Eigen::Ref<Displacements> out) const;
  /// By a relative change of the flexibility of a segment, of the load's share alone.
  void by_flexibility(int segment, Eigen::Ref<Displacements> out) const;
  /// By a change of a segment's length (m).
  void by_length(int segment, Eigen::Ref<Displacements> out) const;
  /// By the payload (kg).
  void by_payload(Eigen::Ref<Displacements> out) const;
  /// By inertia at these accelerations of the bodies (m/s^2; three rows each), linear between them.
  /// @param usable whether a body's acceleration is known
  void by_inertia(const Displacements& acceleration, const std::vector<char>& usable,
                  Eigen::Ref<Displacements> out) const;
  /// By a force (N, base frame) at an arclength.
  void by_force(double s_m, const Eigen::Vector3d& force, Eigen::Ref<Displacements> out) const;

  double arclength_m(int body) const { return body_s_[static_cast<std::size_t>(body)]; }
  int bodies() const { return static_cast<int>(body_s_.size()); }
  /// Section frame at a body: columns are its axes in the base frame.
  Eigen::Matrix3d section(int body) const;
  Eigen::Vector3d place(int body) const { return bodies_[static_cast<std::size_t>(body)]; }
  Eigen::Vector3d place_at(double s_m) const;
  Eigen::Matrix3d section_at(double s_m) const;
  double length_m() const { return length_m_; }

 private:
  struct Piece {
    int segment = 0;
    double ds = 0.0;          // at zero input
    double factor = 1.0;      // 1 / profile
    double weight_kg = 0.0;   // of the arm itself
    double compliance = 0.0;  // of the laws, with the profile, per length at zero input: k / EI
    double joint = 0.0;       // of a joint at its begin, likewise; against loads alone
    Eigen::Vector3d p, t, load_moment, joint_moment, force;  // joint_moment: the load's at its begin
    Eigen::Matrix3d r;
    Eigen::Vector3d turn, stretch;  // of the fit, per length at zero input, section frame
  };
  /// A mass on the arm.
  struct Hung {
    double s_m = 0.0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    double kg = 0.0;
  };
  int piece_at(double s_m) const;
  double overlap(const Piece& piece, std::size_t i, double s_m) const;
  template <class TurnOf, class StretchOf>
  void integrate(TurnOf turn_of, StretchOf stretch_of, Eigen::Ref<Displacements> out) const;
  void loads();

  const arm::Arm& arm_;
  double length_m_;
  rod::Rod rod_;            // what the arm is made of and what acts on it, as everywhere else
  std::vector<Hung> hung_;  // from the tip
  std::vector<double> segment_end_, body_s_;
  std::vector<Piece> pieces_;
  std::vector<double> begin_;  // of each piece
  std::vector<int> body_piece_;
  std::vector<Eigen::Vector3d> bodies_;  // estimated places
  std::vector<std::pair<int, Eigen::Vector3d>> residual_;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  mutable std::vector<Eigen::Vector3d> inertia_;  // scratch
};

}  // namespace softarm::monitor
