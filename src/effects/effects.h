// The effects of the catalogue; each is made in a file of its own.
#pragma once

#include <memory>
#include <utility>

#include "softarm/effects/effect.h"

namespace softarm::effects {

/// An effect with its description.
class Described : public Effect {
 public:
  explicit Described(Info info) : info_(std::move(info)) {}
  const Info& info() const override { return info_; }

 private:
  const Info info_;
};

std::unique_ptr<Effect> make_stiffness_taper();
std::unique_ptr<Effect> make_base_compliance();
std::unique_ptr<Effect> make_hysteresis();
std::unique_ptr<Effect> make_tether();
std::unique_ptr<Effect> make_marker_slip();

}  // namespace softarm::effects
