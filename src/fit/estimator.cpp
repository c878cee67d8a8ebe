#include "softarm/fit/estimator.h"

#include <ceres/tiny_solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "constant_curvature.h"
#include "covariance.h"
#include "free_tip.h"
#include "problem.h"
#include "softarm/math/so3.h"
#include "start.h"

namespace softarm {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using fit::Observation;
using fit::Problem;

constexpr double kFarFromArm =
    1.5;  // bodies further from the base than this many arm lengths are not measurements
constexpr double kBadWarmStart =
    0.05;                         // rms distance over the arm's length above which the last frame is no start
constexpr double kGross = 0.1;    // the same, above which a converged fit is inconsistent
constexpr double kOutlier = 6.0;  // standard deviations at which a body may be set aside ...
constexpr double kOutlierAgainstRest = 4.0;  // ... if it is also this much worse than the others
constexpr double kNearBuckling =
    4.0;  // norm of the tip's turn per turn of the base; that of a stiff rod is 1.7
constexpr double kToldChiSquare = 3.0;  // two standard deviations, less some allowance for curvature
constexpr double kInflationLevel =
    0.999;  // chi-square level above which stated noise no longer explains the residuals

bool is_constant_curvature(Method method) {
  return method == Method::kCcPoints || method == Method::kCcEndpoint;
}

bool depends_on_pressures(const Segment& segment) {
  const StiffnessLaw& law = segment.bending_stiffness;
  return law.per_min_pressure_nm2_per_pa != 0.0 || law.per_jamming_pressure_nm2_per_pa != 0.0;
}

}  // namespace

struct Estimator::Impl {
  Impl(const Arm& a, const EstimatorOptions& o) : arm(a), options(o), problem(arm, options) {
    check();
    for (int dof = 1; dof < 256; ++dof) {
      inflation_limit.push_back(quantile(boost::math::chi_squared(dof), kInflationLevel));
    }
    solver.options.max_num_iterations = 60;
    solver.options.function_tolerance = 1e-6;  // of the cost in units of the noise
    solver.options.parameter_tolerance = 1e-9;
    solver.options.gradient_tolerance = 1e-9;
    estimate.segments.resize(arm.segments.size());
  }

  void check() const {
    if (arm.segments.empty()) throw std::invalid_argument("estimator: the arm has no segments");
    if (arm.bodies.empty()) throw std::invalid_argument("estimator: the arm has no measured bodies");
    if (options.method == Method::kEndOrientation || options.method == Method::kCcEndpoint) {
      for (std::size_t i = 0; i < arm.segments.size(); ++i) {
        if (end_body(static_cast<int>(i)) < 0) {
          throw std::invalid_argument(fmt::format(
              "estimator: method {} needs a ring {}on segment '{}'",
              options.method == Method::kEndOrientation ? "end_orientation" : "cc_endpoint",
              options.method == Method::kEndOrientation ? "with usable orientation " : "at the end ",
              arm.segments[i].name));
        }
      }
    }
  }

  /// The most distal ring of a segment that serves the method; -1 if there is none.
  int end_body(int segment) const {
    double begin = 0.0;
    for (int i = 0; i < segment; ++i) begin += arm.segments[static_cast<std::size_t>(i)].length_m;
    const double length = arm.segments[static_cast<std::size_t>(segment)].length_m;
    const double end = begin + length;
    int best = -1;
    for (int i = 0; i < static_cast<int>(arm.bodies.size()); ++i) {
      const MeasuredBody& body = arm.bodies[static_cast<std::size_t>(i)];
      if (body.kind != BodyKind::kRing || body.arclength_m <= begin || body.arclength_m > end + 1e-9)
        continue;
      if (options.method == Method::kEndOrientation && !body.orientation_usable) continue;
      if (options.method == Method::kCcEndpoint && std::abs(body.arclength_m - end) > 1e-3 * length) continue;
      best = i;
    }
    return best;
  }

  void fail(Status status, std::string detail) {
    estimate.status = status;
    estimate.detail = std::move(detail);
  }

