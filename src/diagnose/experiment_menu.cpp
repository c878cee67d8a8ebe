#include "experiment_menu.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/actuators/actuator.h"
#include "known_pull.h"
#include "policy.h"
#include "recorded_programme.h"
#include "sentences.h"

namespace softarm::diagnose {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using model::Block;
using model::TrialData;

class Menu {
 public:
  Menu(const arm::Arm& arm, const std::vector<TrialData>& trials, double block_s)
      : arm_(arm), from_(arm, trials, block_s) {}

  std::vector<Experiment> experiments() {
    if (!from_.usable()) return {};
    add_repeated();
    add_attitudes();
    add_speeds();
    add_bends();
    add_payloads();
    add_pulls();
    add_vacuum();
    add_body();
    add_clocks();
    return std::move(list_);
  }

 private:
  Experiment& add(std::string id, std::string action, TrialData data) {
    Experiment e;
    e.id = std::move(id);
    e.action = std::move(action);
    e.arm = arm_;
    e.trial = std::move(data);
    list_.push_back(std::move(e));
    return list_.back();
  }

  arm::InputKind kind(Eigen::Index input) const {
    return arm_.inputs.scalars[static_cast<std::size_t>(input)].kind;
  }
  std::string name() const { return from_.base().name; }
  std::string minding_payload() const {
    return from_.payload_kg() > 0.0
               ? fmt::format(" with a payload of {}", with_unit(from_.payload_kg(), "kg"))
               : "";
  }

  void add_repeated() {
    add("repeat", fmt::format("Record {} once more{}", name(), minding_payload()),
        from_.repeated(from_.gravity(), 1.0, from_.payload_kg()));
  }

  /// The direction in which the first input that bends the arm bends it, and its name.
  std::pair<double, std::string> first_direction() const {
    const arm::Segment& segment = arm_.segments.front();
    for (const arm::ActuatorKind* kind : arm::actuator_kinds()) {
      if (kind->count(segment) == 0) continue;
      if (const auto azimuth_rad = kind->bending_direction_rad(segment, 0))
        return {*azimuth_rad, kind->input(segment, 0)};
    }
    return {0.0, ""};
  }

  void add_attitudes() {
    const auto [azimuth, input] = first_direction();
    const Vector3d along = Vector3d::UnitZ();
    const auto across = [&, &azimuth = azimuth](double angle) {
      return Vector3d(std::cos(azimuth + angle), std::sin(azimuth + angle), 0.0);
    };
    const auto bends = [&, &input = input](const std::string& where, const std::string& axis) {
      return input.empty() ? fmt::format("the base's x axis {}", axis)
                           : fmt::format("{} bending it {}", input, where);
    };
    const struct {
      std::string id, description;
      Vector3d gravity;
    } all[] = {
        {"attitude_hanging", "hanging straight down", along},
        {"attitude_standing", "standing straight up", -along},
        {"attitude_side_down", "on its side, " + bends("downwards", "down"), across(0.0)},
        {"attitude_side_up", "on its side, " + bends("upwards", "up"), across(M_PI)},
        {"attitude_side_level", "on its side, " + bends("sideways", "level"), across(M_PI_2)},
        {"attitude_tilted", "tilted by 45 degrees from hanging, " + bends("downwards", "down"),
         (along + across(0.0)).normalized()},
    };
    for (const auto& attitude : all) {
      const bool known =
          std::any_of(from_.trials().begin(), from_.trials().end(), [&](const TrialData& recorded) {
            return std::any_of(recorded.blocks.begin(), recorded.blocks.end(), [&](const Block& block) {
              return block.gravity_base.normalized().dot(attitude.gravity) >
                     std::cos(kPolicy.experiment.new_attitude_rad);
            });
          });
      if (known) continue;
      add(attitude.id,
          fmt::format("Mount the arm {}, and repeat {}{}", attitude.description, name(), minding_payload()),
          from_.repeated(attitude.gravity, 1.0, from_.payload_kg()));
    }
  }

  void add_speeds() {
    const struct {
      std::string id, description;
      double factor;
    } all[] = {{"faster_2", "twice as fast", 2.0},
               {"faster_4", "four times as fast", 4.0},
               {"slower_3", "at a third of the speed", 1.0 / 3.0}};
    for (const auto& speed : all) {
      add(speed.id,
          fmt::format("Repeat {}{}, its inputs changing {}", name(), minding_payload(), speed.description),
          from_.repeated(from_.gravity(), speed.factor, from_.payload_kg()));
    }
  }

  /// At rest, to `to` within kPolicy.experiment.move_s, that held, and back.
  TrialData bend(const VectorXd& to, double hold_s, int times) const {
    const double period_s = 2.0 * kPolicy.experiment.move_s + hold_s;
    return from_.trial(kPolicy.experiment.rest_s + times * period_s + kPolicy.experiment.after_s,
                       from_.gravity(), [&, period_s, hold_s, times](double t_s) {
                         double share = 0.0;
                         const double since_s = t_s - kPolicy.experiment.rest_s;
                         if (since_s > 0.0 && since_s < times * period_s) {
                           const double in_s = std::fmod(since_s, period_s);
                           share = std::min({1.0, in_s / kPolicy.experiment.move_s,
                                             (period_s - in_s) / kPolicy.experiment.move_s});
                         }
                         share = share * share * (3.0 - 2.0 * share);
                         return Driven{(1.0 - share) * from_.rest() + share * to, from_.payload_kg()};
                       });
  }

