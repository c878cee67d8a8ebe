#include "pull.h"

#include <ceres/tiny_solver.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "identify/choose_frames.h"
#include "softarm/rod/solver.h"

namespace softarm::published {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSameInput = 0.01;  // share of the inputs' size
constexpr double kSamePayload_kg = 1e-4;
constexpr double kUpright = 0.999;  // cosine of the base's tangent to the vertical
constexpr double kAtTip_m = 1e-6;
constexpr double kNoEquilibrium = 1e8;  // residual where there is none
constexpr int kMostIterations = 100;

/// The mean of frames at rest with the same inputs and payload.
struct Rest {
  trial::StaticFrame frame;
  std::map<int, Vector3d> p_base;
  double count = 0.0;
};

bool same_inputs(const trial::StaticFrame& a, const trial::StaticFrame& b) {
  if (a.trial != b.trial || a.inputs.size() != b.inputs.size()) return false;
  for (std::size_t i = 0; i < a.inputs.size(); ++i) {
    const double x = a.inputs[i].value_or(0.0), y = b.inputs[i].value_or(0.0);
    if (a.inputs[i].has_value() != b.inputs[i].has_value()) return false;
    if (std::abs(x - y) > kSameInput * std::max(std::abs(x), std::abs(y)) + 1e-9) return false;
  }
  return true;
}

std::vector<Rest> rests(const std::vector<trial::StaticFrame>& frames) {
  std::vector<Rest> list;
  for (const trial::StaticFrame& frame : frames) {
    const bool new_rest = list.empty() || !same_inputs(list.back().frame, frame) ||
                          std::abs(list.back().frame.payload_kg - frame.payload_kg) > kSamePayload_kg;
    if (new_rest) list.push_back({frame, {}, 0.0});
    Rest& rest = list.back();
    rest.count += 1.0;
    for (const trial::SeenBody& seen : frame.bodies) {
      Vector3d& mean = rest.p_base.try_emplace(seen.body, seen.p_base).first->second;
      mean += (seen.p_base - mean) / rest.count;
    }
  }
  return list;
}

/// Moment (2), flexibility and length of one segment from the bodies under two loads, in units of a guess.
class TwoLoads {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 4 };

  TwoLoads(const arm::Arm& arm, const Rest& before, const Rest& after, double moment_nm, double stiffness_nm2)
      : arm_(arm),
        rests_{&before, &after},
        moment_nm_(moment_nm),
        stiffness_nm2_(stiffness_nm2),
        rod_(rod::make_rod(arm)),
        solver_(rod_, stations(arm),
                {{rod::ParameterKind::kMoment, 0, 0},
                 {rod::ParameterKind::kMoment, 0, 1},
                 {rod::ParameterKind::kBendingCompliance, 0, 0},
                 {rod::ParameterKind::kLength, 0, 0}}) {}

  int NumResiduals() const {
    return 3 * static_cast<int>(rests_[0]->p_base.size() + rests_[1]->p_base.size());
  }

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    int row = 0;
    for (const Rest* rest : rests_) {
      rod::Segment& segment = rod_.segments[0];
      segment.moment_nm = {-x[1] * moment_nm_, x[0] * moment_nm_, 0.0};
      segment.bending_compliance = x[2] / stiffness_nm2_;
      segment.length_m = x[3] * segment.rest_length_m;
      rod_.gravity_m_s2 = rest->frame.gravity_base;
      rod_.loads[rod::kPayloadLoad].mass_kg = rest->frame.payload_kg;
      if (!(x[2] > 0.0) || !(x[3] > 0.0) || solver_.solve(rod_) != rod::SolveStatus::kConverged) {
        // TinySolver looks at the numbers alone: a step to here is refused by their size.
        std::fill(residuals, residuals + NumResiduals(), kNoEquilibrium);
        if (jacobian != nullptr) std::fill(jacobian, jacobian + NumResiduals() * NUM_PARAMETERS, 0.0);
        return false;
      }
      for (const auto& [body, p] : rest->p_base) {
        const double sd = arm_.bodies[static_cast<std::size_t>(body)].position_sd_m / std::sqrt(rest->count);
        Eigen::Map<Vector3d>(residuals + row) = (solver_.station(body).p - p) / sd;
        if (jacobian != nullptr) {
          const auto dp = solver_.dp(body);
          Eigen::Map<MatrixXd> j(jacobian, NumResiduals(), 4);
          j.block<3, 1>(row, 0) = dp.col(1) * moment_nm_ / sd;
          j.block<3, 1>(row, 1) = -dp.col(0) * moment_nm_ / sd;
          j.block<3, 1>(row, 2) = dp.col(2) / stiffness_nm2_ / sd;
          j.block<3, 1>(row, 3) = dp.col(3) * segment.rest_length_m / sd;
        }
        row += 3;
      }
    }
    return true;
  }

 private:
  static std::vector<double> stations(const arm::Arm& arm) {
    std::vector<double> list;
    for (const arm::MeasuredBody& body : arm.bodies) list.push_back(body.arclength_m);
    return list;
  }

  const arm::Arm& arm_;
  const Rest* rests_[2];
  const double moment_nm_, stiffness_nm2_;
  mutable rod::Rod rod_;
  mutable rod::Solver solver_;
};

