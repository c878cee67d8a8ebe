// A load that an experiment adds to the arm, as a term of the model without parameters.
#pragma once

#include <Eigen/Core>

#include "model/effect.h"

namespace softarm::diagnose {

/// A dead force at the tip that is known: a thread over a pulley.
class KnownPull : public model::Effect {
 public:
  explicit KnownPull(const Eigen::Vector3d& force_n) : force_n_(force_n) {
    info_.id = "known_pull";
    info_.description = "a thread pulls at the tip";
    info_.sizes = 0;
  }
  const model::Info& info() const override { return info_; }
  void act(const arm::Arm&, const model::FineRod& fine, const model::Values&, const model::Instant&,
           const model::Shape*, const model::Memory&, rod::Rod& rod) const override {
    fine.add_force(fine.length_m(), force_n_, rod);
  }

 private:
  model::Info info_;
  const Eigen::Vector3d force_n_;
};

}  // namespace softarm::diagnose