  const Estimate& run(const Frame& frame) {
    clear(frame);
    if (!place_base(frame) || !observe(frame) || !set_knowns(frame)) return estimate;
    if (options.method == Method::kCcEndpoint) {
      x = fit::constant_curvature_through(arm, problem, end_bodies());
      if (!problem.evaluate(x, fit::constant_curvature_tip(problem, x))) {
        fail(Status::kNoConvergence, "the arc through the end points cannot be evaluated");
        return estimate;
      }
    } else {
      if (!set_outliers_aside(solve())) return estimate;
      estimate.status = Status::kOk;
      estimate.detail.clear();
      if (!keep_to_bounds()) return estimate;
    }
    finish();
    return estimate;
  }

  void clear(const Frame& frame) {
    for (SegmentEstimate& segment : estimate.segments) segment = SegmentEstimate();
    estimate.stamp_s = frame.stamp_s;
    estimate.status = Status::kOk;
    estimate.detail.clear();
    estimate.payload_kg.reset();
    estimate.sd_payload_kg.reset();
    estimate.tells_payload = false;
    estimate.backbone.clear();
    estimate.residuals.clear();
    estimate.rms_residual_m = estimate.mismatch = 0.0;
    estimate.degrees_of_freedom = 0;
    estimate.solver = SolverSummary();
  }

  // --- step 1 ---

  bool place_base(const Frame& frame) {
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

  std::vector<int> end_bodies() const {
    std::vector<int> list;
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) list.push_back(end_body(i));
    return list;
  }

  bool observe(const Frame& frame) {
    std::vector<Observation>& observations = problem.observations();
    observations.clear();
    const bool ends = options.method == Method::kEndOrientation || options.method == Method::kCcEndpoint;
    const std::vector<int> wanted = ends ? end_bodies() : std::vector<int>();
    const Eigen::Isometry3d to_base = base.inverse();
    bool absurd = false;
    for (const BodyObservation& seen : frame.bodies) {
      if (seen.body < 0 || seen.body >= static_cast<int>(arm.bodies.size())) continue;
      if (ends && std::find(wanted.begin(), wanted.end(), seen.body) == wanted.end()) continue;
      const MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
      if (!seen.p_mocap.allFinite()) {
        absurd = true;
        continue;
      }
      Observation o;
      o.body = seen.body;
      o.station = problem.station_of_body(seen.body);
      const bool offset = !body.section_in_body.translation().isZero();
      if (seen.q_mocap && seen.q_mocap->coeffs().allFinite() && seen.q_mocap->norm() > 0.5) {
        const Eigen::Quaterniond q = seen.q_mocap->normalized();
        o.p = to_base * (seen.p_mocap + q * body.section_in_body.translation());
        if (options.method == Method::kEndOrientation) {
          o.tangent = to_base.linear() * (q * (body.section_in_body.linear() * Vector3d::UnitZ()));
        }
      } else {
        if (options.method == Method::kEndOrientation || offset) continue;
        o.p = to_base * seen.p_mocap;
      }
      if (!(o.p.norm() < kFarFromArm * arm.total_length_m())) {
        far.push_back(body.name);
        absurd = true;
        continue;
      }
      observations.push_back(o);
    }
    const std::size_t fewest = ends ? arm.segments.size() : 1;
    if (observations.size() < fewest || (!ends && observations.size() * 3 < arm.segments.size() * 3 + 1)) {
      std::string detail = fmt::format("{} of {} bodies can be used", observations.size(), arm.bodies.size());
      for (const std::string& name : far)
        detail += fmt::format("; '{}' is too far from the base to be on the arm", name);
      far.clear();
      fail(absurd && observations.empty() ? Status::kInvalidInput : Status::kNotEnoughBodies, detail);
      return false;
    }
    far.clear();
    if (!ends && !enough_beyond_every_joint()) {
      fail(Status::kNotEnoughBodies,
           fmt::format("{} bodies, but too few towards the tip for the curvature and length "
                       "of every segment",
                       observations.size()));
      return false;
    }
    return true;
  }