  void add_bends() {
    const std::string as_far =
        fmt::format("as far as {} did at {:.1f} s{}", name(), from_.peak_s(), minding_payload());
    if ((from_.peak() - from_.rest()).lpNorm<Eigen::Infinity>() >
        kPolicy.experiment.moved * from_.peak().lpNorm<Eigen::Infinity>()) {
      add("hold",
          fmt::format("Bend the arm {}, hold that for {:.0f} s, let go and wait for {:.0f} s", as_far,
                      kPolicy.experiment.hold_s, kPolicy.experiment.after_s),
          bend(from_.peak(), kPolicy.experiment.hold_s, 1));
      add("cycle",
          fmt::format("Bend the arm {} and back, {} times from rest, {:.0f} s each way", as_far,
                      kPolicy.experiment.cycles, kPolicy.experiment.move_s),
          bend(from_.peak(), 0.0, kPolicy.experiment.cycles));
    }
    VectorXd all = from_.rest();
    double level = 1e300;
    int chambers = 0;
    for (Eigen::Index k = 0; k < all.size(); ++k) {
      if (kind(k) != arm::InputKind::kPressure) continue;
      level = std::min(level, from_.high()[k]);
      ++chambers;
    }
    if (chambers < 2 || !(level > 0.0)) return;
    // Together they stiffen and stretch the arm and hardly bend it.
    for (Eigen::Index k = 0; k < all.size(); ++k)
      if (kind(k) == arm::InputKind::kPressure) all[k] = level;
    add("together",
        fmt::format(
            "Raise all pressures together to {}{} and let them fall again, {} times, {:.0f} s each way",
            with_unit(level, "Pa"), minding_payload(), kPolicy.experiment.cycles, kPolicy.experiment.move_s),
        bend(all, 0.0, kPolicy.experiment.cycles));
  }

  /// What a pull may be: no more than what the arm is known to bear, its own weight or the heaviest payload
  /// that was on it.
  double most_pull_n() const {
    const double kg = std::max(mass_kg(arm_), from_.most_payload_kg());
    const double most_kg = arm_.payload.range_kg.high;
    return arm_.gravity_m_s2.norm() * (kg > 0.0 ? std::min(kg, most_kg) : most_kg);
  }

  /// A payload to take where more is wanted than was recorded; nothing where the arm cannot bear it.
  double heavier_kg() const {
    const double more = std::max(kPolicy.experiment.payload_times * from_.most_payload_kg(),
                                 from_.most_payload_kg() + kPolicy.experiment.payload_share * mass_kg(arm_));
    return std::min(more, arm_.payload.range_kg.high);
  }

  void add_payloads() {
    const double heavy = heavier_kg();
    if (heavy > kPolicy.experiment.payload_heavier * from_.payload_kg())
      add("payload_heavier", fmt::format("Hang {} on the arm and repeat {}", with_unit(heavy, "kg"), name()),
          from_.repeated(from_.gravity(), 1.0, heavy));
    if (from_.payload_kg() > 0.0 && arm_.payload.range_kg.low <= 0.0)
      add("payload_none", fmt::format("Take the payload off and repeat {}", name()),
          from_.repeated(from_.gravity(), 1.0, 0.0));
    const double kg = from_.most_payload_kg() > 0.0 ? from_.most_payload_kg() : heavy;
    if (!(kg > 0.0)) return;
    const double beside_m = kPolicy.experiment.bracket * arm_.total_length_m();
    const auto [azimuth, input] = first_direction();
    const Vector3d direction(std::cos(azimuth), std::sin(azimuth), 0.0);
    Experiment& e = add(
        "payload_beside",
        fmt::format("Hang {} on a bracket that holds it {} beside the tip's axis{}, and repeat {}",
                    with_unit(kg, "kg"), with_unit(beside_m, "m"),
                    input.empty() ? "" : ", on the side towards which " + input + " bends the arm", name()),
        from_.repeated(from_.gravity(), 1.0, kg));
    e.arm.payload.offset_m += beside_m * direction;
  }

