#include "softarm/estimate/estimator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "constant_curvature.h"
#include "estimator_impl.h"
#include "math/distributions.h"
#include "math/tiny_solver_tolerance.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// Information on what is known: a relative standard deviation of 1e-5.
constexpr double kKnown = 1e10;

double least_position_sd_m(const arm::Arm& arm) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const arm::MeasuredBody& body : arm.bodies) least_m = std::min(least_m, body.position_sd_m);
  return least_m;
}

/// A segment that nothing drives.
arm::SegmentPrediction at_rest(const arm::Segment& segment) {
  arm::SegmentPrediction prediction;
  prediction.bending_stiffness_nm2 = segment.bending_stiffness.base_nm2;
  prediction.length_m = segment.length_m;
  return prediction;
}

std::optional<double> told_payload(const arm::Arm& arm, const trial::Frame& frame) {
  return frame.payload_kg && std::isfinite(*frame.payload_kg) ? frame.payload_kg : arm.payload.default_kg;
}

/// What errors of the effects' numbers add to what the laws say of x.
Eigen::MatrixXd laws_by_errors(const ExtendedFrame& extension, const Problem& problem,
                               const std::vector<arm::SegmentPrediction>& laws, bool estimate_stiffness) {
  Eigen::MatrixXd by_errors = extension.laws_by_errors(laws, problem.reference_stiffnesses());
  // A stiffness that is not fitted moves the bodies instead.
  for (int i = 0; i < static_cast<int>(laws.size()) && !estimate_stiffness; ++i)
    by_errors.row(Problem::column(i, 2)).setZero();
  return by_errors;
}

}  // namespace

bool is_constant_curvature(arm::Method method) {
  return method == arm::Method::kCcPoints || method == arm::Method::kCcEndpoint;
}

Estimator::Impl::Impl(const arm::Arm& a, const arm::EstimatorOptions& o, const std::vector<model::Present>& e)
    : arm(a),
      options(o),
      problem(arm, options),
      memory(arm),
      motion(least_position_sd_m(arm)),
      noise(arm),
      payload_changes(own_kg() + arm.tip_mass_kg, options.dynamics == arm::Dynamics::kModal),
      effects(e) {
  check();
  for (int dof = 1; dof < 256; ++dof) {
    inflation_limit.push_back(math::chi_squared_quantile(dof, kPolicy.fit.inflation_level));
  }
  solver.options.max_num_iterations = kPolicy.fit.most_iterations + 1;  // TinySolver counts its start
  math::set_function_tolerance(solver.options, 1e-6);                   // of the cost in units of the noise
  solver.options.parameter_tolerance = 1e-9;
  solver.options.gradient_tolerance = 1e-9;
  estimate.segments.resize(arm.segments.size());
  if (!effects.empty() && !is_constant_curvature(options.method))
    extension = std::make_unique<ExtendedFrame>(arm, effects, problem);
  if (options.dynamics == arm::Dynamics::kModal && !is_constant_curvature(options.method)) swing.emplace(arm);
  if (options.window_s > 0.0 && !is_constant_curvature(options.method)) {
    std::vector<int> changing;
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      if (options.unknown != arm::Unknown::kPayload) changing.push_back(Problem::column(i, 2));
    }
    if (options.unknown != arm::Unknown::kStiffness) changing.push_back(problem.payload_column());
    window.emplace(options.window_s, std::move(changing), kPolicy.window.posture * arm.total_length_m());
    past = std::make_unique<Problem>(arm, options);
  }
}

void Estimator::Impl::check() const {
  if (arm.segments.empty()) throw std::invalid_argument("estimator: the arm has no segments");
  if (arm.bodies.empty()) throw std::invalid_argument("estimator: the arm has no measured bodies");
  if (options.method == arm::Method::kEndOrientation || options.method == arm::Method::kCcEndpoint) {
    for (std::size_t i = 0; i < arm.segments.size(); ++i) {
      if (end_body(static_cast<int>(i)) < 0) {
        throw std::invalid_argument(fmt::format(
            "estimator: method {} needs a ring {}on segment '{}'",
            options.method == arm::Method::kEndOrientation ? "end_orientation" : "cc_endpoint",
            options.method == arm::Method::kEndOrientation ? "with usable orientation " : "at the end ",
            arm.segments[i].name));
      }
    }
  }
}

