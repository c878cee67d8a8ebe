#include "window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/distributions.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "tip_motion.h"

namespace softarm::estimate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Numbers of newest frames that are held against the rest.
constexpr std::size_t kNewest[] = {2, 4, 8, 16, 32, 64};
// Information on a direction relative to its scale below which nothing is said of it.
constexpr double kNothing = 1e-10;

}  // namespace

Window::Window(double length_s, std::vector<int> changing, double posture_m)
    : length_s_(length_s),
      posture_m_(posture_m),
      changing_(std::move(changing)),
      changed_(changing_.empty() ? 0.0
                                 : math::chi_squared_upper_quantile(static_cast<double>(changing_.size()),
                                                                    kPolicy.window.change_probability)) {}

void Window::clear() {
  recent_.clear();
  frames_.clear();
  groups_.clear();
  // The posture that was entered is the next frame's.
  postures_.erase(std::remove_if(postures_.begin(), postures_.end(),
                                 [&](const Posture& posture) { return posture.id != posture_; }),
                  postures_.end());
  for (Posture& posture : postures_) posture.sums = Sums();
}

Window::Posture* Window::find(int id) {
  const auto found = std::find_if(postures_.begin(), postures_.end(),
                                  [&](const Posture& posture) { return posture.id == id; });
  return found == postures_.end() ? nullptr : &*found;
}

void Window::Sums::add(const Sums& more, double sign) {
  if (frames == 0) {
    *this = more;
    return;
  }
  frames += sign > 0.0 ? more.frames : -more.frames;
  off += sign * more.off;
  x += sign * more.x;
  weight += sign * more.weight;
  centre += sign * more.centre;
  jitter += sign * more.jitter;
  shared += sign * more.shared;
  gains += sign * more.gains;
  motion += sign * more.motion;
  motion_variance += sign * more.motion_variance;
}

Window::Sums Window::sums_of(const Entry& entry) {
  VectorXd weight(entry.rows.measured.size());
  for (Eigen::Index block = 0; block < entry.rows.blocks(); ++block)
    weight.segment<3>(3 * block).setConstant(entry.rows.weight[block]);
  return {1,
          weight.cwiseProduct(entry.rows.measured - entry.rows.model),
          weight,
          entry.rows.x,
          entry.law.centre,
          entry.law.jitter_variance,
          entry.law.shared,
          entry.law.gains,
          entry.motion,
          entry.motion_variance};
}

void Window::drop(const Group& group) {
  Posture* posture = find(group.posture);
  if (posture == nullptr) return;
  posture->changed = true;
  if (posture->sums.frames <= group.sums.frames)
    posture->sums = Sums();
  else
    posture->sums.add(group.sums, -1.0);
}

void Window::forget_before(double stamp_s) {
  while (!frames_.empty() && frames_.front().stamp_s < stamp_s) frames_.pop_front();
  while (!groups_.empty() && groups_.front().first_s < stamp_s) {
    drop(groups_.front());
    groups_.pop_front();
  }
}

void Window::advance(double stamp_s) {
  forget_before(stamp_s - length_s_);
  if (!frames_.empty() && frames_.back().stamp_s == stamp_s) {  // the same frame again
    frames_.pop_back();
    if (!recent_.empty()) recent_.pop_back();
    if (!groups_.empty()) {
      drop({stamp_s, groups_.back().posture, newest_});
      if (groups_.back().sums.frames > 1)
        groups_.back().sums.add(newest_, -1.0);
      else
        groups_.pop_back();
    }
  }
  if (!frames_.empty() && !(frames_.back().stamp_s < stamp_s)) clear();
  const double spacing = last_stamp_s_ ? stamp_s - *last_stamp_s_ : 0.0;
  if (spacing > 0.0 && spacing < kPolicy.window.longest_spacing_s) spacing_s_ = spacing;
  last_stamp_s_ = stamp_s;
}

