// The arm's rod in short pieces: what effects act on.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "softarm/rod/rod.h"
#include "softarm/rod/solver.h"

namespace softarm::model {

/// A stretch of one segment of the arm; one segment of the fine rod.
struct Piece {
  int segment = 0;                              ///< of the arm
  double s_from_m = 0.0, s_to_m = 0.0;          ///< arclength at zero input, from the base
  double fraction_from = 0.0, fraction_to = 0;  ///< of its segment

  double middle_m() const { return 0.5 * (s_from_m + s_to_m); }
  double middle_fraction() const { return 0.5 * (fraction_from + fraction_to); }
};

/// The rod of rod::make_rod with each segment cut into equal pieces, so that stiffness, actuation and weight
/// may vary along it, and with a load of nothing at the end of every piece, for forces that effects add.
///
/// Without effects it is the same rod: all values of a piece are those of its segment, its length and mass
/// their shares.
class FineRod {
 public:
  static constexpr int kPieces = 12;
  /// @param pieces over the whole arm, about; at least three per segment. 1: each segment is one piece
  explicit FineRod(const arm::Arm& arm, int pieces = kPieces);

  const std::vector<Piece>& pieces() const { return pieces_; }
  /// Loads: rod::kTipMassLoad, rod::kPayloadLoad, then one at the end of each piece.
  const rod::Rod& layout() const { return layout_; }
  static constexpr int kFirstStation = 2;
  int stations() const { return static_cast<int>(pieces_.size()); }
  double station_m(int station) const { return pieces_[static_cast<std::size_t>(station)].s_to_m; }
  double length_m() const { return pieces_.back().s_to_m; }

  /// Puts what the laws say into a rod of this layout, as rod::actuate does. Loads, gravity and base are
  /// left alone.
  /// @param predictions one per segment of the arm
  /// @param moments whose moments and curvatures act, mostly the same as `predictions`
  void actuate(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& predictions,
               const std::vector<arm::SegmentPrediction>& moments, rod::Rod& rod) const;

  /// Adds a dead force at s, shared by the two stations beside it (near the base: the rest is borne there).
  void add_force(double s_m, const Eigen::Vector3d& force_n, rod::Rod& rod) const;
  /// The share of station `i` in what acts at s, 0 ... 1.
  double share(double s_m, int station) const;

  /// Masses of the pieces, the tip and the payload of a rod, shared among the stations as add_force does.
  Eigen::VectorXd station_masses_kg(const rod::Rod& rod) const;

  /// Everything that effects and laws may change, as the solver's parameters; values() in the same order.
  const std::vector<rod::Parameter>& parameters() const { return parameters_; }
  /// kBaseRotation is a rotation vector from layout().q_base, world frame.
  Eigen::VectorXd values(const rod::Rod& rod) const;
  void values(const rod::Rod& rod, Eigen::Ref<Eigen::VectorXd> v) const;  ///< into v, as many

 private:
  std::vector<Piece> pieces_;
  rod::Rod layout_;
  std::vector<rod::Parameter> parameters_;
};

}  // namespace softarm::model