int Estimator::Impl::end_body(int segment) const {
  double begin = 0.0;
  for (int i = 0; i < segment; ++i) begin += arm.segments[static_cast<std::size_t>(i)].length_m;
  const double length = arm.segments[static_cast<std::size_t>(segment)].length_m;
  const double end = begin + length;
  int best = -1;
  for (int i = 0; i < static_cast<int>(arm.bodies.size()); ++i) {
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(i)];
    if (body.kind != arm::BodyKind::kRing || body.arclength_m <= begin || body.arclength_m > end + 1e-9)
      continue;
    if (options.method == arm::Method::kEndOrientation && !body.orientation_usable) continue;
    if (options.method == arm::Method::kCcEndpoint && std::abs(body.arclength_m - end) > 1e-3 * length)
      continue;
    best = i;
  }
  return best;
}

void Estimator::Impl::fail(Status status, std::string detail) {
  estimate.status = status;
  estimate.detail = std::move(detail);
}

const Estimate& Estimator::Impl::run(const trial::Frame& frame) {
  clear(frame);
  frame_given = &frame;
  payload_changes.tell(frame.stamp_s(), told_payload(arm, frame));
  estimate.settling = payload_changes.settling();
  if (!place_base(frame) || !observe(frame)) {
    if (!extension) predict_laws(frame);  // walls go on while bodies are hidden
    return estimate;
  }
  if (!set_knowns(extension ? extension->begin(frame, base) : frame)) return estimate;
  if (options.method == arm::Method::kCcEndpoint) {
    x = constant_curvature_through(arm, problem, end_bodies());
    if (!problem.evaluate(x, constant_curvature_tip(problem, x))) {
      fail(Status::kNoConvergence, "the arc through the end points cannot be evaluated");
      return estimate;
    }
  } else {
    // Laws that are believed would take what all bodies have in common for bodies far off. As the last frame
    // says.
    const bool changing = payload_changes.variance_kg2() > 0.0;
    if (changing && options.prior.enabled && have_last && problem.evaluate(last_x))
      allow_for_payload_change();
    if (!solve_with_effects()) return estimate;
    estimate.status = Status::kOk;
    estimate.detail.clear();
    if (!allow_for_stretch() || !keep_to_bounds() || !has_converged()) return estimate;
    scatter = covariance.x;
    if (allow_for_payload_change()) refresh_covariance();
    settle();
    if (!share()) {
      have_last = false;
      fail(Status::kNoConvergence, "the fit was lost when the window's frames were forgotten");
      return estimate;
    }
  }
  finish();
  look_at_payload();
  if (swing && estimate.status == Status::kOk) look_at_swing();
  if (extended) take_effects_out();
  return estimate;
}

void Estimator::Impl::clear(const trial::Frame& frame) {
  for (SegmentEstimate& segment : estimate.segments) segment = SegmentEstimate();
  estimate.stamp_s = frame.stamp_s();
  estimate.status = Status::kOk;
  estimate.detail.clear();
  estimate.payload_kg.reset();
  estimate.sd_payload_kg.reset();
  estimate.identifiable_payload = false;
  estimate.backbone.clear();
  estimate.residuals.clear();
  estimate.too_far.clear();
  estimate.rms_residual_m = estimate.reduced_chi_square = 0.0;
  estimate.degrees_of_freedom = 0;
  estimate.solver = SolverSummary();
  problem.set_effects(nullptr);
  problem.set_motion(nullptr);
  inertia.setZero();
  swing_gravity.setZero();
  extended = false;
}

