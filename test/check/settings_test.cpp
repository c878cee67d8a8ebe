// Every setting that a finding can propose, followed to the letter: the arm file or the layout takes it.
#include "check/settings.h"

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "check_fixture.h"
#include "softarm/arm/arm_file.h"
#include "trial/csv_layout.h"

namespace softarm {
namespace {

using namespace testing_check;

constexpr char kArm[] = R"(
format: 1
name: hanging
base: {body: base, rod_in_body: {rpy_deg: [0, 0, 0]}}
segments:
  - name: upper
    length_m: 0.2
    length_range_m: [0.19, 0.21]
    mass_per_length_kg_m: 0.1
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.03}
    chambers:
      - {input: chamber_1, bending_direction_deg: 0, moment_gain_nm_per_pa: 8.0e-6}
      - {input: chamber_2, bending_direction_deg: 180, moment_gain_nm_per_pa: 8.0e-6}
payload: {arclength_m: 0.2}
noise: {position_sd_m: 0.0002, orientation_sd_rad: 0.01}
bodies:
  - {name: ring_1, arclength_m: 0.0666667, orientation_usable: true, section_in_body: {rpy_deg: [0, 0, 0]}}
  - {name: ring_2, arclength_m: 0.1333333, orientation_usable: true, position_sd_m: 0.0002}
  - {name: ring_3, arclength_m: tip, orientation_usable: true}
inputs:
  pressures:
    - {name: chamber_1, topic: /pressure/chamber_1}
    - {name: chamber_2, topic: /pressure/chamber_2}
)";

constexpr char kImportLayout[] = R"(
time: {column: 1, unit: s}
mocap:
  unit: m
  up: y
  bodies:
    - {name: base, position: [2, 3, 4], orientation: [5, 6, 7, 8], orientation_order: xyzw}
    - {name: ring_3, position: [9, 10, 11]}
pressures:
  unit: psi
  reference: gauge
  inputs: [{topic: /pressure/chamber_1, column: 12}, {topic: /pressure/chamber_2, column: 13}]
)";

/// Entry of a list by its number, or by its name or topic.
YAML::Node entry(const YAML::Node& list, const std::string& which) {
  if (which.find_first_not_of("0123456789") == std::string::npos)
    return list[static_cast<std::size_t>(std::stoul(which))];
  for (YAML::Node item : list) {
    for (const char* key : {"name", "topic"}) {
      if (item[key] && item[key].as<std::string>() == which) return item;
    }
  }
  throw std::runtime_error("no entry " + which);
}

void set(YAML::Node node, std::string path, const std::string& value) {
  static const std::regex kStep(R"(^([a-z_0-9]+)(\[([^\]]+)\])?(\.|$))");
  for (std::smatch step; std::regex_search(path, step, kStep);) {
    const std::string key = step[1], which = step[3];
    const bool last = step.suffix().str().empty() && !step[2].matched;
    if (last) {
      node[key] = YAML::Load(value);
      if (key == "orientation_order" || key == "fixed_orientation") {
        node.remove("orientation");  // as the layout's template says of it: in place of both
        node.remove("orientation_order");
      }
      return;
    }
    node.reset(step[2].matched ? entry(node[key], which) : node[key]);
    path = step.suffix();
  }
  throw std::runtime_error("cannot be followed: " + path);
}

struct Step {
  std::string path, value;
  bool of_layout = false;
};

std::vector<Step> steps_of(std::string setting) {
  static const std::string kOfTheLayout = " (of the layout)";
  std::vector<Step> steps;
  while (!setting.empty()) {
    const std::size_t end = setting.find("; ");
    std::string one = setting.substr(0, end);
    setting = end == std::string::npos ? "" : setting.substr(end + 2);
    const bool of_layout =
        one.size() > kOfTheLayout.size() &&
        one.compare(one.size() - kOfTheLayout.size(), kOfTheLayout.size(), kOfTheLayout) == 0;
    if (of_layout) one.resize(one.size() - kOfTheLayout.size());
    const std::size_t colon = one.find(": ");
    EXPECT_NE(colon, std::string::npos) << one;
    if (colon != std::string::npos) steps.push_back({one.substr(0, colon), one.substr(colon + 2), of_layout});
  }
  return steps;
}

