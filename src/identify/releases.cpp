#include "releases.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/rest_modes.h"
#include "model/slip_oscillator.h"

namespace softarm::identify {
namespace {

using Eigen::Index;
using Eigen::Matrix2Xd;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using model::SlipOscillator;

constexpr double kGone = 0.1;                            // of the highest speed: the hand has let go
constexpr double kSeenFrom_s = 0.1, kSeenUntil_s = 0.3;  // after that: the start of a prediction is found
constexpr double kPredicted_s = 1.0;
constexpr double kAtRest_s = 0.3;     // at the end of a trial
constexpr double kMoves = 0.02;       // of the amplitude: more there is no rest
constexpr double kErrorOfLaw = 0.05;  // of the amplitude: what frames are expected to be off by
constexpr double kPriors[4][2] = {    // median, and sd of the logarithm, in the order of SwingLaw
    {1.0, 0.7},
    {0.1, 1.0},
    {0.5, 1.0},
    {0.01, 1.0}};

/// One release as the modes have it: displacements of the outermost body along either, m.
struct Release {
  std::string trial;
  VectorXd t_s;        // from when the hand let go on
  Matrix2Xd q;         // of the modes
  MatrixXd tip;        // 3 x frames, from the rest
  Vector2d held;       // where it was let go
  MatrixXd by;         // bodies by those displacements, 3b x 2
  Vector2d stiffness;  // per mass, along either
  double amplitude_m = 0.0;
  Index from = 0, until = 0, end = 0;  // frames: seen, predicted
};

struct RawRelease {
  std::string trial;
  VectorXd t_s;
  MatrixXd bodies;  // 3b x frames, rod's base frame
};

/// The frames in which all bodies are seen.
RawRelease read(const arm::Arm& arm, const trial::Trial& trial) {
  const std::size_t b = arm.bodies.size();
  std::vector<const trial::Frame*> whole;
  for (const trial::Frame& frame : trial.frames) {
    if (frame.bodies.size() == b && (!arm.base.body || frame.base_body)) whole.push_back(&frame);
  }
  RawRelease raw{trial.name, VectorXd(static_cast<Index>(whole.size())),
                 MatrixXd(3 * static_cast<Index>(b), static_cast<Index>(whole.size()))};
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const auto column = static_cast<Index>(k);
    raw.t_s[column] = trial::to_seconds(whole[k]->stamp_ns - whole[0]->stamp_ns);
    const Eigen::Isometry3d base =
        arm.base.body ? *whole[k]->base_body * arm.base.rod_in_body : arm.base.fixed_pose;
    for (const trial::BodyObservation& seen : whole[k]->bodies)
      raw.bodies.block<3, 1>(3 * seen.body, column) = base.inverse() * seen.p_mocap;
  }
  return raw;
}

Index frame_at(const VectorXd& t_s, double at_s) {
  return std::lower_bound(t_s.data(), t_s.data() + t_s.size(), at_s - 1e-6) - t_s.data();
}

/// The first frame of a release, by the outermost body's speed over some frames.
Index let_go(const RawRelease& raw) {
  constexpr Index kBeside = 2;
  const Index n = raw.t_s.size();
  VectorXd speed = VectorXd::Zero(n);
  for (Index k = kBeside; k + kBeside < n; ++k)
    speed[k] = (raw.bodies.col(k + kBeside) - raw.bodies.col(k - kBeside)).tail<3>().norm() /
               (raw.t_s[k + kBeside] - raw.t_s[k - kBeside]);
  const double least = kGone * speed.maxCoeff();
  Index k = 0;
  while (k < n && !(speed[k] > least)) ++k;
  return k;
}

/// How far the outermost body still moves at the end.
double still_moves_m(const RawRelease& raw) {
  const Index n = raw.t_s.size() - frame_at(raw.t_s, raw.t_s[raw.t_s.size() - 1] - kAtRest_s);
  const MatrixXd end = raw.bodies.bottomRightCorner(3, n);
  return (end.colwise() - end.rowwise().mean()).colwise().norm().maxCoeff();
}

VectorXd end_of(const RawRelease& raw) {
  const Index n = raw.t_s.size() - frame_at(raw.t_s, raw.t_s[raw.t_s.size() - 1] - kAtRest_s);
  return raw.bodies.rightCols(n).rowwise().mean();
}

/// Along the direction in which it was let go, and across it: of an arm that is alike to all sides any
/// direction is a mode, and friction slips along the way that the arm goes.
/// @param modes bodies by the displacement of the outermost along either mode
Release release_of(const RawRelease& raw, const VectorXd& rest, const MatrixXd& modes,
                   const VectorXd& stiffness) {
  Release release;
  const Index first = let_go(raw);
  const MatrixXd off = raw.bodies.rightCols(raw.t_s.size() - first).colwise() - rest;
  release.trial = raw.trial;
  release.t_s = raw.t_s.tail(off.cols()).array() - raw.t_s[first];
  const Eigen::Matrix2d normal = modes.transpose() * modes;
  const Vector2d along = normal.ldlt().solve(modes.transpose() * off.col(0)).normalized();
  Eigen::Matrix2d turn;
  turn << along[0], -along[1], along[1], along[0];
  release.by = modes * turn;
  release.stiffness = turn.cwiseAbs2().transpose() * stiffness.head<2>();
  release.q = turn.transpose() * normal.ldlt().solve(modes.transpose() * off);
  release.tip = off.bottomRows<3>();
  release.held = release.q.col(0);
  release.amplitude_m = release.tip.col(0).norm();
  release.from = frame_at(release.t_s, kSeenFrom_s);
  release.until = frame_at(release.t_s, kSeenUntil_s);
  release.end = frame_at(release.t_s, kSeenUntil_s + kPredicted_s);
  return release;
}

SlipOscillator oscillator_of(const SwingLaw& law, double stiffness) {
  const double k = law.stiffness_scale * stiffness;
  return SlipOscillator({k, 2.0 * law.damping_ratio * std::sqrt(k), law.slip_share * k, law.slip_m});
}

/// A mode's way from frame `from` on.
VectorXd way_of(const SlipOscillator& oscillator, const Release& release, SlipOscillator::State at) {
  VectorXd way(release.end - release.from);
  for (Index k = release.from; k < release.end; ++k) {
    way[k - release.from] = at.x;
    if (k + 1 < release.end) at = oscillator.step(at, release.t_s[k + 1] - release.t_s[k]);
  }
  return way;
}

/// What the law makes of both modes after the frames in which the start is found: Gauss-Newton in place and
/// rate; friction is what the seen way from where it was held has made of it.
Matrix2Xd predict(const SwingLaw& law, const Release& release) {
  constexpr int kSteps = 3;
  Matrix2Xd all(2, release.end - release.from);
  const Index seen = release.until - release.from;
  for (Index m = 0; m < 2; ++m) {
    const SlipOscillator oscillator = oscillator_of(law, release.stiffness[m]);
    const VectorXd q = release.q.row(m).transpose();
    SlipOscillator::State at{q[release.from], 0.0, oscillator.stretched(0.0, release.held[m])};
    for (Index k = 1; k <= release.from; ++k) at.z = oscillator.stretched(at.z, q[k] - q[k - 1]);
    const double dt_s = release.t_s[release.until] - release.t_s[release.from];
    at.rate = (q[release.until] - q[release.from]) / dt_s;
    const double step = 1e-3 * release.amplitude_m;
    VectorXd way = way_of(oscillator, release, at);
    for (int i = 0; i < kSteps; ++i) {
      SlipOscillator::State moved = at, faster = at;
      moved.x += step;
      faster.rate += step / dt_s;
      Eigen::MatrixX2d by(seen, 2);
      by.col(0) = (way_of(oscillator, release, moved) - way).head(seen);
      by.col(1) = (way_of(oscillator, release, faster) - way).head(seen);
      const VectorXd off = q.segment(release.from, seen) - way.head(seen);
      const Vector2d go = by.colPivHouseholderQr().solve(off);
      at.x += step * go[0];
      at.rate += step / dt_s * go[1];
      way = way_of(oscillator, release, at);
    }
    all.row(m) = way.transpose();
  }
  return all;
}

SwingLaw law_of(const double* logs, bool slips) {
  SwingLaw law{std::exp(logs[0]), std::exp(logs[1])};
  if (!slips) return law;
  law.slip_share = std::exp(logs[2]);
  law.slip_m = std::exp(logs[3]);
  return law;
}

/// Both modes of one release, in shares of what is expected; the logarithms of the law are the parameters.
struct ReleaseRows {
  const Release& release;
  bool slips;
  bool operator()(double const* const* logs, double* residuals) const {
    const Matrix2Xd off = predict(law_of(logs[0], slips), release) -
                          release.q.middleCols(release.from, release.end - release.from);
    // Neighbouring frames are off alike: a release counts as one row per seen stretch.
    const double stretches = (kPredicted_s + kSeenUntil_s - kSeenFrom_s) / (kSeenUntil_s - kSeenFrom_s);
    const double weight =
        std::sqrt(stretches / static_cast<double>(off.cols())) / (kErrorOfLaw * release.amplitude_m);
    Eigen::Map<Matrix2Xd>(residuals, 2, off.cols()) = weight * off;
    return off.allFinite();
  }
};

struct PriorRow {
  int which;
  bool operator()(double const* const* logs, double* residual) const {
    *residual = (logs[0][which] - std::log(kPriors[which][0])) / kPriors[which][1];
    return true;
  }
};

SwingLaw fit(const std::vector<const Release*>& releases, bool slips) {
  const int unknowns = slips ? 4 : 2;
  double logs[4];
  for (int i = 0; i < 4; ++i) logs[i] = std::log(kPriors[i][0]);
  ceres::NumericDiffOptions steps;
  steps.relative_step_size = 1e-4;
  ceres::Problem problem;
  const auto add = [&](auto* functor, int rows, ceres::LossFunction* loss) {
    using Functor = std::remove_pointer_t<decltype(functor)>;
    auto* cost = new ceres::DynamicNumericDiffCostFunction<Functor, ceres::CENTRAL>(
        functor, ceres::TAKE_OWNERSHIP, steps);
    cost->AddParameterBlock(unknowns);
    cost->SetNumResiduals(rows);
    problem.AddResidualBlock(cost, loss, std::vector<double*>{logs});
  };
  for (const Release* release : releases)
    add(new ReleaseRows{*release, slips}, 2 * static_cast<int>(release->end - release->from),
        new ceres::HuberLoss(3.0));
  for (int i = 0; i < unknowns; ++i) add(new PriorRow{i}, 1, nullptr);
  ceres::Solver::Options options;
  options.max_num_iterations = 60;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw std::invalid_argument("releases: no law of swings fits them");
  return law_of(logs, slips);
}

double rms_m(const SwingLaw& law, const Release& release) {
  const Matrix2Xd way = predict(law, release);
  const Index n = release.end - release.until;
  const MatrixXd off =
      release.by.bottomRows<3>() * way.rightCols(n) - release.tip.middleCols(release.until, n);
  return std::sqrt(off.colwise().squaredNorm().mean());
}

double payload_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  for (const trial::Trial& trial : trials) {
    for (const trial::Frame& frame : trial.frames) {
      if (frame.payload_kg) return *frame.payload_kg;
    }
  }
  if (!arm.payload.default_kg) throw std::invalid_argument("releases: the payload is not known");
  return *arm.payload.default_kg;
}

