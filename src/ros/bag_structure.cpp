#include "bag_structure.h"

#include <fmt/format.h>
#include <rosbag/chunked_file.h>
#include <rosbag/constants.h>
#include <rosbag/exceptions.h>
#include <rosbag/stream.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "open_bag.h"

namespace softarm {
namespace {

constexpr std::string_view kFormat = "#ROSBAG V2.0\n";
// Longest header of a record, and longest definition of a connection, that anybody writes; roscpp takes no
// field of more than 1 MB.
constexpr std::uint32_t kLongestHeader = 1u << 20, kLongestConnection = 16u << 20, kLongestField = 1000000;
// A chunk may be said to hold so many bytes, or so many times those that it takes in the file (LZ4 cannot do
// more), before it is decompressed.
constexpr std::uint64_t kPlausibleChunk = 64u << 20, kMostCompressed = 255;
constexpr std::size_t kIndexEntry = 12, kChunkInfoEntry = 8;
constexpr std::uint32_t kNanosecondsOfASecond = 1000000000;

template <class T>
T number_in(std::string_view bytes, std::size_t at = 0) {
  T value;  // bags are little-endian, and so is whatever runs ROS 1
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// The fields of a record's header.
class RecordFields {
 public:
  /// @return false if a field's length is false or it has no name
  bool parse(std::string_view header) {
    fields_.clear();
    while (!header.empty()) {
      if (header.size() < 4) return false;
      const auto length = number_in<std::uint32_t>(header);
      if (length > kLongestField || length > header.size() - 4) return false;
      const std::string_view field = header.substr(4, length);
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) return false;
      fields_.emplace_back(field.substr(0, equals), field.substr(equals + 1));
      header.remove_prefix(4 + length);
    }
    return true;
  }
  /// Empty where there is none. Of several of a name the last counts, as it does for roscpp.
  std::string_view text(std::string_view name) const {
    const auto found =
        std::find_if(fields_.rbegin(), fields_.rend(), [&](const auto& f) { return f.first == name; });
    return found == fields_.rend() ? std::string_view() : found->second;
  }
  /// @return false if it is absent or of another length
  template <class T>
  bool number(std::string_view name, T& value) const {
    const std::string_view bytes = text(name);
    if (bytes.size() == sizeof(T)) value = number_in<T>(bytes);
    return bytes.size() == sizeof(T);
  }
  bool has_op(std::uint8_t op) const {
    std::uint8_t found = 0;
    return number(rosbag::OP_FIELD_NAME, found) && found == op;
  }
  /// A time whose nanoseconds are less than a second: ros::Time throws for some that are more.
  bool has_time(std::string_view name) const {
    std::uint64_t time = 0;
    return number(name, time) && (time >> 32) < kNanosecondsOfASecond;
  }

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;  // views into the header
};

/// A record of the file: its header, and where its data are.
struct BagRecord {
  std::string header;
  RecordFields fields;
  std::uint64_t at = 0, data_at = 0;
  std::uint32_t data_size = 0;
  std::uint64_t end() const { return data_at + data_size; }
};

/// What decompresses the bytes that it is given, whatever its file.
struct Streams {
  rosbag::ChunkedFile no_file;
  rosbag::StreamFactory factory{&no_file};
};

/// One walk through one file.
class BagWalk {
 public:
  explicit BagWalk(const std::string& path) : path_(path), file_(path, std::ios::binary) {
    file_.seekg(0, std::ios::end);
    const std::streamoff size = file_ ? static_cast<std::streamoff>(file_.tellg()) : -1;
    if (size < 0) throw BagError(fmt::format("{}: cannot be read", path_));
    size_ = static_cast<std::uint64_t>(size);
  }

  void check() {
    check_format();
    read_record(kFormat.size(), rosbag::OP_FILE_HEADER, "the bag's header");
    if (!record_.fields.text(rosbag::ENCRYPTOR_FIELD_NAME).empty()) {
      throw BagError(fmt::format("{0}: is encrypted; rosbag decrypt {0} makes one that can be read", path_));
    }
    std::uint64_t at = field<std::uint64_t>(rosbag::INDEX_POS_FIELD_NAME);
    const auto connections = field<std::uint32_t>(rosbag::CONNECTION_COUNT_FIELD_NAME);
    const auto chunks = field<std::uint32_t>(rosbag::CHUNK_COUNT_FIELD_NAME);
    if (at == 0) cut_off("its recorder did not finish it");
    if (at < record_.end()) damaged(record_.at, fmt::format("the index is said to be at byte {}", at));
    for (std::uint32_t i = 0; i < connections; ++i) at = check_connection(at);
    for (std::uint32_t i = 0; i < chunks; ++i) at = check_chunk_info(at);
    std::sort(chunks_.begin(), chunks_.end());
    std::uint64_t free = 0;  // chunks that share bytes would multiply what is read
    for (const auto& [chunk_at, parts] : chunks_) {
      if (chunk_at < free) damaged(chunk_at, "two chunks of the index share bytes");
      free = check_chunk(chunk_at, parts);
    }
  }

