// Work that somebody may end before it is done.
#pragma once

#include <functional>

namespace softarm::math {

/// While it lives, in_parallel() asks it before every piece of work, on this thread and on those that it
/// starts (theirs, too): what the question throws ends the work. Scopes of one thread end in the opposite
/// order.
class StopScope {
 public:
  /// @param ask called from several threads at once; throws where the work is to end. Must outlive the scope
  explicit StopScope(const std::function<void()>* ask);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

  /// Of this thread; null: nobody ends anything.
  static const std::function<void()>* asked();

 private:
  const std::function<void()>* before_;
};

}  // namespace softarm::math
