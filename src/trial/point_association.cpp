#include "point_association.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "arm_chain.h"
#include "assignment.h"
#include "marker_clusters.h"

namespace softarm::trial {
namespace {

constexpr double kVagueM = 0.01;        // a prediction with this standard deviation is no better than none
constexpr double kClearlyBetter = 3.0;  // times the ambiguity: a free place that the geometry prefers so much

// What becomes of a followed point of no body, where it is none of the instant's points: hidden for a moment,
// no longer followed, not looked for so far.
constexpr int kHidden = -1, kNoLonger = -2, kNotLookedFor = -3;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

double square(double x) {
  return x * x;
}

}  // namespace

struct PointAssociator::Instant {
  double stamp_s = 0.0;
  std::vector<Place> places;  // the points, in their order; then the clusters
  std::size_t points = 0;
  std::vector<ChainBody> bodies;
  std::optional<Eigen::Isometry3d> rod_base;
  ChainLimits limits;
  Choice choice;
  std::vector<int> others;  // per other point that is followed: its point, or what became of it
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
    noise_m_ = std::max(noise_m_, bodies_[i].position_sd_m);
  }
  reset();
}

void PointAssociator::reset() {
  tracks_.assign(bodies_.size(), std::nullopt);
  others_.clear();
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

/// Finite points, each once; of too many only so many as say that they are: a camera's cloud has 300,000.
std::vector<Eigen::Vector3d> PointAssociator::distinct(const std::vector<Eigen::Vector3d>& points) const {
  std::vector<Eigen::Vector3d> good;
  for (const Eigen::Vector3d& p : points) {
    const bool known = std::any_of(good.begin(), good.end(), [&](const Eigen::Vector3d& other) {
      return (other - p).norm() < limits_.min_spacing_m;
    });
    if (p.allFinite() && !known) good.push_back(p);
    if (good.size() > limits_.max_points) break;
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
  instant.points = points.size();
  instant.others.assign(others_.size(), kNotLookedFor);
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
    points_unused_ += points.size();
    return result;
  }
  Instant instant = instant_of(stamp_s, good, base_body);
  follow(instant);
  follow_others(instant);
  look_for(instant);
  if (holds(instant)) {
    broken_ = 0;
  } else if (++broken_ >= limits_.broken_after_samples) {
    start_afresh(stamp_s);
    points_unused_ += good.size();
    return result;
  }
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    if (instant.choice[body] < 0) continue;
    result[body] = instant.places[index(instant.choice[body])].p;
    remember(stamp_s, body, *result[body]);
  }
  const std::vector<bool> used = used_points(instant);
  remember_others(instant, used);
  points_unused_ += static_cast<std::uint64_t>(std::count(used.begin(), used.end(), false));
  return result;
}

bool PointAssociator::is_remembered(const Track& track, double stamp_s) const {
  return track.velocity && std::abs(stamp_s - track.stamp_s) <= limits_.remembered_s;
}

bool PointAssociator::is_predicted(std::size_t body, double stamp_s) const {
  return tracks_[body] && is_remembered(*tracks_[body], stamp_s);
}

PointAssociator::Expected PointAssociator::expected(const Track& track, double noise_m,
                                                    double stamp_s) const {
  const double dt = stamp_s - track.stamp_s;
  // What was seen once may be anywhere that it can have reached.
  const double drift_m = track.velocity ? 0.5 * limits_.acceleration_m_s2 * dt * dt
                                        : limits_.max_speed_m_s * dt / limits_.gate_sds;
  const double sd_m = std::sqrt(square(limits_.jitter_m) + 4.0 * square(noise_m) + square(drift_m));
  return {track.velocity ? Eigen::Vector3d(track.p + dt * *track.velocity) : track.p, sd_m};
}

/// -2 ln of a normal density in three dimensions: a vague prediction must not outbid a sharp one.
double PointAssociator::cost_at(const Expected& there, const Eigen::Vector3d& p) const {
  const double sds = (p - there.p).norm() / there.sd_m;
  if (!(sds <= limits_.gate_sds)) return kForbidden;
  return square(sds) + 6.0 * std::log(there.sd_m / kVagueM);
}

