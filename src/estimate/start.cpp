#include "start.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "math/so3.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::Vector3d;

/// A circular arc between two measured places.
struct Arc {
  double s_from = 0.0, s_to = 0.0;
  Vector3d p_from = Vector3d::Zero(), p_to = Vector3d::Zero();
  Eigen::Quaterniond q_from = Eigen::Quaterniond::Identity();  ///< section frame at the start
  Vector3d turn = Vector3d::Zero();                            ///< rotation vector along the arc, in q_from
  double length = 0.0;
};

Arc arc_to(const Arc& last, double s, const Vector3d& p) {
  Arc arc;
  arc.s_from = last.s_to;
  arc.s_to = s;
  arc.p_from = last.p_to;
  arc.p_to = p;
  arc.q_from = (last.q_from * math::exp_so3(last.turn)).normalized();
  const Vector3d chord = arc.q_from.conjugate() * (p - arc.p_from);
  const double across = std::hypot(chord.x(), chord.y());
  const double half = std::atan2(across, chord.z());
  if (across > 1e-9) arc.turn = 2.0 * half * Vector3d(-chord.y(), chord.x(), 0.0) / across;
  arc.length = chord.norm() * (half > 1e-6 ? half / std::sin(half) : 1.0);
  return arc;
}

/// Point at fraction f of a cubic from p0 to p1 with these unit tangents, as near to an arc as a cubic comes.
/// Where a body's tangent is measured the shape before it takes more than one arc.
Vector3d cubic(const Vector3d& p0, const Vector3d& t0, const Vector3d& p1, const Vector3d& t1, double length,
               double f) {
  const double angle = std::atan2(t0.cross(t1).norm(), t0.dot(t1));
  const double speed = length * (angle > 1e-3 ? 4.0 * std::tan(0.25 * angle) / angle : 1.0);
  const double g = 1.0 - f;
  return g * g * (1.0 + 2.0 * f) * p0 + f * f * (3.0 - 2.0 * f) * p1 + speed * f * g * (g * t0 - f * t1);
}

/// Moment at p of everything that hangs beyond s, with the places taken from the arcs.
Vector3d load_moment(const rod::Rod& rod, const std::vector<Arc>& arcs, double s, const Vector3d& p) {
  const auto place = [&](double at) {
    for (const Arc& arc : arcs) {
      if (at <= arc.s_to || &arc == &arcs.back()) {
        const double f = (at - arc.s_from) / (arc.s_to - arc.s_from);
        const double bend = std::clamp(f, 0.0, 2.0);
        const Vector3d middle = arc.q_from * (math::exp_so3(0.5 * bend * arc.turn) * Vector3d::UnitZ());
        const double angle = 0.5 * bend * arc.turn.norm();
        return Vector3d(arc.p_from +
                        bend * arc.length * (angle > 1e-6 ? std::sin(angle) / angle : 1.0) * middle);
      }
    }
    return Vector3d(Vector3d::Zero());
  };
  Vector3d m = Vector3d::Zero();
  for (const rod::PointLoad& load : rod.loads) {
    if (load.s_m < s) continue;
    m += (place(load.s_m) - p).cross(load.mass_kg * rod.gravity_m_s2);
  }
  constexpr int kPieces = 8;
  double start = 0.0;
  for (const rod::Segment& segment : rod.segments) {
    for (int i = 0; i < kPieces; ++i) {
      const double at = start + (i + 0.5) / kPieces * segment.rest_length_m;
      if (at > s) m += (place(at) - p).cross(segment.mass_kg / kPieces * rod.gravity_m_s2);
    }
    start += segment.rest_length_m;
  }
  return m;
}

/// Curvature of an arc, and that by which the load's moment would bend a segment of unit flexibility there.
struct Sample {
  double weight;
  Vector3d curvature, load;
};

/// Slope of curvature against load, drawn towards 1 by as much as noise in the curvature deserves.
double flexibility_from(const std::vector<Sample>& samples) {
  const double weight = kPolicy.start.curvature_sd_per_m / kPolicy.start.flexibility_sd;
  double total = 0.0;
  Eigen::Vector2d curvature = Eigen::Vector2d::Zero(), load = curvature;
  for (const Sample& s : samples) {
    total += s.weight;
    curvature += s.weight * s.curvature.head<2>();
    load += s.weight * s.load.head<2>();
  }
  if (samples.size() < 2) return 1.0;
  curvature /= total;
  load /= total;
  double xx = weight * weight, xy = xx;
  for (const Sample& s : samples) {
    const Eigen::Vector2d x = s.load.head<2>() - load;
    xx += x.squaredNorm();
    xy += x.dot(s.curvature.head<2>() - curvature);
  }
  return xy / xx;
}

