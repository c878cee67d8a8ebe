#include "instant_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/wall_memory.h"
#include "arm_rod.h"
#include "body_kinematics.h"
#include "shape_mixer.h"
#include "softarm/arm/laws.h"

namespace softarm::model {
namespace {

// Of what answers many times over: the solver's own error is answered as well.
constexpr double kSettledStiff_m = 2e-6, kStiffShare = 0.2;
// Of the square root of what is asked for, to which the last step's square is small; rad.
constexpr double kCorrection = 0.14;
constexpr int kMostRounds = 80;      // to get there
constexpr int kMostPlainRounds = 5;  // without mixing
constexpr double kSoft = 0.25;       // answer up to which no mixing is needed
constexpr int kFewRounds = 3;        // with mixing: it may not be needed at the next instant
constexpr int kForceRounds = 25, kForceHalvings = 6, kMostWorse = 5;
// A force that shows how a held place yields: a thousandth of the arm's weight on earth, m/s^2.
constexpr double kLeastProbe_n = 1e-5, kProbePerMass = 1e-2;
constexpr double kSlow = 0.5;                // of the round before: how places yield is looked at anew
constexpr double kLargestWay = 0.15;         // of a held place in one round, of the arm's length
constexpr double kSeen_m = 1e-7;             // ways that say how a place yields
constexpr double kFirstScale = 1.0 / 256.0;  // of effects, at which their continuation begins

arm::InputValues input_values(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}

/// Whether nothing else depends on the shape than the forces that hold places.
bool needs_only_places(const std::vector<Present>& effects) {
  return std::none_of(effects.begin(), effects.end(),
                      [](const Present& p) { return p.effect->needs_shape() && !p.effect->holds_places(); });
}

/// Lets the effects act on the rod, stage by stage.
void act(const arm::Arm& arm, const FineRod& fine, const std::vector<Present>& effects,
         const std::vector<Memory>& memories, const Instant& instant, const Shape* shape, rod::Rod& rod) {
  const auto let = [&](std::size_t i) {
    effects[i].effect->act(arm, fine, effects[i].values, instant, shape, memories[i], rod);
  };
  for (const Stage stage : {Stage::kPieces, Stage::kSides})
    for (std::size_t i = 0; i < effects.size(); ++i)
      if (effects[i].effect->stage() == stage) let(i);
  std::vector<std::size_t> laws;
  for (std::size_t i = 0; i < effects.size(); ++i)
    if (effects[i].effect->stage() == Stage::kLaws) laws.push_back(i);
  if (laws.empty()) return;
  for (rod::Segment& piece : rod.segments) {
    piece.unloaded_curvature_per_m = piece.rest_curvature_per_m.head<2>();
    piece.unloaded_bending_compliance = piece.bending_compliance;
  }
  std::stable_sort(laws.begin(), laws.end(), [&](std::size_t a, std::size_t b) {
    return effects[a].effect->rank() < effects[b].effect->rank();
  });
  for (const std::size_t i : laws) let(i);
}

}  // namespace

Mesh Mesh::of(const std::vector<Present>& effects, double settled_m) {
  Mesh mesh;
  const auto any = [&](bool (Effect::*asks)() const) {
    return std::any_of(effects.begin(), effects.end(),
                       [&](const Present& present) { return (present.effect->*asks)(); });
  };
  mesh.pieces = any(&Effect::varies_along) ? FineRod::kPieces : 1;
  mesh.strains = any(&Effect::needs_strains);
  mesh.settled_m = settled_m;
  return mesh;
}

InstantSolver::InstantSolver(const arm::Arm& arm, const Mesh& mesh)
    : fine(arm, mesh.pieces),
      bodies(arm.bodies),
      values(fine.layout(), stations(arm, fine), {}, options(arm, mesh)),
      rod(fine.layout()),
      mesh_(mesh) {}

std::vector<double> InstantSolver::stations(const arm::Arm& arm, const FineRod& fine) {
  std::vector<double> list = body_stations(arm);
  for (const Piece& piece : fine.pieces()) list.push_back(piece.s_to_m);
  list.push_back(0.0);
  return list;
}

rod::SolverOptions InstantSolver::options(const arm::Arm& arm, const Mesh& mesh) {
  rod::SolverOptions options = solver_options(1e-10, kIntegrated);
  options.linear_correction_rad = kCorrection * std::sqrt(mesh.settled_m / arm.total_length_m());
  return options;
}

bool InstantSolver::make(const arm::Arm& arm, const std::vector<Present>& effects,
                         const std::vector<Memory>& memories, const Dynamics& dynamics,
                         const Instant& instant, const Shape* shape, const Motion& motion, rod::Rod& out,
                         const std::vector<arm::SegmentPrediction>* given, const Eigen::VectorXd* held) {
  out = fine.layout();
  out.gravity_m_s2 = instant.gravity_base;
  out.loads[rod::kPayloadLoad].mass_kg = instant.payload_kg;
  if (given != nullptr) {
    fine.actuate(arm, *given, *given, out);
  } else {
    auto predictions = softarm::arm::predict(arm, input_values(instant.inputs));
    if (!predictions) return false;
    const bool same = instant.inputs == instant.moment_inputs;
    auto moments = same ? predictions : softarm::arm::predict(arm, input_values(instant.moment_inputs));
    if (!moments) return false;
    for (std::size_t i = 0; i < instant.kept_back.size(); ++i) {
      softarm::arm::take_off(instant.kept_back[i], (*predictions)[i]);
      softarm::arm::take_off(instant.kept_back[i], (*moments)[i]);
    }
    fine.actuate(arm, *predictions, *moments, out);
  }
  act(arm, fine, effects, memories, instant, shape, out);
  if (const HeldPlaces places(fine, effects, memories); shape != nullptr && !places.empty())
    places.add(held != nullptr ? *held : places.forces_n(places.positions_m(out, *shape)), out);
  if (dynamics.inertia && !motion.acceleration_m_s2.empty()) {
    const Eigen::VectorXd masses = fine.station_masses_kg(out);
    for (std::size_t j = 0; j < motion.acceleration_m_s2.size(); ++j)
      out.loads[FineRod::kFirstStation + j].force_n -=
          masses[static_cast<Eigen::Index>(j)] * motion.acceleration_m_s2[j];
  }
  if (dynamics.viscoelastic_lag_s != 0.0) {
    for (std::size_t j = 0; j < motion.curvature_rate.size(); ++j)
      out.segments[j].rest_curvature_per_m.head<2>() -=
          dynamics.viscoelastic_lag_s * motion.curvature_rate[j].head<2>();
  }
  return true;
}

void InstantSolver::shape_of_solution(const Motion& motion, Shape& shape) const {
  const int b = static_cast<int>(bodies.size()), n = fine.stations();
  shape.motion = motion;
  shape.stations.clear();
  shape.middles.clear();
  for (int k = 0; k < n; ++k) {
    shape.stations.push_back(values.station(b + k));
    if (mesh_.strains)
      shape.middles.push_back(values.at(fine.pieces()[static_cast<std::size_t>(k)].middle_m()));
  }
  shape.base_moment_nm = values.station(b + n).m;
  shape.base_force_n = values.station(b + n).n;
}

void InstantSolver::bodies_of_solution(Bodies& out) const {
  out.p.resize(3, static_cast<Eigen::Index>(bodies.size()));
  out.u.resize(3, out.p.cols());
  out.q.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const rod::RodState& section = values.station(static_cast<int>(b));
    out.p.col(static_cast<Eigen::Index>(b)) = position_on(bodies[b], section);
    out.u.col(static_cast<Eigen::Index>(b)) = section.u;
    out.q.push_back(section.q);
  }
}