/// Cost of each body of `rows` at each place; below them of each of `rivals`, the other points that contend
/// for such a place.
Eigen::MatrixXd PointAssociator::contest(const Instant& instant, const std::vector<std::size_t>& rows,
                                         std::vector<std::size_t>& rivals) const {
  const auto places = static_cast<Eigen::Index>(instant.places.size());
  const auto count = static_cast<Eigen::Index>(rows.size());
  const auto most = count + static_cast<Eigen::Index>(others_.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(most, places, kForbidden);
  for (Eigen::Index row = 0; row < count; ++row) {
    const std::size_t body = rows[static_cast<std::size_t>(row)];
    const Expected there = expected(*tracks_[body], bodies_[body].position_sd_m, instant.stamp_s);
    for (Eigen::Index j = 0; j < places; ++j) {
      const Place& place = instant.places[static_cast<std::size_t>(j)];
      if (place.kind == kinds_[body]) cost(row, j) = cost_at(there, place.p);
    }
  }
  for (std::size_t other = 0; other < others_.size(); ++other) {
    if (!is_remembered(others_[other].track, instant.stamp_s)) continue;
    const Expected there = expected(others_[other].track, noise_m_, instant.stamp_s);
    const Eigen::Index last = count + static_cast<Eigen::Index>(rivals.size());
    // One that began when the body was no longer seen may be the body: it does not keep it from its place.
    bool contends = false, may_be_the_body = false;
    for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(instant.points); ++j) {
      cost(last, j) = cost_at(there, instant.places[static_cast<std::size_t>(j)].p);
      for (Eigen::Index row = 0; row < count && cost(last, j) < kForbidden; ++row) {
        if (cost(row, j) >= kForbidden) continue;
        contends = true;
        const Track& body = *tracks_[rows[static_cast<std::size_t>(row)]];
        may_be_the_body = may_be_the_body || others_[other].since_s > body.stamp_s;
      }
    }
    if (contends && !may_be_the_body) {
      rivals.push_back(other);
    } else {
      cost.row(last).setConstant(kForbidden);
    }
  }
  return cost.topRows(count + static_cast<Eigen::Index>(rivals.size()));
}

void PointAssociator::follow(Instant& instant) {
  // Rows are the bodies that are remembered and their rivals; columns the places, then each row's own
  // "absent".
  std::vector<std::size_t> rows, rivals;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    if (is_predicted(body, instant.stamp_s)) rows.push_back(body);
  }
  if (rows.empty()) return;
  const Eigen::MatrixXd at_places = contest(instant, rows, rivals);
  const Eigen::Index places = at_places.cols(), count = at_places.rows();
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(count, places + count, kForbidden);
  cost.leftCols(places) = at_places;
  cost.rightCols(count).diagonal().setConstant(square(limits_.gate_sds));
  const Assignment best = cheapest_assignment(cost);
  for (Eigen::Index row = 0; row < count; ++row) {
    const int column = best.column_of_row[static_cast<std::size_t>(row)];
    const auto at = static_cast<std::size_t>(row);
    const bool is_body = at < rows.size();
    int& choice = is_body ? instant.choice[rows[at]] : instant.others[rivals[at - rows.size()]];
    choice = kHidden;
    if (column >= places) continue;
    const auto in_gate = [&](const auto& costs) { return (costs.array() < kForbidden).count(); };
    const bool contested = in_gate(cost.row(row).head(places)) > 1 || in_gate(cost.col(column)) > 1;
    if (contested && rise_without(cost, best, row, limits_.ambiguity) < limits_.ambiguity) {
      if (is_body) outcomes_[rows[at]] = Outcome::kAmbiguous;
      continue;
    }
    choice = column;
    if (is_body) outcomes_[rows[at]] = Outcome::kFollowed;
  }
}

