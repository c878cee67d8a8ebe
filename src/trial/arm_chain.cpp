#include "arm_chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::trial {
namespace {

constexpr double kSlackM = 0.004;         // of a mount: a marker is not exactly where the arm file says
constexpr double kLengthSdRel = 0.1;      // of a link against its chord
constexpr double kBendSdRad = 1.2;        // of one link
constexpr double kBendChangeSdRad = 0.6;  // from link to link
constexpr double kFoldedRad = 2.8;        // no link bends by more
constexpr int kMostVisits = 6000;

double square(double x) {
  return x * x;
}

double sinc(double x) {
  return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

/// The chain as far as it has been followed.
struct Link {
  Eigen::Vector3d p, direction;
  double arclength_m = 0.0, off_axis_m = 0.0;
  double half_m = 0.0;  // from the middle of the last link to p: its direction is that of its middle
  std::optional<Eigen::Vector3d> curvature;
  double cost = 0.0;
};

Link first_link(const Eigen::Isometry3d& rod_base) {
  Link link;
  link.p = rod_base.translation();
  link.direction = rod_base.linear().col(2);
  return link;
}

double reach_m(double arc_m, double off_axis_m, const ChainLimits& limits) {
  return arc_m * (1.0 + limits.stretch) + off_axis_m + kSlackM;
}

std::optional<Link> extend(const Link& from, const ChainBody& body, const Eigen::Vector3d& p,
                           const ChainLimits& limits) {
  const double arc_m = body.arclength_m - from.arclength_m;
  const double slack_m = body.off_axis_m + from.off_axis_m + kSlackM;
  const Eigen::Vector3d step = p - from.p;
  const double length_m = step.norm();
  if (!(length_m <= reach_m(arc_m, body.off_axis_m + from.off_axis_m, limits))) return {};
  // Markers around one station say nothing of the backbone's direction.
  if (arc_m < slack_m) return from;

  Link to;
  to.p = p;
  to.direction = step / length_m;
  to.arclength_m = body.arclength_m;
  to.off_axis_m = body.off_axis_m;
  to.half_m = 0.5 * arc_m;
  if (!(length_m > 1e-9)) return {};
  const Eigen::Vector3d axis = from.direction.cross(to.direction);
  const double turn_rad = std::atan2(axis.norm(), from.direction.dot(to.direction));
  const double span_m = from.half_m + 0.5 * arc_m;
  const double bend_rad = turn_rad / span_m * arc_m;
  const double unsure_rad = slack_m / arc_m;
  if (!(bend_rad <= kFoldedRad + 4.0 * unsure_rad)) return {};
  to.curvature = axis.norm() > 1e-12 ? Eigen::Vector3d(axis.normalized() * turn_rad / span_m)
                                     : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const double chord_m = arc_m * sinc(0.5 * std::min(bend_rad, kFoldedRad));
  to.cost = from.cost + square((length_m - chord_m) / (kLengthSdRel * arc_m + slack_m)) +
            square(bend_rad / (kBendSdRad + unsure_rad));
  if (from.curvature) {
    to.cost +=
        square((*to.curvature - *from.curvature).norm() * arc_m / (kBendChangeSdRad + 2.0 * unsure_rad));
  }
  return to;
}

class Search {
 public:
  Search(const std::vector<ChainBody>& bodies, const std::vector<Place>& places, const Choice& known,
         const ChainLimits& limits)
      : bodies_(bodies), places_(places), known_(known), limits_(limits), choice_(bodies.size(), -1) {}

  void run(const Link& link, std::size_t body) {
    if (++visits_ > kMostVisits) return;
    if (!answers_.empty() && link.cost > best_ + limits_.ambiguity) return;
    if (body == bodies_.size()) {
      best_ = answers_.empty() ? link.cost : std::min(best_, link.cost);
      answers_.emplace_back(link.cost, choice_);
      return;
    }
    std::vector<std::pair<Link, int>> options;
    for (int place = 0; place < static_cast<int>(places_.size()); ++place) {
      if (!may_take(body, place)) continue;
      if (const auto next = extend(link, bodies_[body], places_[at(place)].p, limits_))
        options.emplace_back(*next, place);
    }
    // The best first: what comes later is cut off sooner.
    std::sort(options.begin(), options.end(),
              [](const auto& a, const auto& b) { return a.first.cost < b.first.cost; });
    for (const auto& [next, place] : options) {
      choice_[body] = place;
      run(next, body + 1);
    }
    choice_[body] = -1;
    if (known_[body] >= 0) return;
    Link without = link;
    without.cost += limits_.missing_cost;
    run(without, body + 1);
  }

  ChainAnswer answer() const {
    ChainAnswer result{known_, std::vector<bool>(bodies_.size(), false)};
    const bool too_long = visits_ > kMostVisits;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
      if (known_[body] >= 0) continue;
      std::optional<int> agreed;
      for (const auto& [cost, choice] : answers_) {
        if (cost > best_ + limits_.ambiguity) continue;
        if (!agreed) agreed = choice[body];
        if (*agreed != choice[body]) result.ambiguous[body] = true;
      }
      if (too_long) result.ambiguous[body] = true;
      if (agreed && !result.ambiguous[body]) result.choice[body] = *agreed;
    }
    return result;
  }

 private:
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }

  bool may_take(std::size_t body, int place) const {
    if (known_[body] >= 0) return known_[body] == place;
    const Place& wanted = places_[at(place)];
    if (wanted.kind != bodies_[body].kind) return false;
    for (std::size_t other = 0; other < bodies_.size(); ++other) {
      const int taken = other < body ? choice_[other] : known_[other];
      if (taken < 0) continue;
      if (taken == place || share_a_point(places_[at(taken)], wanted)) return false;
      const double arc_m = std::abs(bodies_[body].arclength_m - bodies_[other].arclength_m);
      const double off_axis_m = bodies_[body].off_axis_m + bodies_[other].off_axis_m;
      if ((wanted.p - places_[at(taken)].p).norm() > reach_m(arc_m, off_axis_m, limits_)) return false;
    }
    return true;
  }

  const std::vector<ChainBody>& bodies_;
  const std::vector<Place>& places_;
  const Choice& known_;
  const ChainLimits& limits_;
  Choice choice_;
  int visits_ = 0;
  double best_ = 0.0;
  std::vector<std::pair<double, Choice>> answers_;
};

}  // namespace

bool share_a_point(const Place& a, const Place& b) {
  return std::find_first_of(a.points.begin(), a.points.end(), b.points.begin(), b.points.end()) !=
         a.points.end();
}

std::optional<double> chain_cost(const Eigen::Isometry3d& rod_base, const std::vector<ChainBody>& bodies,
                                 const std::vector<Place>& places, const Choice& choice,
                                 const ChainLimits& limits) {
  Link link = first_link(rod_base);
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    if (choice[body] < 0) continue;
    const auto next = extend(link, bodies[body], places[static_cast<std::size_t>(choice[body])].p, limits);
    if (!next) return {};
    link = *next;
  }
  return link.cost;
}

ChainAnswer find_chain(const Eigen::Isometry3d& rod_base, const std::vector<ChainBody>& bodies,
                       const std::vector<Place>& places, const Choice& known, const ChainLimits& limits) {
  Search search(bodies, places, known, limits);
  search.run(first_link(rod_base), 0);
  return search.answer();
}

}  // namespace softarm::trial
