// What is hidden between a command and what acts in the arm: regulators, lines, tendons, memory. Absent:
// ideal.
#pragma once

#include <optional>
#include <vector>

#include "law_spec.h"

namespace softarm::rig {

/// The line from a regulator to its chamber, one for all chambers.
struct PressureLag {
  enum class Form {
    kFirstOrder,   ///< tau p' = u - p
    kSecondOrder,  ///< p'' + 2 z w p' + w^2 (p - u) = 0 with 2 z / w = tau: the same delay in slow ramps
    /// A proportional valve, fully open from kFullyOpenPa of error on, with a supply and a vent, each an
    /// orifice of ISO 6358 (critical ratio 0.3) and a chamber of constant volume at constant temperature:
    /// small changes at ambient fill with tau; large ones are limited by the choked flow, and venting slows
    /// near ambient.
    kChoked
  };
  static constexpr double kFullyOpenPa = 10e3;
  Form form = Form::kFirstOrder;
  double time_constant_s = 0.0;
  double damping_ratio = 1.0;         ///< z, of the second order
  double vent_time_constant_s = 0.0;  ///< of the choked form
  double supply_pa = 200e3;           ///< gauge, of the choked form
  int chamber = -1;                   ///< from 0; -1: all
};

/// What acts is below what is commanded, by a share of it.
struct PressureLeak {
  int chamber = -1;  ///< number of the pressure, from 0; -1: all
  double share = 0.0;
  /// Absent: always. Present: while the command holds, the share is lost with this time constant, and while
  /// it moves the regulator makes up for it.
  std::optional<double> time_s;
};

/// The regulator's zero is off, and it only works once the error exceeds the dead band: then at a constant
/// rate until the error is gone.
struct RegulatorError {
  static constexpr double kRatePaPerS = 100e3;
  double offset_pa = 0.0, dead_band_pa = 0.0;
};

struct SlewLimit {
  double rise_pa_per_s = 0.0, fall_pa_per_s = 0.0;
  bool shared = false;  ///< the rise is that of all chambers together: what each wants of it is cut alike
};

/// One supply feeds all chambers, and what reaches them is less by a share.
struct SupplySag {
  enum class Form {
    /// It droops under the others' demand q, the sum of their pressures over the reference: by
    /// share * q^2 / (1 + q^2).
    kDroop,
    /// A tank: what the chambers take in lowers it, in sum of pressures, and a pump fills it again at a
    /// constant rate. By share at the reference, and no more.
    kTank
  };
  Form form = Form::kDroop;
  double share = 0.0, reference_pa = 1.0;
  double refill_pa_per_s = 0.0;  ///< of the tank
};

/// The compressor lets its tank fall and fills it again, four times as fast: all pressures follow by a share,
/// half of it up and down. Where in the period a trial begins follows from the seed.
struct SupplyRipple {
  double share = 0.0, period_s = 1.0;
};

/// Granules pack in memory of how they were evacuated: the stiffness goes by a vacuum that follows a rise of
/// the true one at rate r by only 1 / (1 + r / rate), creeps up to it with a time constant, and in release
/// falls in proportion. On top a rate-independent loop.
struct JammingSettling {
  double rate_pa_per_s = 1.0, compaction_s = 1.0, loop_pa = 0.0;
};

/// Capstan friction: what passes an angle is between e^(-mu angle) and e^(mu angle) of the tension before it.
struct TendonFriction {
  double coefficient = 0.0;  ///< mu
  double routing_rad = 0.0;  ///< angle wound before the base
};

/// Gain and stiffness change over a session (Scenario::session_s), by shares. Linear: reached at over_s, and
/// on at that rate; saturating: 1 - e^(-t / over_s) of them; logarithmic: ln(1 + t / t1) / ln(1 + over_s /
/// t1) of them, t1 = over_s / 20, as polymers age (L. C. E. Struik, Polym. Eng. Sci. 17, 1977).
struct Drift {
  enum class Form { kLinear, kSaturating, kLogarithmic };
  double gain_share = 0.0, stiffness_share = 0.0;
  double over_s = 1.0;
  Form form = Form::kLinear;
};

/// The room's temperature swings over a session (Scenario::session_s); the arm follows it.
struct TemperatureSwing {
  double amplitude_k = 0.0, period_s = 1.0;
  /// At the start of the session. A sine is 0 and rising at 0; of a thermostat the heater goes on there.
  double phase_rad = 0.0;
  double stiffness_share_per_k = 0.0;  ///< of all stiffnesses of the material
  double expansion_share_per_k = 0.0;  ///< of the length
  /// A heater is on for part of the period: exponentials up and down.
  bool thermostat = false;
};

struct InputPathSpec {
  /// Rate-independent hysteresis between an input and what acts in the arm: the width of the loop, in the
  /// input's unit, of a cycle that is wide against it.
  double pressure_play_pa = 0.0, tension_play_n = 0.0, angle_play_rad = 0.0;
  int pressure_play_chamber = -1;  ///< that alone has it, from 0: its valve sticks; -1: all
  enum class Hysteresis { kPlay, kBoucWen };
  Hysteresis hysteresis = Hysteresis::kPlay;

  double line_delay_s = 0.0;  ///< of all pressures
  std::optional<SupplySag> supply_sag;
  std::optional<SupplyRipple> supply_ripple;
  std::optional<RegulatorError> regulator_error;
  double valve_step_pa = 0.0;  ///< the valve sticks and moves in steps of this; 0: freely
  std::optional<SlewLimit> slew_limit;
  std::optional<PressureLag> pressure_lag;
  std::vector<PressureLeak> pressure_leaks;
  std::optional<JammingSettling> jamming_settling;
  std::optional<TendonFriction> tendon_friction;
  std::optional<Drift> drift;
  std::optional<TemperatureSwing> temperature;
  double payload_scale_share = 0.0;  ///< the published payload is what hangs times 1 + share
  LawSpec laws;
};

}  // namespace softarm::rig
