// Recordings in which one thing is wrong: one or more for each finding that proposes a setting.
#pragma once

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "followed_settings.h"

namespace softarm::testing_check {

struct Spoilt {
  std::string id;
  std::function<void(trial::CheckRecording&)> spoil;
  std::function<void(std::string&)> arm_file = {};  ///< the arm file that it is held against, where another
  bool repairs = true;                              ///< the finding is gone where the setting was followed
};

inline void replace(std::string& text, const std::string& was, const std::string& is) {
  const std::size_t where = text.find(was);
  ASSERT_NE(where, std::string::npos) << was;
  text.replace(where, was.size(), is);
}

template <typename Samples>
inline void drop(Samples& samples, double from_s, double to_s) {
  samples.erase(
      std::remove_if(samples.begin(), samples.end(),
                     [&](const auto& s) { return s.stamp_s > kStart + from_s && s.stamp_s < kStart + to_s; }),
      samples.end());
}

inline void turn(trial::CheckRecording& r, std::size_t body, double angle, const Eigen::Vector3d& axis,
                 std::size_t from = 0, std::size_t to = 1u << 30, std::size_t every = 1) {
  auto& poses = r.bodies[body];
  for (std::size_t k = from; k < std::min(to, poses.size()); k += every)
    *poses[k].q_mocap = *poses[k].q_mocap * Eigen::AngleAxisd(angle, axis);
}

/// Tensions and angles in place of the pressures, of the same courses.
inline void of_kind(std::string& text, const std::string& list, const std::string& drive) {
  replace(text, "  pressures:", "  " + list + ":");
  replace(text, "    chambers:", "    " + drive + ":");
  const bool tendons = drive == "tendons";
  for (int i = 0; i < 2; ++i)
    replace(text, "moment_gain_nm_per_pa: 8.0e-6",
            tendons ? "offset_m: 0.01" : "curvature_gain_per_m_rad: 1");
}

inline const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(),
                             kZ = Eigen::Vector3d::UnitZ();

inline std::vector<Spoilt> of_stamps_and_topics() {
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

inline std::vector<Spoilt> of_bodies() {
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

inline std::vector<Spoilt> of_inputs() {
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
inline const std::set<std::string>& settings_by_layout() {
  static const std::set<std::string> ids{"clocks_apart", "turned_over",    "quaternion_spikes",
                                         "length_unit",  "repeated_poses", "offset_at_rest",
                                         "pressure_unit"};
  return ids;
}

inline std::vector<Spoilt> all_spoilt() {
  std::vector<Spoilt> all = of_stamps_and_topics();
  for (auto* some : {&of_bodies, &of_inputs}) {
    for (Spoilt& one : some()) all.push_back(std::move(one));
  }
  return all;
}

}  // namespace softarm::testing_check
