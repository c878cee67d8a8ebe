// A wall or a round post beside the arm touches it at one place, or all along a stretch: k <x - x_w>, across
// the base's axis. A rough one also holds it along its face: a spring as stiff, from where it touched, which
// slips where friction holds no more.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector3d;

// Looked for at these places, directions, and distances: of the way, place^2 / (2 length), by which a bend of
// one radian over the arm would move the place. Where along the arm it touches hardly changes what it looks
// like once gains and stiffness are fitted, the direction does much.
constexpr double kPlaces[] = {0.55, 0.9};
constexpr int kDirections = 18;
constexpr double kWays[] = {0.15, 0.45, 0.9};
// No wall looks like a round post: the arm passes it. Its radius, of the arm's length.
constexpr double kPostRadius = 1.0 / 12.0;
constexpr double kMostCurvature_per_m = 200.0;
// A wall that touches all along the arm but for its base is not looked for: at first it looks much like one
// that touches at one place, and is fitted from there. Middle and half of the stretch, of the arm's length.
constexpr double kStretchMiddle = 0.6, kStretchHalf = 0.4;
// It is so much stiffer than one that pushes as much at one place: nearer to the base the arm is less far
// beyond it. That place, of the stretch.
constexpr double kStretchStiffer = 2.0, kStretchPlace = 0.75;

/// Where on a stretch the arm is held, from its middle, over its length; and the share of the stiffness.
struct StretchPoint {
  double at, share;
};
/// The points of Gauss and Legendre. They are few, as each adds three solutions of the rod to those that show
/// how the places yield.
constexpr std::array<StretchPoint, 5> kStretchPoints{{{-0.4530899229693320, 0.1184634425280945},
                                                      {-0.2692346550528415, 0.2393143352496832},
                                                      {0.0, 0.2844444444444444},
                                                      {0.2692346550528415, 0.2393143352496832},
                                                      {0.4530899229693320, 0.1184634425280945}}};