/// Those that contend with no body take the nearest point, the oldest first.
void PointAssociator::follow_others(Instant& instant) const {
  std::vector<bool> taken = used_points(instant);
  for (int point : instant.others) {
    if (point >= 0) taken[index(point)] = true;
  }
  for (std::size_t other = 0; other < others_.size(); ++other) {
    if (instant.others[other] != kNotLookedFor) continue;
    const Expected there = expected(others_[other].track, noise_m_, instant.stamp_s);
    double nearest_m = limits_.gate_sds * there.sd_m;
    int& choice = instant.others[other];
    choice = is_remembered(others_[other].track, instant.stamp_s) ? kHidden : kNoLonger;
    for (std::size_t point = 0; point < instant.points; ++point) {
      const double distance_m = (instant.places[point].p - there.p).norm();
      if (distance_m > nearest_m) continue;
      nearest_m = distance_m;
      choice = static_cast<int>(point);
    }
    if (choice < 0) continue;
    if (taken[index(choice)]) {
      choice = kNoLonger;  // it was this body, or the older one
    } else {
      taken[index(choice)] = true;
    }
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
  // A body may be where a point was a moment ago: then what is left is not the body for want of a better one.
  std::vector<Place> places = instant.places;
  for (std::size_t other = 0; other < others_.size(); ++other) {
    if (instant.others[other] == kHidden)
      places.push_back({expected(others_[other].track, noise_m_, instant.stamp_s).p, {}, 0});
  }
  const ChainAnswer answer =
      find_chain(*instant.rod_base, instant.bodies, places, instant.choice, instant.limits);
  for (std::size_t body : wanted) {
    const bool is_hidden = answer.choice[body] >= static_cast<int>(instant.places.size());
    instant.choice[body] = is_hidden ? -1 : answer.choice[body];
    if (instant.choice[body] >= 0) {
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
  // No cost is below 0: with so little there is none that is clearly better, and nothing to compare.
  if (cost <= kClearlyBetter * limits_.ambiguity) return true;
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

std::vector<bool> PointAssociator::used_points(const Instant& instant) const {
  std::vector<bool> used(instant.points, false);
  for (int choice : instant.choice) {
    if (choice < 0) continue;
    for (int point : instant.places[index(choice)].points) used[index(point)] = true;
  }
  return used;
}

PointAssociator::Track PointAssociator::seen_again(const Track& before, double stamp_s,
                                                   const Eigen::Vector3d& p) const {
  Track now{stamp_s, p, {}};
  if (stamp_s - before.stamp_s > limits_.remembered_s) return now;
  const Eigen::Vector3d velocity = (p - before.p) / (stamp_s - before.stamp_s);
  // Half of the old one: noise of a difference of two samples is large at high rates.
  if (velocity.norm() <= limits_.max_speed_m_s)
    now.velocity = before.velocity ? Eigen::Vector3d(0.5 * (velocity + *before.velocity)) : velocity;
  return now;
}

void PointAssociator::remember(double stamp_s, std::size_t body, const Eigen::Vector3d& p) {
  auto& track = tracks_[body];
  if (track && stamp_s <= track->stamp_s) return;
  track = track ? seen_again(*track, stamp_s, p) : Track{stamp_s, p, {}};
}

void PointAssociator::remember_others(const Instant& instant, const std::vector<bool>& used) {
  if (instant.stamp_s < *stamp_s_) return;
  std::vector<bool> taken = used;
  std::vector<Other> others;
  for (std::size_t other = 0; other < others_.size(); ++other) {
    const int point = instant.others[other];
    if (point == kNoLonger || (point >= 0 && taken[index(point)])) continue;
    others.push_back(others_[other]);
    Track& track = others.back().track;
    if (point < 0) continue;
    taken[index(point)] = true;
    if (instant.stamp_s > track.stamp_s)
      track = seen_again(track, instant.stamp_s, instant.places[index(point)].p);
  }
  for (std::size_t point = 0; point < instant.points && others.size() < limits_.max_points; ++point) {
    if (!taken[point]) others.push_back({{instant.stamp_s, instant.places[point].p, {}}, instant.stamp_s});
  }
  others_ = std::move(others);
}

}  // namespace softarm::trial
