// What the effects of an arm remember: the one place where their memories are walked through time.
#pragma once

#include <vector>

#include "effect.h"
#include "softarm/arm/arm.h"

namespace softarm::model {

/// Effects act on the inputs one after the other, in the catalogue's order.
void drive(const arm::Arm& arm, const std::vector<Present>& effects, Series& series);

class Memories {
 public:
  explicit Memories(std::vector<Present> effects);

  /// Where a trial begins: as Present::start says.
  void begin(const arm::Arm& arm, const FineRod& fine);
  /// After a pause, in which all came to rest.
  void rest();
  /// An instant is over.
  void remember(const arm::Arm& arm, const FineRod& fine, const Instant& instant, const Shape& shape);

  const std::vector<Memory>& all() const { return memories_; }

 private:
  std::vector<Present> effects_;
  std::vector<Memory> memories_;
};

}  // namespace softarm::model
