// A wall or a round post beside the arm touches it at one place: k <x - x_w>, across the base's axis. A rough
// one also holds it along its face: a spring as stiff, from where it touched, which slips where friction
// holds no more.
#include <algorithm>
#include <cmath>

#include "along.h"
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
            list.push_back((Values(6) << 0.0, place * length, 2.0 * M_PI * i / kDirections,
                            way * 0.5 * place * place * length, 0.0, curvature)
                               .finished());
      }
    }
    return list;
  }
  std::optional<Values> like(const Effect& other, const Values& hose, const FineRod& fine) const override {
    if (other.info().id != "tether") return std::nullopt;
    // Beyond where a hose grows taut it pulls the tip back as a wall does that stands there.
    const double far_m = std::hypot(hose[2], hose[3]);
    return (Values(6) << hose[0], fine.length_m(), std::atan2(-hose[3], -hose[2]), hose[4] - far_m, 0.0, 0.0)
        .finished();
  }
  std::optional<std::pair<double, double>> place(const arm::Arm&, const Values& values) const override {
    return std::make_pair(values[1], values[1]);
  }
  bool holds_places() const override { return true; }
  std::vector<double> held_places_m(const FineRod&, const Values& values) const override {
    return {values[1]};
  }
  Vector3d holding_force_n(const FineRod&, const Values& values, std::size_t, const Vector3d& place_m,
                           const Memory& memory) const override {
    const Touch touch(values, place_m);
    if (touch.depth_m <= 0.0) return Vector3d::Zero();
    Vector3d force = -values[0] * touch.depth_m * touch.to_wall;
    if (!memory.empty()) force -= values[0] * touch.held(values[4], anchor(memory));
    return force;
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&,
                const Shape& shape, Memory& memory) const override {
    if (values[4] == 0.0) return;  // nothing holds
    const Touch touch(values, model::position_at(fine, fine.layout(), shape, values[1]));
    if (touch.depth_m <= 0.0) {
      memory.clear();
      return;
    }
    Vector3d from = touch.place_m;
    if (!memory.empty()) from -= touch.held(values[4], anchor(memory));
    memory.assign(from.data(), from.data() + 3);
  }

 private:
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
  static Vector3d anchor(const Memory& memory) { return {memory[0], memory[1], memory[2]}; }
};

}  // namespace

std::unique_ptr<Effect> make_contact() {
  return std::make_unique<Contact>(Info{
      "contact",
      "the arm touches something beside it",
      "F = k max(0, n . x(s_c) - d), against n, at the place s_c; of a round post k max(0, R - distance "
      "from its axis); along either k times the way from where it holds, friction F at most",
      "K. L. Johnson, Contact Mechanics, 1985, doi:10.1017/CBO9781139171731",
      Family::kLoad,
      {{"stiffness_n_per_m", "N/m", "of what it touches", 0.0, 2000.0, 50.0},
       {"place_m", "m", "where the arm touches it, arclength from the base", 0.0, 10.0, 0.14, false, true},
       {"azimuth_rad", "rad", "direction towards it, base frame, from x", -12.6, 12.6, 0.0},
       {"distance_m", "m", "of it from the axis of the straight arm", -1.0, 1.0, 0.02},
       {"friction", "1", "coefficient of dry friction; 0: smooth", 0.0, 2.0, 0.0},
       {"curvature_per_m", "1/m", "of its face: 0 a wall, 1 / R a post of radius R along the straight arm",
        0.0, kMostCurvature_per_m, 0.0}},
      1,
      {"strain_stiffening", "tether"},
      {"bending_stiffness"}});
}

}  // namespace softarm::effects