bool InstantSolver::solve(const Eigen::Quaterniond* start) {
  rod::SolveStatus status = rod::SolveStatus::kNoConvergence;
  if (start != nullptr) status = values.solve(rod, *start);
  if (status != rod::SolveStatus::kConverged) status = values.solve(rod);
  return status == rod::SolveStatus::kConverged;
}

bool InstantSolver::agree(const Context& at, const std::vector<Present>& effects, Shape assumed,
                          Predicted& now) {
  ShapeMixer mixer(at.feedback.share);
  Eigen::Quaterniond last = now.q_tip;
  Shape followed, next;
  for (int round = 0; round < kMostRounds; ++round) {
    if (!make(at.arm, effects, at.memories, at.dynamics, now.instant, &assumed, at.motion, rod, at.given))
      return false;
    const bool solved = solve(&last);
    if (solved) {
      last = values.q_tip();
      shape_of_solution(at.motion, followed);
      const double settled = mixer.share() < kStiffShare ? kSettledStiff_m : mesh_.settled_m;
      if (difference_m(followed, assumed).lpNorm<Eigen::Infinity>() < settled) {
        now.shape = followed;
        now.q_tip = last;
        at.feedback.share = std::min(1.0, 4.0 * mixer.share());
        at.feedback.mixes = round >= kFewRounds;
        return true;
      }
    }
    if (!mixer.next(assumed, solved ? &followed : nullptr, next)) return false;
    assumed = next;
  }
  return false;
}