void exact(const arm::Arm& arm, const Rest& before, const Rest& after, Pull& pull) {
  const double guess = pull.stiffness_circles_nm2.value_or(arm.segments[0].bending_stiffness.base_nm2);
  const double moment = std::max(1e-3 * guess, guess * pull.before.angle_rad / pull.before.length_m);
  const TwoLoads problem(arm, before, after, moment, guess);
  ceres::TinySolver<TwoLoads> solver;
  solver.options.max_num_iterations = kMostIterations;
  ceres::TinySolver<TwoLoads>::Parameters x(std::cos(pull.before.direction_rad),
                                            std::sin(pull.before.direction_rad), 1.0,
                                            pull.before.length_m / arm.segments[0].length_m);
  solver.Solve(problem, &x);
  if (solver.summary.status == ceres::TinySolver<TwoLoads>::HIT_MAX_ITERATIONS) return;
  VectorXd r(problem.NumResiduals());
  MatrixXd j(problem.NumResiduals(), 4);
  if (!problem(x.data(), r.data(), j.data())) return;
  const Eigen::Matrix4d information = j.transpose() * j;
  const Eigen::Matrix4d covariance = information.ldlt().solve(Eigen::Matrix4d::Identity());
  const double dof = std::max(1.0, static_cast<double>(r.size() - 4));
  const double sd = std::sqrt(covariance(2, 2) * std::max(1.0, r.squaredNorm() / dof));
  if (!(sd < x[2])) return;  // the stiffness is not identifiable from the pull
  pull.stiffness_exact_nm2 = guess / x[2];
  pull.sd_exact_nm2 = guess / x[2] * sd / x[2];
}

/// Index of a body at the tip, a ring.
std::optional<int> tip_body(const arm::Arm& arm) {
  for (int i = static_cast<int>(arm.bodies.size()); i-- > 0;) {
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(i)];
    if (body.kind == arm::BodyKind::kRing && body.arclength_m >= arm.total_length_m() - kAtTip_m) return i;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Pull> find_pulls(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  const std::optional<int> tip = tip_body(arm);
  if (arm.segments.size() != 1 || !tip)
    throw std::invalid_argument(
        fmt::format("the pull needs an arm of one segment with a ring at its tip; {} has {} segments{}",
                    arm.name, arm.segments.size(), tip ? "" : " and no ring there"));
  identify::FrameChoice choice;
  choice.frames_per_trial = 0;
  const std::vector<Rest> all = rests(identify::choose_frames(arm, trials, choice).frames);
  std::vector<Pull> pulls;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const Rest &before = all[i - 1], &after = all[i];
    if (!same_inputs(before.frame, after.frame)) continue;
    if (before.p_base.count(*tip) == 0 || after.p_base.count(*tip) == 0) continue;
    Pull pull;
    pull.trial = after.frame.trial;
    pull.stamp_s = after.frame.stamp_s;
    pull.inputs = after.frame.inputs;
    pull.payload_before_kg = before.frame.payload_kg;
    pull.payload_after_kg = after.frame.payload_kg;
    pull.before = circle_through(before.p_base.at(*tip));
    pull.after = circle_through(after.p_base.at(*tip));
    if (std::cos(pull.after.direction_rad - pull.before.direction_rad) < 0.0) {  // through straight
      pull.after.direction_rad = pull.before.direction_rad;
      pull.after.angle_rad = -pull.after.angle_rad;
    }
    const Vector3d& gravity = after.frame.gravity_base;
    const double down = gravity.norm() > 0.0 ? -gravity.z() / gravity.norm() : 0.0;  // 1: it stands
    if (std::abs(down) > kUpright) {
      pull.upright = true;
      pull.hanging = down < 0.0;
      // Weight bends an arm that stands further, and pulls one that hangs straight.
      const double force =
          (pull.payload_after_kg - pull.payload_before_kg) * gravity.norm() * (pull.hanging ? -1.0 : 1.0);
      pull.stiffness_printed_nm2 = stiffness_on_circles(pull.before, pull.after, force, LoadLaw::kPrinted);
      pull.stiffness_circles_nm2 = stiffness_on_circles(pull.before, pull.after, force, LoadLaw::kStatics);
    }
    exact(arm, before, after, pull);
    pulls.push_back(pull);
  }
  return pulls;
}

std::string describe(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                     const std::vector<Pull>& pulls) {
  std::string text =
      fmt::format("{:<20}{:>9}{:>16}{:>10}{:>9}{:>9}{:>12}{:>12}{:>12}{:>10}\n", "pull", "time s",
                  "payload kg", "length m", "deg", "-> deg", "EI (17)", "EI circles", "EI exact", "+- sd");
  const auto value = [](const std::optional<double>& v) {
    return v ? fmt::format("{:.5f}", *v) : std::string("-");
  };
  for (const Pull& pull : pulls) {
    text += fmt::format(
        "{:<20}{:>9.2f}{:>16}{:>10.4f}{:>9.2f}{:>9.2f}{:>12}{:>12}{:>12}{:>10}\n", trials[pull.trial].name,
        pull.stamp_s, fmt::format("{:.3f} -> {:.3f}", pull.payload_before_kg, pull.payload_after_kg),
        pull.before.length_m, pull.before.angle_rad * 180.0 / M_PI, pull.after.angle_rad * 180.0 / M_PI,
        value(pull.stiffness_printed_nm2), value(pull.stiffness_circles_nm2), value(pull.stiffness_exact_nm2),
        pull.stiffness_exact_nm2 ? fmt::format("{:.5f}", pull.sd_exact_nm2) : "-");
  }
  text += fmt::format(
      "EI in N m^2 of {}: (17) as printed on circles, the same with the moment of a dead force, and exact "
      "statics\nfrom all bodies. A length is that of the circle from base to tip before the pull.\n",
      arm.segments.front().name);
  return text;
}

}  // namespace softarm::published
