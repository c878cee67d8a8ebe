// What a program that a signal ends takes with it.
#pragma once

#include <string>

namespace softarm::app {

/// A file, or a folder as long as it is empty, that is removed at once where SIGINT, SIGTERM or SIGHUP ends
/// the program while this object is there: of several the newest first. The program ends of that signal all
/// the same. A signal that it ignores, or handles itself, is left alone.
class RemovedOnSignal {
 public:
  explicit RemovedOnSignal(std::string path);
  ~RemovedOnSignal();
  RemovedOnSignal(const RemovedOnSignal&) = delete;
  RemovedOnSignal& operator=(const RemovedOnSignal&) = delete;

 private:
  static void end(int signal);

  std::string path_;
  RemovedOnSignal *newer_ = nullptr, *older_ = nullptr;
};

}  // namespace softarm::app