bool InstantSolver::agree_at_once(const Context& at, const std::vector<Present>& effects, Predicted& now) {
  double before_m = 0.0;
  const bool evenly = std::all_of(effects.begin(), effects.end(), [](const Present& p) {
    return !p.effect->needs_shape() || p.effect->answers_evenly();
  });
  const double remembered = evenly ? at.feedback.answer : 1.0;
  for (int round = 0; round < kMostPlainRounds; ++round) {
    if (!make(at.arm, effects, at.memories, at.dynamics, now.instant, &now.shape, at.motion, rod, at.given) ||
        !solve(&now.q_tip))
      return false;
    now.q_tip = values.q_tip();
    double moved_m = 0.0;
    for (int k = 0; k < fine.stations(); ++k)
      moved_m = std::max(moved_m, (values.station(static_cast<int>(bodies.size()) + k).p -
                                   now.shape.stations[static_cast<std::size_t>(k)].p)
                                      .lpNorm<Eigen::Infinity>());
    shape_of_solution(at.motion, now.shape);
    if (moved_m < mesh_.settled_m) return true;
    double answer = remembered;
    if (round > 0) {
      answer = moved_m / before_m;
      if (answer > kSoft) {
        at.feedback.mixes = true;
        return false;
      }
      at.feedback.answer = answer;
    }
    if (answer <= kSoft && moved_m * answer / (1.0 - answer) < mesh_.settled_m) return true;
    before_m = moved_m;
  }
  return false;
}

Eigen::VectorXd InstantSolver::hold(const Context& at, const std::vector<Present>& effects,
                                    const HeldPlaces& places, const Eigen::VectorXd& forces_n,
                                    const Predicted& now, Shape& followed) {
  if (!make(at.arm, effects, at.memories, at.dynamics, now.instant, &now.shape, at.motion, rod, at.given,
            &forces_n) ||
      !solve(&now.q_tip))
    return {};
  shape_of_solution(at.motion, followed);
  return places.positions_m(rod, followed);
}

Eigen::MatrixXd InstantSolver::yielding(const Context& at, const std::vector<Present>& effects,
                                        const HeldPlaces& places, const Eigen::VectorXd& forces_n,
                                        const Eigen::VectorXd& positions_m, const Predicted& now) {
  const double probe_n = kLeastProbe_n + kProbePerMass * fine.station_masses_kg(rod).sum();
  Eigen::MatrixXd compliance(places.size(), places.size());
  Shape followed;
  for (Eigen::Index k = 0; k < places.size(); ++k) {
    Eigen::VectorXd forces = forces_n;
    forces[k] += probe_n;
    const Eigen::VectorXd positions = hold(at, effects, places, forces, now, followed);
    if (positions.size() == 0) return {};
    compliance.col(k) = (positions - positions_m) / probe_n;
  }
  return compliance;
}

