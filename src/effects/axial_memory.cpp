// The length comes late: a share of the strain that the laws say follows with a time constant. In the end it
// is as the laws say, so that no constant takes a part of it.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"
#include "softarm/arm/laws.h"

namespace softarm::effects {
namespace {

constexpr double kLeastStrain = 1e-5;  // that inputs of a usual size make: less, and there is no law
constexpr double kLeastLength = 0.1;
constexpr double kLeftStrain = 0.01;  // strain that a trial finds of what was before it

/// By what the laws say, per segment; none where they do not hold.
Eigen::VectorXd strains(const arm::Arm& arm, const Eigen::VectorXd& inputs) {
  const auto laws = arm::predict(arm, arm::InputValues(inputs.data(), inputs.data() + inputs.size()));
  Eigen::VectorXd list = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.segments.size()));
  for (std::size_t i = 0; laws && i < laws->size(); ++i)
    list[static_cast<Eigen::Index>(i)] = (*laws)[i].length_m / arm.segments[i].length_m - 1.0;
  return list;
}

class AxialMemory : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool needs_strains() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override {
    Eigen::VectorXd usual(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
    for (Eigen::Index i = 0; i < usual.size(); ++i) {
      const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(i)].kind;
      usual[i] = kind == arm::InputKind::kPressure ? 10e3 : kind == arm::InputKind::kTension ? 1.0 : 0.0;
    }
    return (strains(arm, usual) - strains(arm, Eigen::VectorXd::Zero(usual.size()))).cwiseAbs().maxCoeff() >
           kLeastStrain;
  }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector2d(0.0, 2.0), Eigen::Vector2d(0.0, 12.0)};
  }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory& memory, rod::Rod& rod) const override {
    const Eigen::VectorXd now = strains(arm, instant.inputs);
    const Eigen::VectorXd late = now - followed(memory, now, values, instant);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Eigen::Index i = fine.pieces()[j].segment;
      rod.segments[j].length_m *= std::max(kLeastLength, 1.0 - values[0] * late[i] / (1.0 + now[i]));
    }
  }
  std::vector<StartNumber> starts(const arm::Arm& arm, const Values&) const override {
    std::vector<StartNumber> numbers;
    for (const arm::Segment& segment : arm.segments)
      numbers.push_back({segment.name + ".z", "1", kLeftStrain});
    return numbers;
  }
  void begin(const arm::Arm& arm, const FineRod&, const Values&, const Eigen::VectorXd& start,
             Memory& memory) const override {
    memory.assign(2 * arm.segments.size(), 0.0);
    for (std::size_t i = 0; i < arm.segments.size(); ++i)
      memory[2 * i] = kLeftStrain * start[static_cast<Eigen::Index>(i)];
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod&, const Values& values, const Instant& instant,
                const Shape&, Memory& memory) const override {
    const Eigen::VectorXd now = strains(arm, instant.inputs);
    const Eigen::VectorXd w = followed(memory, now, values, instant);
    memory.resize(2 * arm.segments.size());
    for (std::size_t i = 0; i < arm.segments.size(); ++i) {
      memory[2 * i] = w[static_cast<Eigen::Index>(i)];
      memory[2 * i + 1] = now[static_cast<Eigen::Index>(i)];
    }
  }

 private:
  /// What follows; at the beginning all has come that will, and what the trial found beyond that.
  static Eigen::VectorXd followed(const Memory& memory, const Eigen::VectorXd& now, const Values& values,
                                  const Instant& instant) {
    if (memory.empty()) return now;
    Eigen::VectorXd w(now.size());
    const bool begins = instant.dt_s <= 0.0;
    const Following f = begins ? Following() : following(instant.dt_s, std::max(values[1], 1e-2));
    for (Eigen::Index i = 0; i < w.size(); ++i) {
      const double* from = &memory[2 * static_cast<std::size_t>(i)];
      w[i] = begins ? from[0] + now[i] : f.kept * from[0] + f.weight_last * from[1] + f.weight_now * now[i];
    }
    return w;
  }
};

}  // namespace

std::unique_ptr<Effect> make_axial_memory() {
  return std::make_unique<AxialMemory>(
      Info{"axial_memory",
           "the arm goes on growing longer or shorter while what drives it is held",
           "L = L0 (1 + e - share (e - w)), time dw/dt = e - w, e the strain by the laws",
           "standard linear solid; R. M. Christensen, Theory of Viscoelasticity, 1982, isbn:0121742520",
           Family::kMemory,
           {{"share", "1", "of the strain by the laws, that comes late", 0.0, 0.98, 0.3},
            {"time_s", "s", "time constant", 0.1, 600.0, 10.0}},
           1,
           {"pressure_elongation", "creep", "pressure_lag"},
           {}});
}

}  // namespace softarm::effects