class Contact : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  bool needs_strains() const override { return false; }
  std::vector<Values> grid(const arm::Arm&, const FineRod& fine) const override {
    const double length = fine.length_m();
    std::vector<Values> list;
    for (const double place : kPlaces) {
      for (int i = 0; i < kDirections; ++i) {
        for (const double way : kWays)
          for (const double curvature : {0.0, std::min(kMostCurvature_per_m, 1.0 / (kPostRadius * length))})
            list.push_back((Values(7) << 0.0, place * length, 2.0 * M_PI * i / kDirections,
                            way * 0.5 * place * place * length, 0.0, curvature, 0.0)
                               .finished());
      }
    }
    return list;
  }
  std::optional<Values> like(const Effect& other, const Values& its, const FineRod& fine) const override {
    if (other.info().id == info().id) return touching_otherwise(its, fine.length_m());
    if (other.info().id != "tether") return std::nullopt;
    // Beyond where a hose grows taut it pulls the tip back as a wall does that stands there.
    const double far_m = std::hypot(its[2], its[3]);
    return (Values(7) << its[0], fine.length_m(), std::atan2(-its[3], -its[2]), its[4] - far_m, 0.0, 0.0, 0.0)
        .finished();
  }
  std::optional<std::pair<double, double>> place(const arm::Arm& arm, const Values& values) const override {
    return stretch_m(values, arm.total_length_m());
  }
  bool holds_places() const override { return true; }
  /// Where a rough one holds the arm along its face goes by the shapes before: only a smooth one has it all.
  bool needs_whole_derivatives(const Values& values) const override { return values[4] > 0.0; }
  std::vector<double> held_places_m(const FineRod& fine, const Values& values) const override {
    const auto [from_m, to_m] = stretch_m(values, fine.length_m());
    if (!is_spread(values)) return {from_m};
    std::vector<double> places_m;
    for (const StretchPoint& point : kStretchPoints)
      places_m.push_back(0.5 * (from_m + to_m) + point.at * (to_m - from_m));
    return places_m;
  }
  Vector3d holding_force_n(const FineRod& fine, const Values& values, std::size_t which,
                           const Vector3d& place_m, const Memory& memory) const override {
    const Touch touch(values, place_m);
    if (touch.depth_m <= 0.0) return Vector3d::Zero();
    const double stiffness =
        values[0] *
        (is_spread(values) ? kStretchPoints[which].share * share_there(values, fine.length_m()) : 1.0);
    Vector3d force = -stiffness * touch.depth_m * touch.to_wall;
    if (const auto from_m = anchor(values, memory, which))
      force -= stiffness * touch.held(values[4], *from_m);
    return force;
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&,
                const Shape& shape, Memory& memory) const override {
    if (values[4] == 0.0) return;  // nothing holds
    const std::vector<double> places_m = held_places_m(fine, values);
    Memory now;
    bool touches = false;
    for (std::size_t which = 0; which < places_m.size(); ++which) {
      const Touch touch(values, model::position_at(fine, fine.layout(), shape, places_m[which]));
      Vector3d from = Vector3d::Constant(kOff);
      if (touch.depth_m > 0.0) {
        touches = true;
        from = touch.place_m;
        if (const auto before = anchor(values, memory, which)) from -= touch.held(values[4], *before);
      }
      now.insert(now.end(), from.data(), from.data() + 3);
    }
    if (!touches) now.clear();
    memory = std::move(now);
  }

 private:
  /// In the memory, of a place that does not touch while others do.
  static constexpr double kOff = std::numeric_limits<double>::quiet_NaN();
  static bool is_spread(const Values& values) { return values[6] > 0.0; }
  /// What may touch: a stretch ends where the arm does. One place is one of the arm: beyond its length, which
  /// may have been fitted since, the tip.
  static std::pair<double, double> stretch_m(const Values& values, double length_m) {
    return {std::clamp(values[1] - values[6], 0.0, length_m),
            std::clamp(values[1] + values[6], 0.0, length_m)};
  }
  /// Of a stretch the share of its length, and so of its stiffness, that the arm comes to.
  static double share_there(const Values& values, double length_m) {
    const auto [from_m, to_m] = stretch_m(values, length_m);
    return (to_m - from_m) / (2.0 * values[6]);
  }
  /// Along a stretch what touches at one place, and at one place what touches along a stretch.
  static Values touching_otherwise(const Values& values, double length_m) {
    Values otherwise = values;
    if (is_spread(values)) {
      const auto [from_m, to_m] = stretch_m(values, length_m);
      otherwise[0] *= share_there(values, length_m) / kStretchStiffer;
      otherwise[1] = from_m + kStretchPlace * (to_m - from_m);
      otherwise[6] = 0.0;
    } else {
      otherwise[0] *= kStretchStiffer;
      otherwise[1] = kStretchMiddle * length_m;
      otherwise[6] = kStretchHalf * length_m;
    }
    return otherwise;
  }
  /// Where the place is against the wall or the post.
  struct Touch {
    Touch(const Values& values, const Vector3d& place) : place_m(place) {
      const Vector3d n(std::cos(values[2]), std::sin(values[2]), 0.0), t(-n.y(), n.x(), 0.0);
      const double way_m = values[3] - n.dot(place), beside_m = t.dot(place), curvature = values[5];
      // To the post's axis, over its radius; a wall's is infinitely far away.
      const double ahead = 1.0 + curvature * way_m, beside = curvature * beside_m;
      const double far = std::hypot(ahead, beside);
      depth_m = -(way_m * (1.0 + ahead) + beside * beside_m) / (1.0 + far);
      to_wall = far > 0.0 ? Vector3d((ahead * n - beside * t) / far) : n;
    }
    /// From where the spring along the face is held, as far as friction holds it.
    Vector3d held(double friction, const Vector3d& anchor_m) const {
      Vector3d way = place_m - anchor_m;
      way -= to_wall.dot(way) * to_wall;
      const double most_m = friction * depth_m, far_m = way.norm();
      return far_m > most_m ? Vector3d(most_m / far_m * way) : way;
    }
    Vector3d place_m, to_wall;
    double depth_m = 0.0;
  };
  /// From where the place is held along the face; nothing where it did not touch. One that has not as many
  /// places, towards which an estimate leans, has no anchors of its own in a memory.
  static std::optional<Vector3d> anchor(const Values& values, const Memory& memory, std::size_t which) {
    if (memory.size() != 3 * (is_spread(values) ? kStretchPoints.size() : 1)) return std::nullopt;
    const Vector3d from(memory[3 * which], memory[3 * which + 1], memory[3 * which + 2]);
    if (!from.allFinite()) return std::nullopt;
    return from;
  }
};

}  // namespace

std::unique_ptr<Effect> make_contact() {
  return std::make_unique<Contact>(Info{
      "contact",
      "the arm touches something beside it",
      "F = k max(0, n . x(s_c) - d), against n, at the place s_c, or spread evenly over s_c - extent ... "
      "s_c + extent, as far as the arm goes; of a round post k max(0, R - distance from its axis); along "
      "either k times the way from where it holds, friction F at most",
      "K. L. Johnson, Contact Mechanics, 1985, doi:10.1017/CBO9781139171731",
      Family::kLoad,
      {{"stiffness_n_per_m", "N/m", "of what it touches", 0.0, 2000.0, 50.0},
       {"place_m", "m", "where the arm touches it, arclength from the base", 0.0, 10.0, 0.14, false, true},
       {"azimuth_rad", "rad", "direction towards it, base frame, from x", -12.6, 12.6, 0.0},
       {"distance_m", "m", "of it from the axis of the straight arm", -1.0, 1.0, 0.02},
       {"friction", "1", "coefficient of dry friction; 0: smooth", 0.0, 2.0, 0.0},
       {"curvature_per_m", "1/m", "of its face: 0 a wall, 1 / R a post of radius R along the straight arm",
        0.0, kMostCurvature_per_m, 0.0},
       // Held in fits: to first order a short stretch does what its middle does, so that none would leave 0;
       // and a long one is told from one place, but hardly from one that is a little longer. like() has both.
       {"extent_m", "m", "half of the stretch about that place over which the arm touches it; 0: one place",
        0.0, 10.0, 0.0, false, true, true}},
      1,
      {"strain_stiffening", "tether"},
      {"bending_stiffness"}});
}

}  // namespace softarm::effects
