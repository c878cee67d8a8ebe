// Rate-independent loop, by Prandtl and Ishlinskii's operator: plays of graded radii (M. Brokate, J.
// Sprekels, Hysteresis and Phase Transitions, 1996). Between what is commanded and what acts,
//   acting = u - share (u - plays of u),
// or in the material, between curvature and moment, M = EI (u + share (u - plays of u)), the plays those of
// vectors. A cycle wide against the loop has branches that lie share times its width apart. Walls have it
// under every input; in one chamber alone it is its valve that sticks.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr int kPlays = 5;
constexpr double kRadii[kPlays] = {0.1, 0.3, 0.5, 0.7, 0.9};  // of the width, equally weighted
// The same share of these as the width is of kReferencePa.
constexpr double kReference_n = 4.0, kReference_rad = 0.6, kReference_per_m = 20.0;
constexpr int kChamber = 3;  // parameter `chamber`

/// Where the loop is: the parameter `of`.
enum class Of { kPressures = 0, kMaterial = 1, kTensions = 2, kAngles = 3 };

Of of(const Values& values) {
  return static_cast<Of>(std::clamp(static_cast<int>(std::lround(values[2])), 0, 3));
}

class Hysteresis : public Described {
 public:
  using Described::Described;
  bool has_parameter(const arm::Arm& arm, int parameter) const override {
    return parameter != kChamber || has(arm, arm::InputKind::kPressure);
  }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    const auto add = [&](Of where, double chamber, std::initializer_list<double> widths_pa) {
      for (const double width_pa : widths_pa)
        list.push_back(Eigen::Vector4d(0.0, width_pa, static_cast<double>(where), chamber));
    };
    const Rows pressures = rows_of(arm, arm::InputKind::kPressure);
    if (!pressures.empty())
      for (const double chamber : chamber_numbers(arm, pressures))
        add(Of::kPressures, chamber, {700.0, 2000.0, 6000.0});
    if (has(arm, arm::InputKind::kTension)) add(Of::kTensions, 0.0, {700.0, 2000.0, 6000.0});
    if (has(arm, arm::InputKind::kAngle)) add(Of::kAngles, 0.0, {700.0, 2000.0, 6000.0});
    add(Of::kMaterial, 0.0, {800.0, 2000.0, 5000.0});
    return list;
  }

  std::vector<StartNumber> starts(const arm::Arm& arm, const Values& values) const override {
    const Of where = of(values);
    // As a share of the loop's width.
    const auto anywhere = [](const arm::Segment&) { return kAnywhere; };
    std::vector<StartNumber> numbers;
    if (where == Of::kMaterial) {
      numbers = curvature_starts(arm, any_segment, anywhere);
      for (StartNumber& number : numbers) number.unit = "1";
      return numbers;
    }
    for (const Eigen::Index row : looping_rows(arm, values))
      numbers.push_back({arm.inputs.scalars[static_cast<std::size_t>(row)].name, "1", kAnywhere});
    return numbers;
  }
  void begin(const arm::Arm& arm, const FineRod& fine, const Values& values, const Eigen::VectorXd& start,
             Memory& memory) const override {
    if (of(values) != Of::kMaterial) return;
    const auto shares = started_curvatures(arm, any_segment, starts(arm, values), start);
    const double width = values[1] / kReferencePa * kReference_per_m;
    memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      Vector2d share = shares[static_cast<std::size_t>(fine.pieces()[j].segment)];
      if (share.norm() > 1.0) share.normalize();
      for (int k = 0; k < kPlays; ++k) {
        // Until the first instant has told the curvature, plays are where they are from it.
        double* play = &memory[j * kSize] + 2 + 3 * k;
        play[0] = -kRadii[k] * width * share.x();
        play[1] = -kRadii[k] * width * share.y();
      }
    }
  }

  bool looks_back() const override { return true; }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    const Of where = of(values);
    if (where == Of::kMaterial || values[0] == 0.0) return;
    const double reference = where == Of::kTensions ? kReference_n
                             : where == Of::kAngles ? kReference_rad
                                                    : kReferencePa;
    Eigen::Index number = 0;
    for (const Eigen::Index row : looping_rows(arm, values)) {
      const double start = series.start.size() > 0 ? kAnywhere * series.start[number++] : 0.0;
      loop(values[0], values[1] / kReferencePa * reference, start, series.inputs.row(row));
      loop(values[0], values[1] / kReferencePa * reference, start, series.moment_inputs.row(row));
    }
  }

  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory& memory, rod::Rod& rod) const override {
    if (of(values) != Of::kMaterial || memory.empty()) return;
    const double share = values[0] / kPlays;
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double* piece = &memory[j * kSize];
      const Vector2d last(piece[0], piece[1]);
      double stiffer = 1.0;
      Vector2d rest = rod.segments[j].rest_curvature_per_m.head<2>();
      for (int k = 0; k < kPlays; ++k) {
        const double *play = piece + 2 + 3 * k, held = play[2];
        const Vector2d strain = last - Vector2d(play[0], play[1]);
        // M = ... + EI share (strain + held (u - last))
        stiffer += share * held;
        rest -= share * (strain - held * last);
      }
      rod.segments[j].bending_compliance /= stiffer;
      rod.segments[j].rest_curvature_per_m.head<2>() = rest / stiffer;
    }
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm&, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    if (of(values) != Of::kMaterial) return;
    const double width = values[1] / kReferencePa * kReference_per_m;
    const bool begins = memory.empty() || instant.dt_s <= 0.0;
    memory.resize(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      double* piece = &memory[j * kSize];
      const Vector2d u = shape.middles[j].u.head<2>();
      const Vector2d moved = begins ? Vector2d(Vector2d::Zero()) : Vector2d(u - Vector2d(piece[0], piece[1]));
      piece[0] = u.x();
      piece[1] = u.y();
      for (int k = 0; k < kPlays; ++k) {
        double* play = piece + 2 + 3 * k;
        Vector2d strain = (begins ? Vector2d(Vector2d::Zero()) : u) - Vector2d(play[0], play[1]);
        const double radius = kRadii[k] * width, beyond = strain.norm();
        // How much of the play's stiffness there is in the next step, if it goes on as this one did: all of
        // it while the play holds; once it slides, none along the strain and all across it.
        double held = 1.0;
        if (beyond > radius * (1.0 + 1e-9)) {
          const double along = moved.dot(strain) / beyond;
          held = moved.isZero() ? 1.0 : std::clamp(1.0 - along * along / moved.squaredNorm(), 0.0, 1.0);
          strain *= radius / beyond;
        }
        play[0] = u.x() - strain.x();
        play[1] = u.y() - strain.y();
        play[2] = held;
      }
    }
  }

 private:
  static constexpr std::size_t kSize = 2 + 3 * kPlays;  ///< of a piece: curvature, then where each play is

  static arm::InputKind kind_of(Of where) {
    return where == Of::kTensions ? arm::InputKind::kTension
           : where == Of::kAngles ? arm::InputKind::kAngle
                                  : arm::InputKind::kPressure;
  }

  /// The inputs that have the loop.
  static Rows looping_rows(const arm::Arm& arm, const Values& values) {
    const Of where = of(values);
    const Rows rows = rows_of(arm, kind_of(where));
    return where == Of::kPressures ? rows_of_chamber(arm, rows, values[kChamber]) : rows;
  }

  /// @param start how far it is strained, as a share of its width, before anything moved
  static void loop(double share, double width, double start,
                   Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) {
    double at[kPlays];
    for (int k = 0; k < kPlays; ++k)
      at[k] = (row.size() > 0 ? row[0] : 0.0) - std::clamp(start, -1.0, 1.0) * kRadii[k] * width;
    for (Eigen::Index i = 0; i < row.size(); ++i) {
      double mean = 0.0;
      for (int k = 0; k < kPlays; ++k) {
        const double radius = kRadii[k] * width;
        at[k] = std::clamp(at[k], row[i] - radius, row[i] + radius);
        mean += at[k] / kPlays;
      }
      row[i] -= share * (row[i] - mean);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_hysteresis() {
  return std::make_unique<Hysteresis>(Info{
      "hysteresis",
      "up and down differ: the arm lags behind its inputs by a loop that is the same at every speed, as from "
      "friction in the wall or valves that stick",
      "acting = u - share (u - P[u]), u all inputs of a kind or one chamber's; or M = EI (u + share (u - "
      "P[u])); P: mean of plays of graded radii",
      "operator of Prandtl and Ishlinskii; M. Brokate, J. Sprekels, Hysteresis and Phase Transitions, 1996, "
      "doi:10.1007/978-1-4612-4048-8",
      Family::kMemory,
      {{"share", "1", "of a loop of that width", -0.2, 5.0, 0.5},
       {"width_pa", "Pa",
        "width of the loop; 1 kPa stands for 0.4 / m of curvature, 80 mN of tension, 12 mrad of angle", 50.0,
        50e3, 2500.0},
       {"of", "1", "what has the loop (0: pressures, 1: the material's curvature, 2: tensions, 3: angles)",
        0.0, 3.0, 0.0, true},
       chamber_parameter()},
      1,
      {"creep", "pressure_lag", "clock_offset"},
      {"moment_gain"}});
}

}  // namespace softarm::effects