 private:
  [[noreturn]] void damaged(std::uint64_t at, const std::string& what) const {
    throw BagError(fmt::format("{0}: damaged at byte {1}: {2}; to save what is whole: rosbag reindex {0}",
                               path_, at, what));
  }
  [[noreturn]] void cut_off(const std::string& what) const {
    throw BagError(
        fmt::format("{0}: was cut off, its index is missing ({1}); to save what is there: "
                    "rosbag reindex {0}",
                    path_, what));
  }

  void read(std::uint64_t at, std::uint64_t size, const char* what, std::string& bytes) {
    if (at > size_ || size > size_ - at) {
      cut_off(fmt::format("{} should be at bytes {} to {}, the file has {}", what, at, at + size, size_));
    }
    bytes.resize(size);
    file_.seekg(static_cast<std::streamoff>(at));
    file_.read(bytes.data(), static_cast<std::streamsize>(size));
    if (!file_) throw BagError(fmt::format("{}: cannot be read at byte {}", path_, at));
  }

  void check_format() {
    constexpr std::string_view kAnyFormat = "#ROSBAG V";
    read(0, std::min<std::uint64_t>(size_, kFormat.size()), "its first line", bytes_);
    if (bytes_ == kFormat) return;
    if (bytes_.compare(0, kAnyFormat.size(), kAnyFormat) != 0 || size_ < kFormat.size()) {
      throw BagError(
          fmt::format("{}: cannot be read as a ROS bag (it does not begin with #ROSBAG V2.0)", path_));
    }
    throw BagError(
        fmt::format("{0}: is no bag of format 2.0; rosbag fix {0} new.bag makes one of an older one", path_));
  }

  /// Reads the header of a record into record_ and looks for its data.
  void read_record(std::uint64_t at, std::uint8_t op, const char* what) {
    record_.at = at;
    read(at, 4, what, bytes_);
    const auto length = number_in<std::uint32_t>(bytes_);
    if (length > kLongestHeader) damaged(at, fmt::format("{} is said to have {} bytes", what, length));
    read(at + 4, length + std::uint64_t{4}, what, record_.header);
    const std::string_view header(record_.header);
    if (!record_.fields.parse(header.substr(0, length)) || !record_.fields.has_op(op)) {
      damaged(at, fmt::format("{} should be there", what));
    }
    record_.data_size = number_in<std::uint32_t>(header, length);
    record_.data_at = at + 8 + length;
    if (record_.data_size > size_ - record_.data_at) {
      damaged(at, fmt::format("{} should have {} bytes of data, the file has {} more", what,
                              record_.data_size, size_ - record_.data_at));
    }
  }

  template <class T>
  T field(const std::string& name) const {
    T value{};
    if (!record_.fields.number(name, value)) damaged(record_.at, fmt::format("'{}' is missing", name));
    return value;
  }

  std::uint64_t check_connection(std::uint64_t at) {
    constexpr const char* kWhat = "the record of a topic";
    read_record(at, rosbag::OP_CONNECTION, kWhat);
    connections_.insert(field<std::uint32_t>(rosbag::CONNECTION_FIELD_NAME));
    if (record_.fields.text(rosbag::TOPIC_FIELD_NAME).empty()) damaged(at, "'topic' is missing");
    if (record_.data_size > kLongestConnection) {
      damaged(at, fmt::format("{} is said to have {} bytes", kWhat, record_.data_size));
    }
    read(record_.data_at, record_.data_size, kWhat, bytes_);
    if (!RecordFields().parse(bytes_)) damaged(at, "the type of a topic cannot be read");
    return record_.end();
  }

  std::uint64_t check_chunk_info(std::uint64_t at) {
    constexpr const char* kWhat = "the summary of a chunk";
    read_record(at, rosbag::OP_CHUNK_INFO, kWhat);
    const auto version = field<std::uint32_t>(rosbag::VER_FIELD_NAME);
    const auto count = field<std::uint32_t>(rosbag::COUNT_FIELD_NAME);
    const bool timed = record_.fields.has_time(rosbag::START_TIME_FIELD_NAME) &&
                       record_.fields.has_time(rosbag::END_TIME_FIELD_NAME);
    if (version != rosbag::CHUNK_INFO_VERSION || !timed || record_.data_size != count * std::uint64_t{8}) {
      damaged(at, fmt::format("{} contradicts itself", kWhat));
    }
    const auto chunk_at = field<std::uint64_t>(rosbag::CHUNK_POS_FIELD_NAME);
    read(record_.data_at, record_.data_size, kWhat, bytes_);
    std::set<std::uint32_t> topics;  // of which each has its part of the index, however often it is named
    for (std::size_t i = 0; i < count; ++i) {
      topics.insert(number_in<std::uint32_t>(bytes_, i * kChunkInfoEntry));
    }
    chunks_.emplace_back(chunk_at, topics.size());
    return record_.end();
  }

