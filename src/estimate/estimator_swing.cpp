// An arm that is followed through its swings.
#include <algorithm>
#include <cmath>

#include "estimator_impl.h"
#include "model/rest_modes.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Matrix3Xd places_of(const std::vector<Observation>& observations, std::size_t bodies) {
  Matrix3Xd list = Matrix3Xd::Constant(3, static_cast<Index>(bodies), std::nan(""));
  for (const Observation& o : observations) list.col(o.body) = o.p;
  return list;
}

/// How far the body is that is farthest from where it was; those that were or are not seen do not count.
double farthest_m(const Matrix3Xd& a, const Matrix3Xd& b) {
  double most = 0.0;
  for (Index i = 0; i < a.cols(); ++i) {
    const double way = (a.col(i) - b.col(i)).norm();
    if (std::isfinite(way)) most = std::max(most, way);
  }
  return most;
}

}  // namespace

void Estimator::Impl::follow_swing(const trial::Frame& frame,
                                   const std::vector<arm::SegmentPrediction>& laws) {
  swing_laws = laws;
  Matrix3Xd moved = Matrix3Xd::Zero(3, static_cast<Index>(arm.bodies.size()));
  std::optional<VectorXd> by_laws;
  if (inputs_known == true) by_laws = x_by_laws(arm, laws, problem.reference_stiffnesses());
  if (by_laws && last_x_by_laws && !bodies_by_x.empty()) {
    for (std::size_t b = 0; b < bodies_by_x.size(); ++b)
      moved.col(static_cast<Index>(b)) = bodies_by_x[b] * (*by_laws - *last_x_by_laws);
  }
  last_x_by_laws = by_laws;
  swing->add(frame.stamp_s(), problem.observations(), noise, moved);
  swing_gravity = swing->gravity();
  swing_errors = CommonOffsets();
  for (int b = 0; b < static_cast<int>(arm.bodies.size()); ++b) {
    swing_errors.p.push_back(swing->position_by_error(b));
    swing_errors.tangent.push_back(swing->tangent_by_error(b));
  }
  // In a window it is one of the errors that the frame has beside others.
  if (!window) problem.set_motion(&swing_errors);
  problem.set_gravity(problem.rod().gravity_m_s2 + swing_gravity);
  if (extension) extension->set_gravity(problem.rod().gravity_m_s2);
}

std::vector<arm::SegmentPrediction> Estimator::Impl::segments_of_modes() const {
  std::vector<arm::SegmentPrediction> segments = swing_laws;
  for (int i = 0; i < static_cast<int>(segments.size()); ++i) {
    const auto index = static_cast<std::size_t>(i);
    arm::SegmentPrediction& segment = segments[index];
    // EI of one frame is worth more than the laws' only where it is told.
    const SegmentEstimate& found = estimate.segments[index];
    const bool told = found.identifiable_stiffness || told_but_for_change(Problem::column(i, 2));
    if (told && found.bending_stiffness_nm2) segment.bending_stiffness_nm2 = *found.bending_stiffness_nm2;
    const double rest = problem.rest_length(i);
    segment.moment_nm = segment.bending_stiffness_nm2 / rest * x.segment<2>(Problem::column(i, 0));
    segment.curvature_per_m.setZero();
    segment.length_m = rest * x[Problem::column(i, 3)];
  }
  return segments;
}

void Estimator::Impl::look_at_swing() {
  bodies_by_x.assign(arm.bodies.size(), Matrix3Xd(3, x.size()));
  for (int b = 0; b < static_cast<int>(arm.bodies.size()); ++b) {
    Observation body;
    body.body = b;
    problem.position_jacobian(body, bodies_by_x[static_cast<std::size_t>(b)]);
  }
  const std::vector<arm::SegmentPrediction> segments = segments_of_modes();
  ModesAt here;
  here.bodies = places_of(problem.observations(), arm.bodies.size());
  for (const arm::SegmentPrediction& segment : segments)
    here.stiffness_nm2.push_back(segment.bending_stiffness_nm2);
  const bool told = estimate.identifiable_payload || told_but_for_change(problem.payload_column());
  here.payload_kg = payload_known.value_or(told ? *estimate.payload_kg : 0.0);
  if (!payload_known && !told && modes_at) here.payload_kg = modes_at->payload_kg;
  here.payload_kg = std::max(0.0, here.payload_kg);
  here.gravity_base = problem.rod().gravity_m_s2 - swing_gravity - inertia;
  constexpr double kRedraw = kPolicy.swing.redraw;
  if (swing->has_modes() && modes_at) {
    double own_kg = arm.tip_mass_kg;
    for (const arm::Segment& segment : arm.segments)
      own_kg += segment.mass_per_length_kg_m * segment.length_m;
    bool same = farthest_m(here.bodies, modes_at->bodies) < kRedraw * arm.total_length_m() &&
                (here.gravity_base - modes_at->gravity_base).norm() < kRedraw * here.gravity_base.norm() &&
                std::abs(here.payload_kg - modes_at->payload_kg) < kRedraw * (own_kg + modes_at->payload_kg);
    for (std::size_t i = 0; i < segments.size(); ++i)
      same = same && std::abs(here.stiffness_nm2[i] / modes_at->stiffness_nm2[i] - 1.0) < kRedraw;
    if (same) return;
  }
  const auto modes = model::modes_at(arm, segments, here.payload_kg, here.gravity_base, kPolicy.swing.modes);
  if (!modes) return;
  swing->set_modes(*modes, arm.segments[0].wall.lag_s.value_or(arm::Wall::kUsualLag_s));
  modes_at = here;
}

}  // namespace softarm::estimate
