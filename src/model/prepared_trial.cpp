#include "prepared_trial.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "body_mean.h"
#include "math/statistics.h"
#include "trial/static_frame.h"

namespace softarm::model {
namespace {

using Eigen::Vector3d;
using trial::SeenBody;
using trial::StaticFrame;

constexpr double kLongestBend = 2.5;  // of a way, in standard deviations of a mean; noise alone makes 1.1
constexpr double kRests = 1.5;        // ratio of variances up to which a body rests; noise alone makes 1
constexpr double kLeastNoise_rad =
    1e-4;                             // of tangents, which computed trials have without: a model is no finer
constexpr double kFewestShare = 0.6;  // of the block's frames in which a body must be seen
// Without a body, which is no part of a mean: as long, and as many frames.
constexpr double kBlind_s = 0.08;
constexpr std::ptrdiff_t kFewestBlind = 4;

bool shows_a_body(const StaticFrame& frame) {
  return !frame.bodies.empty();
}

/// Frames that show no body are left out, but where nothing is seen for a while between others. Where that is
/// so most of the time somebody recorded states at rest, one by one, and what lies between is no part of it.
/// @return of each frame that stays whether it lies in such a stretch
std::vector<bool> keep_blind_stretches(std::vector<StaticFrame>& frames) {
  const auto seen = std::count_if(frames.begin(), frames.end(), shows_a_body);
  if (2 * seen < static_cast<std::ptrdiff_t>(frames.size())) {
    frames.erase(
        std::remove_if(frames.begin(), frames.end(), [](const StaticFrame& f) { return !shows_a_body(f); }),
        frames.end());
    return std::vector<bool>(frames.size(), false);
  }
  std::vector<StaticFrame> kept;
  std::vector<bool> blind;
  for (auto from = std::find_if(frames.begin(), frames.end(), shows_a_body); from != frames.end();) {
    const auto first = std::find_if_not(from, frames.end(), shows_a_body),
               next = std::find_if(first, frames.end(), shows_a_body);
    const bool lasts = next != frames.end() && next - first >= kFewestBlind &&
                       std::prev(next)->stamp_s - first->stamp_s >= kBlind_s;
    std::move(from, lasts ? next : first, std::back_inserter(kept));
    blind.resize(kept.size() - static_cast<std::size_t>(lasts ? next - first : 0), false);
    blind.resize(kept.size(), true);
    from = next;
  }
  frames = std::move(kept);
  return blind;
}

class Preparing {
 public:
  Preparing(const arm::Arm& arm, const Preparation& how)
      : arm_(arm), how_(how), scatter_(arm.bodies.size()), tangent_scatter_(arm.bodies.size()) {}

  TrialData prepare(const trial::Trial& trial, std::size_t index,
                    std::map<std::string, std::uint64_t>& left_out) {
    std::vector<StaticFrame> frames =
        trial::known_frames(arm_, index, trial, left_out, trial::InputsOf::kSeries, trial::Blind::kKeep);
    TrialData data;
    data.name = trial.name;
    data.frames = static_cast<std::size_t>(std::count_if(frames.begin(), frames.end(), shows_a_body));
    if (data.frames == 0) return data;
    blind_ = keep_blind_stretches(frames);
    data.begin_s = frames.front().stamp_s;
    const auto count = static_cast<Eigen::Index>(frames.size());
    Series& series = data.series;
    series.t_s.resize(count);
    series.inputs.resize(static_cast<Eigen::Index>(arm_.inputs.scalars.size()), count);
    series.payload_kg.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const StaticFrame& frame = frames[static_cast<std::size_t>(i)];
      series.t_s[i] = frame.stamp_s - data.begin_s;
      series.payload_kg[i] = frame.payload_kg;
      for (Eigen::Index k = 0; k < series.inputs.rows(); ++k) {
        const auto channel = static_cast<std::size_t>(k);
        series.inputs(k, i) = channel < frame.inputs.size() ? frame.inputs[channel].value_or(0.0) : 0.0;
      }
    }
    series.moment_inputs = series.inputs;
    cut(frames, data, left_out);
    if (std::all_of(data.blocks.begin(), data.blocks.end(), [](const Block& b) { return b.bodies.empty(); }))
      data.blocks.clear();
    set_aside(data);
    return data;
  }