  /// Each segment has three unknowns of shape, each body three coordinates: from every joint to the tip there
  /// must be as many bodies as segments.
  bool enough_beyond_every_joint() const {
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

  // --- what is known ---

  bool set_knowns(const Frame& frame) {
    const bool arcs = is_constant_curvature(options.method);
    const int segments = static_cast<int>(arm.segments.size());
    payload_known.reset();
    if (frame.payload_kg && std::isfinite(*frame.payload_kg))
      payload_known = frame.payload_kg;
    else
      payload_known = arm.payload.default_kg;
    const bool estimate_payload = !arcs && options.unknown == Unknown::kPayload;
    if (!arcs && !estimate_payload && !payload_known) {
      fail(Status::kMissingPayload,
           "the payload is not known: publish it, set a default, or make it the unknown");
      return false;
    }
    known_flexibility.assign(arm.segments.size(), std::nullopt);
    for (int i = 0; i < segments; ++i) {
      const Segment& segment = arm.segments[static_cast<std::size_t>(i)];
      std::optional<SegmentPrediction> prediction;
      if (frame.inputs.size() == arm.inputs.pressures.size())
        prediction = predict_segment(arm, segment, frame.inputs);
      const bool with_prior = options.prior.enabled && !arcs;
      if (with_prior && !prediction) {
        fail(Status::kMissingPressures,
             fmt::format("segment '{}': the prior needs its pressures", segment.name));
        return false;
      }
      problem.set_prior(i, with_prior ? prediction : std::nullopt);
      if (estimate_payload) {
        if (!prediction && depends_on_pressures(segment)) {
          fail(Status::kMissingPressures,
               fmt::format("segment '{}': its stiffness depends on pressures that are absent", segment.name));
          return false;
        }
        const double ei = prediction ? prediction->bending_stiffness_nm2 : segment.bending_stiffness.base_nm2;
        known_flexibility[static_cast<std::size_t>(i)] = problem.reference_stiffness(i) / ei;
      }
      for (int k = 0; k < fit::kSegmentParameters; ++k) {
        problem.free()[static_cast<std::size_t>(Problem::column(i, k))] =
            k != 2 || !(arcs || estimate_payload);
      }
    }
    problem.free()[static_cast<std::size_t>(problem.payload_column())] = estimate_payload;
    problem.begin();
    return true;
  }

  // --- steps 2 and 3 ---

  void impose_knowns(VectorXd& v) const {
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      const auto& known = known_flexibility[static_cast<std::size_t>(i)];
      if (known) v[Problem::column(i, 2)] = *known;
    }
    if (options.unknown != Unknown::kPayload)
      v[problem.payload_column()] = payload_known.value_or(0.0) / Problem::kPayloadUnit;
  }

  void refresh_covariance() { covariance = fit::covariance(problem, problem_free(), options, x); }

  double rms() const {
    double sum = 0.0;
    int count = 0;
    for (const Observation& o : problem.observations()) {
      if (!o.used) continue;
      sum += (problem.position(o) - o.p).squaredNorm();
      ++count;
    }
    return std::sqrt(sum / std::max(1, count));
  }

  /// @param free_tip go by way of a rod whose base is not yet clamped
  bool start_cold(bool free_tip = false) {
    problem.forget();
    std::vector<std::optional<double>> c = known_flexibility;
    if (is_constant_curvature(options.method)) c.assign(c.size(), 1.0);
    fit::Start start = fit::start_from_shape(arm, problem, c, payload_known.value_or(0.0));
    impose_knowns(start.x);
    if (free_tip && !fit::refine_with_free_tip(problem, start)) return false;
    x = start.x;
    return problem.evaluate(x, start.q_tip) || problem.evaluate(x);
  }

  bool minimise() {
    solver.Solve(problem, &x);
    estimate.solver.iterations += solver.summary.iterations;
    if (estimate.solver.initial_cost == 0.0) estimate.solver.initial_cost = solver.summary.initial_cost;
    estimate.solver.final_cost = solver.summary.final_cost;
    return problem.evaluate(x) && x.allFinite();
  }

