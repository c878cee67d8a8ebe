#include "section_laws.h"

#include <cmath>

#include "ramp.h"

namespace softarm::rig {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The axis about which bending towards an azimuth turns.
Vector2d axis_of(double azimuth_rad) {
  return {-std::sin(azimuth_rad), std::cos(azimuth_rad)};
}

class Cubic : public SectionLaw {
 public:
  explicit Cubic(double beta) : beta_(beta) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    const Vector2d& u = step.curvature;
    const double k = step.stiffness_nm2 * beta_, square = u.squaredNorm();
    to.moment_nm += k * square * u;
    to.tangent_nm2 += k * (square * Matrix2d::Identity() + 2.0 * u * u.transpose());
    to.stored_j_per_m += 0.25 * k * square * square;
  }

 private:
  double beta_;
};

class Gent : public SectionLaw {
 public:
  explicit Gent(double beta) : beta_(beta) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    constexpr double kLast = 0.9;  // of beta u^2
    const Vector2d& u = step.curvature;
    const double square = u.squaredNorm(), x = std::min(beta_ * square, kLast), ei = step.stiffness_nm2;
    const double secant = 1.0 / (1.0 - x), slope = (1.0 + x) * secant * secant;
    double energy = -0.5 * std::log1p(-x) / beta_;  // integral of the moment / EI
    if (beta_ * square <= kLast) {
      to.moment_nm += ei * (secant - 1.0) * u;
      to.tangent_nm2 +=
          ei * ((secant - 1.0) * Matrix2d::Identity() + 2.0 * beta_ * secant * secant * u * u.transpose());
    } else {
      const double size = std::sqrt(square), last = std::sqrt(kLast / beta_), beyond = size - last;
      const double moment = last * secant + slope * beyond;
      const Vector2d along = u / size;
      to.moment_nm += ei * (moment * along - u);
      to.tangent_nm2 += ei * ((moment / size - 1.0) * Matrix2d::Identity() +
                              (slope - moment / size) * along * along.transpose());
      energy += last * secant * beyond + 0.5 * slope * beyond * beyond;
    }
    to.stored_j_per_m += ei * (energy - 0.5 * square);
  }

 private:
  double beta_;
};

class Oval : public SectionLaw {
 public:
  Oval(double share, double knee) : share_(share), knee_(knee) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    const Vector2d& u = step.curvature;
    const double k = step.stiffness_nm2 * share_, square = u.squaredNorm(), x2 = square / (knee_ * knee_);
    const double left = 1.0 / (1.0 + x2);
    to.moment_nm -= k * (1.0 - left) * u;
    to.tangent_nm2 -=
        k * ((1.0 - left) * Matrix2d::Identity() + 2.0 * left * left / (knee_ * knee_) * u * u.transpose());
    to.stored_j_per_m -= 0.5 * k * (square - knee_ * knee_ * std::log1p(x2));
  }

 private:
  double share_, knee_;
};

class Wrinkling : public SectionLaw {
 public:
  Wrinkling(double share, double knee) : share_(share), knee_(knee) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    const Vector2d& u = step.curvature;
    const double size = u.norm(), y = size / knee_ - 1.0;
    if (y <= 0.0) return;
    const double k = step.stiffness_nm2 * share_, slope = -std::expm1(-y), lost = knee_ * (y - slope);
    const Vector2d along = u / size;
    to.moment_nm -= k * lost * along;
    to.tangent_nm2 -=
        k * (lost / size * Matrix2d::Identity() + (slope - lost / size) * along * along.transpose());
    to.stored_j_per_m -= k * knee_ * knee_ * (0.5 * y * y - y + slope);
  }

 private:
  double share_, knee_;
};

