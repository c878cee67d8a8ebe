#include "memories.h"

#include <utility>

namespace softarm::model {

void drive(const arm::Arm& arm, const std::vector<Present>& effects, Series& series) {
  for (const Present& present : in_order(effects)) {
    if (!present.effect->drives()) continue;
    series.start = present.start;
    present.effect->drive(arm, present.values, series);
  }
  series.start.resize(0);
}

Memories::Memories(std::vector<Present> effects) : effects_(std::move(effects)), memories_(effects_.size()) {}

void Memories::begin(const arm::Arm& arm, const FineRod& fine) {
  rest();
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    const Present& present = effects_[i];
    if (present.effect->remembers() && present.start.size() > 0)
      present.effect->begin(arm, fine, present.values, present.start, memories_[i]);
  }
}

void Memories::rest() {
  memories_.assign(effects_.size(), {});
}

void Memories::remember(const arm::Arm& arm, const FineRod& fine, const Instant& instant,
                        const Shape& shape) {
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    const Present& present = effects_[i];
    if (present.effect->remembers())
      present.effect->remember(arm, fine, present.values, instant, shape, memories_[i]);
  }
}

}  // namespace softarm::model
