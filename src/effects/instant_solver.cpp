#include "instant_solver.h"

#include <algorithm>
#include <utility>

#include "shape_mixer.h"
#include "softarm/arm/laws.h"

namespace softarm::effects {
namespace {

constexpr double kSettled_m = 1e-7;  // change of the stations at which a shape agrees with what it causes
// Of what answers many times over: the solver's own error is answered as well.
constexpr double kSettledStiff_m = 2e-6, kStiffShare = 0.2;
constexpr int kMostRounds = 80;              // to get there
constexpr double kFirstScale = 1.0 / 256.0;  // of effects that are brought in by and by

InputValues input_values(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}

}  // namespace

InstantSolver::InstantSolver(const Arm& arm)
    : fine(arm),
      bodies(arm.bodies),
      values(fine.layout(), stations(arm, fine), {}, solver_options()),
      rod(fine.layout()) {}

rod::SolverOptions InstantSolver::solver_options() {
  rod::SolverOptions options;
  options.linear_correction_rad = 1e-4;
  options.orientation_tolerance_rad = 1e-10;
  options.position_tolerance = 1e-6;
  return options;
}

std::vector<double> InstantSolver::body_stations(const Arm& arm) {
  std::vector<double> list;
  for (const MeasuredBody& body : arm.bodies)
    list.push_back(std::min(body.arclength_m, arm.total_length_m()));
  return list;
}

std::vector<double> InstantSolver::stations(const Arm& arm, const FineRod& fine) {
  std::vector<double> list = body_stations(arm);
  for (const Piece& piece : fine.pieces()) list.push_back(piece.middle_m());
  for (const Piece& piece : fine.pieces()) list.push_back(piece.s_to_m);
  list.push_back(0.0);
  return list;
}

bool InstantSolver::make(const Arm& arm, const std::vector<Present>& effects,
                         const std::vector<Memory>& memories, const Dynamics& dynamics,
                         const Instant& instant, const Shape* shape, const Motion& motion, rod::Rod& out,
                         const std::vector<SegmentPrediction>* given) {
  out = fine.layout();
  out.gravity_m_s2 = instant.gravity_base;
  out.loads[rod::kPayloadLoad].mass_kg = instant.payload_kg;
  if (given != nullptr) {
    fine.actuate(arm, *given, *given, out);
  } else {
    const auto predictions = softarm::predict(arm, input_values(instant.inputs));
    if (!predictions) return false;
    const bool same = instant.inputs == instant.moment_inputs;
    const auto moments = same ? predictions : softarm::predict(arm, input_values(instant.moment_inputs));
    if (!moments) return false;
    fine.actuate(arm, *predictions, *moments, out);
  }
  for (std::size_t i = 0; i < effects.size(); ++i)
    effects[i].effect->act(arm, fine, effects[i].values, instant, shape, memories[i], out);
  if (dynamics.inertia && !motion.acceleration_m_s2.empty()) {
    const Eigen::VectorXd masses = fine.station_masses_kg(out);
    for (std::size_t j = 0; j < motion.acceleration_m_s2.size(); ++j)
      out.loads[FineRod::kFirstStation + j].force_n -=
          masses[static_cast<Eigen::Index>(j)] * motion.acceleration_m_s2[j];
  }
  if (dynamics.retardation_s != 0.0) {
    for (std::size_t j = 0; j < motion.curvature_rate.size(); ++j)
      out.segments[j].rest_curvature_per_m.head<2>() -=
          dynamics.retardation_s * motion.curvature_rate[j].head<2>();
  }
  return true;
}

Shape InstantSolver::shape_of_solution(const Motion& motion) const {
  Shape shape;
  shape.motion = motion;
  const int b = static_cast<int>(bodies.size()), n = fine.stations();
  for (int k = 0; k < n; ++k) {
    shape.middles.push_back(values.station(b + k));
    shape.stations.push_back(values.station(b + n + k));
  }
  shape.base_moment_nm = values.station(b + 2 * n).m;
  shape.base_force_n = values.station(b + 2 * n).n;
  return shape;
}

bool InstantSolver::solve(const Eigen::Quaterniond* start) {
  rod::SolveStatus status = rod::SolveStatus::kNoConvergence;
  if (start != nullptr) status = values.solve(rod, *start);
  if (status != rod::SolveStatus::kConverged) status = values.solve(rod);
  return status == rod::SolveStatus::kConverged;
}

bool InstantSolver::agree(const Context& at, const std::vector<Present>& effects, Shape assumed,
                          Predicted& now) {
  ShapeMixer mixer(at.share);
  Eigen::Quaterniond last = now.q_tip;
  Shape followed, next;
  for (int round = 0; round < kMostRounds; ++round) {
    if (!make(at.arm, effects, at.memories, at.dynamics, now.instant, &assumed, at.motion, rod, at.given))
      return false;
    const bool solved = solve(&last);
    if (solved) {
      last = values.q_tip();
      followed = shape_of_solution(at.motion);
      const double settled = mixer.share() < kStiffShare ? kSettledStiff_m : kSettled_m;
      if (difference_m(followed, assumed).lpNorm<Eigen::Infinity>() < settled) {
        now.shape = followed;
        now.q_tip = last;
        at.share = std::min(1.0, 4.0 * mixer.share());
        return true;
      }
    }
    if (!mixer.next(assumed, solved ? &followed : nullptr, next)) return false;
    assumed = next;
  }
  return false;
}

bool InstantSolver::settle(const Context& at, const std::vector<Present>& effects,
                           const Eigen::Quaterniond* start, const Shape* near, Predicted& now) {
  const bool needs_shape =
      std::any_of(effects.begin(), effects.end(), [](const Present& p) { return p.effect->needs_shape(); });
  if (!needs_shape) {
    if (!make(at.arm, effects, at.memories, at.dynamics, now.instant, nullptr, at.motion, rod, at.given) ||
        !solve(start))
      return false;
    now.q_tip = values.q_tip();
    now.shape = shape_of_solution(at.motion);
    return true;
  }
  if (near != nullptr && start != nullptr) {
    now.q_tip = *start;
    Shape assumed = *near;
    assumed.motion = at.motion;
    if (agree(at, effects, std::move(assumed), now)) return true;
  }
  std::vector<Present> others;
  std::vector<Memory> of_others;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (effects[i].effect->needs_shape()) continue;
    others.push_back(effects[i]);
    of_others.push_back(at.memories[i]);
  }
  if (!make(at.arm, others, of_others, at.dynamics, now.instant, nullptr, at.motion, rod, at.given) ||
      !solve(start))
    return false;
  now.q_tip = values.q_tip();
  now.shape = shape_of_solution(at.motion);
  if (agree(at, effects, Shape(now.shape), now)) return true;
  // A stiff spring answers the arm without it with a force that nothing bears: bring it in by and by.
  std::vector<Present> some = effects;
  for (double scale = kFirstScale; scale <= 1.0; scale *= 2.0) {
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (!effects[i].effect->needs_shape()) continue;
      const int sizes = effects[i].effect->info().sizes;
      some[i].values.head(sizes) = scale * effects[i].values.head(sizes);
    }
    if (!agree(at, some, Shape(now.shape), now)) return false;
  }
  return true;
}

}  // namespace softarm::effects
