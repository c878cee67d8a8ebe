#include "body_mean.h"

#include <algorithm>
#include <cmath>

#include "math/statistics.h"

namespace softarm::model {
namespace {

using Eigen::Vector3d;

constexpr double kBendUnknown = 0.5;  // sd, of what a way bends: a model at the mean of the inputs bends, too
constexpr double kOutlier = 5.0;      // standard deviations from the line through a body's positions

}  // namespace

BodyLine fit_line(const std::vector<double>& t, const std::vector<Vector3d>& p,
                  const std::vector<bool>& used) {
  BodyLine line;
  double st = 0.0, stt = 0.0;
  Vector3d sp = Vector3d::Zero(), stp = Vector3d::Zero();
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!used[i]) continue;
    ++line.frames;
    st += t[i];
    stt += t[i] * t[i];
    sp += p[i];
    stp += t[i] * p[i];
  }
  const double n = line.frames, determinant = n * stt - st * st;
  const bool sloped = line.frames >= 3 && determinant > 1e-12;
  const Vector3d slope = sloped ? Vector3d((n * stp - st * sp) / determinant) : Vector3d::Zero();
  line.at_centre = (sp - slope * st) / n;
  line.variance_factor = sloped ? stt / determinant : 1.0 / n;
  line.dof = 3 * (line.frames - (sloped ? 2 : 1));
  // A bend of the way is no noise: it is taken off where frames are left to scatter about it.
  const double mean_t = st / n, width = stt / n - mean_t * mean_t;
  Vector3d bend = Vector3d::Zero();
  double bends = 0.0, skew = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (used[i]) skew += std::pow(t[i] - mean_t, 3) / (n * width);
  }
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!used[i]) continue;
    const double off = t[i] - mean_t, along = off * off - width - skew * off;  // no part of a line in it
    const Vector3d residual = p[i] - line.at_centre - slope * t[i];
    line.sum2 += residual.squaredNorm();
    bend += along * residual;
    bends += along * along;
  }
  if (sloped && line.frames >= kFewestOfBend && bends > 1e-6 * n * width * width) {
    line.sum2 = std::max(line.sum2 - bend.squaredNorm() / bends, 0.0);
    line.dof -= 3;
    line.bend = bend * (width / bends);
    line.bend_factor = width * width / bends;
  }
  return line;
}

std::optional<double> scatter_of_parts(const std::vector<Vector3d>& values,
                                       const std::vector<std::size_t>& part) {
  Vector3d all = Vector3d::Zero();
  double differences = 0.0, pairs = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    all += values[i] / static_cast<double>(values.size());
    if (i == 0) continue;
    differences += (values[i] - values[i - 1]).squaredNorm();
    pairs += 1.0;
  }
  double between = 0.0, parts = 0.0;
  for (std::size_t i = 0; i < values.size();) {
    Vector3d sum = Vector3d::Zero();
    double count = 0.0;
    for (const std::size_t now = part[i]; i < values.size() && part[i] == now; ++i, count += 1.0)
      sum += values[i];
    between += count * (sum / count - all).squaredNorm();
    parts += 1.0;
  }
  if (parts < 2.0 || !(differences > 0.0)) return std::nullopt;
  return (between / (parts - 1.0)) / (0.5 * differences / pairs);
}

double BodyMean::sd(double frame_sd) const {
  const double variance = frame_sd * frame_sd, bent = bend2 / 3.0 - bend_factor * variance;
  return std::sqrt(variance_factor * variance + kBendUnknown * kBendUnknown * std::max(bent, 0.0));
}

std::optional<BodyMean> mean_of(const std::vector<double>& when, const std::vector<Vector3d>& values,
                                double sd, std::vector<double>& scatter) {
  std::vector<bool> used(when.size(), true);
  BodyLine line = fit_line(when, values, used);
  // A jump in one frame lies far from the others' middle.
  std::vector<double> x, y, z;
  for (const Vector3d& v : values) {
    x.push_back(v.x());
    y.push_back(v.y());
    z.push_back(v.z());
  }
  const Vector3d middle(math::median(x), math::median(y), math::median(z));
  std::vector<double> off;
  for (const Vector3d& v : values) off.push_back((v - middle).norm());
  const double limit = kOutlier * std::max(math::median(off), sd);
  bool dropped = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (off[i] > limit) {
      used[i] = false;
      dropped = true;
    }
  }
  if (dropped) line = fit_line(when, values, used);
  if (line.frames < static_cast<int>(kFewestOfMean)) return std::nullopt;
  if (line.dof > 0) scatter.push_back(line.sum2 / line.dof);
  return BodyMean{line.at_centre, line.frames, line.variance_factor, line.bend.squaredNorm(),
                  line.bend_factor};
}

}  // namespace softarm::model
