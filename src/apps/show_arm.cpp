// rviz with its view on the arm: takes a configuration, scales its lengths to the arm, turns the camera to
// where the arm is, and becomes rviz.
#include <fmt/format.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "softarm/arm/arm_file.h"
#include "softarm/output_file.h"

namespace {

constexpr double kConfigured_m = 0.2;  // length of the arm that the configurations in rviz/ are made for

struct Options {
  std::string arm, arms_dir, config, mocap_frame = "mocap", base_frame = "softarm/base", out;
  std::vector<std::string> also;
  double wait_s = 5.0;
};

/// Where an arm is mounted: asked of tf, since it may be a measured body.
std::optional<Eigen::Isometry3d> mounted(const Options& options, const std::string& base_frame) {
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  const ros::WallTime patience = ros::WallTime::now() + ros::WallDuration(options.wait_s);
  while (ros::ok() && ros::WallTime::now() < patience) {
    if (buffer.canTransform(options.mocap_frame, base_frame, ros::Time(0))) {
      const auto t = buffer.lookupTransform(options.mocap_frame, base_frame, ros::Time(0)).transform;
      return Eigen::Translation3d(t.translation.x, t.translation.y, t.translation.z) *
             Eigen::Quaterniond(t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z);
    }
    ros::WallDuration(0.05).sleep();
  }
  return std::nullopt;
}

/// Bases of the other estimators' arms, from that of the first, in the mocap frame.
std::vector<Eigen::Vector3d> bases_beside(const std::optional<Eigen::Isometry3d>& base,
                                          const Options& options) {
  std::vector<Eigen::Vector3d> found;
  if (!base || options.wait_s <= 0.0) return found;
  for (const std::string& name : options.also) {
    const ros::NodeHandle nh;
    if (const auto other = mounted(options, name + "/base"))
      found.emplace_back(other->translation() - base->translation());
    else
      ROS_WARN("the base of %s is not on tf yet: the view may leave its arm out", name.c_str());
  }
  return found;
}

/// What the picture is to take in: the arm, also where its inputs may make it half as long again.
double shown_length_m(const softarm::arm::Arm& arm) {
  double longest_m = 0.0;
  for (const softarm::arm::Segment& segment : arm.segments) longest_m += segment.length_range_m.high;
  return std::max(arm.total_length_m(), 0.7 * longest_m);
}

/// The largest of 1, 2, 5, 10, ... times a power of ten that is not above a length.
double round_length(double length_m) {
  const double decade = std::pow(10.0, std::floor(std::log10(length_m)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= length_m) return step * decade;
  }
  return decade;
}

void scale(YAML::Node node, double factor) {
  if (node) node = node.as<double>() * factor;
}

void set_point(YAML::Node point, const Eigen::Vector3d& p) {
  point["X"] = p.x();
  point["Y"] = p.y();
  point["Z"] = p.z();
}

void fit_view(YAML::Node view, double length_m, const std::optional<Eigen::Isometry3d>& base) {
  const double factor = length_m / kConfigured_m;
  for (const char* key : {"Distance", "Focal Shape Size", "Near Clip Distance"}) scale(view[key], factor);
  for (const char* key : {"X", "Y", "Z"}) scale(view["Focal Point"][key], factor);
  if (!base) return;
  // rviz takes the target frame's position only: offsets are along the axes of the fixed frame.
  const Eigen::Vector3d along = base->linear().col(2);
  set_point(view["Focal Point"], 0.5 * length_m * along);
  // A level arm is looked at from its side, and from nearer: pictures are wider than high.
  if (std::abs(along.z()) > 0.5) return;
  scale(view["Distance"], 0.75);
  view["Yaw"] = std::remainder(std::atan2(along.y(), along.x()) - 1.3, 2.0 * M_PI);
}

void fit_grid(YAML::Node grid, double length_m, const std::optional<Eigen::Isometry3d>& base) {
  const double factor = length_m / kConfigured_m;
  grid["Cell Size"] = round_length(factor * grid["Cell Size"].as<double>() * 1.001);
  // A grid through the origin is the mocap's floor; any other one lies under the arm.
  if (!base || grid["Offset"]["Z"].as<double>() == 0.0) return;
  const Eigen::Vector3d along = base->linear().col(2);
  Eigen::Vector3d below = base->translation() + 0.5 * length_m * along;
  const bool stands = along.z() > 0.5;
  below.z() =
      base->translation().z() + length_m * std::min(0.0, along.z()) - (stands ? 0.25 : 0.6) * length_m;
  set_point(grid["Offset"], below);
}

/// Displays of the estimators in other namespaces, after those of this one.
void show_also(YAML::Node displays, const std::vector<std::string>& namespaces) {
  const std::size_t own = displays.size();
  for (const std::string& name : namespaces) {
    for (std::size_t i = 0; i < own; ++i) {
      for (const char* key : {"Topic", "Marker Topic"}) {
        if (!displays[i][key]) continue;
        YAML::Node display = YAML::Clone(displays[i]);
        display["Name"] = display["Name"].as<std::string>() + " of " + name;
        display[key] = "/" + name + "/" + display[key].as<std::string>();
        displays.push_back(display);
      }
    }
  }
}

/// The view moves to the middle of several arms, and back until it has all of them.
void take_in(YAML::Node view, const std::vector<Eigen::Vector3d>& others) {
  Eigen::AlignedBox3d bases{Eigen::Vector3d(Eigen::Vector3d::Zero())};
  for (const Eigen::Vector3d& from_first : others) bases.extend(from_first);
  YAML::Node focus = view["Focal Point"];
  const Eigen::Vector3d at(focus["X"].as<double>(), focus["Y"].as<double>(), focus["Z"].as<double>());
  set_point(focus, at + bases.center());
  view["Distance"] = view["Distance"].as<double>() + 0.8 * bases.diagonal().norm();
  if (bases.diagonal().head<2>().norm() < 1e-3) return;
  // Side by side: across the line between them.
  view["Yaw"] =
      std::remainder(std::atan2(bases.diagonal().y(), bases.diagonal().x()) - 0.5 * M_PI, 2.0 * M_PI);
}

std::string fitted(const Options& options, double length_m, const std::optional<Eigen::Isometry3d>& base,
                   const std::vector<Eigen::Vector3d>& others) {
  YAML::Node config = YAML::LoadFile(options.config);
  YAML::Node manager = config["Visualization Manager"];
  for (YAML::Node display : manager["Displays"]) {
    const auto kind = display["Class"].as<std::string>();
    if (kind == "rviz/Grid") fit_grid(display, length_m, base);
    if (kind == "rviz/TF") scale(display["Marker Scale"], length_m / kConfigured_m);
    if (kind == "rviz/Path") scale(display["Line Width"], length_m / kConfigured_m);
  }
  fit_view(manager["Views"]["Current"], length_m, base);
  show_also(manager["Displays"], options.also);
  if (!others.empty()) take_in(manager["Views"]["Current"], others);
  YAML::Emitter emitted;
  emitted << config;
  // The configurations name the usual frames.
  std::string text = std::string(emitted.c_str()) + "\n", named;
  const std::string usual = "softarm/", own = options.base_frame.substr(0, options.base_frame.rfind('/') + 1);
  for (std::size_t at = 0, found; at < text.size(); at = found + usual.size()) {
    found = text.find(usual, at);
    named += text.substr(at, found - at);
    if (found == std::string::npos) break;
    named += own;
  }
  return named;
}

/// A file of the user's own ROS folder, where roslaunch's nodes may write.
std::filesystem::path file_for(const std::string& arm) {
  const char* ros_home = std::getenv("ROS_HOME");
  const char* home = std::getenv("HOME");
  const std::filesystem::path folder =
      ros_home ? std::filesystem::path(ros_home) : std::filesystem::path(home ? home : ".") / ".ros";
  std::filesystem::create_directories(folder);
  return folder / fmt::format("softarm_{}.rviz", arm);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<char*> remappings;  // rviz is to have the name that this node was given
  for (int i = 1; i < argc; ++i) {
    if (std::strstr(argv[i], ":=")) remappings.push_back(argv[i]);
  }
  ros::init(argc, argv, "softarm_rviz", ros::init_options::AnonymousName);
  CLI::App app{"Starts rviz with the view of a configuration fitted to an arm and to where it is mounted."};
  Options options;
  app.add_option("--arm", options.arm, "arm file, or the name of one in --arms-dir")->required();
  app.add_option("--arms-dir", options.arms_dir, "folder of shipped arms");
  app.add_option("--config", options.config, "rviz configuration, made for an arm of 0.2 m")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--mocap-frame", options.mocap_frame, "frame of the mocap")->capture_default_str();
  app.add_option("--base-frame", options.base_frame, "frame of the rod's base")->capture_default_str();
  app.add_option("--wait", options.wait_s, "how long to wait for the base's pose on tf, s; 0: do not")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  app.add_option("--also", options.also,
                 "namespaces of further estimators to show, each with its name as frame_prefix")
      ->expected(0, 16);
  app.add_option("--out", options.out, "write the configuration to this file and do not start rviz");
  CLI11_PARSE(app, argc, argv);
  try {
    const softarm::arm::Arm arm = softarm::arm::load_arm_file(options.arm, {options.arms_dir});
    std::optional<Eigen::Isometry3d> base;
    if (!arm.base.body) base = arm.base.fixed_pose;
    if (!base && options.wait_s > 0.0) {
      const ros::NodeHandle nh;
      base = mounted(options, options.base_frame);
      if (!base) ROS_WARN("the base's pose is not on tf yet: the view is that of a hanging arm");
    }
    const std::vector<Eigen::Vector3d> others = bases_beside(base, options);
    const std::string file = options.out.empty() ? file_for(arm.name).string() : options.out;
    softarm::app::OutputFile output(file);
    output.write(fitted(options, shown_length_m(arm), base, others));
    output.commit();
    ros::shutdown();
    if (!options.out.empty()) return 0;
    std::string program = "rviz", option = "-d", name = file;
    std::vector<char*> arguments{program.data(), option.data(), name.data()};
    arguments.insert(arguments.end(), remappings.begin(), remappings.end());
    arguments.push_back(nullptr);
    execvp("rviz", arguments.data());
    throw std::runtime_error(fmt::format("rviz cannot be started: {}", std::strerror(errno)));
  } catch (const std::exception& e) {
    fmt::print(stderr, "show_arm: {}\n", e.what());
    return 1;
  }
}