/// Applies a setting to the document that it is of.
void follow(const check::CheckFinding& finding, YAML::Node arm_file, YAML::Node layout) {
  for (const Step& step : steps_of(finding.setting)) {
    try {
      set(step.of_layout ? layout : arm_file, step.path, step.value);
    } catch (const std::exception& e) {
      FAIL() << finding.id << ": " << step.path << ": " << e.what();
    }
  }
}

arm::Arm loaded(const YAML::Node& arm_file, const YAML::Node& layout, const std::string& what,
                const arm::Arm& before) {
  try {
    trial::parse_csv_layout(YAML::Dump(layout), "layout");
    return arm::parse_arm(YAML::Dump(arm_file), "arm");
  } catch (const std::exception& e) {
    ADD_FAILURE() << what << "\n" << e.what();
    return before;
  }
}

/// Applies the settings of a finding to both documents and loads them.
void follow(const check::CheckFinding& finding, const std::string& arm_text, arm::Arm* arm) {
  YAML::Node arm_file = YAML::Load(arm_text), layout = YAML::Load(kImportLayout);
  follow(finding, arm_file, layout);
  *arm = loaded(arm_file, layout, finding.id + ": " + finding.setting, *arm);
}

struct Spoilt {
  std::string id;
  std::function<void(trial::CheckRecording&)> spoil;
  std::function<void(std::string&)> arm_file = {};  ///< the arm file that it is held against, where another
  bool repairs = true;                              ///< the finding is gone where the setting was followed
};

void replace(std::string& text, const std::string& was, const std::string& is) {
  const std::size_t where = text.find(was);
  ASSERT_NE(where, std::string::npos) << was;
  text.replace(where, was.size(), is);
}

template <typename Samples>
void drop(Samples& samples, double from_s, double to_s) {
  samples.erase(
      std::remove_if(samples.begin(), samples.end(),
                     [&](const auto& s) { return s.stamp_s > kStart + from_s && s.stamp_s < kStart + to_s; }),
      samples.end());
}

void turn(trial::CheckRecording& r, std::size_t body, double angle, const Eigen::Vector3d& axis,
          std::size_t from = 0, std::size_t to = 1u << 30, std::size_t every = 1) {
  auto& poses = r.bodies[body];
  for (std::size_t k = from; k < std::min(to, poses.size()); k += every)
    *poses[k].q_mocap = *poses[k].q_mocap * Eigen::AngleAxisd(angle, axis);
}