  bool solve() {
    const double length = arm.total_length_m();
    bool warm = have_last;
    if (warm) {
      x = last_x;
      impose_knowns(x);
      warm = problem.evaluate(x) && rms() < kBadWarmStart * length;
    }
    bool good = (warm || start_cold()) && minimise();
    const auto poor = [&] { return !good || rms() > 0.5 * kBadWarmStart * length; };
    if (warm && poor()) {
      warm = false;
      good = start_cold() && minimise();
    }
    // A standing arm near its buckling load, say: at a stiffness far off it has no equilibrium near its
    // shape, or the fit runs into the load at which it is lost.
    if (good) refresh_covariance();
    if (poor() || !covariance.shape_determined) {
      const VectorXd before = x;
      const double rms_before = good ? rms() : std::numeric_limits<double>::infinity();
      const bool better = start_cold(true) && minimise() && rms() < rms_before;
      if (!better) x = before;
      good = better || (good && problem.evaluate(x));
      if (good) refresh_covariance();
    }
    estimate.solver.warm_start = warm;
    if (!good) {
      have_last = false;
      fail(Status::kNoConvergence, "no shape of this arm that the fit can reach lies near the bodies");
    }
    return good;
  }

  // --- step 4 ---

  /// How far the bodies used are from the fit, in standard deviations.
  struct Distances {
    double largest = 0.0, sum_of_squares = 0.0;
    int used = 0;
  };
  double distance(const Observation& o) const {
    return (problem.position(o) - o.p).norm() / problem.position_sd(o);
  }
  Distances distances() const {
    Distances d;
    for (const Observation& o : problem.observations()) {
      if (!o.used) continue;
      d.largest = std::max(d.largest, distance(o));
      d.sum_of_squares += distance(o) * distance(o);
      ++d.used;
    }
    return d;
  }

  /// The fit without each body in turn: an outlier pulls the fit so much that its own residual need not be
  /// the largest. The body is set aside whose absence leaves the least, if the rest then contradicts it.
  /// @param fitted x is a fit to all bodies in use
  /// @return false where everything stays as it was
  bool set_one_aside(bool fitted) {
    std::vector<Observation>& observations = problem.observations();
    const VectorXd x_before = x;
    const Eigen::Quaterniond tip_before = problem.solver().q_tip();
    Observation* outlier = nullptr;
    VectorXd best_x;
    Eigen::Quaterniond best_tip;
    double least = std::numeric_limits<double>::infinity();
    for (Observation& o : observations) {
      if (!o.used) continue;
      o.used = false;
      problem.begin();
      for (const bool cold : {false, true}) {
        if (!cold && !fitted) continue;
        x = x_before;
        if (!(cold ? start_cold() : problem.evaluate(x, tip_before)) || !minimise()) continue;
        const Distances rest = distances();
        if (rest.sum_of_squares < least) {
          least = rest.sum_of_squares;
          outlier = &o;
          best_x = x;
          best_tip = problem.solver().q_tip();
        }
        if (rest.largest < kOutlier) break;
      }
      o.used = true;
    }
    if (outlier != nullptr) {
      outlier->used = false;
      problem.begin();
      x = best_x;
      if (problem.evaluate(x, best_tip)) {
        const double rest = std::sqrt(least / distances().used);
        if (distance(*outlier) > std::max(kOutlier, kOutlierAgainstRest * rest)) return true;
      }
      outlier->used = true;
    }
    problem.begin();
    x = x_before;
    if (fitted) problem.evaluate(x, tip_before);
    return false;
  }

  /// @param fitted x is a fit to all bodies
  bool set_outliers_aside(bool fitted) {
    if (!options.robust) return fitted;
    while (true) {
      const Distances now = fitted ? distances() : Distances();
      const auto& observations = problem.observations();
      const auto used = std::count_if(observations.begin(), observations.end(),
                                      [](const Observation& o) { return o.used; });
      if ((fitted && now.largest < kOutlier) || 3 * (static_cast<int>(used) - 1) - estimated_parameters() < 1)
        return fitted;
      if (!set_one_aside(fitted)) return fitted;
      fitted = true;
      refresh_covariance();
    }
  }

  int estimated_parameters() const {
    return static_cast<int>(std::count(problem_free().begin(), problem_free().end(), true));
  }
  const std::vector<bool>& problem_free() const { return const_cast<Impl*>(this)->problem.free(); }

