// The length comes late: a share of the strain that the laws say follows with a time constant, or with a
// spectrum of them. In the end it is as the laws say, so that no constant takes a part of it.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"
#include "relaxation.h"
#include "softarm/arm/laws.h"

namespace softarm::effects {
namespace {

using Eigen::VectorXd;

constexpr double kLeastStrain = 1e-5;  // that inputs of a usual size make: less, and there is no law
constexpr double kLeastLength = 0.1;
constexpr double kLeftStrain = 0.01;  // strain that a trial finds of what was before it

/// By what the laws say, per segment; none where they do not hold.
VectorXd strains(const arm::Arm& arm, const VectorXd& inputs) {
  const auto laws = arm::predict(arm, arm::InputValues(inputs.data(), inputs.data() + inputs.size()));
  VectorXd list = VectorXd::Zero(static_cast<Eigen::Index>(arm.segments.size()));
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
    VectorXd usual(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
    for (Eigen::Index i = 0; i < usual.size(); ++i) {
      const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(i)].kind;
      usual[i] = kind == arm::InputKind::kPressure ? 10e3 : kind == arm::InputKind::kTension ? 1.0 : 0.0;
    }
    return (strains(arm, usual) - strains(arm, VectorXd::Zero(usual.size()))).cwiseAbs().maxCoeff() >
           kLeastStrain;
  }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector3d(0.0, 2.0, 0.0), Eigen::Vector3d(0.0, 12.0, 0.0)};
  }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory& memory, rod::Rod& rod) const override {
    const VectorXd now = strains(arm, instant.inputs);
    const VectorXd late = now - mean_of(followed(memory, now, values, instant));
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
  void begin(const arm::Arm& arm, const FineRod&, const Values&, const VectorXd& start,
             Memory& memory) const override {
    const auto segments = static_cast<Eigen::Index>(arm.segments.size());
    keep(Followed((kLeftStrain * start).transpose().replicate<kTimes, 1>()), VectorXd::Zero(segments),
         memory);
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod&, const Values& values, const Instant& instant,
                const Shape&, Memory& memory) const override {
    const VectorXd now = strains(arm, instant.inputs);
    keep(followed(memory, now, values, instant), now, memory);
  }

 private:
  static constexpr int kTimes = static_cast<int>(kRelaxation.size());
  /// What follows with each time, in rows; a column per segment.
  using Followed = Eigen::Matrix<double, kTimes, Eigen::Dynamic>;

  static void keep(const Followed& w, const VectorXd& last, Memory& memory) {
    memory.assign(static_cast<std::size_t>((kTimes + 1) * last.size()), 0.0);
    Eigen::Map<Eigen::MatrixXd> to(memory.data(), kTimes + 1, last.size());
    to << w, last.transpose();
  }
  /// At the beginning all has come that will, and what the trial found beyond that.
  static Followed followed(const Memory& memory, const VectorXd& now, const Values& values,
                           const Instant& instant) {
    if (memory.empty()) return now.transpose().replicate<kTimes, 1>();
    const Eigen::Map<const Eigen::MatrixXd> from(memory.data(), kTimes + 1, now.size());
    Followed w(kTimes, now.size());
    const Relaxing over = relaxing(instant.dt_s, values[1], values[2]);
    for (int k = 0; k < kTimes; ++k) {
      if (instant.dt_s <= 0.0) {
        w.row(k) = from.row(k) + now.transpose();
        continue;
      }
      const Following& f = over[static_cast<std::size_t>(k)];
      w.row(k) = f.kept * from.row(k) + f.weight_last * from.row(kTimes) + f.weight_now * now.transpose();
    }
    return w;
  }
  static VectorXd mean_of(const Followed& w) {
    VectorXd mean = VectorXd::Zero(w.cols());
    for (int k = 0; k < kTimes; ++k)
      mean += kRelaxation[static_cast<std::size_t>(k)].weight * w.row(k).transpose();
    return mean;
  }
};

}  // namespace

std::unique_ptr<Effect> make_axial_memory() {
  return std::make_unique<AxialMemory>(
      Info{"axial_memory",
           "the arm keeps lengthening or shortening while its inputs are held",
           "L = L0 (1 + e - share (e - w)), w the mean of w_i, time_i dw_i/dt = e - w_i, e the strain by the "
           "laws, times level over decades about time",
           "standard linear solid; R. M. Christensen, Theory of Viscoelasticity, 1982, isbn:0121742520",
           Family::kMemory,
           {{"share", "1", "of the strain by the laws, that comes late", 0.0, 0.98, 0.3},
            {"time_s", "s", "time constant, that in the middle where there are several", 0.1, 600.0, 10.0},
            {"decades", "1", "over which time constants are spread, each as often; 0: one", 0.0, 5.0, 0.0}},
           1,
           {"pressure_elongation", "creep", "pressure_lag"},
           {}});
}

}  // namespace softarm::effects
