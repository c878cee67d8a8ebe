// A load that an experiment adds to the arm, as a term of the model without parameters.
#pragma once

#include <Eigen/Core>

#include "softarm/effects/effect.h"

namespace softarm::diagnose {

/// A dead force at the tip that is known: a thread over a pulley.
class KnownPull : public effects::Effect {
 public:
  explicit KnownPull(const Eigen::Vector3d& force_n) : force_n_(force_n) {
    info_.id = "known_pull";
    info_.words = "a thread pulls at the tip";
    info_.sizes = 0;
  }
  const effects::Info& info() const override { return info_; }
  void act(const Arm&, const effects::FineRod& fine, const effects::Values&, const effects::Instant&,
           const effects::Shape*, const effects::Memory&, rod::Rod& rod) const override {
    fine.add_force(fine.length_m(), force_n_, rod);
  }

 private:
  effects::Info info_;
  const Eigen::Vector3d force_n_;
};

}  // namespace softarm::diagnose
