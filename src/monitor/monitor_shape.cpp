#include "monitor_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "arm/stiffness_profile.h"
#include "rod/actuation.h"

namespace softarm::monitor {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kPieces = 20;

}  // namespace

MonitorShape::MonitorShape(const arm::Arm& arm)
    : arm_(arm), length_m_(arm.total_length_m()), rod_(rod::make_rod(arm)), hung_(rod_.loads.size()) {
  double end = 0.0;
  for (const arm::Segment& segment : arm.segments) segment_end_.push_back(end += segment.length_m);
  for (const arm::MeasuredBody& body : arm.bodies) body_s_.push_back(body.arclength_m);
  bodies_.assign(arm.bodies.size(), Vector3d::Zero());
  body_piece_.assign(arm.bodies.size(), 0);
  residual_.reserve(arm.bodies.size());
}

int MonitorShape::piece_at(double s_m) const {
  const auto above = std::upper_bound(begin_.begin(), begin_.end(), s_m);
  return std::max(0, static_cast<int>(above - begin_.begin()) - 1);
}

Vector3d MonitorShape::place_at(double s_m) const {
  const auto i = static_cast<std::size_t>(piece_at(s_m));
  return pieces_[i].p + (s_m - begin_[i] - 0.5 * pieces_[i].ds) * pieces_[i].t;
}

Matrix3d MonitorShape::section_at(double s_m) const {
  return pieces_[static_cast<std::size_t>(piece_at(s_m))].r;
}

Matrix3d MonitorShape::section(int body) const {
  return pieces_[static_cast<std::size_t>(body_piece_[static_cast<std::size_t>(body)])].r;
}

void MonitorShape::set(const estimate::Estimate& estimate) {
  const std::vector<estimate::BackbonePoint>& points = estimate.backbone;
  // More pieces than these gain nothing; a live backbone and an offline one give the same.
  const std::size_t intervals = points.size() - 1;
  const std::size_t step = intervals % kPieces == 0 ? intervals / kPieces : 1;
  pieces_.resize(intervals / step);
  begin_.resize(pieces_.size());
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const estimate::BackbonePoint &a = points[i * step], &b = points[(i + 1) * step];
    Piece& piece = pieces_[i];
    const double mid = 0.5 * (a.arclength_m + b.arclength_m);
    begin_[i] = a.arclength_m;
    piece.ds = b.arclength_m - a.arclength_m;
    piece.segment = 0;
    while (piece.segment + 1 < static_cast<int>(segment_end_.size()) &&
           mid > segment_end_[static_cast<std::size_t>(piece.segment)])
      ++piece.segment;
    const auto segment_index = static_cast<std::size_t>(piece.segment);
    const arm::Segment& segment = arm_.segments[segment_index];
    const double from = segment_end_[segment_index] - segment.length_m;
    piece.factor = 1.0 / arm::stiffness_factor(segment.stiffness_profile, (mid - from) / segment.length_m);
    const rod::Segment& part = rod_.segments[segment_index];
    piece.weight_kg = part.mass_kg / part.rest_length_m * piece.ds;
    Eigen::Quaterniond q = a.q_base;
    if (q.dot(b.q_base) < 0.0) {
      q.coeffs() -= b.q_base.coeffs();
    } else {
      q.coeffs() += b.q_base.coeffs();
    }
    piece.r = q.normalized().toRotationMatrix();
    // Turn of the chord's ends in the middle's frame: exact for a constant curvature to third order.
    const Eigen::Quaterniond turn = a.q_base.conjugate() * b.q_base;
    const Vector3d angle = 2.0 * (turn.w() < 0.0 ? -1.0 : 1.0) * turn.vec();
    const double square = angle.squaredNorm();
    piece.turn = angle * ((1.0 + square / 24.0) / piece.ds);
    const Vector3d chord = b.p_base - a.p_base;
    piece.p = 0.5 * (a.p_base + b.p_base);
    piece.t = chord / piece.ds;
    piece.stretch = piece.r.transpose() * piece.t * (1.0 + square / 24.0);
  }
  residual_.clear();
  for (std::size_t i = 0; i < body_s_.size(); ++i) {
    body_piece_[i] = piece_at(std::min(body_s_[i], length_m_ * (1.0 - 1e-9)));
    const Piece& piece = pieces_[static_cast<std::size_t>(body_piece_[i])];
    bodies_[i] =
        piece.p + (body_s_[i] - begin_[static_cast<std::size_t>(body_piece_[i])] - 0.5 * piece.ds) * piece.t;
  }
  for (const estimate::BodyResidual& residual : estimate.residuals) {
    bodies_[static_cast<std::size_t>(residual.body)] = residual.estimated_base;
    residual_.emplace_back(residual.body, residual.measured_base - residual.estimated_base);
  }
  gravity_ = estimate.base_in_mocap.linear().transpose() * arm_.gravity_m_s2;
  rod_.loads[rod::kPayloadLoad].mass_kg = estimate.payload_kg.value_or(0.0);
  for (std::size_t i = 0; i < hung_.size(); ++i) {
    const rod::PointLoad& load = rod_.loads[i];
    const double s_m = std::min(load.s_m, length_m_ * (1.0 - 1e-9));
    hung_[i] = {load.s_m, place_at(std::min(load.s_m, length_m_)) + section_at(s_m) * load.offset_m,
                load.mass_kg};
  }
  std::sort(hung_.begin(), hung_.end(), [](const Hung& x, const Hung& y) { return x.s_m > y.s_m; });
}

