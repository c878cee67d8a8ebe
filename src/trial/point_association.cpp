#include "point_association.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "arm_chain.h"
#include "assignment.h"
#include "marker_clusters.h"

namespace softarm::trial {
namespace {

constexpr double kVagueM = 0.01;        // a prediction with this standard deviation is no better than none
constexpr double kClearlyBetter = 3.0;  // times the ambiguity: a free place that the geometry prefers so much

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

double square(double x) {
  return x * x;
}

}  // namespace

struct PointAssociator::Instant {
  double stamp_s = 0.0;
  std::vector<Place> places;
  std::vector<ChainBody> bodies;
  std::optional<Eigen::Isometry3d> rod_base;
  ChainLimits limits;
  Choice choice;
};

PointAssociator::PointAssociator(const arm::Arm& arm, const AssociationLimits& limits)
    : limits_(limits), base_(arm.base), bodies_(arm.bodies) {
  if (bodies_.empty())
    throw std::invalid_argument("arm '" + arm.name + "' has no bodies that points could belong to");
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    // Clusters alike are of one kind: the first body's that has such a one.
    int kind = 0;
    for (std::size_t k = 0; k <= i && kind == 0 && bodies_[i].markers > 1; ++k) {
      const bool same = bodies_[k].markers == bodies_[i].markers &&
                        bodies_[k].marker_cluster_radius_m == bodies_[i].marker_cluster_radius_m;
      if (same) kind = static_cast<int>(k) + 1;
    }
    kinds_.push_back(kind);
  }
  reset();
}

void PointAssociator::reset() {
  tracks_.assign(bodies_.size(), std::nullopt);
  outcomes_.assign(bodies_.size(), Outcome::kNoPoint);
  stamp_s_.reset();
  broken_ = 0;
}

const char* PointAssociator::name(Outcome outcome) {
  switch (outcome) {
    case Outcome::kFollowed:
      return "followed";
    case Outcome::kFound:
      return "found";
    case Outcome::kNoPoint:
      return "no_point";
    case Outcome::kAmbiguous:
      return "ambiguous";
    case Outcome::kBrokenGeometry:
      return "broken_geometry";
  }
  return "unknown";
}

/// Finite points, each once.
std::vector<Eigen::Vector3d> PointAssociator::distinct(const std::vector<Eigen::Vector3d>& points) const {
  std::vector<Eigen::Vector3d> good;
  for (const Eigen::Vector3d& p : points) {
    const bool known = std::any_of(good.begin(), good.end(), [&](const Eigen::Vector3d& other) {
      return (other - p).norm() < limits_.min_spacing_m;
    });
    if (p.allFinite() && !known) good.push_back(p);
  }
  return good;
}

/// Nothing is chosen in it yet.
PointAssociator::Instant PointAssociator::instant_of(
    double stamp_s, const std::vector<Eigen::Vector3d>& points,
    const std::optional<Eigen::Isometry3d>& base_body) const {
  Instant instant;
  instant.stamp_s = stamp_s;
  instant.limits = {limits_.stretch, limits_.ambiguity, limits_.missing_cost};
  instant.choice.assign(bodies_.size(), -1);
  if (!base_.body) {
    instant.rod_base = base_.fixed_pose;
  } else if (base_body) {
    instant.rod_base = *base_body * base_.rod_in_body;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    instant.places.push_back({points[i], {static_cast<int>(i)}, 0});
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const arm::MeasuredBody& body = bodies_[i];
    const double off_axis_m =
        body.kind == arm::BodyKind::kRing ? body.section_in_body.translation().norm() : body.radius_m;
    instant.bodies.push_back({body.arclength_m, off_axis_m, kinds_[i]});
    if (kinds_[i] != static_cast<int>(i) + 1) continue;
    for (Place& place : clusters_through(points, body.markers, body.marker_cluster_radius_m, kinds_[i]))
      instant.places.push_back(std::move(place));
  }
  return instant;
}