  /// When all trials are prepared: how sure every mean is.
  void weigh(Prepared& prepared) const {
    prepared.white_sd_m = white_sd_m();
    prepared.white_sd_rad = white_sd_rad();
    auto place = places_.begin(), tangent = tangents_.begin();
    for (TrialData& trial : prepared.trials) {
      for (Block& block : trial.blocks) {
        for (Seen& seen : block.bodies) seen.white_sd_m = (place++)->sd(prepared.white_sd_m[seen.body]);
        for (SeenTangent& seen : block.tangents)
          seen.white_sd_rad = (tangent++)->sd(prepared.white_sd_rad[seen.body]);
      }
    }
  }

 private:
  Eigen::VectorXd white_sd_m() const {
    return white_sd(scatter_, [](const arm::MeasuredBody& body) { return body.position_sd_m; });
  }
  Eigen::VectorXd white_sd_rad() const {
    return white_sd(tangent_scatter_, [](const arm::MeasuredBody& body) { return body.orientation_sd_rad; })
        .cwiseMax(kLeastNoise_rad);
  }

  template <typename Stated>
  Eigen::VectorXd white_sd(const std::vector<std::vector<double>>& scatter, const Stated& stated) const {
    Eigen::VectorXd sd(static_cast<Eigen::Index>(arm_.bodies.size()));
    for (std::size_t b = 0; b < arm_.bodies.size(); ++b) {
      // The median bears blocks in which the arm does not move along a line.
      const double variance = scatter[b].empty() ? 0.0 : math::median(scatter[b]);
      sd[static_cast<Eigen::Index>(b)] = variance > 0.0 ? std::sqrt(variance) : stated(arm_.bodies[b]);
    }
    return sd;
  }

  /// Where a block that begins at a frame ends, at the latest, and whether at a pause.
  struct Reach {
    std::size_t last = 0;
    bool gap = false;
    int means = 1;
  };
  Reach reach(const Eigen::VectorXd& t, std::size_t first, double lasts_s) const {
    const auto count = static_cast<std::size_t>(t.size());
    const auto at = [&](std::size_t i) { return t[static_cast<Eigen::Index>(i)]; };
    std::size_t i = first + 1;
    for (; i < count; ++i) {
      if (at(i) - at(i - 1) > kLongestPause_s) return {i, true, 1};
      if (blind_[i] != blind_[first]) break;
      if (i - first >= kFewestOfMean && at(i) - at(first) >= lasts_s - 1e-6) break;
    }
    return {i, false, 1};
  }

  void cut(const std::vector<StaticFrame>& frames, TrialData& data,
           std::map<std::string, std::uint64_t>& left_out) {
    const Eigen::VectorXd& t = data.series.t_s;
    bool begins = true;
    for (std::size_t first = 0; first < frames.size();) {
      const Reach to = end_of_block(frames, first, t);
      if (to.last - first >= kFewestOfMean) {
        data.blocks.push_back(mean(frames, first, to.last, t));
        data.blocks.back().means = to.means;
        data.blocks.back().begins = begins;
        begins = to.gap;
      } else {
        if (!blind_[first]) left_out["alone between gaps"] += to.last - first;
        begins = begins || to.gap;
      }
      first = to.last;
    }
  }

