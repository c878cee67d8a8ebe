// Frames that share: what others say of this one, and it of them.
#include <algorithm>
#include <cmath>

#include "estimator_impl.h"
#include "math/linear_algebra.h"
#include "model/inertia.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// What a parameter's information has added, relative to it, for a system to be solved that leaves some free.
constexpr double kLeftFree = 1e-12;
constexpr int kMotionSteps = 6;          // of a frame in motion, at most,
constexpr double kSettled_sd = 0.1;      // ... until they are no longer than that
constexpr double kLeastShare = 0.1;      // of a step that is tried
constexpr double kLeastMotion = 1e-6;    // m/s^2, of what stays of motion: nothing, but numbers round
constexpr double kLeastPassing = 1e-12;  // variance, of x: what is less is rounding

/// The most probable, but for what is held at zero.
VectorXd most_probable(const Evidence& of, const std::vector<bool>& held) {
  VectorXd scale(of.weighted.size());
  for (Index i = 0; i < scale.size(); ++i) {
    const bool free = (i >= static_cast<Index>(held.size()) || !held[static_cast<std::size_t>(i)]) &&
                      of.information(i, i) > 0.0;
    scale[i] = free ? 1.0 / std::sqrt(of.information(i, i)) : 0.0;
  }
  MatrixXd a = scale.asDiagonal() * of.information * scale.asDiagonal();
  for (Index i = 0; i < scale.size(); ++i) a(i, i) = scale[i] > 0.0 ? 1.0 + kLeftFree : 1.0;
  return scale.cwiseProduct(math::solve_symmetric(a, scale.cwiseProduct(of.weighted)));
}

std::vector<bool> negated(std::vector<bool> list) {
  list.flip();
  return list;
}

}  // namespace

Index Estimator::Impl::motions() const {
  return offsets_of_body(options) * static_cast<Index>(arm.bodies.size());
}

Index Estimator::Impl::errors() const {
  return motions() + kMotions + law.gains.cols();
}

VectorXd Estimator::Impl::passing_variance() const {
  VectorXd variance(static_cast<Index>(law.passing.size()));
  for (std::size_t i = 0; i < law.passing.size(); ++i)
    variance[static_cast<Index>(i)] = std::max(law.jitter_variance[law.passing[i]], kLeastPassing);
  return variance;
}

VectorXd Estimator::Impl::placement_variance() const {
  const Index offsets = offsets_of_body(options);
  VectorXd variance(errors());
  variance.segment<kMotions>(motions()).setConstant(kLeastMotion * kLeastMotion);
  variance.tail(law.gains.cols()) = law.gain_variance;
  for (std::size_t i = 0; i < arm.bodies.size(); ++i) {
    const auto of = variance.segment(offsets * static_cast<Index>(i), offsets);
    const double place_m = std::max(arm.bodies[i].placement_sd_m, kPolicy.window.least_offset_m);
    const double turn_rad = std::max(arm.bodies[i].placement_sd_rad, kPolicy.window.least_offset_rad);
    variance.segment<3>(offsets * static_cast<Index>(i)).setConstant(place_m * place_m);
    if (of.size() > 3)
      variance.segment<2>(offsets * static_cast<Index>(i) + 3).setConstant(turn_rad * turn_rad);
  }
  return variance;
}

VectorXd Estimator::Impl::posture_variance() const {
  const Index offsets = offsets_of_body(options);
  VectorXd variance = VectorXd::Zero(errors());
  variance.segment<kMotions>(motions()) = inertia_variance();
  for (int i = 0; i < static_cast<int>(arm.bodies.size()); ++i) {
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(i)];
    variance.segment<3>(offsets * i)
        .setConstant(body.position_sd_m * body.position_sd_m - noise.position_variance(i));
    if (offsets > 3)
      variance.segment<2>(offsets * i + 3)
          .setConstant(body.orientation_sd_rad * body.orientation_sd_rad - noise.tangent_variance(i));
  }
  return variance.cwiseMax(0.0);
}

void Estimator::Impl::believe() {
  if (is_constant_curvature(options.method) || (!options.prior.enabled && !window)) {
    problem.set_belief(std::nullopt);
    return;
  }
  if (!window) {
    problem.set_belief(
        belief_of_frame(law, law.information.asDiagonal(), VectorXd::Zero(law.information.size())));
    return;
  }
  const VectorXd placement = placement_variance();
  const Evidence common = window->belief(law, placement, posture_variance(), motions());
  if (!options.prior.enabled && window->frames() == 0)
    problem.set_belief(std::nullopt);
  else
    problem.set_belief(belief_about_centre(law, without_last(common, placement.size())));
}

