// Softer where it is bent to one side: a seam, a wall that buckles or folds where it is pressed. It is the
// part of the bending towards that side that meets less, or more, stiffness; what goes across it does not.
#include <algorithm>
#include <cmath>
#include <optional>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kMostSofter = 0.95;  // of EI
constexpr double kOfWall = -0.1;      // softer by, from where a fit begins
constexpr int kDirections = 8;

/// Takes a share of the stiffness about an axis away.
void soften(double share, const Vector2d& axis, rod::Segment& piece) {
  Matrix2d stiffness = Matrix2d::Identity();
  stiffness << 1.0 + piece.anisotropy.x(), piece.anisotropy.y(), piece.anisotropy.y(),
      1.0 - piece.anisotropy.x();
  stiffness -= share * axis * axis.transpose();
  const double mean = 0.5 * stiffness.trace();
  piece.bending_compliance /= mean;
  piece.anisotropy = Vector2d(0.5 * (stiffness(0, 0) - stiffness(1, 1)), stiffness(0, 1)) / mean;
}

class OneSidedSoftness : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  Stage stage() const override { return Stage::kSides; }
  /// On either side the piece is linear, with the stiffness that is felt there.
  bool needs_whole_derivatives(const Values&) const override { return false; }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (int i = 0; i < kDirections; ++i) list.push_back(Vector2d(0.0, 2.0 * M_PI * i / kDirections));
    return list;
  }
  std::optional<Values> like(const Effect& other, const Values& wall, const FineRod&) const override {
    // A wall, or what is soft like one, holds the arm back as stiffness towards it does.
    if (other.info().id != "contact") return std::nullopt;
    return Vector2d(kOfWall, wall[2]);
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    if (values[0] == 0.0) return;
    // Bent towards x is turned about y.
    const Vector2d axis(-std::sin(values[1]), std::cos(values[1]));
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      rod::Segment& piece = rod.segments[j];
      const Vector2d bent = linear_curvature(piece, shape->middles[j]) - piece.rest_curvature_per_m.head<2>();
      if (axis.dot(bent) > 0.0) soften(std::min(kMostSofter, values[0]), axis, piece);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_one_sided_softness() {
  return std::make_unique<OneSidedSoftness>(Info{
      "one_sided_softness",
      "the arm is softer, or stiffer, where it is bent to one side",
      "M = EI (u - softer max(0, u . e) e), e the turn that bends towards that side",
      "a membrane wrinkles where it is pressed: R. L. Comer, S. Levy, AIAA J. 1, 1963, doi:10.2514/3.1873",
      Family::kConstitutive,
      {{"softer", "1", "share of EI, by which it is lower when bent to that side", -3.0, 0.9, 0.1},
       {"side_rad", "rad", "direction of that side, from x of the section", -12.6, 12.6, 0.5}},
      1,
      {"contact", "rest_curvature", "chamber_mismatch", "plane_stiffness"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