  /// Half of a block where a body's way bends in it, several where the arm rests in all of them.
  Reach end_of_block(const std::vector<StaticFrame>& frames, std::size_t first,
                     const Eigen::VectorXd& t) const {
    Reach to = reach(t, first, how_.block_s);
    if (bends(frames, first, to.last, t)) {
      const Reach half = reach(t, first, 0.5 * how_.block_s);
      return half.last < to.last && to.last - half.last >= kFewestOfMean ? half : to;
    }
    for (int blocks = 2; blocks <= how_.most_blocks && !to.gap && to.last < frames.size(); ++blocks) {
      const Reach further = reach(t, first, blocks * how_.block_s);
      if (further.last == to.last || !rests(frames, first, further.last, t)) break;
      to = further;
      to.means = blocks;
    }
    return to;
  }

  /// Whether no body moves, and nobody changes the payload: means over short parts scatter as frames do.
  bool rests(const std::vector<StaticFrame>& frames, std::size_t first, std::size_t last,
             const Eigen::VectorXd& t) const {
    for (std::size_t i = first + 1; i < last; ++i)
      if (frames[i].payload_kg != frames[i - 1].payload_kg) return false;
    double scatter = 0.0, bodies = 0.0;
    for (std::size_t b = 0; b < arm_.bodies.size(); ++b) {
      std::vector<Vector3d> where;
      std::vector<std::size_t> part;
      for (std::size_t i = first; i < last; ++i) {
        for (const SeenBody& seen : frames[i].bodies) {
          if (seen.body != static_cast<int>(b)) continue;
          where.push_back(seen.p_base);
          part.push_back(static_cast<std::size_t>(
              (t[static_cast<Eigen::Index>(i)] - t[static_cast<Eigen::Index>(first)] + 1e-6) /
              (0.5 * how_.block_s)));
        }
      }
      if (const std::optional<double> ratio = scatter_of_parts(where, part)) {
        scatter += *ratio;
        bodies += 1.0;
      }
    }
    return bodies > 0.0 && scatter < kRests * bodies;
  }