BodyRows Estimator::Impl::rows() const {
  BodyRows rows =
      body_rows(problem, x, noise, offsets_of_body(options), static_cast<Index>(arm.bodies.size()), errors());
  // As without the motion, which b has.
  rows.model -= rows.j.middleCols<kMotions>(x.size() + motions()) * inertia;
  return rows;
}

std::optional<BodyRows> Estimator::Impl::rows_of(Window::Posture& posture, const VectorXd& at) {
  Window::Place& place = posture.place;
  const VectorXd& weight = posture.sums.weight;
  const Index blocks = weight.size() / (3 * static_cast<Index>(arm.bodies.size()));
  past->observations().clear();
  for (int body = 0; body < static_cast<int>(arm.bodies.size()); ++body) {
    const Index row = 3 * blocks * body;
    Observation seen;
    seen.body = body;
    if (blocks > 1 && weight[row + 3] > 0.0) seen.tangent = Vector3d::UnitZ();
    if (weight[row] > 0.0) past->observations().push_back(seen);
  }
  past->set_gravity(place.gravity_base);
  past->set_laws(place.laws);
  past->set_effects(place.effects ? &*place.effects : nullptr);
  past->free() = problem.free();
  past->begin();
  if (!at.allFinite() || !past->evaluate(at, place.q_tip)) return std::nullopt;
  place.q_tip = past->solver().q_tip();
  return body_rows(*past, at, noise, offsets_of_body(options), static_cast<Index>(arm.bodies.size()),
                   posture.rows.j.cols() - at.size());
}

VectorXd Estimator::Impl::parameters_of(const Window::Posture& posture) const {
  const Index n = x.size(), errors = posture.rows.j.cols() - n;
  const auto shared = [&](Index i) { return i == n - 1 || i % kSegmentParameters == 2; };
  VectorXd at = posture.rows.x;
  for (Index i = 0; i < n; ++i) {
    if (shared(i)) at[i] = x[i];
  }
  const FrameLaw mean = posture.sums.mean_law(law);
  VectorXd by_law = mean.centre;
  for (Index i = 0; i < n; ++i) {
    if (shared(i)) by_law += mean.shared.col(i) * (at[i] - mean.centre[i]) / mean.shared(i, i);
  }
  Evidence own = posture.rows.evidence(posture.rows.measured, posture.sums.weight);
  own.weighted -= own.information.leftCols(n) * at;
  if (last_offsets.size() == errors) own.weighted -= own.information.rightCols(errors) * last_offsets;
  std::vector<bool> held(static_cast<std::size_t>(n + errors), true);
  for (Index i = 0; i < n; ++i) {
    if (shared(i)) continue;
    held[static_cast<std::size_t>(i)] = false;
    if (!(law.information[i] > 0.0)) continue;
    const double variance = mean.shared(i, i) * mean.shared(i, i) / law.information[i] +
                            law.jitter_variance[i] + mean.gains.row(i).cwiseAbs2() * law.gain_variance;
    own.information(i, i) += 1.0 / variance;
    own.weighted[i] += (by_law[i] - at[i]) / variance;
  }
  return at + most_probable(own, held).head(n);
}

void Estimator::Impl::linearise_postures() {
  for (Window::Posture* posture : window->to_linearise()) {
    if (posture->changed) {
      const VectorXd mean = posture->sums.x / posture->sums.frames;
      const std::optional<BodyRows> there = rows_of(*posture, mean);
      if (!there) continue;
      posture->rows = *there;
      posture->rows.measured = there->model + posture->sums.mean_off();
      posture->changed = false;
    }
    const VectorXd measured = posture->rows.measured;
    std::optional<BodyRows> anew = rows_of(*posture, parameters_of(*posture));
    if (!anew) continue;
    posture->rows = std::move(*anew);
    posture->rows.measured = measured;
    posture->age = 0;
  }
}

void Estimator::Impl::settle() {
  if (!window) return;
  if (!swing) motion.add(estimate.stamp_s, tip());
  influence = VectorXd::Ones(rows().blocks());
  if (options.objective != arm::Objective::kLeastSquares || !problem.noise_weights()) return;
  double moved = settle_from_here();
  // The fit took the swing for another payload or moment: from there it is far.
  for (int step = 0; step < kMotionSteps && moved > kSettled_sd && !inertia_variance().isZero(); ++step)
    moved = settle_from_here();
}