/// Those that can be used, and a line for each of the others.
std::vector<RawRelease> usable(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                               std::vector<std::string>& left_out) {
  std::vector<RawRelease> list;
  for (const trial::Trial& trial : trials) {
    RawRelease raw = read(arm, trial);
    const Index n = raw.t_s.size(), first = n > 0 ? let_go(raw) : 0;
    if (first >= n || raw.t_s[n - 1] - raw.t_s[first] < kSeenUntil_s + kPredicted_s) {
      left_out.push_back(
          fmt::format("{}: less than {:g} s after a hand let go", trial.name, kSeenUntil_s + kPredicted_s));
      continue;
    }
    const double amplitude_m = (raw.bodies.col(first) - end_of(raw)).tail<3>().norm();
    if (!(still_moves_m(raw) < kMoves * amplitude_m)) {
      left_out.push_back(fmt::format("{}: does not come to rest", trial.name));
      continue;
    }
    list.push_back(std::move(raw));
  }
  return list;
}

}  // namespace

ReleaseFit fit_releases(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  ReleaseFit found;
  const std::vector<RawRelease> raw = usable(arm, trials, found.left_out);
  if (raw.size() < 2)
    throw std::invalid_argument(fmt::format("releases: {} of {} trials can be used, 2 are needed{}{}",
                                            raw.size(), trials.size(), found.left_out.empty() ? "" : "; ",
                                            found.left_out.empty() ? "" : found.left_out[0]));
  const auto modes = model::modes_at_no_input(arm, payload_of(arm, trials), 2);
  if (!modes)
    throw std::invalid_argument("releases: by the arm file, the arm without input has no stable rest");
  const Index rows = 3 * static_cast<Index>(arm.bodies.size());
  MatrixXd by = modes->bodies.topRows(rows);
  VectorXd rest = VectorXd::Zero(rows);
  for (Index m = 0; m < 2; ++m) {
    by.col(m) /= by.col(m).tail<3>().norm();
    found.mode_hz.push_back(std::sqrt(modes->stiffness[m]) / (2.0 * M_PI));
  }
  const std::size_t fitted = (raw.size() + 1) / 2;
  for (std::size_t i = 0; i < raw.size(); i += 2) rest += end_of(raw[i]) / static_cast<double>(fitted);
  std::vector<Release> releases;
  for (const RawRelease& one : raw) releases.push_back(release_of(one, rest, by, modes->stiffness));
  std::vector<const Release*> told;
  for (std::size_t i = 0; i < releases.size(); i += 2) told.push_back(&releases[i]);
  found.linear = fit(told, false);
  found.slip = fit(told, true);
  for (std::size_t i = 0; i < releases.size(); ++i) {
    const Release& r = releases[i];
    found.errors.push_back({r.trial, i % 2 == 0, r.amplitude_m,
                            r.tip.middleCols(r.until, r.end - r.until).colwise().norm().maxCoeff(),
                            rms_m(found.linear, r), rms_m(found.slip, r)});
  }
  return found;
}

}  // namespace softarm::identify
