// A node that outlives its roscore.
#pragma once

#include <ros/master.h>
#include <ros/service_server.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace softarm {

/// Registers this node's topics and services again with a roscore that was restarted, which knows nothing of
/// it: until then the node would live on, and nobody would find it. Looks once a second, in a thread of its
/// own.
class MasterWatch {
 public:
  /// @param services of the node, beside its topics, which roscpp lists
  explicit MasterWatch(const std::vector<ros::ServiceServer>& services);
  ~MasterWatch();
  MasterWatch(const MasterWatch&) = delete;
  MasterWatch& operator=(const MasterWatch&) = delete;

 private:
  void run();
  void look();

  std::vector<std::string> services_;
  bool answers_ = true;
  bool over_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::thread thread_;
};

/// What is published, by the master; nothing where it does not answer. ros::master::getTopics() would wait
/// for it, and hold up all frames.
ros::master::V_TopicInfo published_topics();

}  // namespace softarm