double Estimator::Impl::settle_from_here() {
  BodyRows own = rows();
  const Index n = problem.NumParameters();
  const VectorXd placement = placement_variance();
  linearise_postures();
  window->see_from(own);
  // Its own motion is added to its bodies, beside what its posture's frames have on average.
  VectorXd posture = posture_variance();
  posture.segment<kMotions>(motions()).setZero();
  Evidence believed = window->belief(law, placement, posture, motions());
  believed.weighted -= believed.information.leftCols(n) * (x - law.centre);
  const auto with_bodies = [&] {
    Evidence all = moving(own.evidence(), 1.0);
    all.weighted += believed.weighted - all.information.leftCols(n) * x;
    all.information += believed.information;
    return all;
  };
  // A body that is off by more than it ever was has its influence bounded.
  const VectorXd d = most_probable(with_bodies(), negated(estimated));
  for (Index block = 0; block < own.blocks(); ++block)
    influence[block] = problem.bounded_influence(own.distance(block, d));
  own.weight = own.weight.cwiseProduct(influence);
  const VectorXd found = most_probable(with_bodies(), negated(estimated));
  last_offsets = found.tail(placement.size());
  const Evidence of_x = without_last(with_bodies(), placement.size());
  covariance = covariance_from(of_x.information, estimated);
  if (extension) extension->set_errors(found.tail(law.of_effects));
  const VectorXd way = move_to(of_x, most_probable_motion(own, found));
  double moved = 0.0;  // in standard deviations
  for (Index i = 0; i < n; ++i) {
    if (estimated[static_cast<std::size_t>(i)] && covariance.x(i, i) > 0.0)
      moved = std::max(moved, std::abs(way[i]) / std::sqrt(covariance.x(i, i)));
  }
  return moved;
}

Vector3d Estimator::Impl::most_probable_motion(const BodyRows& own, const VectorXd& found) const {
  // That of its posture, and of the rest as much as is left of the bodies' distances.
  const Index first = x.size() + motions();
  const VectorXd left = own.measured - own.model - own.j * found;
  const MatrixXd by_motion = own.j.middleCols<kMotions>(first);
  VectorXd weights(3 * own.blocks());
  for (Index block = 0; block < own.blocks(); ++block)
    weights.segment<3>(3 * block).setConstant(own.weight[block]);
  Eigen::Matrix3d information = by_motion.transpose() * weights.asDiagonal() * by_motion;
  information.diagonal() += inertia_variance().cwiseMax(kLeastMotion * kLeastMotion).cwiseInverse();
  const Vector3d pull = by_motion.transpose() * weights.asDiagonal() * left;
  return found.segment<kMotions>(first) + information.ldlt().solve(pull);
}

void Estimator::Impl::feel(const Vector3d& by_motion) {
  problem.set_gravity(problem.rod().gravity_m_s2 - inertia + by_motion);
  inertia = by_motion;
}

VectorXd Estimator::Impl::move_to(const Evidence& of, const Vector3d& by_motion) {
  const int payload = problem.payload_column();
  Evidence pulled = of;
  const auto pull = [&](int column, double to, double sd) {
    pulled.information(column, column) += 1.0 / (sd * sd);
    pulled.weighted[column] += (to - x[column]) / (sd * sd);
  };
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i)
    pull(Problem::column(i, 2), 1.0, kPolicy.fit.weak_flexibility_sd);
  pull(payload, 0.0, kPolicy.fit.weak_payload_sd_kg / Problem::kPayloadUnit);
  std::vector<bool> held = negated(estimated);
  const std::vector<arm::Range> ranges = bounds();
  VectorXd d = VectorXd::Zero(x.size());
  while (true) {
    // What is held at a bound moves the rest by its own way there.
    Evidence rest = pulled;
    rest.weighted -= pulled.information * d;
    VectorXd more = most_probable(rest, held);
    bool moved = false;
    for (Index i = 0; i < x.size(); ++i) {
      if (held[static_cast<std::size_t>(i)]) continue;
      const arm::Range& range = ranges[static_cast<std::size_t>(i)];
      const double to = x[i] + d[i] + more[i];
      if (to >= range.low && to <= range.high) continue;
      d[i] = std::clamp(to, range.low, range.high) - x[i];
      held[static_cast<std::size_t>(i)] = moved = true;
    }
    if (moved) continue;
    d += more;
    break;
  }
  const VectorXd before = x;
  const Vector3d felt = inertia;
  // A rod that is not solved from so far is from half-way.
  for (double share = 1.0; share > kLeastShare; share *= 0.5) {
    x = before + share * d;
    feel(felt + share * (by_motion - felt));
    if (x.allFinite() && problem.evaluate(x)) return d;
  }
  x = before;
  feel(felt);
  problem.evaluate(x);
  return VectorXd::Zero(x.size());
}