void MonitorShape::loads() {
  // From the tip: the weight beyond, and its moment about the place.
  Vector3d force = Vector3d::Zero(), moment_about_origin = Vector3d::Zero();
  auto next = hung_.begin();
  for (std::size_t i = pieces_.size(); i-- > 0;) {
    Piece& piece = pieces_[i];
    for (; next != hung_.end() && begin_[i] < next->s_m; ++next) {
      const Vector3d weight = next->kg * gravity_;
      force += weight;
      moment_about_origin += next->place.cross(weight);
    }
    const Vector3d half = 0.5 * piece.weight_kg * gravity_;
    force += half;
    moment_about_origin += piece.p.cross(half);
    piece.force = piece.r.transpose() * force;
    piece.load_moment = piece.r.transpose() * (moment_about_origin - piece.p.cross(force));
    piece.load_moment.z() = 0.0;
    force += half;
    moment_about_origin += piece.p.cross(half);
    const Vector3d begin = piece.p - 0.5 * piece.ds * piece.t;
    piece.joint_moment = piece.r.transpose() * (moment_about_origin - begin.cross(force));
    piece.joint_moment.z() = 0.0;
  }
}

double MonitorShape::overlap(const Piece& piece, std::size_t i, double s_m) const {
  return std::clamp(s_m - begin_[i], 0.0, piece.ds);
}

template <class TurnOf, class StretchOf>
void MonitorShape::integrate(TurnOf turn_of, StretchOf stretch_of, Eigen::Ref<Displacements> out) const {
  // dx_i = sum over pieces before s_i of (R turn ds) x (x_i - p) + R stretch ds
  //      = a x x_i - b + c with the running sums a of R turn ds, b of R turn ds x p, c of R stretch ds.
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
  std::size_t done = 0;
  // Bodies are few and in the order of the arm: one pass, with the part of a piece up to each of them.
  for (std::size_t k = 0; k < body_s_.size(); ++k) {
    const auto at = static_cast<std::size_t>(body_piece_[k]);
    if (at < done) {  // not in order: start again
      a.setZero();
      b.setZero();
      done = 0;
    }
    for (; done < at; ++done) {
      const Piece& piece = pieces_[done];
      const Vector3d turn = piece.r * turn_of(piece) * piece.ds;
      a += turn;
      b += turn.cross(piece.p) - piece.r * stretch_of(piece) * piece.ds;
    }
    const Piece& piece = pieces_[at];
    const double part = overlap(piece, at, body_s_[k]);
    const Vector3d turn = piece.r * turn_of(piece) * part;
    const Vector3d middle = piece.p + 0.5 * (part - piece.ds) * piece.t;
    const Vector3d& x = bodies_[k];
    out.segment<3>(static_cast<Eigen::Index>(3 * k)) =
        a.cross(x) - b + turn.cross(x - middle) + piece.r * stretch_of(piece) * part;
  }
}