/// Remembers the curvature of each dashpot.
class Maxwell : public SectionLaw {
 public:
  explicit Maxwell(std::vector<MaxwellBranch> branches) : branches_(std::move(branches)) {}
  std::size_t memory_size() const override { return 2 * branches_.size(); }
  void add(const SectionStep& step, const double* before, double* after, SectionResponse& to) const override {
    const double ei = step.stiffness_nm2;
    const Vector2d& u = step.curvature;
    for (const MaxwellBranch& branch : branches_) {
      const Eigen::Map<const Vector2d> old(before);
      Eigen::Map<Vector2d> dashpot(after);
      double weight_now = 1.0;
      if (step.dt_s > 0.0) {
        const double h = step.dt_s / branch.relaxation_s;
        const double passed = -std::expm1(-h);
        weight_now = h > 1e-4 ? 1.0 - passed / h : 0.5 * h - h * h / 6.0;
        dashpot = (1.0 - passed) * old + (passed - weight_now) * step.last_curvature + weight_now * u;
      } else {
        dashpot = u;
      }
      to.moment_nm -= ei * branch.share * dashpot;
      to.tangent_nm2 -= ei * branch.share * weight_now * Matrix2d::Identity();
      to.stored_j_per_m += 0.5 * ei * branch.share * ((u - dashpot).squaredNorm() - u.squaredNorm());
      before += 2;
      after += 2;
    }
  }

 private:
  std::vector<MaxwellBranch> branches_;
};

/// Remembers z.
class BoucWen : public SectionLaw {
 public:
  BoucWen(double height, double yield) : height_(height), yield_(yield) {}
  std::size_t memory_size() const override { return 2; }
  void add(const SectionStep& step, const double* before, double* after, SectionResponse& to) const override {
    Matrix2d tangent;
    Eigen::Map<Vector2d> z(after);
    z = bouc_wen_along(Eigen::Map<const Vector2d>(before), (step.curvature - step.last_curvature) / yield_,
                       tangent);
    const double moment = step.stiffness_nm2 * height_;
    to.moment_nm += moment * z;
    to.tangent_nm2 += moment / yield_ * tangent;
    to.stored_j_per_m += 0.5 * moment * yield_ * z.squaredNorm();
  }

 private:
  double height_, yield_;
};

/// Remembers the square of the largest curvature.
class Mullins : public SectionLaw {
 public:
  Mullins(double share, double scale, bool recovers) : share_(share), scale_(scale), recovers_(recovers) {}
  std::size_t memory_size() const override { return 1; }
  void add(const SectionStep& step, const double* before, double* after, SectionResponse& to) const override {
    const Vector2d& u = step.curvature;
    const double square = u.squaredNorm(), most = std::max(square, *before);
    const double k = step.stiffness_nm2 * share_;
    *after = most;
    if (recovers_) {
      const double y = (most - square) / (scale_ * scale_), y0 = most / (scale_ * scale_);
      to.moment_nm += k * std::erfc(y) * u;
      to.tangent_nm2 += k * std::erfc(y) * Matrix2d::Identity();
      if (y > 0.0)
        to.tangent_nm2 +=
            k * 4.0 / std::sqrt(M_PI) * std::exp(-y * y) / (scale_ * scale_) * u * u.transpose();
      to.stored_j_per_m += 0.5 * k * scale_ * scale_ * (integral_of_erfc(y0) - integral_of_erfc(y));
    } else {
      const double left = std::exp(-std::sqrt(most) / scale_);
      to.moment_nm += k * left * u;
      to.tangent_nm2 += k * left * Matrix2d::Identity();
      if (square >= *before && square > 0.0)
        to.tangent_nm2 -= k * left / (scale_ * std::sqrt(square)) * u * u.transpose();
      to.stored_j_per_m += 0.5 * k * left * square;
    }
  }

 private:
  static double integral_of_erfc(double y) { return y * std::erfc(y) - std::expm1(-y * y) / std::sqrt(M_PI); }
  double share_, scale_;
  bool recovers_;
};