  /// A flexibility, length or payload outside its physical range is held at the limit and the rest fitted
  /// again.
  bool keep_to_bounds() {
    estimated = problem_free();
    bool moved = false;
    const auto hold = [&](int column, double low, double high) {
      if (!estimated[static_cast<std::size_t>(column)] || (x[column] >= low && x[column] <= high)) return;
      x[column] = std::clamp(x[column], low, high);
      problem.free()[static_cast<std::size_t>(column)] = false;
      moved = true;
    };
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      const Segment& segment = arm.segments[static_cast<std::size_t>(i)];
      const double reference = problem.reference_stiffness(i), rest = problem.rest_length(i);
      hold(Problem::column(i, 2), reference / segment.bending_stiffness_range_nm2.high,
           reference / segment.bending_stiffness_range_nm2.low);
      const Range& length = segment.length_range_m;
      if (length.high > 0.0) hold(Problem::column(i, 3), length.low / rest, length.high / rest);
    }
    hold(problem.payload_column(), arm.payload.range_kg.low / Problem::kPayloadUnit,
         arm.payload.range_kg.high / Problem::kPayloadUnit);
    if (!moved) return true;
    problem.begin();
    bool good = problem.evaluate(x) && minimise();
    if (!good) {
      // Too far for a step: from the measured shape, with what is held as known.
      for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
        const int column = Problem::column(i, 2);
        if (problem.free()[static_cast<std::size_t>(column)]) continue;
        known_flexibility[static_cast<std::size_t>(i)] = x[column];
      }
      good = start_cold() && minimise();
    }
    problem.free() = estimated;  // what is told is asked of all of them
    problem.begin();
    if (!good || !problem.evaluate(x)) {
      have_last = false;
      fail(Status::kNoConvergence, "no shape with stiffness, length and payload in their ranges was found");
      return false;
    }
    refresh_covariance();
    return true;
  }

  // --- step 5 ---

  void finish() {
    estimate.rms_residual_m = rms();
    estimate.solver.rod_solves = problem.rod_solves();
    if (options.method == Method::kCcEndpoint) estimated = problem_free();
    if (estimate.rms_residual_m > kGross * arm.total_length_m()) {
      have_last = false;
      fail(Status::kInconsistent,
           fmt::format("no shape of this arm comes nearer than {:.1f} mm to the bodies",
                       1e3 * estimate.rms_residual_m));
      return;
    }
    if (options.method == Method::kCcEndpoint) refresh_covariance();
    residuals_and_mismatch();
    const int dof = estimate.degrees_of_freedom;
    if (dof > 0 && dof < static_cast<int>(inflation_limit.size()) &&
        estimate.mismatch * dof > inflation_limit[static_cast<std::size_t>(dof - 1)]) {
      covariance.x *= estimate.mismatch;
    }
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      fit::fill_segment(problem, i, x, covariance, estimated, options,
                        estimate.segments[static_cast<std::size_t>(i)]);
    }
    bending_angles();
    payload();
    backbone();
    last_x = x;
    have_last = options.method != Method::kCcEndpoint;
    confirm_stiffness();
  }

  /// Near a buckling load the shape is so sensitive to the stiffness that the linear covariance promises
  /// much, while another stiffness with another moment explains the bodies nearly as well. There, EI is told
  /// only if fits with EI moved by twice the relative standard deviation that telling asks for are worse by
  /// what such a deviation would make them.
  void confirm_stiffness() {
    if (problem.solver().base_per_tip_rotation().inverse().norm() < kNearBuckling) return;
    const double moved = 1.0 + 2.0 * options.tells_relative_sd;
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      SegmentEstimate& segment = estimate.segments[static_cast<std::size_t>(i)];
      if (!segment.tells_stiffness) continue;
      const int column = Problem::column(i, 2);
      const Eigen::Quaterniond q_tip = problem.solver().q_tip();
      problem.free()[static_cast<std::size_t>(column)] = false;
      for (const double factor : {moved, 1.0 / moved}) {
        VectorXd y = last_x;
        problem.begin();
        problem.forget();
        problem.evaluate(y, q_tip);
        y[column] *= factor;
        double cost = std::numeric_limits<double>::infinity();
        if (problem.evaluate(y)) {
          solver.Solve(problem, &y);
          cost = solver.summary.final_cost;
        }
        // Without an equilibrium within reach, the shape itself is another start.
        known_flexibility[static_cast<std::size_t>(i)] = y[column];
        if (start_cold()) {
          solver.Solve(problem, &x);
          cost = std::min(cost, solver.summary.final_cost);
        }
        if (2.0 * (cost - estimate.solver.final_cost) < kToldChiSquare) segment.tells_stiffness = false;
      }
      problem.free()[static_cast<std::size_t>(column)] = true;
    }
    problem.forget();
    problem.evaluate(last_x);
    x = last_x;
  }

  void residuals_and_mismatch() {
    double chi2 = 0.0;
    int rows = 0;
    for (const Observation& o : problem.observations()) {
      BodyResidual r;
      r.body = o.body;
      r.measured_base = o.p;
      r.estimated_base = problem.position(o);
      r.used = o.used;
      estimate.residuals.push_back(r);
      if (!o.used) continue;
      const double sd = problem.position_sd(o);
      chi2 += (r.estimated_base - r.measured_base).squaredNorm() / (sd * sd);
      rows += 3;
      if (o.tangent) {
        const Vector3d e = problem.solver().station(o.station).q * Vector3d::UnitZ() - *o.tangent;
        chi2 += e.squaredNorm() / (problem.tangent_sd(o) * problem.tangent_sd(o));
        rows += 2;
      }
    }
    estimate.degrees_of_freedom =
        std::max(0, rows - static_cast<int>(std::count(estimated.begin(), estimated.end(), true)));
    estimate.mismatch = estimate.degrees_of_freedom > 0 ? chi2 / estimate.degrees_of_freedom : 0.0;
  }

  void bending_angles() {
    Vector3d from = Vector3d::UnitZ();
    for (std::size_t i = 0; i < arm.segments.size(); ++i) {
      const int station = static_cast<int>(arm.bodies.size() + i);
      const Vector3d to = problem.solver().station(station).q * Vector3d::UnitZ();
      estimate.segments[i].bending_angle_rad = std::atan2(from.cross(to).norm(), from.dot(to));
      from = to;
    }
  }

  void payload() {
    if (is_constant_curvature(options.method)) {
      estimate.payload_kg = payload_known;
      return;
    }
    const int column = problem.payload_column();
    estimate.payload_kg = x[column] * Problem::kPayloadUnit;
    if (options.unknown != Unknown::kPayload || !covariance.determined[static_cast<std::size_t>(column)])
      return;
    estimate.sd_payload_kg = std::sqrt(covariance.x(column, column)) * Problem::kPayloadUnit;
    estimate.tells_payload = *estimate.sd_payload_kg <= options.tells_relative_sd * *estimate.payload_kg;
  }

  void backbone() {
    const double length = arm.total_length_m();
    for (int i = 0; i < backbone_points; ++i) {
      const rod::RodState state = problem.solver().at(length * i / std::max(1, backbone_points - 1));
      estimate.backbone.push_back({state.s_m, state.p, state.q, state.u});
    }
  }

  const Arm arm;
  EstimatorOptions options;
  Problem problem;
  ceres::TinySolver<Problem> solver;
  std::vector<double> inflation_limit;
  int backbone_points = 41;

  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  bool base_seen = false;
  std::vector<std::string> far;
  std::optional<double> payload_known;
  std::vector<std::optional<double>> known_flexibility;
  std::vector<bool> estimated;
  fit::Covariance covariance;
  VectorXd x, last_x;
  bool have_last = false;
  Estimate estimate;
};

Estimator::Estimator(const Arm& arm, const EstimatorOptions& options)
    : impl_(std::make_unique<Impl>(arm, options)) {}
Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

const Estimate& Estimator::estimate(const Frame& frame) {
  return impl_->run(frame);
}

void Estimator::reset() {
  impl_->have_last = false;
  impl_->base_seen = false;
  impl_->problem.forget();
}

const Arm& Estimator::arm() const {
  return impl_->arm;
}
const EstimatorOptions& Estimator::options() const {
  return impl_->options;
}

void Estimator::set_unknown(Unknown unknown) {
  if (unknown == impl_->options.unknown) return;
  EstimatorOptions options = impl_->options;
  options.unknown = unknown;
  const int points = impl_->backbone_points;
  impl_ = std::make_unique<Impl>(Arm(impl_->arm), options);
  impl_->backbone_points = points;
}

void Estimator::set_backbone_points(int count) {
  impl_->backbone_points = count;
}

}  // namespace softarm