void MonitorShape::discrepancy(const std::vector<arm::SegmentPrediction>* predictions, Displacements& e) {
  if (predictions != nullptr) {
    rod::actuate(arm_, *predictions, rod_);
  } else {
    // Signatures still need some stiffness: that at no input.
    for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
      const arm::StiffnessLaw& law = arm_.segments[i].bending_stiffness;
      rod_.segments[i].bending_compliance =
          1.0 / (law.by_pressure.empty() ? law.base_nm2 : law.by_pressure.front().bending_stiffness_nm2);
      rod_.segments[i].length_m = arm_.segments[i].length_m;
    }
  }
  loads();
  for (Piece& piece : pieces_) {
    const rod::Segment& part = rod_.segments[static_cast<std::size_t>(piece.segment)];
    piece.compliance = part.length_m / part.rest_length_m * piece.factor * part.bending_compliance;
    // A joint at the segment's start, spread over the piece behind it.
    const bool first = &piece == pieces_.data() || (&piece - 1)->segment != piece.segment;
    piece.joint = first ? part.joint_compliance / piece.ds : 0.0;
  }
  if (predictions != nullptr) {
    const auto turn_of = [&](const Piece& piece) -> Vector3d {
      const rod::Segment& part = rod_.segments[static_cast<std::size_t>(piece.segment)];
      Vector3d turn = piece.compliance * (part.moment_nm + piece.load_moment) +
                      piece.joint * piece.joint_moment +
                      part.length_m / part.rest_length_m * part.rest_curvature_per_m - piece.turn;
      turn.z() = 0.0;
      return turn;
    };
    const auto stretch_of = [&](const Piece& piece) -> Vector3d {
      const rod::Segment& part = rod_.segments[static_cast<std::size_t>(piece.segment)];
      const Vector3d compliance(part.shear_compliance, part.shear_compliance, part.axial_compliance);
      const Vector3d v = Vector3d::UnitZ() + compliance.cwiseProduct(piece.force);
      // Behind a joint the chord is turned by all of its turn, the frame in the middle by half of it.
      const Vector3d half_turn = 0.5 * piece.ds * piece.joint * piece.joint_moment;
      return part.length_m / part.rest_length_m * v + half_turn.cross(Vector3d::UnitZ()) - piece.stretch;
    };
    integrate(turn_of, stretch_of, e);
  } else {
    for (const auto& entry : residual_) e.segment<3>(3 * entry.first).setZero();
  }
  for (const auto& [body, residual] : residual_) e.segment<3>(3 * body) = residual - e.segment<3>(3 * body);
}

namespace {
const auto kNoStretch = [](const auto&) -> Vector3d { return Vector3d::Zero(); };
}

void MonitorShape::by_curvature(int segment, int axis, Eigen::Ref<Displacements> out) const {
  const Vector3d unit = axis == 0 ? Vector3d::UnitX() : Vector3d::UnitY();
  integrate(
      [&](const Piece& piece) -> Vector3d {
        return piece.segment == segment ? Vector3d(piece.factor * unit) : Vector3d(Vector3d::Zero());
      },
      kNoStretch, out);
}

void MonitorShape::by_flexibility(int segment, Eigen::Ref<Displacements> out) const {
  integrate(
      [&](const Piece& piece) -> Vector3d {
        return piece.segment == segment ? Vector3d(piece.compliance * piece.load_moment)
                                        : Vector3d(Vector3d::Zero());
      },
      kNoStretch, out);
}