  void add_pulls() {
    double softest = 1e300;
    for (const arm::Segment& segment : arm_.segments)
      softest = std::min(softest, arm::unloaded_stiffness_nm2(segment));
    const double length = arm_.total_length_m();
    const double force_n =
        std::min(kPolicy.experiment.pull_bend * softest / (length * length), most_pull_n());
    if (!(force_n > 0.0)) return;
    const auto [azimuth, input] = first_direction();
    for (const bool beside : {false, true}) {
      const double angle = azimuth + (beside ? M_PI_2 : 0.0);
      const std::string where = input.empty() ? fmt::format("along the base's {} axis", beside ? "y" : "x")
                                              : fmt::format("{} the direction in which {} bends the arm",
                                                            beside ? "across" : "in", input);
      Experiment& e =
          add(beside ? "pull_across" : "pull_along",
              fmt::format("Pull at the tip with {} by a long thread over a pulley, {}, and repeat {}{}",
                          with_unit(force_n, "N"), where, name(), minding_payload()),
              from_.repeated(from_.gravity(), 1.0, from_.payload_kg()));
      e.loads.push_back(
          std::make_shared<KnownPull>(force_n * Vector3d(std::cos(angle), std::sin(angle), 0.0)));
    }
  }

  void add_vacuum() {
    VectorXd evacuated = from_.rest();
    double most = 0.0;
    for (Eigen::Index k = 0; k < evacuated.size(); ++k) {
      if (kind(k) != arm::InputKind::kVacuum) continue;
      evacuated[k] = from_.high()[k];
      most = std::max(most, from_.high()[k]);
    }
    if (!(most > kPolicy.experiment.least_vacuum_pa))
      return;  // an arm without, or one whose vacuum was never on
    const auto& by = kPolicy.experiment;
    const double vent_s = by.let_go_s + by.move_s + by.jammed_wait_s;
    const auto ramp = [](double t_s, double from_s, double takes_s) {
      return std::clamp((t_s - from_s) / takes_s, 0.0, 1.0);
    };
    add("vacuum_while_bent",
        fmt::format(
            "Bend the arm as far as {} did at {:.1f} s{}, then apply {} of vacuum, let the other inputs go "
            "and wait for {:.0f} s, then let the vacuum go",
            name(), from_.peak_s(), minding_payload(), with_unit(most, "Pa"), by.jammed_wait_s),
        from_.trial(vent_s + by.jam_s + by.after_s, from_.gravity(), [&](double t_s) {
          const double bent = ramp(t_s, by.rest_s, by.move_s) - ramp(t_s, by.let_go_s, by.move_s);
          const double jammed = ramp(t_s, by.jam_at_s, by.jam_s) - ramp(t_s, vent_s, by.jam_s);
          Driven now{(1.0 - bent) * from_.rest() + bent * from_.peak(), from_.payload_kg()};
          for (Eigen::Index k = 0; k < now.inputs.size(); ++k) {
            if (kind(k) == arm::InputKind::kVacuum)
              now.inputs[k] = (1.0 - jammed) * from_.low()[k] + jammed * evacuated[k];
          }
          return now;
        }));
  }

  /// In the widest gap between those that there are.
  void add_body() {
    std::vector<double> places{0.0};
    for (const arm::MeasuredBody& body : arm_.bodies) places.push_back(body.arclength_m);
    std::sort(places.begin(), places.end());
    double gap_m = 0.0, place_m = 0.0;
    for (std::size_t i = 1; i < places.size(); ++i) {
      if (places[i] - places[i - 1] > gap_m) {
        gap_m = places[i] - places[i - 1];
        place_m = 0.5 * (places[i] + places[i - 1]);
      }
    }
    double sd_m = 0.0;
    for (const double one : from_.white_sd_m()) sd_m = std::max(sd_m, one);
    if (!(gap_m > 0.0) || !(sd_m > 0.0)) return;
    Experiment& e = add("one_more_body",
                        fmt::format("Put one more body on the arm, {:.0f} mm from the base, and repeat {}{}",
                                    1e3 * place_m, name(), minding_payload()),
                        from_.repeated(from_.gravity(), 1.0, from_.payload_kg()));
    arm::MeasuredBody body;
    body.name = "one_more";
    body.arclength_m = place_m;
    body.position_sd_m = arm_.bodies.front().position_sd_m;
    e.arm.bodies.push_back(body);
    model::Seen seen;
    seen.body = static_cast<int>(arm_.bodies.size());
    seen.white_sd_m = sd_m;
    for (Block& block : e.trial.blocks) {
      seen.frames = static_cast<int>(block.last - block.first);
      block.bodies.push_back(seen);
    }
  }

  void add_clocks() {
    if (arm_.inputs.scalars.empty()) return;
    Experiment& e =
        add("clocks",
            fmt::format("Let both clocks stamp one event, such as a lamp in the cameras' view that the "
                        "inputs' recorder switches, to {:.0f} ms, and record {} once more{}",
                        1e3 * kPolicy.experiment.clock_sd_s, name(), minding_payload()),
            from_.repeated(from_.gravity(), 1.0, from_.payload_kg()));
    e.clock_sd_s = kPolicy.experiment.clock_sd_s;
  }

  const arm::Arm& arm_;
  const RecordedProgramme from_;
  std::vector<Experiment> list_;
};

}  // namespace

std::vector<Experiment> experiment_menu(const arm::Arm& arm, const std::vector<TrialData>& trials,
                                        double block_s) {
  return Menu(arm, trials, block_s).experiments();
}

}  // namespace softarm::diagnose