bool Estimator::Impl::place_base(const trial::Frame& frame) {
  if (!arm.base.body) {
    base = arm.base.fixed_pose;
  } else if (frame.base_body && frame.base_body->matrix().allFinite()) {
    base = *frame.base_body * arm.base.rod_in_body;
    base_seen = true;
  } else if (!base_seen || !arm.base.hold_last) {
    fail(Status::kNoBasePose, fmt::format("body '{}' that carries the base {}", *arm.base.body,
                                          base_seen ? "is lost" : "has not been seen yet"));
    return false;
  }
  estimate.base_in_mocap = base;
  problem.set_gravity(is_constant_curvature(options.method)
                          ? Vector3d(Vector3d::Zero())
                          : Vector3d(base.linear().transpose() * arm.gravity_m_s2));
  return true;
}

std::vector<int> Estimator::Impl::end_bodies() const {
  std::vector<int> list;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) list.push_back(end_body(i));
  return list;
}

bool Estimator::Impl::observe(const trial::Frame& frame) {
  std::vector<Observation>& observations = problem.observations();
  observations.clear();
  const bool ends =
      options.method == arm::Method::kEndOrientation || options.method == arm::Method::kCcEndpoint;
  const std::vector<int> wanted = ends ? end_bodies() : std::vector<int>();
  const Eigen::Isometry3d to_base = base.inverse();
  bool absurd = false;
  for (const trial::BodyObservation& seen : frame.bodies) {
    if (seen.body < 0 || seen.body >= static_cast<int>(arm.bodies.size())) continue;
    if (ends && std::find(wanted.begin(), wanted.end(), seen.body) == wanted.end()) continue;
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
    if (!seen.p_mocap.allFinite()) {
      absurd = true;
      continue;
    }
    Observation o;
    o.body = seen.body;
    const bool offset = !body.section_in_body.translation().isZero();
    if (seen.q_mocap && seen.q_mocap->coeffs().allFinite() && seen.q_mocap->norm() > 0.5) {
      const Eigen::Quaterniond q = seen.q_mocap->normalized();
      o.p = to_base * (seen.p_mocap + q * body.section_in_body.translation());
      if (options.method == arm::Method::kEndOrientation) {
        o.tangent = to_base.linear() * (q * (body.section_in_body.linear() * Vector3d::UnitZ()));
      }
    } else {
      if (options.method == arm::Method::kEndOrientation || offset) continue;
      o.p = to_base * seen.p_mocap;
    }
    if (!(o.p.norm() < kPolicy.bodies.far * arm.total_length_m())) {
      const double distance_m = o.p.stableNorm();
      if (std::isfinite(distance_m)) estimate.too_far.push_back({seen.body, distance_m});
      absurd = true;
      continue;
    }
    observations.push_back(o);
  }
  // What the bodies do not determine the laws do, where they are believed.
  const bool alone = !options.prior.enabled || is_constant_curvature(options.method);
  const std::size_t fewest = ends ? arm.segments.size() : 1;
  if (observations.size() < fewest ||
      (!ends && alone && observations.size() * 3 < arm.segments.size() * 3 + 1)) {
    fail(absurd && observations.empty() ? Status::kInvalidInput : Status::kNotEnoughBodies,
         fmt::format("{} of {} bodies can be used{}{}", observations.size(), arm.bodies.size(),
                     ends || arm.bodies.size() > arm.segments.size()
                         ? ""
                         : ", and without the prior more are needed than there are segments",
                     too_far_words()));
    return false;
  }
  if (!ends && alone && !enough_beyond_every_joint()) {
    fail(Status::kNotEnoughBodies,
         fmt::format("{} bodies, but too few towards the tip for the curvature and length "
                     "of every segment{}",
                     observations.size(), too_far_words()));
    return false;
  }
  return true;
}

std::string Estimator::Impl::too_far_words() const {
  std::string words;
  for (const BodyTooFar& far : estimate.too_far)
    words += fmt::format("; '{}' is {:.3g} m from the base",
                         arm.bodies[static_cast<std::size_t>(far.body)].name, far.distance_m);
  if (words.empty()) return words;
  return words + fmt::format(", too far for an arm of {:.3g} m: {}", arm.total_length_m(), kUnitsHint);
}

