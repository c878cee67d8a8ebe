#include "monitor_window.h"

#include <Eigen/LU>

#include "policy.h"

namespace softarm::monitor {
namespace {}  // namespace

MonitorWindow::MonitorWindow(std::size_t bodies) : bins_(kPolicy.window.bins) {
  const auto rows = static_cast<Eigen::Index>(3 * bodies);
  const auto size = [&](Bin& bin) {
    bin.time_s.assign(bodies, 0.0);
    bin.count.assign(bodies, 0.0);
    bin.discrepancy.setZero(rows);
    bin.place.setZero(rows);
  };
  for (Bin& bin : bins_) size(bin);
  size(open_);
  motion_.discrepancy.setZero(rows);
  motion_.velocity.setZero(rows);
  motion_.acceleration.setZero(rows);
  motion_.usable.assign(bodies, 0);
  motion_.samples.assign(bodies, 0.0);
}

void MonitorWindow::reset() {
  filled_ = 0;
  is_open_ = false;
}

bool MonitorWindow::add(double stamp_s, const Displacements& discrepancy, const Displacements& place,
                        const std::vector<char>& seen) {
  if (is_open_ && (stamp_s - open_.to_s > kPolicy.window.gap_s || stamp_s < open_.from_s)) reset();
  bool full = false;
  if (is_open_ && stamp_s - open_.from_s > kPolicy.window.bin_s - 1e-4) {
    close();
    full = filled_ >= kPolicy.window.fewest_bins;
    if (full) {
      fit();
      full = motion_.to_s - motion_.from_s > kPolicy.window.full * kPolicy.window.seconds();
    }
  }
  if (!is_open_) {
    is_open_ = true;
    open_.from_s = stamp_s;
    open_.time_s.assign(seen.size(), 0.0);
    open_.count.assign(seen.size(), 0.0);
    open_.discrepancy.setZero();
    open_.place.setZero();
  }
  open_.to_s = stamp_s;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!seen[i]) continue;
    const auto row = static_cast<Eigen::Index>(3 * i);
    const double share = 1.0 / ++open_.count[i];
    open_.time_s[i] += share * (stamp_s - open_.from_s - open_.time_s[i]);
    open_.discrepancy.segment<3>(row) +=
        share * (discrepancy.segment<3>(row) - open_.discrepancy.segment<3>(row));
    open_.place.segment<3>(row) += share * (place.segment<3>(row) - open_.place.segment<3>(row));
  }
  return full;
}

void MonitorWindow::close() {
  bins_[next_] = open_;  // same sizes: no allocation
  next_ = (next_ + 1) % kPolicy.window.bins;
  if (filled_ < kPolicy.window.bins) ++filled_;
  is_open_ = false;
}

void MonitorWindow::fit() {
  const Bin& newest = bins_[(next_ + kPolicy.window.bins - 1) % kPolicy.window.bins];
  std::size_t used = 0;
  motion_.to_s = newest.to_s;
  for (std::size_t k = 1; k <= filled_; ++k) {
    const Bin& bin = bins_[(next_ + kPolicy.window.bins - k) % kPolicy.window.bins];
    if (newest.to_s - bin.from_s > kPolicy.window.seconds() + 0.5 * kPolicy.window.bin_s) break;
    motion_.from_s = bin.from_s;
    used = k;
  }
  const double middle_s = 0.5 * (motion_.from_s + motion_.to_s);
  for (std::size_t i = 0; i < motion_.usable.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), right = Eigen::Matrix3d::Zero();  // row: power of time
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0;
    std::size_t present = 0;
    for (std::size_t k = 1; k <= used; ++k) {
      const Bin& bin = bins_[(next_ + kPolicy.window.bins - k) % kPolicy.window.bins];
      const double n = bin.count[i];
      if (n == 0.0) continue;
      ++present;
      count += n;
      sum += n * bin.discrepancy.segment<3>(row);
      const double t = bin.from_s + bin.time_s[i] - middle_s;
      const Eigen::Vector3d powers(1.0, t, 0.5 * t * t);
      normal += n * powers * powers.transpose();
      right += n * powers * bin.place.segment<3>(row).transpose();
    }
    motion_.samples[i] = count;
    motion_.usable[i] =
        static_cast<double>(present) >= kPolicy.window.seen * static_cast<double>(used) && present >= 4;
    if (!motion_.usable[i]) {
      motion_.discrepancy.segment<3>(row).setZero();
      motion_.velocity.segment<3>(row).setZero();
      motion_.acceleration.segment<3>(row).setZero();
      continue;
    }
    motion_.discrepancy.segment<3>(row) = sum / count;
    const Eigen::Matrix3d solution = normal.inverse() * right;
    motion_.velocity.segment<3>(row) = solution.row(1).transpose();
    motion_.acceleration.segment<3>(row) = solution.row(2).transpose();
  }
}

}  // namespace softarm::monitor
