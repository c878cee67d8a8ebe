// Softer when it is bent to one side, stiffer to the other: a seam, a wall that wrinkles on one side only.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr double kMostSofter = 0.95;  // of EI

class OneSidedSoftness : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    if (values.head<2>().isZero(0.0)) return;
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      rod::Segment& piece = rod.segments[j];
      const rod::RodState& middle = shape->middles[j];
      const Vector2d rest = piece.rest_curvature_per_m.head<2>();
      const Vector2d even = linear_curvature(piece, middle) - rest;
      const double size = even.norm();
      if (!(size > 0.0)) continue;
      // Bent towards x is turned about y.
      const Vector2d direction = Vector2d(even.y(), -even.x()) / size;
      const double stiffness = 1.0 - std::min(kMostSofter, values.head<2>().dot(direction));
      bend_to(rest + even / stiffness, stiffness, middle, piece);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_one_sided_softness() {
  return std::make_unique<OneSidedSoftness>(Info{
      "one_sided_softness",
      "the arm is softer when it is bent to one side, and stiffer to the other",
      "M = EI (1 - softer . d) u, d the direction of bending",
      "a membrane wrinkles where it is pressed: R. L. Comer, S. Levy, AIAA J. 1, 1963, doi:10.2514/3.1873",
      Family::kConstitutive,
      {{"softer_x", "1", "share of EI, by which it is lower when bent towards x of the section", -0.9, 0.9,
        0.1},
       {"softer_y", "1", "share of EI, by which it is lower when bent towards y of the section", -0.9, 0.9,
        0.1}},
      2,
      {"contact", "rest_curvature", "chamber_mismatch", "plane_stiffness"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
