// What an alarm is about: kind, place, size, axis, onset.
#include <algorithm>
#include <cmath>

#include "mismatch_monitor_impl.h"
#include "policy.h"

namespace softarm::monitor {
namespace {

using Eigen::Vector3d;

}  // namespace

void MismatchMonitor::Impl::name_change() {
  named.kind = winner.kind;
  named.or_kind.reset();
  const ChangeHypothesis* second = test.runner_up();
  if (second && winner.kind != ChangeKind::kUnclear &&
      second->penalised > (1.0 - kPolicy.naming.lead_share) * winner.penalised - kPolicy.naming.lead) {
    named.or_kind = second->kind;
  }
  named.s_m = 0.5 * (winner.s_from_m + winner.s_to_m);
  test.widen(winner);
  named.s_from_m = winner.s_from_m;
  named.s_to_m = winner.s_to_m;
  const Displacements moved = winner.signature * winner.amplitude;
  named.size_m = 0.0;
  int most = 0;
  for (int body = 0; body < shape.bodies(); ++body) {
    // What is not seen might be said to have moved any way.
    if (!window.motion().usable[static_cast<std::size_t>(body)]) continue;
    const double distance = moved.segment<3>(3 * body).norm();
    if (distance <= named.size_m) continue;
    named.size_m = distance;
    most = body;
  }
  named.axis = axis_of(moved.segment<3>(3 * most), most);
  named.body = most;
  if (winner.kind == ChangeKind::kContact) {
    for (int body = 0; body < shape.bodies(); ++body) {
      if (std::abs(shape.arclength_m(body) - named.s_m) <
          std::abs(shape.arclength_m(*named.body) - named.s_m))
        named.body = body;
    }
  }
  named.onset_s = onset();
}

double MismatchMonitor::Impl::onset() const {
  // The innovations along the change, in units of the change: 1 now, about 0 before it.
  const Displacements moved = winner.signature * winner.amplitude;
  const double square = moved.squaredNorm();
  double at_s = *last_step_s;
  for (std::size_t k = 1; k <= pasts && square > 0.0; ++k) {
    const Past& past = history[(next_past + kHistory - k) % kHistory];
    if (*last_step_s - past.to_s > kPolicy.naming.longest_onset_s) break;
    if (moved.dot(past.innovation) / square < kPolicy.naming.rising) break;
    at_s = past.to_s;
  }
  // A window's mean reaches this share of a step so much after it.
  return at_s - kPolicy.naming.rising * kPolicy.window.seconds();
}

MismatchAxis MismatchMonitor::Impl::axis_of(const Vector3d& displacement, int body) const {
  const Eigen::Matrix3d section = shape.section(body);
  const Vector3d along = section.col(2);
  const double axial = std::abs(displacement.dot(along));
  const Vector3d across = displacement - displacement.dot(along) * along;
  if (axial > across.norm()) return MismatchAxis::kAxial;
  const Vector3d tip = shape.place_at(shape.length_m());
  if (tip.head<2>().norm() < kPolicy.naming.straight * shape.length_m()) return MismatchAxis::kInPlane;
  const Vector3d normal = Vector3d(-tip.y(), tip.x(), 0.0).normalized();
  return std::abs(displacement.dot(normal)) > M_SQRT1_2 * across.norm() ? MismatchAxis::kOutOfPlane
                                                                        : MismatchAxis::kInPlane;
}

}  // namespace softarm::monitor
