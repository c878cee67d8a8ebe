#include "open_bag.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <rosbag/view.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <vector>

#include "bag_structure.h"

namespace softarm {
namespace {

/// rosbag::Bag makes and destroys a plugin loader of its own, whose library's tables are not safe against
/// threads: bags may be read side by side, but not opened or destroyed.
std::mutex& bag_lifetime() {
  static std::mutex mutex;
  return mutex;
}

/// One that a full disk left open. Its destructor would try again, and throw: better a few kilobytes that
/// stay. Called under bag_lifetime().
void keep(rosbag::Bag* unfinished) {
  static std::vector<rosbag::Bag*>& kept = *new std::vector<rosbag::Bag*>;
  kept.push_back(unfinished);
}

std::shared_ptr<rosbag::Bag> opened(const std::string& path, rosbag::bagmode::BagMode mode) {
  const std::lock_guard<std::mutex> lock(bag_lifetime());
  // While a bag lives the library of its plugins (encryption, with all of GnuPG) stays loaded. Each would
  // load and unload it, and every time that takes longer: glibc walks through what all before had registered.
  [[maybe_unused]] static const rosbag::Bag& keeps_library = *new rosbag::Bag;
  // Of that a newer rosbag, whose loader lives until the program ends, would warn then.
  [[maybe_unused]] static const int at_exit =
      std::atexit([] { console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR); });
  auto bag = std::make_unique<rosbag::Bag>();
  try {
    bag->open(path, mode);
  } catch (const rosbag::BagException&) {
    if (mode == rosbag::bagmode::Write) keep(bag.release());
    throw;
  }
  return {bag.release(), [](rosbag::Bag* finished) {
            const std::lock_guard<std::mutex> finish(bag_lifetime());
            try {
              finished->close();
            } catch (const std::exception&) {
              keep(finished);
              return;
            }
            delete finished;
          }};
}

}  // namespace

std::string absolute_topic(const std::string& topic) {
  return topic.rfind('/', 0) == 0 ? topic : "/" + topic;
}

std::shared_ptr<rosbag::Bag> open_bag(const std::string& path) {
  check_bag_structure(path);
  try {
    std::shared_ptr<rosbag::Bag> bag = opened(path, rosbag::bagmode::Read);
    rosbag::View(*bag).getConnections();  // reads the index
    return bag;
  } catch (const std::exception& e) {
    throw BagError(fmt::format("{}: cannot be read as a ROS bag ({})", path, e.what()));
  }
}

std::shared_ptr<rosbag::Bag> new_bag(const std::string& path) {
  return opened(path, rosbag::bagmode::Write);
}

void written(const std::string& path, const std::function<void()>& what) {
  errno = 0;  // rosbag says at which of its steps it failed, but not why
  try {
    what();
  } catch (const rosbag::BagException& e) {
    throw BagError(
        fmt::format("{}: cannot be written: {}", path, errno != 0 ? std::strerror(errno) : e.what()));
  }
}

}  // namespace softarm