bool InstantSolver::agree_by_forces(const Context& at, const std::vector<Present>& effects,
                                    const HeldPlaces& places, Eigen::VectorXd& forces_n, Predicted& now) {
  Eigen::MatrixXd& compliance = at.feedback.compliance_m_per_n;
  const double largest_m = kLargestWay * fine.length_m();
  const bool only_places = needs_only_places(effects);
  Eigen::VectorXd solved_n, solved_m;  // what was solved last
  Shape followed;
  double last_m = largest_m;
  int halvings = 0, worse = 0;
  for (int round = 0; round < kForceRounds; ++round) {
    const Eigen::VectorXd positions = hold(at, effects, places, forces_n, now, followed);
    if (positions.size() == 0) {
      if (solved_n.size() == 0 || ++halvings > kForceHalvings) return false;
      forces_n = 0.5 * (forces_n + solved_n);
      continue;
    }
    now.q_tip = values.q_tip();
    const double moved_m = difference_m(followed, now.shape).lpNorm<Eigen::Infinity>();
    if (compliance.rows() == places.size() && solved_n.size() > 0) {  // Broyden's update
      const Eigen::VectorXd change_n = forces_n - solved_n, way_m = positions - solved_m,
                            expected_m = compliance * change_n;
      // Most of the way must be the forces' doing: other effects answer to the shape, too.
      const bool by_forces = only_places || (way_m - expected_m).norm() < expected_m.norm();
      if (way_m.norm() > kSeen_m && change_n.squaredNorm() > 0.0 && by_forces)
        compliance += (way_m - expected_m) * change_n.transpose() / change_n.squaredNorm();
    }
    solved_n = forces_n;
    solved_m = positions;
    Eigen::VectorXd step_n;
    double way_m = 2.0 * largest_m;
    const auto look = [&] {
      step_n = places.step_n(positions, forces_n, compliance);
      way_m = (compliance * step_n).lpNorm<Eigen::Infinity>();
    };
    if (compliance.rows() == places.size()) look();
    const bool settled = way_m < mesh_.settled_m;
    if (settled && (moved_m < mesh_.settled_m || only_places)) {
      now.shape = followed;
      return true;
    }
    if (!settled && !(way_m <= kSlow * last_m)) {  // by the shape that these positions are of
      compliance = yielding(at, effects, places, forces_n, positions, now);
      if (compliance.rows() != places.size()) return false;
      look();
    }
    if (way_m > last_m && ++worse > kMostWorse) return false;
    last_m = way_m;
    now.shape = followed;
    forces_n += std::min(1.0, largest_m / way_m) * step_n;
  }
  return false;
}

bool InstantSolver::agree_from(const Context& at, const std::vector<Present>& effects,
                               const HeldPlaces& places, Eigen::VectorXd forces_n, Predicted& now) {
  if (places.empty()) return agree(at, effects, Shape(now.shape), now);
  const Shape shape = now.shape;
  const Eigen::Quaterniond q_tip = now.q_tip;
  if (agree_by_forces(at, effects, places, forces_n, now)) return true;
  at.feedback.compliance_m_per_n.resize(0, 0);
  at.feedback.mixes = false;
  now.shape = shape;
  now.q_tip = q_tip;
  return !needs_only_places(effects) && agree(at, effects, shape, now);
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
    shape_of_solution(at.motion, now.shape);
    return true;
  }
  const HeldPlaces places(fine, effects, at.memories);
  if (near != nullptr && start != nullptr) {
    const bool stiff = at.feedback.compliance_m_per_n.size() > 0;
    const auto from_near = [&] {
      now.q_tip = *start;
      now.shape = *near;
      now.shape.motion = at.motion;
    };
    from_near();
    if (!stiff && !at.feedback.mixes) {
      if (agree_at_once(at, effects, now)) return true;
      from_near();
    }
    if (agree_from(at, effects, places, places.forces_n(places.positions_m(fine.layout(), now.shape)), now))
      return true;
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
  shape_of_solution(at.motion, now.shape);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(places.size());
  if (agree_from(at, effects, places, none, now)) return true;
  // A stiff spring answers the arm without it with a force that nothing bears: continuation from a soft one.
  std::vector<Present> some = effects;
  Eigen::VectorXd forces_n = none;
  for (double scale = kFirstScale; scale <= 1.0; scale *= 2.0) {
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (!effects[i].effect->needs_shape()) continue;
      const int sizes = effects[i].effect->info().sizes;
      some[i].values.head(sizes) = scale * effects[i].values.head(sizes);
    }
    const HeldPlaces softly(fine, some, at.memories);
    if (needs_only_places(some) ? !agree_by_forces(at, some, softly, forces_n, now)
                                : !agree(at, some, Shape(now.shape), now))
      return false;
  }
  return true;
}

}  // namespace softarm::model
