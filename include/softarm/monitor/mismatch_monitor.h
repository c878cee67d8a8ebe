// Live: does the arm still do what its laws, and its own past, say? Where along it not, and since when?
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "softarm/arm/arm.h"
#include "softarm/estimate/estimator.h"
#include "softarm/export.h"
#include "softarm/trial/trial.h"

namespace softarm::monitor {

/// What a sudden change looks like most.
enum class ChangeKind {
  kNone,
  kRing,       ///< one body moved, all others as before: a ring slipped, its markers were knocked
  kContact,    ///< bodies moved as by a sideways force at one place of the arm
  kActuation,  ///< ... as by another actuation of a segment: a leak, a hose that came off, a stuck valve
  kBase,       ///< the arm moved as a whole against its base: the base's markers slipped, the clamp yielded
  kUnclear,    ///< something changed, and none of these explains it
};
SOFTARM_EXPORT std::string to_string(ChangeKind kind);

/// Direction of a mismatch: in the plane in which the arm bends, across that plane, along the arm.
enum class MismatchAxis { kNone, kInPlane, kOutOfPlane, kAxial };
SOFTARM_EXPORT std::string to_string(MismatchAxis axis);

/// What MismatchMonitor says at one frame.
struct Mismatch {
  double stamp_s = 0.0;
  /// False until the first quarter of a second of usable frames, and after gaps: the rest says nothing.
  bool valid = false;
  /// Whether the arm's laws could be applied to the inputs. Without them only what the fit itself cannot
  /// follow is seen.
  bool laws = false;

  // Against the arm's laws. Lasting errors of the arm file stay in it.
  /// Root mean square over the bodies' coordinates, a quarter of a second's mean, in standard deviations of
  /// the mocap's noise of one frame.
  double score_sd = 0.0;
  double rms_m = 0.0;  ///< the same as a root mean square distance per body

  // Against the laws as corrected by the last minutes: a change.
  double change_sd = 0.0;     ///< the most likely change, in its standard deviations
  double threshold_sd = 0.0;  ///< an alarm is a change beyond this that lasts; 0: held off, see `description`
  bool alarm = false;
  std::optional<double> onset_s;  ///< of the alarm
  ChangeKind kind = ChangeKind::kNone;
  std::optional<ChangeKind> or_kind;  ///< explains it nearly as well
  double size_m = 0.0;                ///< of the change: the largest displacement of a body

  /// Place along the arm at zero input: that of the alarm, else of the largest mismatch against the laws.
  double s_m = 0.0;                     ///< likeliest
  double s_from_m = 0.0, s_to_m = 0.0;  ///< where it may be
  std::optional<int> body;              ///< body at, or next to, that place
  MismatchAxis axis = MismatchAxis::kNone;
  std::string description;  ///< one line for people
};

struct MismatchMonitorParams {
  double threshold_sd = 6.0;        ///< change beyond which there is an alarm
  double confirm_s = 0.15;          ///< it must last so long
  double learn_s = 4.0;             ///< no alarm before so much has been seen
  double payload_hold_off_s = 2.0;  ///< no alarm for so long after the payload changed: a hand was there
  double memory_s = 60.0;           ///< time after which what was learned of the arm is doubted
  double accept_after_s = 30.0;     ///< an alarm that lasts longer is taken as how the arm now is, and ends
};

/// Watches a stream of frames and their estimates.
///
/// A per-frame fit hides most of what happens to an arm in its free EI, M0, phi and L (collinearity, see
/// doc/mismatch.md). So bodies are not compared with the fit but with what the arm's laws say at the frame's
/// inputs, at the shape that is measured:
/// 1. Discrepancy e of every body: the laws' curvature (M + m(s)) / EI, with m(s) the moment of the weights
///    beyond s on the measured shape, and the laws' length, less curvature and length of the fit, integrated
///    along the backbone to a displacement; plus the residual of the fit. Independent of what the fit leaves
///    free.
/// 2. Bins of 25 ms, of which the last ten make a window; velocity and acceleration of every body from it.
///    The weights' inertia is added to their weight.
/// 3. A Kalman filter on the lasting errors of the laws (moment's zero, gain and direction, flexibility,
///    length, delay) and on a constant offset of every body: the slow reference. What it leaves is the
///    innovation, whose covariance is learned too, so that a poor model makes the monitor less sensitive, not
///    noisy.
/// 4. Generalised likelihood ratio of the innovation for each kind of change and place. The largest, as a
///    number of standard deviations, is change_sd.
/// 5. Alarm where that stays over the threshold; onset by going back through the innovations projected on the
///    winner's signature. While there is an alarm the reference stands still.
///
/// Memory is bounded. Not thread-safe; one instance per stream. Time comes from stamps alone.
class SOFTARM_EXPORT MismatchMonitor {
 public:
  explicit MismatchMonitor(const arm::Arm& arm) : MismatchMonitor(arm, MismatchMonitorParams()) {}
  MismatchMonitor(const arm::Arm& arm, const MismatchMonitorParams& params);
  ~MismatchMonitor();
  MismatchMonitor(MismatchMonitor&&) noexcept;
  MismatchMonitor& operator=(MismatchMonitor&&) noexcept;

  /// What the estimator was told to find: an unknown payload may change at any time without being a mismatch.
  void set_unknown(arm::Unknown unknown);

  /// Frames in order of their stamps; one that goes back by more than a second is a reset. Estimates that are
  /// not ok, or have fewer than five points of backbone, count as frames not seen.
  /// @return valid until the next call
  const Mismatch& add(const trial::Frame& frame, const estimate::Estimate& estimate);

  /// Forgets everything, what was learned too.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softarm::monitor