void Window::enter(const std::vector<Observation>& bodies, const VectorXd& passing) {
  // The nearest posture that the arm has had.
  double nearest_m = posture_m_;
  std::optional<int> at;
  for (const Posture& posture : postures_) {
    double farthest_m = -1.0;
    for (const Observation& now : bodies) {
      for (const Observation& then : posture.bodies) {
        if (now.body == then.body) farthest_m = std::max(farthest_m, (now.p - then.p).norm());
      }
    }
    if (farthest_m < 0.0 || farthest_m > nearest_m) continue;
    nearest_m = farthest_m;
    at = posture.id;
  }
  posture_ = at ? *at : ++postures_seen_;
  for (Posture& posture : postures_) {
    if (posture.id != posture_) posture.seen_from.reset();
  }
  postures_.erase(std::remove_if(postures_.begin(), postures_.end(),
                                 [&](const Posture& p) { return p.sums.frames == 0 && p.id != posture_; }),
                  postures_.end());
  if (!at)
    postures_.push_back({posture_, bodies, passing, Sums(), Place(), BodyRows(), true, 0, std::nullopt});
}

double Window::weight_of_misfit(std::size_t from, std::size_t to) const {
  double chi2 = 0.0, dof = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    chi2 += frames_[i].misfit * frames_[i].degrees_of_freedom;
    dof += frames_[i].degrees_of_freedom;
  }
  // Misfit beyond the noise does not average out: it is the same error in every frame. With noise of variance
  // 1 and an error of variance k in all of n frames, n frames say as much as n / (1 + n k).
  const double expected = dof > 0.0 ? math::chi_squared_quantile(dof, kPolicy.window.misfit_level) : 0.0;
  if (!(dof > 0.0 && chi2 > expected)) return 1.0;
  return 1.0 / (1.0 + static_cast<double>(to - from) * (chi2 - expected) / dof);
}

Evidence Window::sum(std::size_t from, std::size_t to) const {
  Evidence total{MatrixXd::Zero(frames_.front().evidence.information.rows(),
                                frames_.front().evidence.information.cols()),
                 VectorXd::Zero(frames_.front().evidence.weighted.size())};
  for (std::size_t i = from; i < to; ++i) {
    total.information += frames_[i].evidence.information;
    total.weighted += frames_[i].evidence.weighted;
  }
  const double weight = weight_of_misfit(from, to);
  total.information *= weight;
  total.weighted *= weight;
  return total;
}

VectorXd Window::Sums::mean_off() const {
  return (weight.array() > 0.0).select(off.cwiseQuotient(weight.cwiseMax(1e-300)), 0.0);
}

FrameLaw Window::Sums::mean_law(const FrameLaw& like) const {
  FrameLaw mean = like;
  const double count = frames;
  mean.centre = centre / count;
  mean.shared = shared / count;
  mean.gains = gains / count;
  mean.jitter_variance = jitter / count;
  return mean;
}

Evidence Window::common(const Posture& posture, const FrameLaw& law) const {
  const Sums& sums = posture.sums;
  const double count = sums.frames;
  // Frames of a swing have the same jitter.
  const double repeats = std::min(count, std::max(1.0, kPolicy.window.swing_s / spacing_s_));
  FrameLaw mean = sums.mean_law(law);
  if (posture.seen_from) {
    mean.shared = law.shared;
    mean.gains = law.gains;
  }
  const BodyRows& rows = posture.seen_from ? *posture.seen_from : posture.rows;
  return evidence_on_errors(mean, rows.evidence(rows.measured, sums.weight), repeats / count);
}

void Window::see_from(const BodyRows& own) {
  Posture* here = find(posture_);
  if (here == nullptr || here->sums.frames == 0) return;
  const BodyRows& rows = here->rows;
  here->seen_from = own;
  here->seen_from->measured =
      own.model + own.j.leftCols(own.x.size()) * (rows.x - own.x) + rows.measured - rows.model;
}

