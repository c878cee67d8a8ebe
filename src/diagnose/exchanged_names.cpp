#include "exchanged_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>

#include "arm/body_order.h"
#include "policy.h"
#include "sentences.h"

namespace softarm::diagnose {
namespace {

/// Numbers of the arm file's rings, from base to tip.
std::vector<std::size_t> rings_of(const arm::Arm& arm) {
  std::vector<std::size_t> rings;
  for (std::size_t b = 0; b < arm.bodies.size(); ++b)
    if (arm.bodies[b].kind == arm::BodyKind::kRing) rings.push_back(b);
  std::stable_sort(rings.begin(), rings.end(), [&](std::size_t a, std::size_t b) {
    return arm.bodies[a].arclength_m < arm.bodies[b].arclength_m;
  });
  return rings;
}

/// Of one instant; nothing where not all rings are seen, or they stand as they should.
std::optional<arm::BodyOrder> order_in(const arm::Arm& arm, const std::vector<std::size_t>& rings,
                                       const model::Block& block) {
  std::vector<Eigen::Vector3d> p_base;
  std::vector<double> arclength_m;
  for (const std::size_t ring : rings) {
    const auto seen = std::find_if(block.bodies.begin(), block.bodies.end(), [&](const model::Seen& one) {
      return one.body == static_cast<int>(ring);
    });
    if (seen == block.bodies.end()) return std::nullopt;
    p_base.push_back(seen->p_base);
    arclength_m.push_back(arm.bodies[ring].arclength_m);
  }
  return arm::other_order(p_base, arclength_m);
}

/// An order, with the means of its misfits, in most of a trial.
std::optional<arm::BodyOrder> order_in(const arm::Arm& arm, const std::vector<std::size_t>& rings,
                                       const model::TrialData& trial) {
  std::map<std::vector<std::size_t>, std::vector<arm::BodyOrder>> found;
  const std::size_t step = std::max<std::size_t>(1, trial.blocks.size() / kPolicy.names.instants);
  std::size_t looked_at = 0;
  for (std::size_t k = 0; k < trial.blocks.size(); k += step) {
    if (trial.blocks[k].bodies.empty()) continue;
    ++looked_at;
    if (const auto other = order_in(arm, rings, trial.blocks[k])) found[other->order].push_back(*other);
  }
  for (const auto& [order, list] : found) {
    const auto count = static_cast<double>(list.size());
    if (!(count > kPolicy.names.mostly * static_cast<double>(looked_at))) continue;
    arm::BodyOrder mean{order, 0.0, 0.0};
    for (const arm::BodyOrder& one : list) {
      mean.as_is_m += one.as_is_m / count;
      mean.least_m += one.least_m / count;
    }
    return mean;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ExchangedNames> exchanged_names(const arm::Arm& arm,
                                              const std::vector<model::TrialData>& trials) {
  const std::vector<std::size_t> rings = rings_of(arm);
  ExchangedNames names;
  std::optional<arm::BodyOrder> first;
  for (const model::TrialData& trial : trials) {
    const std::optional<arm::BodyOrder> other = order_in(arm, rings, trial);
    if (!other || (first && other->order != first->order)) continue;
    if (!first) first = other;
    names.trials.push_back(trial.name);
  }
  if (!first) return std::nullopt;
  names.as_said_m = first->as_is_m;
  names.as_seen_m = first->least_m;
  for (std::size_t k = 0; k < rings.size(); ++k) {
    names.said.push_back(arm.bodies[rings[k]].name);
    names.seen.push_back(arm.bodies[rings[first->order[k]]].name);
  }
  return names;
}

std::string sentence_of(const ExchangedNames& names, std::size_t trials) {
  return fmt::format(
      "From base to tip the arm file has {}, the recording {}, in {}: distances between neighbours are {} "
      "off in the arm file's order, {} in the recording's. Exchange the names first (softarm check gives the "
      "setting); until then the rest means little.",
      one_of(names.said, "and"), one_of(names.seen, "and"),
      names.trials.size() == trials ? "all trials" : one_of(names.trials, "and"),
      millimetres(names.as_said_m), millimetres(names.as_seen_m));
}

}  // namespace softarm::diagnose
