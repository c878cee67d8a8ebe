// Parameters of a node, checked.
#pragma once

#include <fmt/format.h>
#include <ros/ros.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace softarm {

/// Reads and checks the parameters of a node, one by one; remembers which there are.
///
/// What is not set is absent, and so is an empty string: that is how a launch file says "not given". All
/// throw std::runtime_error in one line: parameter, value, what is allowed.
class ParamReader {
 public:
  explicit ParamReader(const ros::NodeHandle& nh) : nh_(nh) {}

  template <class T>
  std::optional<T> get(const std::string& name, const char* type) {
    known_.push_back(nh_.resolveName(name));
    if (!nh_.hasParam(name)) return {};
    T value;
    if (!nh_.getParam(name, value)) throw error(name, std::string("must be ") + type);
    return value;
  }

  std::optional<std::string> word(const std::string& name) {
    // An empty string is how a launch file says "not given".
    std::optional<std::string> value = get<std::string>(name, "a string");
    return value && value->empty() ? std::nullopt : value;
  }

  std::optional<bool> flag(const std::string& name) {
    known_.push_back(nh_.resolveName(name));
    XmlRpc::XmlRpcValue raw;
    if (!nh_.getParam(name, raw)) return {};
    if (raw.getType() == XmlRpc::XmlRpcValue::TypeBoolean) return static_cast<bool>(raw);
    if (raw.getType() == XmlRpc::XmlRpcValue::TypeString) {
      const std::string word(raw);
      if (word.empty()) return {};
      // roslaunch passes on and off as strings.
      if (word == "on") return true;
      if (word == "off") return false;
    }
    throw error(name, "must be true or false (or on, off)");
  }

  std::optional<double> number(const std::string& name, double low, double high) {
    known_.push_back(nh_.resolveName(name));
    XmlRpc::XmlRpcValue raw;
    if (!nh_.getParam(name, raw)) return {};
    if (raw.getType() == XmlRpc::XmlRpcValue::TypeString && std::string(raw).empty()) return {};
    double value = 0.0;
    if (!nh_.getParam(name, value)) throw error(name, fmt::format("must be a number in [{}, {}]", low, high));
    if (!(value >= low && value <= high)) {
      throw error(name, fmt::format("is {}, allowed is [{}, {}]", value, low, high));
    }
    return value;
  }

  /// Warns of parameters of the node that nobody reads: most often a slip of the pen.
  void warn_of_unknown() const {
    std::vector<std::string> names;
    if (!nh_.getParamNames(names)) return;
    const std::string space = nh_.getNamespace() + "/";
    for (const std::string& name : names) {
      const bool ours =
          name.rfind(space, 0) == 0 && std::find(known_.begin(), known_.end(), name) == known_.end();
      if (ours && name != space + "diagnostic_period")
        ROS_WARN("parameter %s is not known, ignored", name.c_str());
    }
  }

  std::runtime_error error(const std::string& name, const std::string& what) const {
    return std::runtime_error("parameter " + nh_.resolveName(name) + " " + what);
  }

 private:
  ros::NodeHandle nh_;
  std::vector<std::string> known_;
};

}  // namespace softarm