  /// A chunk and its parts of the index. @return where they end
  std::uint64_t check_chunk(std::uint64_t at, std::size_t parts) {
    if (at < kFormat.size() || at >= size_) {
      damaged(at, fmt::format("a chunk should be there, the file has {} bytes", size_));
    }
    read_record(at, rosbag::OP_CHUNK, "a chunk");
    read_chunk();
    std::uint64_t next = record_.end();
    for (std::size_t i = 0; i < parts; ++i) next = check_index(next);
    return next;
  }

  /// Reads the chunk of record_ into chunk_.
  void read_chunk() {
    const std::string_view compression = record_.fields.text(rosbag::COMPRESSION_FIELD_NAME);
    const auto size = field<std::uint32_t>(rosbag::SIZE_FIELD_NAME);
    const bool plain = compression == rosbag::COMPRESSION_NONE;
    if (!plain && compression != rosbag::COMPRESSION_BZ2 && compression != rosbag::COMPRESSION_LZ4) {
      damaged(record_.at, "a chunk is compressed neither by bz2 nor by lz4");
    }
    const bool plausible = plain ? size == record_.data_size
                                 : size <= std::max(kPlausibleChunk, kMostCompressed * record_.data_size);
    if (!plausible) {
      damaged(record_.at, fmt::format("a chunk of {} bytes is said to hold {}", record_.data_size, size));
    }
    read(record_.data_at, record_.data_size, "a chunk", plain ? chunk_ : bytes_);
    if (plain) return;
    chunk_.assign(size, '\0');
    if (!streams_) streams_.emplace();
    try {
      streams_->factory
          .getStream(compression == rosbag::COMPRESSION_BZ2 ? rosbag::compression::BZ2
                                                            : rosbag::compression::LZ4)
          ->decompress(reinterpret_cast<std::uint8_t*>(chunk_.data()), size,
                       reinterpret_cast<std::uint8_t*>(bytes_.data()), record_.data_size);
    } catch (const rosbag::BagException& e) {
      damaged(record_.at, fmt::format("a chunk cannot be decompressed ({})", e.what()));
    }
  }

  /// One topic's part of the index of chunk_. @return where it ends
  std::uint64_t check_index(std::uint64_t at) {
    constexpr const char* kWhat = "the index of a chunk";
    read_record(at, rosbag::OP_INDEX_DATA, kWhat);
    const auto version = field<std::uint32_t>(rosbag::VER_FIELD_NAME);
    const auto connection = field<std::uint32_t>(rosbag::CONNECTION_FIELD_NAME);
    const auto count = field<std::uint32_t>(rosbag::COUNT_FIELD_NAME);
    if (version != rosbag::INDEX_VERSION || record_.data_size != count * std::uint64_t{kIndexEntry}) {
      damaged(at, fmt::format("{} contradicts itself", kWhat));
    }
    if (connections_.count(connection) == 0) damaged(at, fmt::format("{} is of no topic of the bag", kWhat));
    read(record_.data_at, record_.data_size, kWhat, bytes_);
    for (std::size_t i = 0; i < count; ++i) {
      const auto offset = number_in<std::uint32_t>(bytes_, i * kIndexEntry + 8);
      const bool timed = number_in<std::uint32_t>(bytes_, i * kIndexEntry + 4) < kNanosecondsOfASecond;
      if (!timed || !is_message(offset, connection)) {
        damaged(record_.data_at + i * kIndexEntry,
                fmt::format("no message is where {} says (byte {} of a chunk of {} bytes)", kWhat, offset,
                            chunk_.size()));
      }
    }
    return record_.end();
  }

  /// Whether a whole message of a connection begins there in chunk_.
  bool is_message(std::size_t offset, std::uint32_t connection) {
    std::string_view rest(chunk_);
    if (offset > rest.size() || rest.size() - offset < 8) return false;
    rest.remove_prefix(offset);
    const auto length = number_in<std::uint32_t>(rest);
    if (length > rest.size() - 8) return false;
    std::uint32_t found = 0;
    return message_.parse(rest.substr(4, length)) && message_.has_op(rosbag::OP_MSG_DATA) &&
           message_.number(rosbag::CONNECTION_FIELD_NAME, found) && found == connection &&
           number_in<std::uint32_t>(rest, 4 + length) <= rest.size() - 8 - length;
  }

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::optional<Streams> streams_;  // they take megabytes: from the first compressed chunk on
  BagRecord record_;                // the last that was read
  std::string bytes_, chunk_;
  RecordFields message_;
  std::set<std::uint32_t> connections_;
  std::vector<std::pair<std::uint64_t, std::size_t>> chunks_;  // where, and parts of the index
};

}  // namespace

void check_bag_structure(const std::string& path) {
  BagWalk(path).check();
}

}  // namespace softarm
