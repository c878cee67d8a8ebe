#include "recent_messages.h"

#include <fmt/format.h>
#include <rosbag/bag.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "open_bag.h"

namespace softarm {
namespace {

namespace fs = std::filesystem;

constexpr double kTimeBack_s = 1.0;

void write(rosbag::Bag& bag, const RecentMessage& m, const ros::Time& receipt) {
  bag.write(m.topic, receipt, *m.message, m.connection);
}

}  // namespace

bool RecentMessage::latched() const {
  if (!connection) return false;
  const auto found = connection->find("latching");
  return found != connection->end() && found->second == "1";
}

double RecentMessages::duration_s() const {
  return messages_.empty() ? 0.0 : (messages_.back().receipt - messages_.front().receipt).toSec();
}

void RecentMessages::clear() {
  messages_.clear();
  before_.clear();
  bytes_ = 0;
}

void RecentMessages::drop_oldest() {
  RecentMessage& oldest = messages_.front();
  bytes_ -= oldest.message->size();
  if (oldest.latched()) before_[oldest.topic] = std::move(oldest);
  messages_.pop_front();
}

void RecentMessages::add(RecentMessage message) {
  if (!messages_.empty() && (messages_.back().receipt - message.receipt).toSec() > kTimeBack_s) clear();
  bytes_ += message.message->size();
  // Nearly always the last; topics overtake one another by a little.
  auto place = messages_.end();
  while (place != messages_.begin() && std::prev(place)->receipt > message.receipt) --place;
  messages_.insert(place, std::move(message));
  while (duration_s() > keep_s_) drop_oldest();
  while (bytes_ > most_bytes_ && messages_.size() > 1) {
    drop_oldest();
    ++dropped_for_size_;
  }
}

std::vector<std::string> write_trials(const RecentMessages& recent, const std::string& folder,
                                      double trial_s) {
  const std::deque<RecentMessage>& messages = recent.messages();
  if (messages.empty()) throw std::runtime_error("nothing has been recorded yet");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder, error.message()));

  const long count = std::max(1L, std::lround(recent.duration_s() / trial_s));
  const double each_s = recent.duration_s() / static_cast<double>(count);
  std::map<std::string, RecentMessage> held = recent.before();
  std::vector<std::string> paths;
  auto next = messages.begin();
  for (long i = 0; i < count; ++i) {
    const fs::path path = fs::path(folder) / fmt::format("trial_{:02}.bag", i + 1);
    const fs::path temporary = path.string() + ".active";
    std::shared_ptr<rosbag::Bag> bag;  // closed again only after its failure has been said
    const auto write_trial = [&] {
      bag = new_bag(temporary.string());
      bag->setCompression(rosbag::compression::LZ4);
      const ros::Time begin = next != messages.end() ? next->receipt : messages.back().receipt;
      for (const auto& entry : held) write(*bag, entry.second, begin);
      const ros::Time end = messages.front().receipt + ros::Duration(each_s * static_cast<double>(i + 1));
      for (; next != messages.end() && (i + 1 == count || next->receipt < end); ++next) {
        write(*bag, *next, next->receipt);
        if (next->latched()) held[next->topic] = *next;
      }
      bag->close();
    };
    try {
      written(path.string(), write_trial);
    } catch (const BagError&) {  // it says which file
      fs::remove(temporary, error);
      throw;
    } catch (const std::exception& e) {
      fs::remove(temporary, error);
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), e.what()));
    }
    fs::rename(temporary, path, error);
    if (error)
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), error.message()));
    paths.push_back(path.string());
  }
  return paths;
}

}  // namespace softarm
