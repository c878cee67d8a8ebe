// Sections slide on each other under a force across the arm: slope = force / GA.
#include "effects.h"

namespace softarm::effects {
namespace {

class Shear : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    for (rod::Segment& piece : rod.segments) piece.shear_compliance += values[0];
  }
};

}  // namespace

std::unique_ptr<Effect> make_shear() {
  return std::make_unique<Shear>(
      Info{"shear",
           "the arm shears under loads across it, more than the arm file says",
           "slope = V (1/GA + compliance), V the force across the arm",
           "S. P. Timoshenko, Phil. Mag. 41, 1921, doi:10.1080/14786442108636264",
           Family::kConstitutive,
           {{"compliance_per_n", "1/N", "slope per force across the arm, 1/GA, beyond the arm file's", 0.0,
             0.2, 0.015}},
           1,
           {"base_compliance", "rigid_ends"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