bool Estimator::Impl::enough_beyond_every_joint() const {
  double begin = 0.0;
  for (std::size_t i = 0; i < arm.segments.size(); ++i) {
    const auto& observations = problem.observations();
    const auto beyond = std::count_if(observations.begin(), observations.end(), [&](const Observation& o) {
      return arm.bodies[static_cast<std::size_t>(o.body)].arclength_m > begin + 1e-6;
    });
    if (beyond < static_cast<std::ptrdiff_t>(arm.segments.size() - i)) return false;
    begin += arm.segments[i].length_m;
  }
  return true;
}

std::optional<std::vector<arm::SegmentPrediction>> Estimator::Impl::predict_laws(const trial::Frame& frame) {
  if (frame.inputs.size() != arm.inputs.scalars.size()) return std::nullopt;
  std::optional<std::vector<arm::SegmentPrediction>> predictions =
      model::predict(arm, frame.inputs, extension ? extension->moment_inputs() : frame.inputs);
  if (!predictions) return predictions;
  memory.follow(frame.stamp_s(), frame.inputs, *predictions);
  return predictions;
}

bool Estimator::Impl::has_needed_inputs(const trial::Frame& frame, bool estimate_stiffness) {
  const bool believe_laws = options.prior.enabled;
  for (const arm::Segment& segment : arm.segments) {
    const bool needed = believe_laws || (!estimate_stiffness && arm::stiffness_depends_on_inputs(segment));
    if (!needed || arm::predict_segment(arm, segment, frame.inputs)) continue;
    const std::string missing = arm::missing_inputs(arm, segment, frame.inputs);
    const char* why = believe_laws ? "the prior needs" : "its stiffness depends on";
    fail(missing.empty() ? Status::kInvalidInput : Status::kMissingInputs,
         missing.empty()
             ? fmt::format("segment '{}': {} inputs that are outside of its laws", segment.name, why)
             : fmt::format("segment '{}': {} {}, absent or too old", segment.name, why, missing));
    return false;
  }
  return true;
}

std::vector<Eigen::Vector2d> Estimator::Impl::unknown_starts(
    const std::vector<arm::SegmentPrediction>& laws) {
  if (!extension || !options.prior.enabled || inputs_known != true) return {};
  const double last_kg = have_last ? last_x[problem.payload_column()] * Problem::kPayloadUnit : 0.0;
  return extension->start_variance(laws, payload_known.value_or(last_kg));
}

bool Estimator::Impl::set_knowns(const trial::Frame& frame) {
  const bool arcs = is_constant_curvature(options.method);
  const int segments = static_cast<int>(arm.segments.size());
  payload_known = told_payload(arm, frame);
  const bool estimate_payload = !arcs && options.unknown != arm::Unknown::kStiffness;
  // Believed laws say what EI is as well as they know it.
  const bool estimate_stiffness =
      !arcs && (options.unknown != arm::Unknown::kPayload || options.prior.enabled);
  if (estimate_payload) {
    payload_known.reset();
  } else if (!arcs && !payload_known) {
    fail(Status::kMissingPayload,
         "the payload is not known: publish it, set a default, or make it the unknown");
    return false;
  }

  std::optional<std::vector<arm::SegmentPrediction>> predictions = predict_laws(frame);
  if (!predictions && !arcs && !has_needed_inputs(frame, estimate_stiffness)) return false;
  problem.set_laws(predictions);
  laws_given = predictions;
  // What frames share is counted from the laws at their inputs: without inputs it is something else.
  if (window && inputs_known && *inputs_known != predictions.has_value()) window->clear();
  inputs_known = predictions.has_value();
  if (!predictions) {
    predictions.emplace();
    for (const arm::Segment& segment : arm.segments)
      predictions->push_back(arm::predict_segment(arm, segment, frame.inputs).value_or(at_rest(segment)));
  }
  if (extension) {
    laws_at_frame = *predictions;
    extension->set_laws(laws_at_frame);
  }
  const bool believed = !arcs && (options.prior.enabled || window);
  if (believed) {
    law = frame_law(arm, options.prior, *predictions, problem.reference_stiffnesses(), window.has_value(),
                    frame.inputs);
    if (extension)
      allow_for_effects(laws_by_errors(*extension, problem, *predictions, estimate_stiffness), law);
    allow_for_memory(options.prior, memory, unknown_starts(*predictions), *predictions, law);
    if (!have_last) stretch_m.assign(arm.segments.size(), 0.0);
    allow_for_axial_stiffness(options.prior, stretch_m, law);
  }

  known_flexibility.assign(arm.segments.size(), std::nullopt);
  start_flexibility = known_flexibility;
  for (int i = 0; i < segments; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const double flexibility = problem.reference_stiffness(i) / (*predictions)[index].bending_stiffness_nm2;
    if (!arcs && !estimate_stiffness) known_flexibility[index] = flexibility;
    if (believed && !estimate_stiffness) law.information[Problem::column(i, 2)] = kKnown;
    if (!arcs && (!estimate_stiffness || estimate_payload)) start_flexibility[index] = flexibility;
    for (int k = 0; k < kSegmentParameters; ++k)
      problem.free()[static_cast<std::size_t>(Problem::column(i, k))] = k != 2 || estimate_stiffness;
  }
  problem.free()[static_cast<std::size_t>(problem.payload_column())] = estimate_payload;
  if (window || swing) noise.add(frame.stamp_s(), problem.observations());
  if (swing) follow_swing(frame, *predictions);
  if (window) {
    window->advance(frame.stamp_s());
    window->enter(problem.observations(), passing_variance());
  }
  believe();
  problem.begin();
  return true;
}

