// What rosbag's library follows unseen in a file: lengths, offsets and counts.
#pragma once

#include <string>

namespace softarm {

/// Walks the records of a bag (http://wiki.ros.org/Bags/Format/2.0) as rosbag's library will, and holds every
/// length, offset and count against the bytes that are there: the library checks few of them and ends the
/// program, or takes gigabytes, where one is false. Reads the file once, and holds one chunk at a time.
/// @throws BagError if it is no bag, was cut off or is damaged: file, byte, what is there, remedy
void check_bag_structure(const std::string& path);

}  // namespace softarm
