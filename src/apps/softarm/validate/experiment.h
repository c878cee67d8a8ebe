// Experiments on the virtual rig: inputs and payloads held one after another, measured when the arm is still.
#pragma once

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "rig/scenario.h"
#include "rig/simulator.h"
#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"
#include "table.h"

namespace softarm::app::validate {

/// What is commanded for a while. Lists are as long as the arm has inputs of the kind.
struct Hold {
  std::vector<double> pressures_pa, tensions_n, angles_rad;
  double vacuum_pa = 0.0;
  double payload_kg = 0.0;
};

struct HoldTiming {
  double ramp_s = 1.0;   ///< from one hold to the next
  double dwell_s = 3.0;  ///< ramp included
  int frames = 1;        ///< measured at the end of each
  /// Kelvin-Voigt damping of all segments: half of critical or more brings the arm to rest within a hold. It
  /// slows down an arm near buckling.
  double viscoelastic_lag_s = 0.1;
};

/// What was measured while a hold lasted.
struct Held {
  std::vector<trial::Frame> frames;  ///< inputs and payload as commanded
  rig::Truth truth;                  ///< at the last of them
  double moving_m = 0.0;             ///< how far a ring still moved between the first and the last
};

/// The shipped arm and scenario of a name, for the same arm.
arm::Arm shipped_arm(const std::string& name);
rig::Scenario shipped_scenario(const std::string& name);

/// What a real arm has and an ideal one has not; sizes stated once for all papers (see doc/validation.md).
enum class Quality { kIdeal, kRealLike };

/// Hides what real arms of its kind have to a scenario.
/// - base that yields by the bending moment there: 5 N m/rad for the 200 mm arms of 200 g; for the others
///   such that their own bending stiffness over length keeps its ratio to it
/// - hysteresis: 2.5 kPa of 50 for chambers; as large a share (5 %) of the range for tensions and angles
void make_real_like(rig::Scenario& scenario, double tension_range_n, double angle_range_rad);

/// Runs the holds one after another, from rest, and measures at the end of each. The rig's damping is raised
/// and its time step lengthened, which shortens the way to rest and does not change where that is.
/// @param seed of the noise
std::vector<Held> run_holds(rig::Scenario scenario, const arm::Arm& arm, const std::vector<Hold>& holds,
                            std::uint64_t seed, const HoldTiming& timing);

/// Reproducible on every platform, unlike the distributions of <random>.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

 private:
  std::mt19937_64 engine_;
};

/// A seed for one part of a run: distinct for distinct parts.
std::uint64_t seed_of(std::uint64_t run, std::uint64_t paper, std::uint64_t part);

struct Statistics {
  std::size_t count = 0;
  double mean = 0.0, median = 0.0, maximum = 0.0, minimum = 0.0;
  double sd = 0.0;  ///< with n - 1
};
/// All NaN without values (Cell shows "none").
Statistics statistics(std::vector<double> values);

}  // namespace softarm::app::validate