std::vector<Window::Posture*> Window::to_linearise() {
  std::vector<Posture*> list;
  for (Posture& posture : postures_) {
    ++posture.age;
    if (posture.sums.frames > 0) list.push_back(&posture);
  }
  const auto waited = [&](const Posture* posture) {
    return posture->id == posture_ ? std::numeric_limits<int>::max() : posture->age;
  };
  std::stable_sort(list.begin(), list.end(),
                   [&](const Posture* a, const Posture* b) { return waited(a) > waited(b); });
  if (list.size() > kPolicy.window.linearised) list.resize(kPolicy.window.linearised);
  return list;
}

Eigen::Vector3d Window::variance_of_motion(const Sums& sums) const {
  // A posture that lies at the end of a swing has always the same acceleration, and one that holds all of it
  // none on average. What is seen comes late, and frames of a swing are not each by themselves.
  const double count = sums.frames;
  const double repeats = std::min(count, std::max(1.0, kPolicy.window.swing_s / spacing_s_));
  return (sums.motion / count).cwiseAbs2() + (repeats / count) * (sums.motion_variance / count).cwiseMax(0.0);
}

Evidence Window::belief(const FrameLaw& law, const VectorXd& placement, const VectorXd& posture_variance,
                        Eigen::Index motions) const {
  const Eigen::Index n = law.centre.size(), m = placement.size();
  Evidence lasting{MatrixXd::Zero(n + m, n + m), VectorXd::Zero(n + m)};
  lasting.information.diagonal() << law.information, placement.cwiseInverse();
  const double weight = frames_.empty() ? 1.0 : weight_of_misfit(0, frames_.size());
  CommonErrors errors{VectorXd(), posture_variance};
  const Posture* here = nullptr;
  Evidence of_here;
  for (const Posture& posture : postures_) {
    if (posture.id == posture_) here = &posture;
    if (posture.sums.frames == 0) continue;
    Evidence of = common(posture, law);
    of.information *= weight;
    of.weighted *= weight;
    if (&posture == here) {
      of_here = std::move(of);
      continue;
    }
    errors.passing = posture.passing;
    errors.posture.segment<3>(motions) = variance_of_motion(posture.sums);
    const Evidence said = beyond_posture(of, errors);
    lasting.information += said.information;
    lasting.weighted += said.weighted;
  }
  errors.passing = here != nullptr ? here->passing : VectorXd();
  errors.posture = posture_variance;
  if (here != nullptr && here->sums.frames > 0)
    errors.posture.segment<3>(motions) =
        errors.posture.segment<3>(motions).cwiseMax(variance_of_motion(here->sums));
  return belief_with_offsets(law, errors, lasting, of_here.weighted.size() > 0 ? &of_here : nullptr);
}

void Window::look_back(const Entry& entry) {
  const double seen_s = TipMotion::span_s(spacing_s_);
  while (!recent_.empty() && recent_.front().stamp_s < entry.stamp_s - seen_s) recent_.pop_front();
  for (Recent& frame : recent_) {
    Posture* posture = find(frame.posture);
    const auto group = std::find_if(groups_.rbegin(), groups_.rend(),
                                    [&](const Group& g) { return g.first_s <= frame.stamp_s; });
    if (posture == nullptr || group == groups_.rend() || group->posture != frame.posture) continue;
    // What is seen now was in the middle between.
    const bool centred = entry.stamp_s - frame.stamp_s <= 0.5 * seen_s;
    const Eigen::Vector3d motion = centred ? entry.motion : frame.motion;
    const Eigen::Vector3d variance = frame.motion_variance.cwiseMax(entry.motion_variance);
    for (Sums* sums : {&posture->sums, &group->sums}) {
      sums->motion += motion - frame.motion;
      sums->motion_variance += variance - frame.motion_variance;
    }
    frame.motion = motion;
    frame.motion_variance = variance;
  }
}