/// Everything is looked for afresh from the next instant on; this one keeps its outcomes.
void PointAssociator::start_afresh(double stamp_s) {
  const auto outcomes = outcomes_;
  reset();
  stamp_s_ = stamp_s;
  outcomes_ = outcomes;
  ++restarts_;
}

std::vector<std::optional<Eigen::Vector3d>> PointAssociator::update(
    double stamp_s, const std::vector<Eigen::Vector3d>& points,
    const std::optional<Eigen::Isometry3d>& base_body) {
  if (stamp_s_ && !(std::abs(stamp_s - *stamp_s_) <= limits_.time_jump_s)) {
    reset();
    ++restarts_;
  }
  stamp_s_ = std::max(stamp_s_.value_or(stamp_s), stamp_s);

  const std::vector<Eigen::Vector3d> good = distinct(points);
  std::vector<std::optional<Eigen::Vector3d>> result(bodies_.size());
  outcomes_.assign(bodies_.size(), Outcome::kNoPoint);
  if (good.size() > limits_.max_points) {
    outcomes_.assign(bodies_.size(), Outcome::kAmbiguous);
    points_unused_ += good.size();
    return result;
  }
  Instant instant = instant_of(stamp_s, good, base_body);
  follow(instant);
  look_for(instant);
  if (holds(instant)) {
    broken_ = 0;
  } else if (++broken_ >= limits_.broken_after_samples) {
    start_afresh(stamp_s);
    points_unused_ += good.size();
    return result;
  }
  std::vector<bool> used(good.size(), false);
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    if (instant.choice[body] < 0) continue;
    const Place& place = instant.places[index(instant.choice[body])];
    result[body] = place.p;
    remember(stamp_s, body, place.p);
    for (int point : place.points) used[index(point)] = true;
  }
  points_unused_ += static_cast<std::uint64_t>(std::count(used.begin(), used.end(), false));
  return result;
}

bool PointAssociator::is_predicted(std::size_t body, double stamp_s) const {
  const auto& track = tracks_[body];
  return track && track->velocity && std::abs(stamp_s - track->stamp_s) <= limits_.remembered_s;
}

void PointAssociator::follow(Instant& instant) {
  // Rows are the bodies that are remembered; columns the places, then each row's own "absent".
  std::vector<std::size_t> rows;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    if (is_predicted(body, instant.stamp_s)) rows.push_back(body);
  }
  if (rows.empty()) return;
  const auto places = static_cast<Eigen::Index>(instant.places.size());
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(count, places + count, kForbidden);
  for (Eigen::Index row = 0; row < count; ++row) {
    const std::size_t body = rows[static_cast<std::size_t>(row)];
    const Track& track = *tracks_[body];
    const double dt = instant.stamp_s - track.stamp_s;
    const double drift_m = 0.5 * limits_.acceleration_m_s2 * dt * dt;
    const double sd_m =
        std::sqrt(square(limits_.jitter_m) + 4.0 * square(bodies_[body].position_sd_m) + square(drift_m));
    const Eigen::Vector3d expected = track.p + dt * *track.velocity;
    // -2 ln of a normal density in three dimensions: a vague prediction must not outbid a sharp one.
    const double vagueness = 6.0 * std::log(sd_m / kVagueM);
    for (Eigen::Index j = 0; j < places; ++j) {
      const Place& place = instant.places[static_cast<std::size_t>(j)];
      const double sds = (place.p - expected).norm() / sd_m;
      if (place.kind == kinds_[body] && sds <= limits_.gate_sds) cost(row, j) = square(sds) + vagueness;
    }
    cost(row, places + row) = square(limits_.gate_sds);
  }
  const std::vector<int> best = cheapest_assignment(cost);
  const double least = total_cost(cost, best);
  for (Eigen::Index row = 0; row < count; ++row) {
    const int column = best[static_cast<std::size_t>(row)];
    if (column >= places) continue;
    const std::size_t body = rows[static_cast<std::size_t>(row)];
    const auto in_gate = [&](const auto& costs) { return (costs.array() < kForbidden).count(); };
    const bool contested = in_gate(cost.row(row).head(places)) > 1 || in_gate(cost.col(column)) > 1;
    if (contested) {
      Eigen::MatrixXd otherwise = cost;
      otherwise(row, column) = kForbidden;
      if (total_cost(otherwise, cheapest_assignment(otherwise)) - least < limits_.ambiguity) {
        outcomes_[body] = Outcome::kAmbiguous;
        continue;
      }
    }
    instant.choice[body] = column;
    outcomes_[body] = Outcome::kFollowed;
  }
}

