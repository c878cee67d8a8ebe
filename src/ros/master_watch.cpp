#include "master_watch.h"

#include <fmt/format.h>
#include <ros/connection_manager.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>

#include <chrono>

namespace softarm {
namespace {

constexpr std::chrono::seconds kEvery(1);

XmlRpc::XmlRpcValue list_of(const std::vector<std::string>& words) {
  XmlRpc::XmlRpcValue list;
  list.setSize(static_cast<int>(words.size()));
  for (std::size_t i = 0; i < words.size(); ++i) list[static_cast<int>(i)] = words[i];
  return list;
}

/// A call of the master. @return whether it was there and agreed
bool call(const std::string& method, const std::vector<std::string>& words, XmlRpc::XmlRpcValue& answer) {
  XmlRpc::XmlRpcValue whole;
  return ros::master::execute(method, list_of(words), whole, answer, false);
}

/// A call of this node's own interface for the master: roscpp has no other way to it.
bool call_self(const char* method, const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue& answer) {
  const ros::XMLRPCManagerPtr& manager = ros::XMLRPCManager::instance();
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(manager->getServerURI(), host, port)) return false;
  XmlRpc::XmlRpcClient* client = manager->getXMLRPCClient(host, static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue whole;
  const bool done =
      client->execute(method, request, whole) && manager->validateXmlrpcResponse(method, whole, answer);
  manager->releaseXMLRPCClient(client);
  return done;
}

/// All of the node's topics of a kind. @param list "getSubscriptions" or "getPublications"
template <typename Do>
bool for_topics(const char* list, const Do& what) {
  XmlRpc::XmlRpcValue topics;
  if (!call_self(list, list_of({ros::this_node::getName()}), topics)) return false;
  bool all = true;
  for (int i = 0; i < topics.size(); ++i)
    all = what(static_cast<std::string>(topics[i][0]), static_cast<std::string>(topics[i][1])) && all;
  return all;
}

bool register_again(const std::vector<std::string>& services) {
  const std::string &name = ros::this_node::getName(), uri = ros::XMLRPCManager::instance()->getServerURI();
  XmlRpc::XmlRpcValue answer;
  bool all = for_topics("getPublications", [&](const std::string& topic, const std::string& type) {
    return call("registerPublisher", {name, topic, type, uri}, answer);
  });
  all = for_topics("getSubscriptions",
                   [&](const std::string& topic, const std::string& type) {
                     XmlRpc::XmlRpcValue publishers;
                     if (!call("registerSubscriber", {name, topic, type, uri}, publishers)) return false;
                     // Those that are registered already; later ones the master announces. Of none: what is
                     // connected may only not have come back yet.
                     if (publishers.size() == 0) return true;
                     XmlRpc::XmlRpcValue update;
                     update[0] = name;
                     update[1] = topic;
                     update[2] = publishers;
                     return call_self("publisherUpdate", update, answer);
                   }) &&
        all;
  const std::string api = fmt::format("rosrpc://{}:{}", ros::network::getHost(),
                                      ros::ConnectionManager::instance()->getTCPPort());
  for (const std::string& service : services)
    all = call("registerService", {name, service, api, uri}, answer) && all;
  return all;
}

}  // namespace

ros::master::V_TopicInfo published_topics() {
  ros::master::V_TopicInfo list;
  XmlRpc::XmlRpcValue topics;
  if (!call("getPublishedTopics", {ros::this_node::getName(), ""}, topics)) return list;
  for (int i = 0; i < topics.size(); ++i)
    list.emplace_back(static_cast<std::string>(topics[i][0]), static_cast<std::string>(topics[i][1]));
  return list;
}

MasterWatch::MasterWatch(const std::vector<ros::ServiceServer>& services) {
  for (const ros::ServiceServer& service : services) services_.push_back(service.getService());
  thread_ = std::thread([this] { run(); });
}

MasterWatch::~MasterWatch() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void MasterWatch::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!wake_.wait_for(lock, kEvery, [this] { return over_; })) {
    lock.unlock();
    look();
    lock.lock();
  }
}

void MasterWatch::look() {
  const bool answers = ros::master::check();
  if (answers_ && !answers) ROS_WARN("the roscore does not answer: existing connections go on");
  answers_ = answers;
  if (!answers) return;
  const std::string& name = ros::this_node::getName();
  XmlRpc::XmlRpcValue uri;  // empty: it knows no such node
  if (call("lookupNode", {name, name}, uri) && uri.getType() == XmlRpc::XmlRpcValue::TypeString &&
      static_cast<std::string>(uri) == ros::XMLRPCManager::instance()->getServerURI())
    return;
  // It is this node, or the master, that ends. ros::ok() only says so once all topics have been taken back:
  // registered again, they would stay behind.
  if (ros::isShuttingDown() || !ros::master::check()) return;
  if (register_again(services_)) {
    ROS_WARN("the roscore was restarted: registered with it again");
  } else {
    ROS_ERROR_THROTTLE(
        10.0, "the roscore was restarted, and does not accept this node's topics: start the node again");
  }
}

}  // namespace softarm
