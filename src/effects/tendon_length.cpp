// Cables that end in one segment pass through those before it, and where their servos hold they keep their
// length: what bends the segments before towards a cable, be it inputs or loads, leaves it so much less to
// bend its own by. Of a cable as far from the axis there as here that is the whole angle, however far it is;
// of one in a sheath nothing. The bend is the integral of the curvature, so the arm is cut into pieces.
#include <algorithm>
#include <cmath>
#include <vector>

#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// Determinant of the cables' mean, of two a quarter of the squared sine between them: less is one way to
// pull.
constexpr double kOneWay = 1e-3;

/// What a segment's cables hold of a turn about the section's axes: all of it, or where they pull one way its
/// part about the axis of that. However many there are, to keep their lengths it bends back as much.
Matrix2d held_by_cables(const arm::Segment& segment) {
  Matrix2d sum = Matrix2d::Zero();
  for (const arm::Cable& cable : segment.cables) {
    // Bent towards x is turned about y.
    const Vector2d axis(-std::sin(cable.bending_direction_rad), std::cos(cable.bending_direction_rad));
    sum += axis * axis.transpose() / static_cast<double>(segment.cables.size());
  }
  return sum.determinant() > kOneWay ? Matrix2d(Matrix2d::Identity()) : sum;
}

class TendonLength : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  bool answers_evenly() const override { return true; }
  bool applies_to(const arm::Arm& arm) const override {
    return std::any_of(arm.segments.begin(), arm.segments.end(), [&](const arm::Segment& segment) {
      return &segment != &arm.segments.front() && !segment.cables.empty();
    });
  }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    if (values[0] == 0.0) return;
    std::vector<double> lengths_m(arm.segments.size(), 0.0);
    std::vector<Vector2d> bends(arm.segments.size(), Vector2d::Zero());
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const auto i = static_cast<std::size_t>(fine.pieces()[j].segment);
      lengths_m[i] += rod.segments[j].length_m;
      bends[i] += rod.segments[j].length_m * shape->middles[j].u.head<2>();
    }
    std::vector<Vector2d> back_per_m;
    Vector2d before = Vector2d::Zero();
    for (std::size_t i = 0; i < arm.segments.size(); ++i) {
      back_per_m.push_back(values[0] / lengths_m[i] * (held_by_cables(arm.segments[i]) * before));
      before += bends[i];
    }
    // A curvature, as that of the cables themselves: loads bend the segment about it.
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      rod.segments[j].rest_curvature_per_m.head<2>() -=
          back_per_m[static_cast<std::size_t>(fine.pieces()[j].segment)];
  }
};

}  // namespace

std::unique_ptr<Effect> make_tendon_length() {
  return std::make_unique<TendonLength>(Info{
      "tendon_length",
      "cables that pass through other segments keep their length: their own segment bends back by what "
      "those bend",
      "u = u_0 - share P b / L, b the sum of the bends of all segments before, P onto the directions of "
      "the segment's cables",
      "lengths of tendons in several sections: B. A. Jones, I. D. Walker, IEEE Trans. Robotics 22, 2006, "
      "doi:10.1109/TRO.2005.861458",
      Family::kActuation,
      {{"share", "1",
        "of what the segments before are bent by, that cables bend their own back (0: in sheaths; 1: at "
        "one distance from the axis all along, and held)",
        -1.0, 2.0, 0.5}},
      1,
      {"curvature_gain", "tendon_slack"},
      {"curvature_gain"}});
}

}  // namespace softarm::effects