/// Remembers the curvature at which the core is straight for itself.
class Core : public SectionLaw {
 public:
  explicit Core(const CoreLaw& law) : law_(law) {}
  std::size_t memory_size() const override { return 2; }
  void add(const SectionStep& step, const double* before, double* after, SectionResponse& to) const override {
    const double k = step.core_stiffness_nm2, k_last = step.last_core_stiffness_nm2;
    const Vector2d& u = step.curvature;
    Eigen::Map<Vector2d> reference(after);
    reference = Eigen::Map<const Vector2d>(before);
    // What stiffness comes in is without moment at the curvature of its coming.
    double moved = 0.0;
    if (k > k_last) {
      moved = (k - k_last) / k;
      reference += moved * (0.5 * law_.memory * (u + step.last_curvature) - reference);
      moved *= 0.5 * law_.memory;
    }
    Vector2d elastic = u - reference;
    Matrix2d tangent = (1.0 - moved) * Matrix2d::Identity();
    if (law_.yield_per_m > 0.0 && law_.smooth) {
      Vector2d start = (step.last_curvature - reference) / law_.yield_per_m;
      // What comes in where the arm is bent far slips at once. Beyond the yield the model would soften with
      // bending: no rod has a definite shape then.
      if (start.norm() > 1.0) start.normalize();
      Matrix2d slip;
      elastic = law_.yield_per_m * bouc_wen_along(start, (u - step.last_curvature) / law_.yield_per_m, slip);
      tangent = (1.0 - moved) * slip;
    } else if (law_.yield_per_m > 0.0 && elastic.norm() > law_.yield_per_m) {
      const Vector2d along = elastic.normalized();
      tangent = (1.0 - moved) * law_.yield_per_m / elastic.norm() *
                (Matrix2d::Identity() - along * along.transpose());
      elastic = law_.yield_per_m * along;
    }
    reference = u - elastic;
    to.moment_nm += k * (elastic - u);
    to.tangent_nm2 += k * (tangent - Matrix2d::Identity());
    to.stored_j_per_m += 0.5 * k * (elastic.squaredNorm() - u.squaredNorm());
  }

 private:
  CoreLaw law_;
};

class PlaneStiffness : public SectionLaw {
 public:
  PlaneStiffness(double azimuth, double share) : axis_(axis_of(azimuth)), share_(share) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    const double k = step.stiffness_nm2 * share_, along = axis_.dot(step.curvature);
    to.moment_nm += k * along * axis_;
    to.tangent_nm2 += k * axis_ * axis_.transpose();
    to.stored_j_per_m += 0.5 * k * along * along;
  }

 private:
  Vector2d axis_;
  double share_;
};

class Ribs : public SectionLaw {
 public:
  Ribs(double azimuth, double share) : axis_(axis_of(azimuth)), share_(share) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    constexpr double kGivesWayPerM = 8.0;
    const double k = step.stiffness_nm2 * share_, x = axis_.dot(step.curvature) / kGivesWayPerM;
    const double reached = std::tanh(x);
    to.moment_nm += k * kGivesWayPerM * reached * axis_;
    to.tangent_nm2 += k * (1.0 - reached * reached) * axis_ * axis_.transpose();
    to.stored_j_per_m += k * kGivesWayPerM * kGivesWayPerM * std::log(std::cosh(x));
  }

 private:
  Vector2d axis_;
  double share_;
};

class OneSidedFolds : public SectionLaw {
 public:
  OneSidedFolds(double azimuth, double share) : axis_(axis_of(azimuth)), share_(share) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    constexpr double kFoldsPerM = 2.0;
    const double u = axis_.dot(step.curvature);
    if (u <= 0.0) return;
    const double k = step.stiffness_nm2 * share_, folded = -std::expm1(-u / kFoldsPerM);
    const double lost = u - kFoldsPerM * folded;
    to.moment_nm -= k * lost * axis_;
    to.tangent_nm2 -= k * folded * axis_ * axis_.transpose();
    to.stored_j_per_m -= k * (0.5 * u * u - kFoldsPerM * lost);
  }

 private:
  Vector2d axis_;
  double share_;
};

class OneSided : public SectionLaw {
 public:
  OneSided(double azimuth, double share) : axis_(axis_of(azimuth)), share_(share) {}
  void add(const SectionStep& step, const double*, double*, SectionResponse& to) const override {
    constexpr double kOnsetPerM = 0.5;
    const double k = step.stiffness_nm2 * share_;
    const Ramp ramp(axis_.dot(step.curvature), kOnsetPerM);
    to.moment_nm -= k * ramp.value * axis_;
    to.tangent_nm2 -= k * ramp.slope * axis_ * axis_.transpose();
    to.stored_j_per_m -= k * ramp.integral;
  }

