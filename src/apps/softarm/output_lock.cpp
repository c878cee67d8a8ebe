#include "output_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "command.h"

namespace softarm::app {

OutputLock::OutputLock(const std::filesystem::path& path, const std::string& held) {
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(path, ignored);
  // A file is opened for writing: network file systems lock no other.
  file_ = ::open(path.c_str(), (folder ? O_RDONLY | O_DIRECTORY : O_RDWR | O_CREAT) | O_CLOEXEC, 0666);
  if (file_ < 0) throw Failure(fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno)));
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  const int why = errno;
  ::close(file_);
  throw Failure(
      why == EWOULDBLOCK ? held : fmt::format("{}: cannot be locked: {}", path.string(), std::strerror(why)));
}

OutputLock::~OutputLock() {
  ::close(file_);
}

}  // namespace softarm::app
