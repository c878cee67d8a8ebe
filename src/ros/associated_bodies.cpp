#include <memory>

#include "marker_bodies.h"
#include "trial/point_association.h"

namespace softarm {
namespace {

constexpr char kSource[] = "markers";
constexpr double kTimeJump_s = 1.0;  // smaller steps back are late messages

struct State {
  explicit State(const arm::Arm& arm) : associator(arm), bodies(arm.bodies.size()) {}
  trial::PointAssociator associator;
  std::size_t bodies;
  std::optional<double> stamp_s;
  std::uint64_t ghosts = 0, restarts = 0;
};

/// Those that are measurements.
std::vector<Eigen::Vector3d> points_of(const std::vector<ReportedMarker>& markers,
                                       trial::FrameAssembler& assembler) {
  std::vector<Eigen::Vector3d> points;
  for (const ReportedMarker& marker : markers) {
    if (marker.lost) {
      assembler.count_rejected(marker.lost, kSource);
    } else if (!marker.p_mocap.allFinite()) {
      assembler.count_rejected("nan", kSource);
    } else if (marker.p_mocap.isZero(0.0)) {
      assembler.count_rejected("all_zero", kSource);
    } else {
      points.push_back(marker.p_mocap);
    }
  }
  return points;
}

}  // namespace

MarkerSink associated_bodies(const arm::Arm& arm) {
  const auto state = std::make_shared<State>(arm);
  return [state](trial::Stamp stamp, const std::vector<ReportedMarker>& markers,
                 trial::FrameAssembler& assembler) {
    const double stamp_s = stamp.s;
    if (!(stamp_s > 0.0)) return assembler.count_rejected("bad_stamp", kSource);
    if (state->stamp_s && stamp_s <= *state->stamp_s && stamp_s > *state->stamp_s - kTimeJump_s) {
      return assembler.count_rejected(stamp_s == *state->stamp_s ? "duplicate" : "late", kSource);
    }
    trial::PointAssociator& associator = state->associator;
    if (assembler.is_alone_in_time(stamp)) {
      // The assembler counts them and waits for the next message; the associator keeps its tracks meanwhile.
      for (std::size_t i = 0; i < state->bodies; ++i)
        assembler.add_missing_body(static_cast<int>(i), stamp, "time_gap");
      return;
    }
    state->stamp_s = stamp_s;
    const auto positions =
        associator.update(stamp_s, points_of(markers, assembler), assembler.base_body_pose());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const int body = static_cast<int>(i);
      if (positions[i]) {
        assembler.add_body(body, stamp, *positions[i], std::nullopt);
      } else {
        assembler.add_missing_body(body, stamp, trial::PointAssociator::name(associator.outcomes()[i]));
      }
    }
    assembler.count_rejected("ghost", kSource, associator.points_unused() - state->ghosts);
    assembler.count_rejected("association_restarted", kSource, associator.restarts() - state->restarts);
    state->ghosts = associator.points_unused();
    state->restarts = associator.restarts();
  };
}

}  // namespace softarm