/// Arcs from the base through the places of the bodies in use, in order of arclength; where a tangent is
/// measured, several up to it.
std::vector<Arc> arcs_through(const arm::Arm& arm, const Problem& problem) {
  std::vector<const Observation*> seen;
  for (const Observation& o : problem.observations()) {
    if (o.used) seen.push_back(&o);
  }
  std::sort(seen.begin(), seen.end(), [&](const Observation* a, const Observation* b) {
    return arm.bodies[static_cast<std::size_t>(a->body)].arclength_m <
           arm.bodies[static_cast<std::size_t>(b->body)].arclength_m;
  });
  std::vector<Arc> arcs;
  Arc last;
  for (const Observation* o : seen) {
    const double s = arm.bodies[static_cast<std::size_t>(o->body)].arclength_m;
    if (s - last.s_to < kPolicy.start.too_close * arm.total_length_m()) continue;
    if (!o->tangent) {
      last = arc_to(last, s, problem.measured_for_laws(*o));
      arcs.push_back(last);
      continue;
    }
    constexpr int kPieces = 4;
    const Arc before = last;
    const Vector3d tangent = before.q_from * (math::exp_so3(before.turn) * Vector3d::UnitZ());
    for (int i = 1; i <= kPieces; ++i) {
      const double f = static_cast<double>(i) / kPieces;
      last = arc_to(last, before.s_to + f * (s - before.s_to),
                    cubic(before.p_to, tangent, problem.measured_for_laws(*o), problem.tangent_for_laws(*o),
                          s - before.s_to, f));
      arcs.push_back(last);
    }
  }
  return arcs;
}

/// What the arcs say of the segment from `begin` to `end`, m.
struct Covered {
  Vector3d turn = Vector3d::Zero();
  double covered_m = 0.0, length_m = 0.0;
  std::vector<Sample> samples;
};

Covered covered_by(const std::vector<Arc>& arcs, const rod::Rod& rod, double begin, double end,
                   double reference_stiffness_nm2) {
  Covered result;
  for (const Arc& arc : arcs) {
    // A segment beyond the last arc continues it.
    const double to = &arc == &arcs.back() ? std::max(arc.s_to, end) : arc.s_to;
    const double overlap = std::min(to, end) - std::max(arc.s_from, begin);
    if (overlap <= 0.0) continue;
    const double span = arc.s_to - arc.s_from;
    result.turn += overlap / span * arc.turn;
    result.length_m += overlap / span * arc.length;
    result.covered_m += overlap;
    const Eigen::Quaterniond q = arc.q_from * math::exp_so3(0.5 * arc.turn);
    const Vector3d moment =
        q.conjugate() * load_moment(rod, arcs, 0.5 * (arc.s_from + arc.s_to), 0.5 * (arc.p_from + arc.p_to));
    result.samples.push_back({overlap, arc.turn / arc.length, moment / reference_stiffness_nm2});
  }
  return result;
}

double stretch_of(const Covered& seen, const arm::Segment& segment, double rest_m) {
  const double stretch = seen.covered_m > 0.0 ? seen.length_m / seen.covered_m : 1.0;
  if (segment.length_range_m.high > 0.0) {
    return std::clamp(stretch, segment.length_range_m.low / rest_m, segment.length_range_m.high / rest_m);
  }
  return std::clamp(stretch, kPolicy.start.least_stretch, kPolicy.start.most_stretch);
}

}  // namespace

Start start_from_shape(const arm::Arm& arm, const Problem& problem,
                       const std::vector<std::optional<double>>& flexibility, double payload_kg) {
  const int segments = static_cast<int>(arm.segments.size());
  Start start;
  start.x = Eigen::VectorXd::Zero(segments * kSegmentParameters + 1);
  const std::vector<Arc> arcs = arcs_through(arm, problem);
  rod::Rod rod = problem.rod();
  rod.loads[rod::kPayloadLoad].mass_kg = payload_kg;

  double begin = 0.0;
  start.q_tip = Eigen::Quaterniond::Identity();
  for (int i = 0; i < segments; ++i) {
    const double rest = problem.rest_length(i);
    const double reference = problem.reference_stiffness(i);
    const double end = begin + rest;
    const Covered seen = covered_by(arcs, rod, begin, end, reference);
    const arm::Segment& segment = arm.segments[static_cast<std::size_t>(i)];
    const auto& given = flexibility[static_cast<std::size_t>(i)];
    const double c = given ? *given
                           : std::clamp(flexibility_from(seen.samples),
                                        reference / segment.bending_stiffness_range_nm2.high,
                                        reference / segment.bending_stiffness_range_nm2.low);
    if (seen.covered_m > 0.0) {
      Vector3d actuation = -segment.rest_curvature_per_m;
      for (const Sample& sample : seen.samples)
        actuation += sample.weight / seen.covered_m * (sample.curvature - c * sample.load);
      start.x[Problem::column(i, 0)] = actuation.y() * rest;
      start.x[Problem::column(i, 1)] = -actuation.x() * rest;
      start.q_tip = start.q_tip * math::exp_so3(seen.turn * rest / seen.covered_m);
    }
    start.x[Problem::column(i, 2)] = c;
    start.x[Problem::column(i, 3)] = stretch_of(seen, segment, rest);
    begin = end;
  }
  start.q_tip.normalize();
  start.x[segments * kSegmentParameters] = payload_kg / Problem::kPayloadUnit;
  return start;
}

}  // namespace softarm::estimate