double Estimator::Impl::inertia_share() const {
  return model::inertia_over_weight(own_kg(), end_kg());
}

Vector3d Estimator::Impl::inertia_variance() const {
  const Vector3d by_payload = gravity_variance_by_payload();
  // What the frame's rod has of its swing is in its gravity.
  if (swing) return by_payload + swing->gravity_by_error().rowwise().squaredNorm();
  const double share = inertia_share();
  return by_payload + share * share * motion.acceleration_variance();
}

Evidence Estimator::Impl::moving(Evidence bodies, double repeats) const {
  VectorXd variance = VectorXd::Zero(bodies.weighted.size());
  variance.segment<kMotions>(x.size() + motions()) = repeats * inertia_variance();
  integrate_out(variance, bodies);
  return bodies;
}

Vector3d Estimator::Impl::tip() const {
  return problem.solver().station(static_cast<int>(arm.bodies.size() + arm.segments.size()) - 1).p;
}

Window::Entry Estimator::Impl::entry() const {
  Window::Entry entry;
  entry.stamp_s = estimate.stamp_s;
  const double repeats = std::max(1.0, kPolicy.window.swing_s / window->spacing_s());
  entry.rows = rows();
  // By the stated noise, and nothing else: what bodies are off by is the same before a change and after it.
  VectorXd stated(entry.rows.measured.size());
  const Index per_body = stated.size() / (3 * static_cast<Index>(arm.bodies.size()));
  for (Index block = 0; block < entry.rows.blocks(); ++block) {
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(block / per_body)];
    const double sd = block % per_body == 0 ? body.position_sd_m : body.orientation_sd_rad;
    stated.segment<3>(3 * block).setConstant(entry.rows.weight[block] > 0.0 ? influence[block] / (sd * sd)
                                                                            : 0.0);
  }
  VectorXd as_driven = entry.rows.measured;
  FrameLaw law_there = law;
  if (law.of_effects > 0) {
    const VectorXd& off = extension->at().errors;
    as_driven -= entry.rows.j.rightCols(law.of_effects) * off;
    law_there.centre += law.by_effects() * off;
  }
  Evidence bodies = entry.rows.evidence(as_driven, stated);
  bodies = moving(std::move(bodies), repeats);
  if (!swing) entry.motion = inertia_share() * motion.acceleration();
  entry.motion_variance = inertia_variance();
  entry.evidence = evidence_on_shared(law_there, bodies.information.topLeftCorner(x.size(), x.size()),
                                      bodies.weighted.head(x.size()), repeats);
  entry.rows.weight = entry.rows.weight.cwiseProduct(influence);
  entry.law = law;
  entry.place = {problem.rod().gravity_m_s2 - inertia - swing_gravity, laws_given,
                 extension ? std::optional<EffectsAt>(extension->at()) : std::nullopt,
                 problem.solver().q_tip()};
  const Distances now = distances();
  double tangents = 0.0, tangent_chi2 = 0.0;
  for (const Observation& o : problem.observations()) {
    if (!o.used || !o.tangent) continue;
    tangents += 2.0;
    const Vector3d off = problem.tangent(o) - *o.tangent;
    tangent_chi2 += off.squaredNorm() / (problem.tangent_sd(o) * problem.tangent_sd(o));
  }
  entry.degrees_of_freedom = std::max(0.0, 3.0 * now.used + tangents - determined_by_bodies(problem, x));
  if (entry.degrees_of_freedom > 0.0)
    entry.misfit = (now.sum_of_squares + tangent_chi2) / entry.degrees_of_freedom;
  return entry;
}

bool Estimator::Impl::share() {
  if (!window || rms() > kPolicy.fit.inconsistent * arm.total_length_m()) return true;
  if (window->forget_before_change(entry(), law.information)) {
    // This frame was fitted with what is now forgotten.
    feel(Vector3d::Zero());
    believe();
    problem.begin();
    bool good = problem.evaluate(x) && minimise() && converged;
    if (good) refresh_covariance();
    if (!good || !keep_to_bounds() || !converged) return false;
    settle();
  }
  window->add(entry());
  return true;
}

}  // namespace softarm::estimate
