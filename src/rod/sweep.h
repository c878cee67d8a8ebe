// One integration of the rod from a given tip orientation to the base, with derivatives.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "grid.h"
#include "rod/kernel/kernel.h"
#include "softarm/rod/rod.h"

namespace softarm::rod {

/// Lane k of a vector.
inline Eigen::Vector3d lane(const kernel::Lanes v[3], int k) {
  return {v[0].value[k], v[1].value[k], v[2].value[k]};
}

/// Lanes of the first block that are not the caller's parameters.
constexpr int kUnknownLanes = 3;                    ///< rotation of the tip about the world axes
constexpr int kLoadScaleLane = kernel::kLanes - 1;  ///< common factor on all loads, for continuation
constexpr int kFirstBlockParameters = kernel::kLanes - kUnknownLanes - 1;

/// State and derivatives at a breakpoint, on its proximal side (loads there included).
struct Node {
  kernel::State y;
  double n[3];
};

class Sweep {
 public:
  Sweep(const Rod& layout, const std::vector<double>& stations_m, const std::vector<Parameter>& parameters,
        int max_refinement);

  /// Takes the rod's values. `load_direction` is the rod at full load that the load-scale lane points to.
  void set_rod(const Rod& rod, const Rod& load_direction);
  void refine(int refinement);
  int refinement() const { return refinement_; }

  /// Integrates the state. @return the estimated position error at the tip relative to the base, m
  double integrate(const Eigen::Quaterniond& q_tip);
  /// Integrates the derivatives of one block along the last integrate().
  void differentiate(int block);

  int blocks() const { return static_cast<int>(lanes_.size()); }
  int breakpoints() const { return grid_.breakpoints(); }
  const Grid& grid() const { return grid_; }
  const Node& node(int breakpoint) const { return nodes_[static_cast<std::size_t>(breakpoint)]; }
  Node& node(int breakpoint) { return nodes_[static_cast<std::size_t>(breakpoint)]; }
  const kernel::LaneState& lanes(int block, int breakpoint) const {
    return lanes_[static_cast<std::size_t>(block)][static_cast<std::size_t>(breakpoint)];
  }
  void nominal_step(const kernel::Step& step, Node& node) const {
    kernel_.nominal_step(step, node.n, node.y, nullptr, nullptr);
  }
  const kernel::Section& section(int segment) const { return sections_[static_cast<std::size_t>(segment)]; }

  /// Block and lane of a parameter.
  static int block_of(int parameter);
  static int lane_of(int parameter);
  /// First parameter of a block, and of the next one.
  int first_parameter(int block) const {
    const int first = block == 0 ? 0 : kFirstBlockParameters + (block - 1) * kernel::kLanes;
    return std::min(first, static_cast<int>(parameters_.size()));
  }

 private:
  void set_sources(int block);
  /// The interval from the tip on which any of a block's parameters acts first; before it derivatives are 0.
  std::size_t first_interval(int block) const;
  void apply_loads(int breakpoint, Node& node) const;
  void apply_loads(int block, int breakpoint, const Node& before, kernel::LaneState& y) const;
  /// From the distal side of the joint at an interval's proximal end to its proximal side.
  void turn_joint(std::size_t interval, Node& node);
  void turn_joint(int block, std::size_t interval, kernel::LaneState& y) const;

  Grid grid_;
  std::vector<Parameter> parameters_;
  kernel::Kernel kernel_;
  const Rod* rod_ = nullptr;
  const Rod* load_direction_ = nullptr;
  int refinement_ = 0;
  std::vector<kernel::Section> sections_;
  std::vector<Node> nodes_;
  std::vector<Node> distal_;                      ///< the same nodes before their loads
  std::vector<Eigen::Quaterniond> beyond_joint_;  ///< by interval: the distal side of the joint at its begin
  std::vector<kernel::Stage> stages_;
  std::vector<std::vector<kernel::LaneState>> lanes_;     ///< [block][breakpoint]
  std::vector<std::vector<kernel::LaneSource>> sources_;  ///< [block][segment]
  std::vector<std::size_t> first_;                        ///< [block] first_interval()
};

}  // namespace softarm::rod
