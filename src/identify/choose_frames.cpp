// Which frames are worth fitting: known, at rest, and unlike each other.
#include "choose_frames.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace softarm::identify {
namespace {

using Eigen::Vector3d;

constexpr double kStillFor_s = 0.5;       // before a frame that is taken for one at rest
constexpr double kStillInput = 0.01;      // share of an input's range over the trial
constexpr double kStillNoise = 5.0;       // ... or so many standard deviations of a measured input
constexpr double kQuietShare = 0.9;       // of the steps from frame to frame: the largest are commanded ones
constexpr double kStillSpeed_m_s = 0.01;  // of the farthest body
constexpr double kBeforeChange_s = 0.5;   // of the payload, which is announced in the middle of its change
constexpr double kAfterChange_s = 1.5;
constexpr std::size_t kFewestStatic = 3;   // frames at rest for which a trial's others are left out
constexpr double kStaticRange = 0.7;       // ... and their share of the trial's range of every input
constexpr std::size_t kCandidates = 2000;  // of one trial
constexpr double kTimeWeight = 0.1;        // of a whole trial against a whole range of an input

/// Inputs (0 where absent) and payload as one vector.
Eigen::VectorXd settings(const trial::StaticFrame& frame) {
  Eigen::VectorXd v(static_cast<int>(frame.inputs.size()) + 1);
  for (std::size_t i = 0; i < frame.inputs.size(); ++i)
    v[static_cast<int>(i)] = frame.inputs[i].value_or(0.0);
  v[v.size() - 1] = frame.payload_kg;
  return v;
}

/// Largest distance that one body has moved between two frames, m.
double moved_m(const trial::StaticFrame& a, const trial::StaticFrame& b) {
  double largest = 0.0;
  for (const trial::SeenBody& x : a.bodies) {
    for (const trial::SeenBody& y : b.bodies) {
      if (x.body == y.body) largest = std::max(largest, (x.p_base - y.p_base).norm());
    }
  }
  return largest;
}

/// Standard deviation of each setting's noise, from its steps from frame to frame. 0 for commanded ones,
/// which mostly stay as they are.
Eigen::VectorXd noise_of(const std::vector<Eigen::VectorXd>& at) {
  Eigen::VectorXd sd = Eigen::VectorXd::Zero(at.front().size());
  for (Eigen::Index k = 0; k < sd.size(); ++k) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < at.size(); ++i) {
      if (at[i].size() == sd.size() && at[i - 1].size() == sd.size())
        steps.push_back(std::abs(at[i][k] - at[i - 1][k]));
    }
    std::sort(steps.begin(), steps.end());
    steps.resize(static_cast<std::size_t>(kQuietShare * static_cast<double>(steps.size())));
    double sum2 = 0.0;
    for (const double step : steps) sum2 += step * step;
    if (!steps.empty()) sd[k] = std::sqrt(0.5 * sum2 / static_cast<double>(steps.size()));
  }
  return sd;
}

/// For each frame whether inputs and payload have not changed for a while and the bodies do not move. A frame
/// whose past is not recorded counts: recordings of single static shapes are made of such.
std::vector<bool> at_rest(const std::vector<trial::StaticFrame>& frames, double noise_m) {
  std::vector<bool> rest(frames.size(), true);
  if (frames.empty()) return rest;
  std::vector<Eigen::VectorXd> at;
  for (const trial::StaticFrame& frame : frames) at.push_back(settings(frame));
  Eigen::VectorXd low = at.front(), high = at.front();
  for (const Eigen::VectorXd& v : at) {
    if (v.size() != low.size()) continue;
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Eigen::VectorXd tolerance = (kStillInput * (high - low)).cwiseMax(kStillNoise * noise_of(at));
  std::size_t newest_change = 0;  // first frame of the run of equal settings, compared with its first
  std::size_t past = 0;           // first frame no older than kStillFor_s
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool same = at[i].size() == at[newest_change].size() &&
                      ((at[i] - at[newest_change]).cwiseAbs().array() <= tolerance.array() + 1e-12).all();
    if (!same) newest_change = i;
    while (frames[past].stamp_s < frames[i].stamp_s - kStillFor_s) ++past;
    if (newest_change > past) rest[i] = false;
    const double span_s = frames[i].stamp_s - frames[past].stamp_s;
    if (span_s > 0.0 && moved_m(frames[i], frames[past]) > kStillSpeed_m_s * span_s + 6.0 * noise_m)
      rest[i] = false;
  }
  return rest;
}

/// For each frame whether the payload is the same for a while before and after it: hanging a weight on takes
/// time, and the arm swings afterwards.
std::vector<bool> payload_settled(const std::vector<trial::StaticFrame>& frames) {
  std::vector<bool> settled(frames.size(), true);
  std::vector<double> changes_s;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    // Frames further apart are of static conditions, each by itself.
    const bool seen = frames[i].stamp_s - frames[i - 1].stamp_s < kBeforeChange_s;
    if (seen && frames[i].payload_kg != frames[i - 1].payload_kg) changes_s.push_back(frames[i].stamp_s);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const double change_s : changes_s) {
      const double since_s = frames[i].stamp_s - change_s;
      settled[i] = settled[i] && !(since_s > -kBeforeChange_s && since_s < kAfterChange_s);
    }
  }
  return settled;
}

