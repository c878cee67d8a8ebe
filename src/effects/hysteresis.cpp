// Rate-independent loop, by Prandtl and Ishlinskii's operator: plays of graded radii (M. Brokate, J.
// Sprekels, Hysteresis and Phase Transitions, 1996). Between what is commanded and what acts,
//   acting = u - share (u - plays of u),
// or in the material, between curvature and moment, M = EI (u + share (u - plays of u)), the plays those of
// vectors. A cycle wide against the loop has branches that lie share times its width apart.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr int kPlays = 5;
constexpr double kRadii[kPlays] = {0.1, 0.3, 0.5, 0.7, 0.9};  // of the width, equally weighted
// The same share of these as the width is of kReferencePa.
constexpr double kReference_n = 4.0, kReference_rad = 0.6, kReference_per_m = 20.0;

double reference(InputKind kind) {
  return kind == InputKind::kTension ? kReference_n
         : kind == InputKind::kAngle ? kReference_rad
                                     : kReferencePa;
}

class Hysteresis : public Described {
 public:
  using Described::Described;
  bool applies_to(const Arm& arm) const override {
    return has(arm, InputKind::kPressure) || has(arm, InputKind::kTension) || has(arm, InputKind::kAngle);
  }
  std::vector<Values> grid(const Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double width_pa : {700.0, 2000.0, 6000.0}) list.push_back(Eigen::Vector3d(0.0, width_pa, 0.0));
    for (const double width_pa : {800.0, 2000.0, 5000.0}) list.push_back(Eigen::Vector3d(0.0, width_pa, 1.0));
    return list;
  }

  void drive(const Arm& arm, const Values& values, Series& series) const override {
    if (of_material(values) || values[0] == 0.0) return;
    for (Eigen::Index row = 0; row < series.inputs.rows(); ++row) {
      const InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(row)].kind;
      if (kind == InputKind::kVacuum) continue;
      const double width = values[1] / kReferencePa * reference(kind);
      loop(values[0], width, series.inputs.row(row));
      loop(values[0], width, series.moment_inputs.row(row));
    }
  }

  void act(const Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory& memory, rod::Rod& rod) const override {
    if (!of_material(values) || memory.empty()) return;
    const double share = values[0] / kPlays;
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      // Plays that slid go on sliding, those that did not stay: exact but for the instant of a turn.
      double stiffer = 1.0;
      Vector2d rest = rod.segments[j].rest_curvature_per_m.head<2>();
      for (int k = 0; k < kPlays; ++k) {
        const Play play = read(memory, j, k);
        if (play.slid) {
          rest -= share * play.strain;
        } else {
          stiffer += share;
          rest += share * play.at;
        }
      }
      rod.segments[j].bending_compliance /= stiffer;
      rod.segments[j].rest_curvature_per_m.head<2>() = rest / stiffer;
    }
  }
  bool remembers() const override { return true; }
  void remember(const Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape& shape,
                Memory& memory) const override {
    if (!of_material(values)) return;
    const double width = values[1] / kReferencePa * kReference_per_m;
    const bool begins = memory.empty();
    memory.resize(fine.pieces().size() * kPlays * kSize);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Vector2d u = shape.middles[j].u.head<2>();
      for (int k = 0; k < kPlays; ++k) {
        Play play;
        play.at = begins ? u : read(memory, j, k).at;
        play.strain = u - play.at;
        const double radius = kRadii[k] * width, beyond = play.strain.norm();
        play.slid = beyond > radius;
        if (play.slid) play.strain *= radius / beyond;
        play.at = u - play.strain;
        write(play, j, k, memory);
      }
    }
  }

 private:
  /// Of a section's material.
  struct Play {
    Vector2d at = Vector2d::Zero(), strain = Vector2d::Zero();  ///< curvature is their sum
    bool slid = false;
  };
  static constexpr std::size_t kSize = 5;

  static bool of_material(const Values& values) { return values[2] > 0.5; }

  static Play read(const Memory& memory, std::size_t piece, int play) {
    const double* from = &memory[(piece * kPlays + static_cast<std::size_t>(play)) * kSize];
    return {{from[0], from[1]}, {from[2], from[3]}, from[4] > 0.5};
  }
  static void write(const Play& play, std::size_t piece, int number, Memory& memory) {
    double* to = &memory[(piece * kPlays + static_cast<std::size_t>(number)) * kSize];
    to[0] = play.at.x();
    to[1] = play.at.y();
    to[2] = play.strain.x();
    to[3] = play.strain.y();
    to[4] = play.slid ? 1.0 : 0.0;
  }

  static void loop(double share, double width, Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) {
    double at[kPlays];
    std::fill_n(at, kPlays, row.size() > 0 ? row[0] : 0.0);
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
      "up and down differ: the arm lags behind what drives it by a loop that is the same at every speed",
      Family::kMemory,
      {{"share", "1", "of a loop of that width", -0.2, 5.0, 0.5},
       {"width_pa", "Pa",
        "width of the loop, of pressures; of tensions, angles and curvatures the same share of 4 N, 0.6 rad "
        "and "
        "20 / m as of 50 kPa",
        50.0, 50e3, 2500.0},
       {"of_material", "1", "0: between what is commanded and what acts; 1: between curvature and moment",
        0.0, 1.0, 0.0, true}},
      1,
      {"creep", "pressure_lag", "clock_offset"},
      {"moment_gain"}});
}

}  // namespace softarm::effects
