#include "recent_messages.h"

#include <fmt/format.h>
#include <rosbag/bag.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "bag_message.h"
#include "conversions.h"
#include "open_bag.h"

namespace softarm {
namespace {

namespace fs = std::filesystem;

constexpr double kTimeBack_s = 1.0;
constexpr std::size_t kCounters = 2 * sizeof(void*);  // that make_shared puts beside what it makes

/// What the heap takes for so many bytes: glibc puts 8 before them, rounds up to 16, and gives large ones
/// whole pages.
std::size_t on_heap(std::size_t bytes) {
  constexpr std::size_t kHeader = 8, kStep = 16, kLeast = 32, kLarge = 128 * 1024, kPage = 4096;
  if (bytes >= kLarge) return (bytes + 2 * kHeader + kPage - 1) / kPage * kPage;
  return std::max(kLeast, (bytes + kHeader + kStep - 1) / kStep * kStep);
}

double seconds_between(const ros::Time& from, const ros::Time& to) {
  return seconds_since(to_stamp(from).ns, to);
}

/// What a text takes beside its own object: nothing where it is short.
std::size_t on_heap(const std::string& text) {
  return text.capacity() > std::string().capacity() ? on_heap(text.capacity() + 1) : 0;
}

/// What an entry of a map takes.
std::size_t entry_on_heap(std::size_t bytes) {
  constexpr std::size_t kNode = 4 * sizeof(void*);  // colour, parent, left, right
  return on_heap(kNode + bytes);
}

/// Writes messages as they were published: those of a source one after the other through one ShapeShifter.
class BagOfRecent {
 public:
  explicit BagOfRecent(rosbag::Bag& bag) : bag_(bag) {}

  void write(const RecentMessage& m, const ros::Time& receipt) {
    auto [entry, is_new] = shapes_.try_emplace(m.source.get());
    topic_tools::ShapeShifter& shape = entry->second;
    if (is_new) shape.morph(m.source->md5, m.source->type, m.source->definition, "");
    auto* const bytes = const_cast<std::uint8_t*>(m.bytes->data());  // IStream only reads them
    ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(m.bytes->size()));
    shape.read(stream);
    // What came before there was a simulated time came at zero, which bags do not take.
    bag_.write(m.source->topic, std::max(receipt, ros::TIME_MIN), shape, m.source->connection);
  }

 private:
  rosbag::Bag& bag_;
  std::map<const RecentSource*, topic_tools::ShapeShifter> shapes_;
};

}  // namespace

bool RecentSource::latched() const {
  if (!connection) return false;
  const auto found = connection->find("latching");
  return found != connection->end() && found->second == "1";
}

std::size_t RecentSource::footprint() const {
  // Itself, and its entry in RecentMessages: a pointer and two numbers.
  std::size_t bytes = on_heap(kCounters + sizeof(RecentSource)) +
                      entry_on_heap(sizeof(std::shared_ptr<RecentSource>) + 2 * sizeof(std::size_t));
  for (const std::string* text : {&topic, &type, &md5, &definition}) bytes += on_heap(*text);
  if (!connection) return bytes;
  // roscpp lets go of the header when the connection ends: it is then kept for the messages alone.
  bytes += on_heap(kCounters + sizeof(ros::M_string));
  for (const auto& [key, value] : *connection)
    bytes += entry_on_heap(sizeof(ros::M_string::value_type)) + on_heap(key) + on_heap(value);
  return bytes;
}

std::size_t RecentMessage::footprint(std::size_t size) {
  // Its place in the deque, whose blocks are never quite full; the vector; the vector's bytes.
  return sizeof(RecentMessage) + sizeof(void*) + on_heap(kCounters + sizeof(std::vector<std::uint8_t>)) +
         on_heap(size);
}

double RecentMessages::duration_s() const {
  return messages_.empty() ? 0.0 : seconds_between(messages_.front().receipt, messages_.back().receipt);
}

void RecentMessages::hold(const RecentMessage& message) {
  Held& held = sources_.at(message.source);
  if (held.messages++ == 0) bytes_ += held.footprint;
  bytes_ += message.footprint();
}

void RecentMessages::release(const RecentMessage& message) {
  bytes_ -= message.footprint();
  const auto source = sources_.find(message.source);
  if (--source->second.messages > 0) return;
  bytes_ -= source->second.footprint;
  sources_.erase(source);
}

void RecentMessages::drop_oldest() {
  RecentMessage& oldest = messages_.front();
  if (oldest.source->latched()) {
    const auto [entry, is_new] = before_.try_emplace(oldest.source->topic);
    if (!is_new) release(entry->second);
    entry->second = std::move(oldest);
  } else {
    release(oldest);
  }
  messages_.pop_front();
}

RecentMessages::Sources::iterator RecentMessages::source_of(
    const std::string& topic, const topic_tools::ShapeShifter& message,
    const boost::shared_ptr<ros::M_string>& connection) {
  const auto found = std::find_if(sources_.begin(), sources_.end(), [&](const auto& entry) {
    const RecentSource& source = *entry.first;
    return source.connection == connection && source.topic == topic && source.md5 == message.getMD5Sum() &&
           source.type == message.getDataType();
  });
  if (found != sources_.end()) return found;
  const auto source = std::make_shared<const RecentSource>(RecentSource{
      topic, message.getDataType(), message.getMD5Sum(), message.getMessageDefinition(), connection});
  return sources_.emplace(source, Held{0, source->footprint()}).first;
}

void RecentMessages::add(const std::string& topic, const ros::Time& receipt,
                         const topic_tools::ShapeShifter& message,
                         const boost::shared_ptr<ros::M_string>& connection) {
  if (!messages_.empty() && seconds_between(receipt, messages_.back().receipt) > kTimeBack_s)
    while (!messages_.empty()) drop_oldest();
  const auto source = source_of(topic, message, connection);
  if (RecentMessage::footprint(message.size()) + source->second.footprint > most_bytes_) {
    if (source->second.messages == 0) sources_.erase(source);
    ++dropped_for_size_;  // rather it than all others
    return;
  }
  RecentMessage added{receipt, source->first,
                      std::make_shared<const std::vector<std::uint8_t>>(bytes_of(message))};
  hold(added);
  // Nearly always the last; topics overtake one another by a little.
  auto place = messages_.end();
  while (place != messages_.begin() && std::prev(place)->receipt > receipt) --place;
  messages_.insert(place, std::move(added));
  while (duration_s() > keep_s_) drop_oldest();
  while (bytes_ > most_bytes_ && !messages_.empty()) {
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
      BagOfRecent recent_bag(*bag);
      for (const auto& entry : held) recent_bag.write(entry.second, begin);
      const ros::Time end = messages.front().receipt + ros::Duration(each_s * static_cast<double>(i + 1));
      for (; next != messages.end() && (i + 1 == count || next->receipt < end); ++next) {
        recent_bag.write(*next, next->receipt);
        if (next->source->latched()) held[next->source->topic] = *next;
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