void MonitorShape::by_length(int segment, Eigen::Ref<Displacements> out) const {
  const double per_length = 1.0 / arm_.segments[static_cast<std::size_t>(segment)].length_m;
  // A longer segment of the same curvature also turns further.
  integrate(
      [&](const Piece& piece) -> Vector3d {
        return piece.segment == segment ? Vector3d(per_length * piece.turn) : Vector3d(Vector3d::Zero());
      },
      [&](const Piece& piece) -> Vector3d {
        return piece.segment == segment ? Vector3d(per_length * Vector3d::UnitZ())
                                        : Vector3d(Vector3d::Zero());
      },
      out);
}

void MonitorShape::by_payload(Eigen::Ref<Displacements> out) const {
  by_force(arm_.payload.arclength_m, gravity_, out);
}

void MonitorShape::by_force(double s_m, const Vector3d& force, Eigen::Ref<Displacements> out) const {
  const Vector3d at = place_at(std::min(s_m, length_m_));
  const Piece* last = &pieces_[static_cast<std::size_t>(piece_at(std::min(s_m, length_m_ * (1.0 - 1e-9))))];
  integrate(
      [&](const Piece& piece) -> Vector3d {
        if (&piece > last) return Vector3d::Zero();
        Vector3d moment = piece.r.transpose() * (at - piece.p).cross(force);
        moment.z() = 0.0;
        if (&piece == last) {
          // Half the piece, more or less, is beyond the force: what is before it, on average.
          const auto i = static_cast<std::size_t>(last - pieces_.data());
          const double share = std::clamp((s_m - begin_[i]) / piece.ds, 0.0, 1.0);
          Vector3d mean = piece.r.transpose() * (0.5 * share * share * piece.ds * piece.t).cross(force);
          mean.z() = 0.0;
          moment = mean;
        }
        return (piece.compliance + piece.joint) * moment;
      },
      kNoStretch, out);
}

void MonitorShape::by_inertia(const Displacements& acceleration, const std::vector<char>& usable,
                              Eigen::Ref<Displacements> out) const {
  // Acceleration along the arm: 0 at the base, linear from body to body, constant beyond the last.
  const auto at = [&](double s_m) -> Vector3d {
    double from = 0.0;
    Vector3d a = Vector3d::Zero();
    for (std::size_t k = 0; k < body_s_.size(); ++k) {
      if (!usable[k] || body_s_[k] <= from) continue;
      const Vector3d next = acceleration.segment<3>(static_cast<Eigen::Index>(3 * k));
      if (s_m <= body_s_[k]) return a + (s_m - from) / (body_s_[k] - from) * (next - a);
      from = body_s_[k];
      a = next;
    }
    return a;
  };
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
  std::vector<Vector3d>& moments = inertia_;
  moments.resize(pieces_.size());
  auto next = hung_.begin();
  for (std::size_t i = pieces_.size(); i-- > 0;) {
    const Piece& piece = pieces_[i];
    for (; next != hung_.end() && begin_[i] < next->s_m; ++next) {
      const Vector3d inertia = -next->kg * at(next->s_m);
      force += inertia;
      moment += next->place.cross(inertia);
    }
    const Vector3d half = -0.5 * piece.weight_kg * at(begin_[i] + 0.5 * piece.ds);
    force += 2.0 * half;
    moment += 2.0 * piece.p.cross(half);
    moments[i] = piece.r.transpose() * (moment - piece.p.cross(force));
    moments[i].z() = 0.0;
  }
  integrate(
      [&](const Piece& piece) -> Vector3d {
        return (piece.compliance + piece.joint) * moments[static_cast<std::size_t>(&piece - pieces_.data())];
      },
      kNoStretch, out);
}

}  // namespace softarm::monitor
