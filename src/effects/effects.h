// The effects of the catalogue; each is made in a file of its own.
#pragma once

#include <memory>
#include <utility>

#include "catalogue.h"
#include "effect_list.h"
#include "model/effect.h"

namespace softarm::effects {

// An effect is written with the names of the model.
using arm::Arm;
using arm::InputKind;
using model::Bodies;
using model::Effect;
using model::Family;
using model::FineRod;
using model::Info;
using model::Instant;
using model::Memory;
using model::Motion;
using model::Parameter;
using model::Piece;
using model::Present;
using model::Series;
using model::Shape;
using model::Stage;
using model::StartNumber;
using model::Values;

/// An effect with its description.
class Described : public Effect {
 public:
  explicit Described(Info info) : info_(std::move(info)) {}
  const Info& info() const override { return info_; }

 private:
  const Info info_;
};

#define SOFTARM_DECLARE(name) std::unique_ptr<Effect> make_##name();
SOFTARM_EFFECTS(SOFTARM_DECLARE)
#undef SOFTARM_DECLARE

}  // namespace softarm::effects