void PointAssociator::look_for(Instant& instant) {
  if (!instant.rod_base) return;
  // Where two points contend for a place that was predicted, what fits the arm roughly does not decide.
  std::vector<std::size_t> wanted;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    if (!is_predicted(body, instant.stamp_s)) wanted.push_back(body);
  }
  if (wanted.empty()) return;
  const ChainAnswer answer =
      find_chain(*instant.rod_base, instant.bodies, instant.places, instant.choice, instant.limits);
  for (std::size_t body : wanted) {
    instant.choice[body] = answer.choice[body];
    if (answer.choice[body] >= 0) {
      outcomes_[body] = Outcome::kFound;
    } else if (answer.ambiguous[body]) {
      outcomes_[body] = Outcome::kAmbiguous;
    }
  }
}

bool PointAssociator::holds(Instant& instant) {
  if (!instant.rod_base) return true;
  const auto cost_of = [&](const Choice& choice) {
    return chain_cost(*instant.rod_base, instant.bodies, instant.places, choice, instant.limits)
        .value_or(std::numeric_limits<double>::infinity());
  };
  const double cost = cost_of(instant.choice);
  std::vector<std::size_t> to_blame;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    if (instant.choice[body] < 0) continue;
    Choice other = instant.choice;
    if (!std::isfinite(cost)) {
      other[body] = -1;
      if (std::isfinite(cost_of(other))) to_blame.push_back(body);
      continue;
    }
    // Has a ghost taken the body's place? Then the body itself is a free place that fits far better.
    for (int place = 0; place < static_cast<int>(instant.places.size()); ++place) {
      const bool taken = std::any_of(instant.choice.begin(), instant.choice.end(), [&](int c) {
        return c >= 0 && c != instant.choice[body] &&
               share_a_point(instant.places[index(c)], instant.places[index(place)]);
      });
      if (taken || place == instant.choice[body] || instant.places[index(place)].kind != kinds_[body])
        continue;
      other[body] = place;
      if (cost_of(other) < cost - kClearlyBetter * limits_.ambiguity) {
        to_blame.push_back(body);
        break;
      }
    }
  }
  if (std::isfinite(cost) && to_blame.empty()) return true;
  if (to_blame.empty()) {
    for (std::size_t body = 0; body < bodies_.size(); ++body) to_blame.push_back(body);
  }
  for (std::size_t body : to_blame) {
    if (instant.choice[body] >= 0) outcomes_[body] = Outcome::kBrokenGeometry;
    instant.choice[body] = -1;
  }
  return false;
}

void PointAssociator::remember(double stamp_s, std::size_t body, const Eigen::Vector3d& p) {
  auto& track = tracks_[body];
  if (track && stamp_s <= track->stamp_s) return;
  Track now{stamp_s, p, {}};
  if (track && stamp_s - track->stamp_s <= limits_.remembered_s) {
    const Eigen::Vector3d velocity = (p - track->p) / (stamp_s - track->stamp_s);
    // Half of the old one: noise of a difference of two samples is large at high rates.
    if (velocity.norm() <= limits_.max_speed_m_s)
      now.velocity = track->velocity ? Eigen::Vector3d(0.5 * (velocity + *track->velocity)) : velocity;
  }
  track = now;
}

}  // namespace softarm::trial
