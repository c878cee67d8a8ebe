// What a check of a recording is, and all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softarm/check/check.h"

namespace softarm::check {

struct Context;

/// Findings of one id that are alike (kPolicy.timing.same_figure) become one for all bodies, or all inputs.
enum class Alike {
  kOnePerPlace,   ///< never
  kOnePerDriver,  ///< what a driver does to one of them it mostly does to all
  kOnePerEvent,   ///< the same, if at the same times
};

/// A finding that a check may have.
struct Statement {
  const char* id;                    ///< a row of doc/check.md
  std::optional<Severity> severity;  ///< absent: it depends on what is found
  Alike alike = Alike::kOnePerPlace;
};

struct Check {
  void (*look)(Context&) = nullptr;
  std::vector<Statement> states;  ///< all that it may find; empty: it only makes ready what others look at

  /// Null where it does not state the id.
  const Statement* statement(const std::string& id) const;
};

/// In running order: what one finds wrong the next leaves out.
const std::vector<Check>& checks();

}  // namespace softarm::check
