// The room's temperature swings, and with it the material's stiffness and length: nobody logged it.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kSwingMinute_s = 60.0;
constexpr double kLeastOfSwing = 0.05;

class Temperature : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  /// A swing that is longer than the session is monotone within it, as `drift` is; a neighbour of a period is
  /// no more than half a swing off after half an hour.
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double period_min : {10.0, 15.0, 22.0, 40.0}) {
      list.push_back(Values::Zero(5));
      list.back()[4] = period_min;
    }
    return list;
  }
  std::string live_obstacle(const Values&) const override {
    return "it says how warm the arm was during the trials diagnosed, not how warm it is now";
  }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory&, rod::Rod& rod) const override {
    const double angle = 2.0 * M_PI * instant.session_s / (kSwingMinute_s * std::max(values[4], 0.01));
    const double s = std::sin(angle), c = std::cos(angle);
    stiffen(std::max(kLeastOfSwing, 1.0 + values[0] * s + values[1] * c), arm, fine, instant, rod);
    const double length = std::max(kLeastOfSwing, 1.0 + values[2] * s + values[3] * c);
    for (rod::Segment& piece : rod.segments) piece.length_m *= length;
  }
};

}  // namespace

std::unique_ptr<Effect> make_temperature() {
  return std::make_unique<Temperature>(Info{
      "temperature",
      "the arm's stiffness and length swing over the session, as with the room's temperature",
      "EI (1 + stiffness_sin sin w + stiffness_cos cos w), L likewise, w = 2 pi t / period, t the session's "
      "time",
      "the swing is a form of its own; modulus and length of rubber with temperature: L. R. G. Treloar, The "
      "Physics of Rubber Elasticity, 2005, isbn:0198570279",
      Family::kMemory,
      {{"stiffness_sin", "1", "share of all stiffnesses that swings with the sine", -0.5, 0.5, 0.03},
       {"stiffness_cos", "1", "share of all stiffnesses that swings with the cosine", -0.5, 0.5, 0.03},
       {"length_sin", "1", "share of the length that swings with the sine", -0.05, 0.05, 0.001},
       {"length_cos", "1", "share of the length that swings with the cosine", -0.05, 0.05, 0.001},
       {"period_min", "min", "of the swing", 0.5, 600.0, 20.0}},
      4,
      {"drift", "creep", "mullins"},
      {"bending_stiffness", "moment_gain", "length"}});
}

}  // namespace softarm::effects
