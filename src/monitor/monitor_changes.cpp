#include "monitor_changes.h"

#include <algorithm>
#include <cmath>

#include "policy.h"

namespace softarm::monitor {
ChangeTest::ChangeTest(const arm::Arm& arm) {
  const double length = arm.total_length_m();
  const auto rows = static_cast<Eigen::Index>(3 * arm.bodies.size());
  const auto add = [&](ChangeKind kind, int index, double from, double to, int columns) {
    ChangeHypothesis h;
    h.kind = kind;
    h.index = index;
    h.s_from_m = from;
    h.s_to_m = to;
    h.signature.setZero(rows, columns);
    h.amplitude.setZero(columns);
    hypotheses_.push_back(std::move(h));
  };
  for (std::size_t i = 0; i < arm.bodies.size(); ++i) {
    const double s = arm.bodies[i].arclength_m;
    add(ChangeKind::kRing, static_cast<int>(i), s, s, 3);
  }
  for (int i = 1; i <= kPolicy.naming.contact_places; ++i) {
    const double s = length * i / kPolicy.naming.contact_places;
    add(ChangeKind::kContact, i, s, s, 2);
  }
  double end = 0.0;
  for (std::size_t i = 0; i < arm.segments.size(); ++i) {
    const double begin = end;
    end += arm.segments[i].length_m;
    add(ChangeKind::kActuation, static_cast<int>(i), begin, end, 2);
  }
  add(ChangeKind::kBase, 0, 0.0, 0.0, 6);
}

void ChangeTest::signature(const MonitorShape& shape, ChangeHypothesis& h) const {
  switch (h.kind) {
    case ChangeKind::kRing:
      h.signature.middleRows<3>(3 * h.index) = shape.section(h.index);
      break;
    case ChangeKind::kContact: {
      const Eigen::Matrix3d section = shape.section_at(h.s_to_m);
      for (int k = 0; k < 2; ++k) shape.by_force(h.s_to_m, section.col(k), h.signature.col(k));
      break;
    }
    case ChangeKind::kActuation:
      for (int k = 0; k < 2; ++k) shape.by_curvature(h.index, k, h.signature.col(k));
      break;
    case ChangeKind::kBase:
      for (int body = 0; body < shape.bodies(); ++body) {
        const Eigen::Vector3d x = shape.place(body);
        h.signature.block<3, 3>(3 * body, 0).setIdentity();
        h.signature.block<3, 3>(3 * body, 3) << 0.0, x.z(), -x.y(), -x.z(), 0.0, x.x(), x.y(), -x.x(), 0.0;
      }
      break;
    case ChangeKind::kNone:
    case ChangeKind::kUnclear:
      break;
  }
}

const ChangeHypothesis& ChangeTest::best(const MonitorShape& shape, const Displacements& innovation,
                                         const math::CholeskyFactor& factor,
                                         const std::vector<char>& usable) {
  const Eigen::VectorXd y = factor.whiten_vector(innovation);
  best_ = 0;
  double most = -1e300;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    ChangeHypothesis& h = hypotheses_[i];
    h.likelihood = 0.0;
    h.amplitude.setZero();
    h.penalised = -kPolicy.naming.per_value * static_cast<double>(h.amplitude.size());
    if (h.kind == ChangeKind::kRing && !usable[static_cast<std::size_t>(h.index)]) continue;
    signature(shape, h);
    whitened_ = factor.whiten(h.signature);
    h.amplitude = math::least_squares(whitened_, y);
    h.likelihood = y.squaredNorm() - (y - whitened_ * h.amplitude).squaredNorm();
    h.penalised += h.likelihood;
    if (h.penalised > most) {
      most = h.penalised;
      best_ = i;
    }
  }
  return hypotheses_[best_];
}

const ChangeHypothesis* ChangeTest::runner_up() const {
  const ChangeHypothesis* second = nullptr;
  for (const ChangeHypothesis& h : hypotheses_) {
    if (h.kind == hypotheses_[best_].kind) continue;
    if (!second || h.penalised > second->penalised) second = &h;
  }
  return second;
}

void ChangeTest::widen(ChangeHypothesis& winner) const {
  if (winner.kind != ChangeKind::kContact) return;
  // Two standard deviations of the place, and something for the model.
  const double enough =
      winner.likelihood - kPolicy.naming.place - kPolicy.naming.place_share * winner.likelihood;
  for (const ChangeHypothesis& h : hypotheses_) {
    if (h.kind != winner.kind || h.likelihood < enough) continue;
    winner.s_from_m = std::min(winner.s_from_m, h.s_from_m);
    winner.s_to_m = std::max(winner.s_to_m, h.s_to_m);
  }
}

}  // namespace softarm::monitor
