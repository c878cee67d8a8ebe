// A wall beside the arm touches it at one place: k <x - x_w>, across the base's axis.
#include <cmath>

#include "along.h"
#include "effects.h"

namespace softarm::effects {
namespace {

// Looked for at these places, directions, and distances: of the way, place^2 / (2 length), by which a bend of
// one radian over the arm would move the place. Where along the arm it touches hardly changes what it looks
// like once gains and stiffness are fitted, the direction does much.
constexpr double kPlaces[] = {0.55, 0.9};
constexpr int kDirections = 18;
constexpr double kWays[] = {0.15, 0.45, 0.9};

class Contact : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  std::vector<Values> grid(const arm::Arm&, const FineRod& fine) const override {
    const double length = fine.length_m();
    std::vector<Values> list;
    for (const double place : kPlaces) {
      for (int i = 0; i < kDirections; ++i) {
        for (const double way : kWays)
          list.push_back(Eigen::Vector4d(0.0, place * length, 2.0 * M_PI * i / kDirections,
                                         way * 0.5 * place * place * length));
      }
    }
    return list;
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    const Eigen::Vector3d to_wall(std::cos(values[2]), std::sin(values[2]), 0.0);
    const double depth = to_wall.dot(position_at(fine, rod, *shape, values[1])) - values[3];
    if (depth > 0.0) fine.add_force(values[1], -values[0] * depth * to_wall, rod);
  }
};

}  // namespace

std::unique_ptr<Effect> make_contact() {
  return std::make_unique<Contact>(
      Info{"contact",
           "the arm touches something beside it",
           "F = k max(0, n . x(s_c) - d), against n, at the place s_c",
           "K. L. Johnson, Contact Mechanics, 1985, doi:10.1017/CBO9781139171731",
           Family::kLoad,
           {{"stiffness_n_per_m", "N/m", "of what it touches", 0.0, 2000.0, 50.0},
            {"place_m", "m", "where the arm touches it, arclength from the base", 0.0, 10.0, 0.14},
            {"azimuth_rad", "rad", "direction towards it, base frame, from x", -12.6, 12.6, 0.0},
            {"distance_m", "m", "of it from the axis of the straight arm", -1.0, 1.0, 0.02}},
           1,
           {"strain_stiffening", "tether"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
