// Gain and stiffness change over the session: by a rate at first, which may fade.
#include <algorithm>
#include <cmath>

#include "arm/drive.h"
#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kMinute_s = 60.0;
constexpr double kLeastFactor = 0.05;

/// What servos bend by winding cables up is a curvature: stiffness drops out. As a turn about the section's
/// axes, per segment.
std::vector<Eigen::Vector3d> driven_curvature_per_m(const arm::Arm& arm, const Instant& instant) {
  std::vector<Eigen::Vector3d> list;
  const arm::InputReader inputs(arm, instant.moment_inputs);
  for (const arm::Segment& segment : arm.segments) {
    const Eigen::Vector2d towards = arm::drive_of(segment, inputs).value_or(arm::Drive()).curvature_per_m;
    list.emplace_back(-towards.y(), towards.x(), 0.0);
  }
  return list;
}

class Drift : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double fading_per_min : {0.0, 1.0})
      list.push_back((Values(3) << 0.0, 0.0, fading_per_min).finished());
    return list;
  }
  std::string live_obstacle(const Values&) const override {
    return "it says how the arm changed during the trials diagnosed, not how it is now";
  }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    double minutes = instant.session_s / kMinute_s;
    if (values[2] > 1e-9) minutes = -std::expm1(-values[2] * minutes) / values[2];
    const double gain = std::max(0.0, 1.0 + values[0] * minutes);
    const double stiffness = std::max(kLeastFactor, 1.0 + values[1] * minutes);
    const std::vector<Eigen::Vector3d> curvature_per_m = driven_curvature_per_m(arm, instant);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      rod::Segment& piece = rod.segments[j];
      const auto segment = static_cast<std::size_t>(fine.pieces()[j].segment);
      piece.moment_nm += (stiffness - 1.0) / piece.bending_compliance * curvature_per_m[segment];
      piece.moment_nm *= gain;
      piece.bending_compliance /= stiffness;
      piece.torsional_compliance /= stiffness;
      piece.shear_compliance /= stiffness;
      piece.axial_compliance /= stiffness;
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_drift() {
  return std::make_unique<Drift>(Info{
      "drift",
      "the arm changes over the session: what drives it bends it less or more, or it grows softer or stiffer",
      "M0 (1 + gain T), EI (1 + stiffness T), T = (1 - exp(-fading t)) / fading, t the session's time",
      "drift of instruments: JCGM 100:2008, doi:10.59161/JCGM100-2008E",
      Family::kMemory,
      {{"gain_per_min", "1/min", "change of all moments, as a share of them, at first", -1.0, 1.0, 0.03},
       {"stiffness_per_min", "1/min", "change of all stiffnesses, as a share of them, at first", -1.0, 1.0,
        0.03},
       {"fading_per_min", "1/min", "rate at which the change fades", 0.0, 60.0, 1.0}},
      2,
      {"mullins", "creep"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
