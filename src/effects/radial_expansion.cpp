// The radius grows with the mean pressure; EI and GJ with its square, as the wall gets thinner.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kLeastFactor = 0.2;  // of the radius

class RadialExpansion : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kPressure); }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    std::vector<double> square;
    for (const arm::Segment& segment : arm.segments)
      square.push_back(std::pow(radius(arm, segment, values, instant), 2));
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double factor = square[static_cast<std::size_t>(fine.pieces()[j].segment)];
      rod.segments[j].bending_compliance /= factor;
      rod.segments[j].torsional_compliance /= factor;
    }
  }
  /// Markers on the skin move outwards.
  bool observes() const override { return true; }
  void observe(const arm::Arm& arm, const Values& values, const Instant& instant,
               Bodies& bodies) const override {
    for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
      const arm::MeasuredBody& body = arm.bodies[b];
      if (body.kind != arm::BodyKind::kSkinMarker) continue;
      double end_m = 0.0;
      const arm::Segment* on = &arm.segments.back();
      for (const arm::Segment& segment : arm.segments) {
        end_m += segment.length_m;
        if (body.arclength_m > end_m) continue;
        on = &segment;
        break;
      }
      const double further_m = body.radius_m * (radius(arm, *on, values, instant) - 1.0);
      bodies.p.col(static_cast<Eigen::Index>(b)) +=
          further_m *
          (bodies.q[b] * Eigen::Vector3d(std::cos(body.angle_rad), std::sin(body.angle_rad), 0.0));
    }
  }

 private:
  static double radius(const arm::Arm& arm, const arm::Segment& segment, const Values& values,
                       const Instant& instant) {
    return std::max(kLeastFactor,
                    1.0 + values[0] * mean_pressure_pa(arm, segment, instant.inputs) / kReferencePa);
  }
};

}  // namespace

std::unique_ptr<Effect> make_radial_expansion() {
  return std::make_unique<RadialExpansion>(Info{
      "radial_expansion",
      "the arm grows wider, and stiffer, with the pressure",
      "r (1 + share p / 50 kPa), EI and GJ with r^2, p the mean pressure",
      "chambers of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft Robotics 2, 2015, "
      "doi:10.1089/soro.2014.0022",
      Family::kConstitutive,
      {{"share", "1", "of the radius, by which it grows up to a mean pressure of 50 kPa", 0.0, 2.0, 0.06}},
      1,
      {"pressure_stiffening", "gain_nonlinearity"},
      {"bending_stiffness", "per_min_pressure", "per_jamming_pressure"}});
}

}  // namespace softarm::effects
