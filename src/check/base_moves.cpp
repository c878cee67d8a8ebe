// A mount that moves during the trial, or cameras that do.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "math_of_poses.h"
#include "policy.h"

namespace softarm::check {
namespace {

/// The mount's pose, averaged over blocks of time.
struct Blocks {
  std::vector<double> times;
  std::vector<Eigen::Vector3d> places;
  std::vector<std::optional<Eigen::Quaterniond>> attitudes;

  double turn(std::size_t a, std::size_t b) const {
    return attitudes[a] && attitudes[b] ? rotation_between(*attitudes[a], *attitudes[b]).norm() : 0.0;
  }
};

Blocks blocks_of(const Track& base) {
  Blocks blocks;
  const double block_s =
      std::max(kPolicy.places.base_block_s, kPolicy.places.base_block_periods * base.period_s);
  for (double t = base.poses.front().t_s; t + block_s <= base.poses.back().t_s; t += block_s) {
    const auto p = base.mean_position(t, t + block_s);
    if (!p) continue;
    blocks.times.push_back(t + 0.5 * block_s);
    blocks.places.push_back(*p);
    blocks.attitudes.push_back(base.mean_orientation(t, t + block_s));
  }
  return blocks;
}

/// How far the mount gets from where it was, and the largest step of it.
struct Moves {
  double far_m = 0.0, far_rad = 0.0;
  double step_m = 0.0, step_rad = 0.0;
  double usual_m = 0.0, usual_rad = 0.0;  // from block to block: noise, correlated noise included
  double step_at_s = 0.0;
};

Moves moves_of(const Blocks& blocks) {
  const auto& places = blocks.places;
  Moves moves;
  std::vector<double> neighbours_m, neighbours_rad;
  std::size_t step_at = 0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    neighbours_m.push_back((places[i] - places[i - 1]).norm());
    neighbours_rad.push_back(blocks.turn(i - 1, i));
    moves.far_m = std::max(moves.far_m, (places[i] - places[0]).norm());
    moves.far_rad = std::max(moves.far_rad, blocks.turn(0, i));
    if (i < 2) continue;
    // Over two blocks: the step itself may lie within one.
    if ((places[i] - places[i - 2]).norm() > moves.step_m) {
      moves.step_m = (places[i] - places[i - 2]).norm();
      step_at = i - 1;
    }
    moves.step_rad = std::max(moves.step_rad, blocks.turn(i - 2, i));
  }
  moves.usual_m = math::median(neighbours_m);
  moves.usual_rad = math::median(neighbours_rad);
  moves.step_at_s = blocks.times[step_at];
  return moves;
}

void check_base_moves(Context& context) {
  const Track& base = context.tracks[0];
  if (base.poses.size() < kPolicy.places.base_poses) return;
  const Blocks blocks = blocks_of(base);
  if (blocks.places.size() < kPolicy.places.base_blocks) return;
  const Moves moves = moves_of(blocks);
  if (moves.far_m <
          context.of_length(kPolicy.places.base_moves) + kPolicy.places.base_moves_usual * moves.usual_m &&
      moves.far_rad < kPolicy.places.base_moves_rad + kPolicy.places.base_moves_usual * moves.usual_rad)
    return;
  const bool bumped = moves.step_m > kPolicy.places.bumped * moves.far_m ||
                      moves.step_rad > kPolicy.places.bumped * moves.far_rad;
  const bool far =
      moves.far_m > context.of_length(kPolicy.places.base_far) || moves.far_rad > kPolicy.places.base_far_rad;
  CheckFinding& finding = context.add(
      far ? Severity::kSerious : Severity::kWarning, bumped ? "base_bumped" : "base_drifts", base.name,
      fmt::format("the mount {} by {:.2g} mm and {:.2g} deg", bumped ? "moves suddenly," : "drifts",
                  1e3 * moves.far_m, moves.far_rad / kDegree));
  finding.figure = moves.far_m;
  finding.unit = "m";
  if (bumped) finding.spans = {{moves.step_at_s, moves.step_at_s}};
  finding.remedy =
      "clamp the mount and the cameras; the shape is measured relative to the base, so what matters is "
      "whether the direction of gravity in the mocap frame changed: if the cameras were bumped, leave out "
      "what comes after";
}

}  // namespace

Check make_base_moves() {
  return {check_base_moves, {{"base_bumped", {}}, {"base_drifts", {}}}};
}

}  // namespace softarm::check