  /// Whether the bodies' ways are no straight lines: a mean over a bend lies beside all places where the body
  /// can be.
  bool bends(const std::vector<StaticFrame>& frames, std::size_t first, std::size_t last,
             const Eigen::VectorXd& t) const {
    const double centre =
        t.segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last - first)).mean();
    double square = 0.0, bodies = 0.0;
    for (std::size_t b = 0; b < arm_.bodies.size(); ++b) {
      std::vector<double> when;
      std::vector<Vector3d> where;
      for (std::size_t i = first; i < last; ++i) {
        for (const SeenBody& seen : frames[i].bodies) {
          if (seen.body != static_cast<int>(b)) continue;
          when.push_back(t[static_cast<Eigen::Index>(i)] - centre);
          where.push_back(seen.p_base);
        }
      }
      if (when.size() < static_cast<std::size_t>(kFewestOfBend)) continue;
      const double sd_m = arm_.bodies[b].position_sd_m / std::sqrt(static_cast<double>(when.size()));
      square += fit_line(when, where, std::vector<bool>(when.size(), true)).bend.squaredNorm() /
                (3.0 * sd_m * sd_m);
      bodies += 1.0;
    }
    return square > kLongestBend * kLongestBend * bodies;
  }

  Block mean(const std::vector<StaticFrame>& frames, std::size_t first, std::size_t last,
             const Eigen::VectorXd& t) {
    Block block;
    block.first = first;
    block.last = last;
    // The base turns by noise only, or slowly.
    block.q_base_mocap = frames[(first + last) / 2].q_base_mocap;
    block.base_in_mocap_m = frames[(first + last) / 2].base_in_mocap_m;
    double centre = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      centre += t[static_cast<Eigen::Index>(i)] / static_cast<double>(last - first);
      block.gravity_base += frames[i].gravity_base / static_cast<double>(last - first);
    }
    for (std::size_t b = 0; b < arm_.bodies.size(); ++b) {
      std::vector<double> when, when_turned;
      std::vector<Vector3d> where, tangents;
      for (std::size_t i = first; i < last; ++i) {
        for (const SeenBody& seen : frames[i].bodies) {
          if (seen.body != static_cast<int>(b)) continue;
          when.push_back(t[static_cast<Eigen::Index>(i)] - centre);
          where.push_back(seen.p_base);
          if (!seen.tangent_base) continue;
          when_turned.push_back(when.back());
          tangents.push_back(*seen.tangent_base);
        }
      }
      const std::size_t fewest = std::max<std::size_t>(
          kFewestOfMean, static_cast<std::size_t>(kFewestShare * static_cast<double>(last - first)));
      if (when.size() < fewest) continue;
      const arm::MeasuredBody& body = arm_.bodies[b];
      const std::optional<BodyMean> place = mean_of(when, where, body.position_sd_m, scatter_[b]);
      if (!place) continue;
      block.bodies.push_back({static_cast<int>(b), place->value, place->frames, 0.0});
      places_.push_back(*place);
      if (tangents.size() < fewest) continue;
      if (const std::optional<BodyMean> mean =
              mean_of(when_turned, tangents, body.orientation_sd_rad, tangent_scatter_[b])) {
        block.tangents.push_back({static_cast<int>(b), mean->value.normalized(), 0.0});
        tangents_.push_back(*mean);
      }
    }
    return block;
  }

  /// Around changes of the payload a hand is on the arm, and afterwards it swings.
  void set_aside(TrialData& data) const {
    const Series& series = data.series;
    std::vector<double> changes_s;
    for (Eigen::Index i = 1; i < series.t_s.size(); ++i) {
      if (series.payload_kg[i] != series.payload_kg[i - 1]) changes_s.push_back(series.t_s[i]);
    }
    for (Block& block : data.blocks) {
      const double from = series.t_s[static_cast<Eigen::Index>(block.first)];
      const double to = series.t_s[static_cast<Eigen::Index>(block.last - 1)];
      for (const double change : changes_s) {
        if (to > change - how_.before_payload_s && from < change + how_.after_payload_s)
          block.set_aside = true;
      }
    }
  }

  const arm::Arm& arm_;
  const Preparation how_;
  std::vector<bool> blind_;                           ///< of the trial's frames
  std::vector<std::vector<double>> scatter_;          ///< variance per coordinate and frame, by body
  std::vector<std::vector<double>> tangent_scatter_;  ///< the same of tangents
  std::vector<BodyMean> places_, tangents_;           ///< of all blocks, in their order
};

}  // namespace

Prepared prepare(const arm::Arm& arm, const std::vector<trial::Trial>& trials, const Preparation& how) {
  Prepared prepared;
  Preparing preparing(arm, how);
  std::vector<std::size_t> order(trials.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (how.as_recorded) {
    const auto key = [&](std::size_t i) {
      const trial::Trial& one = trials[i];
      return std::pair(one.frames.empty() ? std::int64_t{0} : one.frames.front().stamp_ns, one.name);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  }
  for (const std::size_t i : order) {
    TrialData data = preparing.prepare(trials[i], i, prepared.left_out);
    if (!data.blocks.empty()) prepared.trials.push_back(std::move(data));
  }
  if (prepared.trials.empty()) {
    std::string reasons;
    for (const auto& [reason, count] : prepared.left_out)
      reasons += (reasons.empty() ? "" : ", ") + reason + " (" + std::to_string(count) + ")";
    throw UnusableTrials("no frame of these trials can be compared with the model: " +
                         (reasons.empty() ? std::string("they are empty") : reasons));
  }
  double earliest_s = prepared.trials.front().begin_s;
  for (const TrialData& trial : prepared.trials) earliest_s = std::min(earliest_s, trial.begin_s);
  for (TrialData& trial : prepared.trials) trial.series.session_s = trial.begin_s - earliest_s;
  preparing.weigh(prepared);
  return prepared;
}

}  // namespace softarm::model
