// Gain and stiffness change over the session: by a rate at first, which may fade.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kMinute_s = 60.0;
constexpr double kLeastFactor = 0.05;

class Drift : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    // Over a session of an hour, and within a trial.
    for (const double fading_per_min : {0.0, 0.1, 1.0})
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
    stiffen(stiffness, arm, fine, instant, rod);
    for (rod::Segment& piece : rod.segments) piece.moment_nm *= gain;
  }
};

}  // namespace

std::unique_ptr<Effect> make_drift() {
  return std::make_unique<Drift>(Info{
      "drift",
      "the arm changes over the session: its actuators bend it less or more, or it grows softer or stiffer",
      "M0 (1 + gain T), EI (1 + stiffness T), T = (1 - exp(-fading t)) / fading, t the session's time",
      "drift of instruments: JCGM 100:2008, doi:10.59161/JCGM100-2008E",
      Family::kMemory,
      {{"gain_per_min", "1/min", "change of all moments, as a share of them, at first", -1.0, 1.0, 0.03},
       {"stiffness_per_min", "1/min", "change of all stiffnesses, as a share of them, at first", -1.0, 1.0,
        0.03},
       {"fading_per_min", "1/min", "rate at which the change fades", 0.0, 60.0, 1.0}},
      2,
      {"temperature", "mullins", "creep"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