void Window::add(const Entry& entry) {
  if (!std::isfinite(entry.stamp_s) || !entry.evidence.information.allFinite() ||
      !entry.evidence.weighted.allFinite() || !entry.rows.j.allFinite() || !entry.rows.measured.allFinite())
    return;
  Posture* posture = find(posture_);
  if (posture == nullptr) return;
  frames_.push_back({entry.stamp_s, entry.evidence, entry.misfit, entry.degrees_of_freedom});
  newest_ = sums_of(entry);
  // Linearised once, the frames before it stay where they are until all are linearised anew.
  if (posture->sums.frames == 0) posture->rows = entry.rows;
  posture->sums.add(newest_);
  posture->place = entry.place;
  posture->changed = true;
  if (groups_.empty() || groups_.back().posture != posture_ ||
      entry.stamp_s - groups_.back().first_s > length_s_ / kPolicy.window.groups)
    groups_.push_back({entry.stamp_s, posture_, Sums()});
  groups_.back().sums.add(newest_);
  look_back(entry);
  recent_.push_back({entry.stamp_s, posture_, entry.motion, entry.motion_variance});
}

bool Window::forget_before_change(const Entry& newest, const VectorXd& law_information) {
  frames_.push_back({newest.stamp_s, newest.evidence, newest.misfit, newest.degrees_of_freedom});
  const std::size_t split = where_changed(law_information);
  const double from_s = frames_[split].stamp_s;
  frames_.pop_back();
  if (split == 0) return false;
  forget_before(from_s);
  return true;
}

std::size_t Window::where_changed(const VectorXd& law_information) const {
  const auto n = law_information.size();
  const auto m = static_cast<Eigen::Index>(changing_.size());
  if (m == 0) return 0;
  // A frame may not contradict those before it by more than its own misfit allows, whatever the split: all
  // splits are tried, and the most improbable decides.
  std::size_t best = 0;
  double largest = changed_;
  for (const std::size_t newest : kNewest) {
    if (newest + 2 > frames_.size()) break;
    const std::size_t split = frames_.size() - newest;
    const Evidence before = sum(0, split), after = sum(split, frames_.size());
    // z of before; the newest frames' own is z + d on what may change.
    MatrixXd a = MatrixXd::Zero(n + m, n + m);
    VectorXd b = VectorXd::Zero(n + m);
    a.topLeftCorner(n, n) = before.information + after.information;
    a.topLeftCorner(n, n).diagonal() += law_information;
    b.head(n) = before.weighted + after.weighted;
    for (Eigen::Index i = 0; i < m; ++i) {
      const int ci = changing_[static_cast<std::size_t>(i)];
      a.col(n + i).head(n) = after.information.col(ci);
      a.row(n + i).head(n) = after.information.row(ci);
      for (Eigen::Index k = 0; k < m; ++k) {
        a(n + i, n + k) = after.information(ci, changing_[static_cast<std::size_t>(k)]);
      }
      b[n + i] = after.weighted[ci];
    }
    VectorXd scale(n + m);
    for (Eigen::Index i = 0; i < n + m; ++i) scale[i] = a(i, i) > 0.0 ? 1.0 / std::sqrt(a(i, i)) : 1.0;
    a = (scale.asDiagonal() * a * scale.asDiagonal()).eval();
    b = scale.cwiseProduct(b);
    // What nothing is said of stays where it is.
    a.diagonal().array() += kNothing;
    const math::SymmetricSolver with(a);
    const math::SymmetricSolver without(a.topLeftCorner(n, n));
    if (!with.ok() || !without.ok()) continue;
    const double gain = b.dot(with.solve(b)) - b.head(n).dot(without.solve(b.head(n)));
    if (gain > largest) {
      largest = gain;
      best = split;
    }
  }
  return best;
}

}  // namespace softarm::estimate