 private:
  Vector2d axis_;
  double share_;
};

}  // namespace

Eigen::Vector2d bouc_wen_along(const Eigen::Vector2d& z, const Eigen::Vector2d& path,
                               Eigen::Matrix2d& tangent) {
  constexpr double kNoPath = 1e-7, kFarPath = 50.0;
  const double length = path.norm();
  if (length < kNoPath) {
    tangent = Matrix2d::Identity();
    if (z.dot(path) > 0.0) tangent -= z * z.transpose();
    return z + tangent * path;
  }
  // z' = e - z max(0, e . z) along e: while e . z < 0 straight on; then, with a = e . z at the start,
  // e . z = (sinh s + a cosh s) / (cosh s + a sinh s), and what is across falls as 1 / (cosh s + a sinh s).
  const Vector2d e = path / length, across_e(-e.y(), e.x());
  const double a = e.dot(z), across = across_e.dot(z), s = std::min(length, kFarPath);
  if (a < 0.0 && s <= -a) {
    tangent = Matrix2d::Identity();
    return z + path;
  }
  double along = 0.0, fade = 0.0;       // e . z, and what is left of the part across
  double along_s = 0.0, along_a = 0.0;  // their derivatives
  double fade_s = 0.0, fade_a = 0.0;
  if (a < 0.0) {
    along = std::tanh(s + a);
    fade = 1.0 / std::cosh(s + a);
    along_s = along_a = fade * fade;
    fade_s = fade_a = -along * fade;
  } else {
    const double sh = std::sinh(s), ch = std::cosh(s), below = ch + a * sh;
    along = (sh + a * ch) / below;
    fade = 1.0 / below;
    along_s = 1.0 - along * along;
    along_a = fade * fade;
    fade_s = -along * fade;
    fade_a = -sh * fade * fade;
  }
  // e turns by the angle t: da/dt = across, d across/dt = -a.
  const Vector2d by_length = along_s * e + across * fade_s * across_e;
  const Vector2d by_turn =
      (along_a * across - across * fade) * e + (along - a * fade + across * fade_a * across) * across_e;
  tangent = by_length * e.transpose() + by_turn / length * across_e.transpose();
  return along * e + across * fade * across_e;
}

SectionLawPtr cubic_stiffening(double beta_m2) {
  return std::make_shared<Cubic>(beta_m2);
}
SectionLawPtr gent_stiffening(double beta_m2) {
  return std::make_shared<Gent>(beta_m2);
}
SectionLawPtr oval_softening(double share, double knee_per_m) {
  return std::make_shared<Oval>(share, knee_per_m);
}
SectionLawPtr wrinkling_softening(double share, double knee_per_m) {
  return std::make_shared<Wrinkling>(share, knee_per_m);
}
SectionLawPtr maxwell_branches(std::vector<MaxwellBranch> branches) {
  return std::make_shared<Maxwell>(std::move(branches));
}
SectionLawPtr bouc_wen(double height_per_m, double yield_per_m) {
  return std::make_shared<BoucWen>(height_per_m, yield_per_m);
}
SectionLawPtr mullins(double share, double scale_per_m, bool recovers) {
  return std::make_shared<Mullins>(share, scale_per_m, recovers);
}
SectionLawPtr jammed_core(const CoreLaw& law) {
  return std::make_shared<Core>(law);
}
SectionLawPtr plane_stiffness(double azimuth_rad, double share) {
  return std::make_shared<PlaneStiffness>(azimuth_rad, share);
}
SectionLawPtr rib_stiffness(double azimuth_rad, double share) {
  return std::make_shared<Ribs>(azimuth_rad, share);
}
SectionLawPtr one_sided_folds(double azimuth_rad, double share) {
  return std::make_shared<OneSidedFolds>(azimuth_rad, share);
}
SectionLawPtr one_sided_softness(double azimuth_rad, double share) {
  return std::make_shared<OneSided>(azimuth_rad, share);
}

}  // namespace softarm::rig
