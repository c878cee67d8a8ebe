// State of the live monitor.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "arm/wall_memory.h"
#include "monitor_changes.h"
#include "monitor_reference.h"
#include "monitor_shape.h"
#include "monitor_window.h"
#include "softarm/arm/laws.h"
#include "softarm/monitor/mismatch_monitor.h"

namespace softarm::monitor {

inline constexpr std::size_t kHistory = 100;  // windows, one per bin: 2.5 s

/// One window that was looked at.
struct Past {
  double to_s = 0.0;
  Displacements innovation;
  std::vector<arm::SegmentPrediction> laws;  ///< empty: none
};

struct MismatchMonitor::Impl {
  Impl(const arm::Arm& arm_in, const MismatchMonitorParams& params_in)
      : arm(arm_in),
        memory(arm),
        params(params_in),
        shape(arm),
        window(arm.bodies.size()),
        reference(arm, params.memory_s, typical_sd(arm)),
        test(arm),
        unknown(arm.estimator.unknown),
        seen(arm.bodies.size(), 0),
        history(kHistory) {
    const auto rows = static_cast<Eigen::Index>(3 * arm.bodies.size());
    discrepancy.setZero(rows);
    place.setZero(rows);
    inertia.setZero(rows);
    innovation.setZero(rows);
    over_innovation.setZero(rows);
    for (Past& past : history) past.innovation.setZero(rows);
    reset();
  }

  static double typical_sd(const arm::Arm& arm) {
    double square = 0.0;
    for (const arm::MeasuredBody& body : arm.bodies) square += body.position_sd_m * body.position_sd_m;
    return std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, arm.bodies.size())));
  }

  void reset();
  void add(const trial::Frame& frame, const estimate::Estimate& estimate);
  void note_payload(const trial::Frame& frame);
  void step(double stamp_s);
  void score();
  void look_for_change();
  void decide();
  void name_change();
  void end_alarm();
  void learn(double dt_s);
  double onset() const;
  MismatchAxis axis_of(const Eigen::Vector3d& displacement, int body) const;

  arm::Arm arm;
  arm::LawMemory memory;  ///< of the walls
  MismatchMonitorParams params;
  MonitorShape shape;
  MonitorWindow window;
  SlowReference reference;
  ChangeTest test;
  arm::Unknown unknown;
  Mismatch mismatch;
  Mismatch named;  ///< of the alarm: onset, kind, place

  std::vector<char> seen;
  Displacements discrepancy, place, inertia, innovation;
  Displacements over_innovation;  ///< when the change went over the threshold
  std::optional<std::vector<arm::SegmentPrediction>> predictions;
  std::vector<Past> history;  // a ring
  std::size_t next_past = 0, pasts = 0;

  std::optional<double> last_frame_s, last_step_s, first_s, payload_change_s, over_since_s, below_since_s,
      suspicious_since_s, alarm_since_s;
  std::optional<double> payload_kg;
  double since_update_s = 0.0;
  bool payload_seen = false, had_laws = false, winner_valid = false;
  ChangeHypothesis winner;
};

}  // namespace softarm::monitor
