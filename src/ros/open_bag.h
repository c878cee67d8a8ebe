// Opens recordings, also side by side from several threads.
#pragma once

#include <rosbag/bag.h>

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

namespace softarm {

/// A bag that cannot be used. what() is one line: file, what is wrong, remedy.
class BagError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens a bag for reading. Bags may be read side by side; they are opened and destroyed by one thread at a
/// time.
/// @throws BagError if it is no bag, was cut off or is damaged (bag_structure.h)
std::shared_ptr<rosbag::Bag> open_bag(const std::string& path);

/// The name with its leading slash, which recorders may have left out.
std::string absolute_topic(const std::string& topic);

/// A new bag to write. Bags may be written side by side, each by one thread.
/// @throws rosbag::BagException if the file cannot be created
std::shared_ptr<rosbag::Bag> new_bag(const std::string& path);

/// Does what writes to a bag. @throws BagError with the file's name and the reason where the bag throws
/// @param path as which people know the file
void written(const std::string& path, const std::function<void()>& what);

}  // namespace softarm