/// Tensions and angles in place of the pressures, of the same courses.
void of_kind(std::string& text, const std::string& list, const std::string& drive) {
  replace(text, "  pressures:", "  " + list + ":");
  replace(text, "    chambers:", "    " + drive + ":");
  const bool tendons = drive == "tendons";
  for (int i = 0; i < 2; ++i)
    replace(text, "moment_gain_nm_per_pa: 8.0e-6",
            tendons ? "offset_m: 0.01" : "curvature_gain_per_m_rad: 1");
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(),
                      kZ = Eigen::Vector3d::UnitZ();

std::vector<Spoilt> of_stamps_and_topics() {
  using R = trial::CheckRecording;
  const auto topic = [](R& r, const std::string& feeds) -> trial::RecordedTopic& {
    return *std::find_if(r.topics.begin(), r.topics.end(), [&](const auto& t) { return t.feeds == feeds; });
  };
  const auto move_stamps = [](R& r, double by_s) {
    for (auto& body : r.bodies) {
      for (auto& pose : body) pose.stamp_s += by_s;
    }
  };
  return {
      {"missing_topic",
       [=](R& r) {
         topic(r, "ring_2").found_type.clear();
         r.bodies[2].clear();
         r.other_topics["/mocap/ring2/pose"] = "geometry_msgs/PoseStamped";
       },
       {},
       false},
      {"missing_topic",
       [=](R& r) {
         r.topics.push_back({"/pressure/chamber_1", "sensor_msgs/FluidPressure", "chamber_1", "", 0});
         r.other_topics["/pressure/chamber1"] = "sensor_msgs/FluidPressure";
         r.inputs[0].clear();
       },
       {},
       false},
      {"missing_topic",
       [=](R& r) {
         topic(r, "base").found_type.clear();
         r.bodies[0].clear();
         r.other_topics["/vrpn_client_node/base/pose"] = "geometry_msgs/PoseStamped";
       },
       {},
       false},
      {"wrong_type",
       [=](R& r) {
         topic(r, "base").found_type = "geometry_msgs/TransformStamped";
         r.bodies[0].clear();
       },
       {},
       false},
      {"wrong_type",
       [=](R& r) {
         r.topics.push_back(
             {"/pressure/chamber_1", "sensor_msgs/FluidPressure", "chamber_1", "std_msgs/Float64", 9});
         r.inputs[0].clear();
       },
       {},
       false},
      {"gap",
       [](R& r) {
         for (auto& input : r.inputs) drop(input, 6.0, 7.5);
       }},
      {"split_frames",
       [](R& r) {
         for (auto& pose : r.bodies[3]) pose.stamp_s += 0.0035;
       }},
      {"other_epoch", [=](R& r) { move_stamps(r, 100.0); }},
      {"other_epoch", [=](R& r) { move_stamps(r, 1e5); }, {}, false},
      {"other_epoch",
       [=](R& r) {
         for (auto& v : r.inputs[0]) v.stamp_s -= 500.0;
       }},
      {"stamps_ahead", [=](R& r) { move_stamps(r, 0.02); }},
      {"clock_offset_or_lag", [](R& r) { r = clean(7, 0.2); }},
      {"clock_offset_or_lag",
       [](R& r) {
         r = clean(7, -0.12);
         for (auto& body : r.bodies) {
           for (auto& pose : body) pose.receipt_s += 0.15;
         }
       }},
      {"clocks_apart",
       [](R& r) {
         r = clean(7, 30.0, {150.0, [](int i, double t) {
                               return 12e3 * (1.0 + std::sin(0.9 * t + 3.0 * std::sin(0.11 * t) + i) *
                                                        std::sin(0.023 * t));
                             }});
       }},
  };
}

std::vector<Spoilt> of_bodies() {
  using R = trial::CheckRecording;
  const auto skin = [](std::string& text) {
    replace(text, "{name: ring_3, arclength_m: tip, orientation_usable: true}",
            "{name: ring_3, arclength_m: tip, kind: skin_marker, angle_deg: 0, radius_m: 0.0}");
  };
  const auto end_orientation = [](std::string& text) { text += "estimator: {method: end_orientation}\n"; };
  const auto spikes = [](std::size_t body) {
    return [=](R& r) { turn(r, body, 0.9, kX, at(2), 1u << 30, 50); };
  };
  return {
      {"no_orientation",
       [](R& r) {
         for (auto& pose : r.bodies[3]) pose.q_mocap.reset();
       }},
      {"turned_over", [](R& r) { turn(r, 3, M_PI, kX, at(6), at(8)); }, {}, false},
      {"turned_over", [](R& r) { turn(r, 0, M_PI, kX, at(6), at(8)); }},
      {"quaternion_spikes", spikes(3), {}, false},
      {"quaternion_spikes", spikes(3), skin, false},
      {"quaternion_spikes", spikes(3), end_orientation, false},
      {"quaternion_spikes", spikes(0)},
      {"repeated_poses",
       [](R& r) {
         for (auto& body : r.bodies) {
           for (std::size_t k = 1; k < body.size(); k += 2) {
             body[k].p_mocap = body[k - 1].p_mocap;
             body[k].q_mocap = body[k - 1].q_mocap;
           }
         }
       },
       {},
       false},
      {"body_order", [](R& r) { std::swap(r.bodies[1], r.bodies[2]); }, {}, false},
      {"length_unit",
       [](R& r) {
         for (auto& body : r.bodies) {
           for (auto& pose : body) pose.p_mocap *= 1000.0;
         }
       },
       {},
       false},
      {"base_upside_down", [](R& r) { turn(r, 0, M_PI, kY); }},
      {"base_attitude", [](R& r) { turn(r, 0, M_PI / 2, kX); }},
      {"base_attitude", [](R& r) { r.bodies[0].clear(); },
       [](std::string& text) {
         replace(text, "{body: base, rod_in_body: {rpy_deg: [0, 0, 0]}}",
                 "{fixed: {position_m: [0.1, -0.2, 1], attitude: horizontal}}");
       }},
      {"tangent_backwards", [](R& r) { turn(r, 1, M_PI, kY); }},
      {"turned_about_tangent", [](R& r) { turn(r, 3, M_PI, kZ); }},
      {"stretched", [](R&) {},
       [](std::string& text) {
         for (const auto& [was, is] :
              std::map<std::string, std::string>{{"length_m: 0.2\n", "length_m: 0.19\n"},
                                                 {"[0.19, 0.21]", "[0.188, 0.192]"},
                                                 {"0.0666667", "0.06333"},
                                                 {"0.1333333", "0.12667"},
                                                 {"arclength_m: 0.2}", "arclength_m: 0.19}"}})
           replace(text, was, is);
       }},
      {"stretched", [](R&) {},
       [](std::string& text) {
         for (const auto& [was, is] :
              std::map<std::string, std::string>{{"length_m: 0.2\n", "length_m: 0.21\n"},
                                                 {"0.0666667", "0.07"},
                                                 {"0.1333333", "0.14"},
                                                 {"arclength_m: 0.2}", "arclength_m: 0.21}"}})
           replace(text, was, is);
       }},
      {"ring_misplaced", [](R&) {}, [](std::string& text) { replace(text, "0.1333333", "0.1373333"); }},
      {"ring_misplaced",
       [](R& r) {  // beyond the arm's end, where the arm file takes no ring
         for (auto& pose : r.bodies[3]) pose.p_mocap.z() -= 0.006;
       },
       {},
       false},
      {"noise_understated", [](R&) {}, [](std::string& text) { replace(text, "0.0002, or", "0.0001, or"); },
       false},
      {"ring_wanders",
       [](R& r) {
         for (std::size_t k = 0; k < r.bodies[2].size(); ++k) {
           const double phase = 2.8 * static_cast<double>(k) / kRate;
           const Eigen::Vector3d off =
               7e-4 * Eigen::Vector3d(std::sin(phase), std::sin(phase + 2.0), std::sin(1.3 * phase));
           r.bodies[2][k].p_mocap += off;
           if (k % 10 == 0) r.frames[k / 10].bodies[1].p_mocap += off;
         }
       },
       {},
       false},
      {"correlated_noise",
       [](R& r) {
         for (std::size_t b = 1; b < 4; ++b) {
           for (std::size_t k = 0; k < r.bodies[b].size(); ++k)
             r.bodies[b][k].p_mocap.y() += 4e-4 * std::sin(16.0 * static_cast<double>(k) / kRate + 1.0 * b);
         }
       },
       {},
       false},
      {"tangent_off",
       [](R& r) {
         std::mt19937 random(2);
         std::normal_distribution<double> normal;
         double off = 0.0;
         std::size_t frame = 0;
         for (std::size_t k = 0; k < r.bodies[3].size(); ++k) {
           off += -0.02 * off + 0.2 * 0.08 * normal(random);
           *r.bodies[3][k].q_mocap = *r.bodies[3][k].q_mocap * Eigen::AngleAxisd(off, kX);
           if (k % 10 == 0) r.frames[frame++].bodies[2].q_mocap = r.bodies[3][k].q_mocap;
         }
       },
       {},
       false},
  };
}

std::vector<Spoilt> of_inputs() {
  using R = trial::CheckRecording;
  const auto times = [](double factor, double offset = 0.0) {
    return [=](R& r) {
      for (auto& input : r.inputs) {
        for (auto& v : input) v.value = (v.value - 101325.0) * factor + offset;
      }
    };
  };
  const auto noisy = [=](double factor, double offset, double sd) {
    return [=](R& r) {
      times(factor, offset)(r);
      std::mt19937 random(2);
      std::normal_distribution<double> noise(0.0, sd);
      for (auto& v : r.inputs[0]) v.value += noise(random);
    };
  };
  const auto tendons = [](std::string& text) { of_kind(text, "tensions", "tendons"); };
  const auto cables = [](std::string& text) { of_kind(text, "angles", "cables"); };
  return {
      {"pressure_unit", times(1.0), {}, false},
      {"pressure_unit", times(1e-3, 101.325), {}, false},
      {"offset_at_rest",
       [](R& r) {
         for (auto& v : r.inputs[0]) v.value += 1000.0;
       }},
      {"offset_at_rest",
       [](R& r) {
         for (auto& v : r.inputs[0]) v.value += 2000.0;
       },
       [](std::string& text) {
         replace(text, "topic: /pressure/chamber_1}", "topic: /pressure/chamber_1, unit: psi, zero: 0.1}");
       },
       false},
      {"offset_at_rest", noisy(1e-3, 1.5, 0.05), tendons},
      {"offset_at_rest", noisy(1e-4, 0.2, 0.01), cables},
      {"tension_unit", times(1.0), tendons, false},
      {"angle_unit", times(3e-3), cables, false},
      {"payload_range",
       [](R& r) {
         r.payload.push_back({kStart + 5.0, kStart + 5.0, 7.0});
       }},
      {"payload_range",
       [](R& r) {
         r.payload.push_back({kStart + 5.0, kStart + 5.0, 200.0});
       },
       {},
       false},
      {"payload_unknown", [](R& r) { r.payload.clear(); }, {}, false},
  };
}

/// Findings whose settings differ where the layout is known.
const std::set<std::string>& settings_by_layout() {
  static const std::set<std::string> ids{"clocks_apart",   "turned_over",    "quaternion_spikes",
                                         "repeated_poses", "offset_at_rest", "pressure_unit"};
  return ids;
}

std::vector<Spoilt> all_spoilt() {
  std::vector<Spoilt> all = of_stamps_and_topics();
  for (auto* some : {&of_bodies, &of_inputs}) {
    for (Spoilt& one : some()) all.push_back(std::move(one));
  }
  return all;
}

TEST(CheckSettings, EverySettingFollowedToTheLetterIsTakenAndRepairsWhatItCan) {
  std::set<std::string> with_setting;
  std::size_t number = 0;
  for (const Spoilt& spoilt : all_spoilt()) {
    for (const bool imported : {false, true}) {
      if (imported && settings_by_layout().count(spoilt.id) == 0) continue;
      SCOPED_TRACE(spoilt.id + ", case " + std::to_string(number++) + (imported ? ", imported" : ""));
      std::string arm_text = kArm;
      if (spoilt.arm_file) spoilt.arm_file(arm_text);
      const arm::Arm arm = arm::parse_arm(arm_text, "arm");
      trial::CheckRecording recording = clean();
      spoilt.spoil(recording);
      if (imported) recording.import_layout = kImportLayout;
      const check::CheckReport report = check::check_recording(recording, arm);
      const check::CheckFinding* expected = find(report, spoilt.id);
      ASSERT_NE(expected, nullptr) << to_text(report);
      for (const check::CheckFinding& finding : report.findings) {
        if (finding.setting.empty()) continue;
        with_setting.insert(finding.id);
        arm::Arm after = arm;
        follow(finding, arm_text, &after);
        const bool of_layout = finding.setting.find("(of the layout)") != std::string::npos;
        if (finding.id != spoilt.id || !spoilt.repairs || of_layout) continue;
        recording.import_layout.clear();
        const check::CheckReport again = check::check_recording(recording, after);
        const check::CheckFinding* left = find(again, finding.id, finding.where);
        EXPECT_TRUE(!left || left->severity == check::Severity::kInformation) << finding.setting << "\n"
                                                                              << left->what;
      }
    }
  }
  // Gravity wants an arm that sags: its setting is followed in test/apps/check_test.cpp. All others are here.
  with_setting.insert("gravity");
  const std::set<std::string> expected{"angle_unit",
                                       "base_attitude",
                                       "base_upside_down",
                                       "body_order",
                                       "clock_offset_or_lag",
                                       "clocks_apart",
                                       "correlated_noise",
                                       "gap",
                                       "gravity",
                                       "length_unit",
                                       "missing_topic",
                                       "no_orientation",
                                       "noise_understated",
                                       "offset_at_rest",
                                       "other_epoch",
                                       "payload_range",
                                       "payload_unknown",
                                       "pressure_unit",
                                       "quaternion_spikes",
                                       "repeated_poses",
                                       "ring_misplaced",
                                       "ring_wanders",
                                       "split_frames",
                                       "stamps_ahead",
                                       "stretched",
                                       "tangent_backwards",
                                       "tangent_off",
                                       "tension_unit",
                                       "turned_about_tangent",
                                       "turned_over",
                                       "wrong_type"};
  EXPECT_EQ(with_setting, expected);
}

/// Whether the one is the other's key, or a map around it.
bool around(const Step& a, const Step& b) {
  return a.of_layout == b.of_layout && b.path.compare(0, a.path.size(), a.path) == 0 &&
         (b.path.size() == a.path.size() || b.path[a.path.size()] == '.' || b.path[a.path.size()] == '[');
}

/// No two settings of a report set one key to different values.
void expect_one_value_each(const check::CheckReport& report) {
  std::vector<Step> all;
  for (const check::CheckFinding& finding : report.findings) {
    const std::vector<Step> steps = steps_of(finding.setting);
    for (const Step& step : steps) {
      for (const Step& other : all) {
        if (around(step, other) || around(other, step)) {
          EXPECT_TRUE(step.path == other.path && step.value == other.value)
              << step.path << ": " << step.value << " against " << other.path << ": " << other.value << "\n"
              << to_text(report);
        }
      }
    }
    all.insert(all.end(), steps.begin(), steps.end());
  }
}

TEST(CheckSettings, TwoThatAreFollowedTogetherDoNotUndoOneAnother) {
  // One of each id that touches what others touch.
  std::vector<Spoilt> some;
  for (Spoilt& one : all_spoilt()) {
    static const std::set<std::string> kTouching{"missing_topic",       "gap",
                                                 "other_epoch",         "stamps_ahead",
                                                 "clock_offset_or_lag", "clocks_apart",
                                                 "body_order",          "quaternion_spikes",
                                                 "length_unit",         "base_upside_down",
                                                 "base_attitude",       "ring_misplaced",
                                                 "stretched",           "ring_wanders",
                                                 "noise_understated",   "correlated_noise"};
    const bool known = std::any_of(some.begin(), some.end(), [&](const Spoilt& s) {
      return s.id == one.id && s.id != "quaternion_spikes";
    });
    if (kTouching.count(one.id) && !known) some.push_back(std::move(one));
  }
  for (std::size_t i = 0; i < some.size(); ++i) {
    for (std::size_t j = i + 1; j < some.size(); ++j) {
      if (some[j].arm_file && some[i].arm_file) continue;  // they rewrite the same lines
      SCOPED_TRACE(some[i].id + " and " + some[j].id);
      std::string arm_text = kArm;
      for (const auto* one : {&some[i], &some[j]}) {
        if (one->arm_file) one->arm_file(arm_text);
      }
      const arm::Arm arm = arm::parse_arm(arm_text, "arm");
      trial::CheckRecording recording = clean();
      some[j].spoil(recording);
      some[i].spoil(recording);
      const check::CheckReport report = check::check_recording(recording, arm);
      expect_one_value_each(report);
      YAML::Node arm_file = YAML::Load(arm_text), layout = YAML::Load(kImportLayout);
      for (const check::CheckFinding& finding : report.findings) follow(finding, arm_file, layout);
      loaded(arm_file, layout, to_text(report), arm);
    }
  }
}

TEST(CheckSettings, OfFiguresThatAnotherFindingSpoilsNoneIsSet) {
  const auto finding = [](const char* id, const char* setting) {
    check::CheckFinding f;
    f.severity = check::Severity::kSerious;
    f.id = id;
    f.setting = setting;
    f.remedy = "repair it";
    return f;
  };
  std::vector<check::CheckFinding> findings{
      finding("gravity", "gravity_m_s2: [0.000, -9.810, 0.000]"),
      finding("base_attitude", "base.rod_in_body: {position_m: [0, 0, 0]}"),
      finding("tangent_off", "bodies[tip].orientation_usable: false"),
      finding("offset_at_rest", "inputs.pressures[c].zero: 3")};
  check::withhold_contradictions(findings);
  EXPECT_EQ(findings[0].setting, "");
  EXPECT_EQ(findings[0].remedy,
            "repair it; what to set follows when base_attitude is repaired: check again then");
  EXPECT_NE(findings[1].setting, "");
  EXPECT_EQ(findings[2].setting, "");
  EXPECT_NE(findings[3].setting, "");
}

TEST(CheckSettings, InputsThatAreHeldForDifferentTimesHaveOneSetting) {
  trial::CheckRecording recording = clean();
  drop(recording.inputs[0], 6.0, 7.5);
  drop(recording.inputs[1], 10.0, 11.0);
  const check::CheckReport report = check::check_recording(recording, arm::parse_arm(kArm, "arm"));
  const check::CheckFinding *one = find(report, "gap", "chamber_1"), *two = find(report, "gap", "chamber_2");
  ASSERT_TRUE(one && two && one != two) << to_text(report);
  EXPECT_FALSE(one->setting.empty());
  EXPECT_EQ(one->setting, two->setting);
  expect_one_value_each(report);
}

TEST(CheckSettings, WhatInputsAreAheadIsTakenOffOnce) {
  trial::CheckRecording recording = clean(7, 0.25);
  for (auto& input : recording.inputs) {
    for (auto& v : input) v.stamp_s += 0.05;
  }
  arm::Arm arm = arm::parse_arm(kArm, "arm");
  const check::CheckReport report = check::check_recording(recording, arm);
  const check::CheckFinding *ahead = find(report, "stamps_ahead", "chamber_1"),
                            *shift = find(report, "clock_offset_or_lag");
  ASSERT_TRUE(ahead && shift) << to_text(report);
  YAML::Node arm_file = YAML::Load(kArm), layout = YAML::Load(kImportLayout);
  follow(*ahead, arm_file, layout);
  follow(*shift, arm_file, layout);
  EXPECT_NEAR(arm_file["inputs"]["bodies"]["latency_s"].as<double>(), 0.25, 0.01) << to_text(report);
  const arm::Arm after = loaded(arm_file, layout, "both", arm);
  const check::CheckReport again = check::check_recording(recording, after);
  EXPECT_NEAR(*find(again, "clock_offset_or_lag")->figure, 0.0, 0.01) << to_text(again);
}

TEST(CheckSettings, AnotherBodysTopicIsNotTakenForOneThatIsMissing) {
  trial::CheckRecording recording = clean();
  auto& topic = *std::find_if(recording.topics.begin(), recording.topics.end(),
                              [](const trial::RecordedTopic& t) { return t.feeds == "ring_3"; });
  topic.topic = "/mocap/tip/pose";
  topic.found_type.clear();
  recording.bodies[3].clear();
  recording.other_topics["/mocap/base/pose"] = "geometry_msgs/PoseStamped";
  const arm::Arm arm = arm::parse_arm(kArm, "arm");
  const check::CheckReport report = check::check_recording(recording, arm);
  const check::CheckFinding* finding = find(report, "missing_topic");
  ASSERT_NE(finding, nullptr) << to_text(report);
  EXPECT_EQ(finding->setting, "") << to_text(report);
  recording.other_topics["/mocap/tp/pose"] = "geometry_msgs/PoseStamped";
  EXPECT_NE(find(check::check_recording(recording, arm), "missing_topic")->remedy.find("/mocap/tp/pose"),
            std::string::npos);
}

/// A new setting wants a case above.
TEST(CheckSettings, EverySourceWithASettingIsAmongThoseThatAreFollowed) {
  std::map<std::string, int> found;
  static const std::regex kSets(R"((\.setting|->setting)\s*\+?=[^=])");
  for (const auto& file : std::filesystem::directory_iterator(SOFTARM_SOURCE_DIR "/src/check")) {
    std::ifstream in(file.path());
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto count =
        std::distance(std::sregex_iterator(text.begin(), text.end(), kSets), std::sregex_iterator());
    if (count > 0) found[file.path().filename().string()] = static_cast<int>(count);
  }
  const std::map<std::string, int> followed{
      {"attitude.cpp", 3}, {"check.cpp", 1},        {"clocks.cpp", 2},      {"frozen.cpp", 1},
      {"gravity.cpp", 1},  {"input_levels.cpp", 1}, {"input_units.cpp", 3}, {"jumps.cpp", 2},
      {"noise.cpp", 2},    {"numbers.cpp", 1},      {"order.cpp", 1},       {"payload.cpp", 2},
      {"places.cpp", 2},   {"receipt.cpp", 2},      {"spacing.cpp", 2},     {"timing.cpp", 2},
      {"together.cpp", 2}, {"topics.cpp", 2},       {"turned_over.cpp", 2}, {"units.cpp", 1}};
  EXPECT_EQ(found, followed);
}

}  // namespace
}  // namespace softarm
