// A first round as the engine begins it: for tests of what comes after.
#pragma once

#include <algorithm>
#include <string>

#include "diagnose/refits.h"
#include "diagnose/screen.h"
#include "diagnose/unseen.h"
#include "looked.h"

namespace softarm::diagnose::testing {

/// What a first round knows before its refits.
struct Started {
  explicit Started(Looked& looked) : alone{looked.baseline, unseen(looked.model, looked.baseline)} {
    round.screened = screen(looked.model, looked.baseline, 0, [](double) {});
  }
  const Screened& of(const std::string& id) const {
    return *std::find_if(round.screened.begin(), round.screened.end(),
                         [&](const Screened& s) { return s.effect->info().id == id; });
  }
  Standing alone;
  Round round;
};

}  // namespace softarm::diagnose::testing
