#include "stop.h"

#include <utility>

namespace softarm::math {
namespace {

thread_local const std::function<void()>* ask_of_thread = nullptr;

}  // namespace

StopScope::StopScope(const std::function<void()>* ask) : before_(std::exchange(ask_of_thread, ask)) {}

StopScope::~StopScope() {
  ask_of_thread = before_;
}

const std::function<void()>* StopScope::asked() {
  return ask_of_thread;
}

}  // namespace softarm::math
