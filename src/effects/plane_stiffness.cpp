// A section that is not round, or wound otherwise in one plane than across it: M = EI (I + T) u.
#include <algorithm>

#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr double kMostUneven = 0.95;  // of the mean: no plane is without stiffness

class PlaneStiffness : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    const double size = values.head<2>().norm();
    if (size == 0.0) return;
    // By the angle of the turn's axis, which is a quarter ahead of the direction of bending: the sign
    // changes.
    const Vector2d uneven = -std::min(1.0, kMostUneven / size) * values.head<2>();
    for (rod::Segment& piece : rod.segments) piece.anisotropy = uneven;
  }
};

}  // namespace

std::unique_ptr<Effect> make_plane_stiffness() {
  return std::make_unique<PlaneStiffness>(Info{
      "plane_stiffness",
      "the arm is stiffer in one plane than across it",
      "M = EI (I + T) u, T = [[towards_x, diagonal], [diagonal, -towards_x]]",
      "two principal stiffnesses of a section: S. S. Antman, Nonlinear Problems of Elasticity, 2005, "
      "doi:10.1007/0-387-27649-1",
      Family::kConstitutive,
      {{"towards_x", "1", "share by which EI is higher for bending towards x, and lower towards y", -0.9, 0.9,
        0.1},
       {"diagonal", "1", "share by which EI is higher for bending between x and y, and lower across that",
        -0.9, 0.9, 0.1}},
      2,
      {"chamber_mismatch", "one_sided_softness", "bending_plane_offset"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