std::vector<trial::StaticFrame> those_of(const std::vector<trial::StaticFrame>& frames,
                                         const std::vector<bool>& wanted) {
  std::vector<trial::StaticFrame> list;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (wanted[i]) list.push_back(frames[i]);
  }
  return list;
}

/// Whether frames at rest go about as far, in inputs and payload, as all of the trial: a trial that moves
/// from its start to its end is at rest only where nothing is on.
bool stands_for(const std::vector<trial::StaticFrame>& rest, const std::vector<trial::StaticFrame>& all) {
  if (rest.size() < kFewestStatic || rest.size() == all.size()) return false;
  const auto range = [](const std::vector<trial::StaticFrame>& frames) {
    Eigen::VectorXd low = settings(frames.front()), high = low;
    for (const trial::StaticFrame& frame : frames) {
      const Eigen::VectorXd v = settings(frame);
      if (v.size() != low.size()) continue;
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    return Eigen::VectorXd(high - low);
  };
  const Eigen::VectorXd part = range(rest), whole = range(all);
  return part.size() == whole.size() && (part.array() >= kStaticRange * whole.array()).all();
}

/// Greedy farthest points over inputs, payload and (weakly) time: deterministic, and dense nowhere.
std::vector<std::size_t> spread(const std::vector<trial::StaticFrame>& frames, const Eigen::VectorXd& range,
                                std::size_t count) {
  std::vector<std::size_t> chosen;
  if (count == 0 || frames.size() <= count) {
    for (std::size_t i = 0; i < frames.size(); ++i) chosen.push_back(i);
    return chosen;
  }
  const double begin_s = frames.front().stamp_s;
  const double span_s = std::max(1e-9, frames.back().stamp_s - begin_s);
  Eigen::MatrixXd points(range.size() + 1, static_cast<int>(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Eigen::VectorXd v = settings(frames[i]);
    const int column = static_cast<int>(i);
    points.col(column).setZero();
    for (int k = 0; k < std::min(v.size(), range.size()); ++k)
      points(k, column) = range[k] > 0.0 ? v[k] / range[k] : 0.0;
    points(range.size(), column) = kTimeWeight * (frames[i].stamp_s - begin_s) / span_s;
  }
  Eigen::VectorXd distance =
      Eigen::VectorXd::Constant(points.cols(), std::numeric_limits<double>::infinity());
  int next = 0;
  while (chosen.size() < count) {
    chosen.push_back(static_cast<std::size_t>(next));
    distance = distance.cwiseMin((points.colwise() - points.col(next)).colwise().squaredNorm().transpose());
    distance.maxCoeff(&next);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

FrameSet choose_frames(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                       const FrameChoice& choice) {
  FrameSet set;
  double noise_m = 0.0;
  for (const arm::MeasuredBody& body : arm.bodies) noise_m = std::max(noise_m, body.position_sd_m);
  std::vector<std::vector<trial::StaticFrame>> candidates(trials.size());
  for (std::size_t t = 0; t < trials.size(); ++t) {
    std::vector<trial::StaticFrame> known =
        trial::known_frames(arm, t, trials[t], set.left_out, trial::InputsOf::kFrames);
    if (choice.prefer_static) {
      std::vector<trial::StaticFrame> settled = those_of(known, payload_settled(known));
      // Recordings of single static shapes may have any stamps.
      if (2 * settled.size() > known.size()) {
        set.left_out["payload just changed"] += known.size() - settled.size();
        known = std::move(settled);
      }
      std::vector<trial::StaticFrame> quiet = those_of(known, at_rest(known, noise_m));
      if (stands_for(quiet, known)) {
        set.left_out["in motion"] += known.size() - quiet.size();
        known = std::move(quiet);
      }
    }
    if (choice.frames_per_trial > 0 && known.size() > std::max(kCandidates, choice.frames_per_trial)) {
      const std::size_t keep = std::max(kCandidates, choice.frames_per_trial);
      std::vector<trial::StaticFrame> thinned;
      for (std::size_t i = 0; i < keep; ++i) thinned.push_back(std::move(known[i * known.size() / keep]));
      set.left_out["alike"] += known.size() - keep;
      known = std::move(thinned);
    }
    candidates[t] = std::move(known);
  }
  for (auto reason = set.left_out.begin(); reason != set.left_out.end();)
    reason = reason->second == 0 ? set.left_out.erase(reason) : std::next(reason);
  Eigen::VectorXd low, high;
  for (const auto& known : candidates) {
    for (const trial::StaticFrame& frame : known) {
      const Eigen::VectorXd v = settings(frame);
      if (low.size() != v.size()) low = high = v;
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
  }
  for (auto& known : candidates) {
    const std::vector<std::size_t> chosen = spread(known, high - low, choice.frames_per_trial);
    if (chosen.size() < known.size()) set.left_out["alike"] += known.size() - chosen.size();
    for (const std::size_t i : chosen) set.frames.push_back(std::move(known[i]));
  }
  return set;
}

}  // namespace softarm::identify