Estimator::Estimator(const arm::Arm& arm, const arm::EstimatorOptions& options)
    : Estimator(arm, options, std::vector<model::Present>()) {}
Estimator::Estimator(const arm::Arm& arm, const arm::EstimatorOptions& options,
                     const std::vector<model::Present>& effects)
    : impl_(std::make_unique<Impl>(arm, options, effects)) {}
Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

const Estimate& Estimator::estimate(const trial::Frame& frame) & {
  return impl_->run(frame);
}

Estimate Estimator::estimate(const trial::Frame& frame) && {
  return impl_->run(frame);
}

void Estimator::reset() {
  impl_->have_last = false;
  impl_->base_seen = false;
  if (impl_->window) impl_->window->clear();
  impl_->motion.forget();
  impl_->noise.forget();
  impl_->payload_changes.forget();
  if (impl_->swing) impl_->swing->forget();
  impl_->modes_at.reset();
  impl_->last_x_by_laws.reset();
  impl_->bodies_by_x.clear();
  impl_->contradictions = 0;
  impl_->inputs_known.reset();
  impl_->problem.forget();
  impl_->memory.reset();
  if (impl_->extension) impl_->extension->reset();
}

const arm::Arm& Estimator::arm() const {
  return impl_->arm;
}
const arm::EstimatorOptions& Estimator::options() const {
  return impl_->options;
}

Estimator::ByLaws Estimator::by_laws() const {
  if (impl_->extended) return {impl_->frame_by_laws, impl_->estimate_by_laws};
  return {*impl_->frame_given, impl_->estimate};
}

std::vector<std::string> Estimator::effect_notes() const {
  if (impl_->extension) return impl_->extension->notes();
  if (impl_->effects.empty()) return {};
  return {"none of the arm file's effects is in the model: methods with constant curvature have none"};
}

void Estimator::set_unknown(arm::Unknown unknown) {
  if (unknown == impl_->options.unknown) return;
  arm::EstimatorOptions options = impl_->options;
  options.unknown = unknown;
  const std::unique_ptr<Impl> before = std::move(impl_);
  impl_ = std::make_unique<Impl>(before->arm, options, before->effects);
  impl_->backbone_points = before->backbone_points;
  impl_->solver.options.max_num_iterations = before->solver.options.max_num_iterations;
  impl_->base = before->base;
  impl_->base_seen = before->base_seen;
  impl_->payload_changes = before->payload_changes;
  if (impl_->extension && before->extension) impl_->extension = std::move(before->extension);
}

void Estimator::set_backbone_points(int count) {
  impl_->backbone_points = count;
}

void Estimator::set_most_iterations(int count) {
  impl_->solver.options.max_num_iterations = count + 1;  // TinySolver counts its start
}

}  // namespace softarm::estimate
