// End caps and clamps that neither bend nor are bent by the actuation.
#include <algorithm>

#include "along.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kMost = 0.45;  // of the arm's length, each
constexpr double kLeft = 1e-4;  // of the compliance

class RigidEnds : public Described {
 public:
  using Described::Described;
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory&, rod::Rod& rod) const override {
    const double most = kMost * fine.length_m();
    const Eigen::VectorXd shares =
        cap_at_base(fine, std::min(values[0], most)) + cap_at_tip(fine, std::min(values[1], most));
    for (std::size_t j = 0; j < rod.segments.size(); ++j) {
      const double factor = std::max(kLeft, 1.0 - shares[static_cast<Eigen::Index>(j)]);
      rod::Segment& piece = rod.segments[j];
      piece.bending_compliance *= factor;
      piece.torsional_compliance *= factor;
      piece.shear_compliance *= factor;
      piece.axial_compliance *= factor;
      piece.rest_curvature_per_m *= factor;
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_rigid_ends() {
  return std::make_unique<RigidEnds>(
      Info{"rigid_ends",
           "the ends of the arm do not bend: caps or clamps reach into it",
           "u = 0 for s < base and s > L - tip",
           "conditions along a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kConstitutive,
           {{"base_m", "m", "length of what does not bend at the base", 0.0, 0.1, 0.01},
            {"tip_m", "m", "length of what does not bend at the tip", 0.0, 0.1, 0.01}},
           2,
           {"stiffness_taper", "shear", "base_compliance", "soft_spot"},
           {"moment_gain", "bending_stiffness"}});
}

}  // namespace softarm::effects
