#include "removed_on_signal.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <utility>

namespace softarm::app {
namespace {

// All that there are; only who holds `list_is_held` reads or changes them.
RemovedOnSignal* newest_unfinished = nullptr;
pid_t owner_of_unfinished = 0;  // what a fork has of them is its parent's
std::atomic_flag list_is_held = ATOMIC_FLAG_INIT;

sigset_t ending_signals() {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&set, signal);
  return set;
}

/// Holds the list. No handler interrupts the thread meanwhile, so a handler in another one may wait for it.
class HeldList {
 public:
  HeldList() {
    const sigset_t set = ending_signals();
    ::pthread_sigmask(SIG_BLOCK, &set, &before_);
    while (list_is_held.test_and_set(std::memory_order_acquire)) {
    }
  }
  ~HeldList() {
    list_is_held.clear(std::memory_order_release);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  HeldList(const HeldList&) = delete;
  HeldList& operator=(const HeldList&) = delete;

 private:
  sigset_t before_{};
};

void handle_what_is_by_default(void (*handler)(int)) {
  struct sigaction ours {};
  ours.sa_handler = handler;
  ours.sa_mask = ending_signals();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    ::sigaction(signal, nullptr, &now);
    if ((now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == SIG_DFL) ::sigaction(signal, &ours, nullptr);
  }
}

}  // namespace

/// Calls nothing but what may be called in a handler. The list stays held: nothing is begun any more.
void RemovedOnSignal::end(int signal) {
  while (list_is_held.test_and_set(std::memory_order_acquire)) {
  }
  if (owner_of_unfinished == ::getpid()) {
    for (const RemovedOnSignal* one = newest_unfinished; one != nullptr; one = one->older_)
      if (::unlink(one->path_.c_str()) != 0) ::rmdir(one->path_.c_str());
  }
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  ::sigaction(signal, &usual, nullptr);
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  ::raise(signal);
  ::_exit(128 + signal);  // the first process of a container, which no signal ends by default
}

RemovedOnSignal::RemovedOnSignal(std::string path) : path_(std::move(path)) {
  const HeldList held;
  handle_what_is_by_default(&RemovedOnSignal::end);
  owner_of_unfinished = ::getpid();
  older_ = newest_unfinished;
  if (older_ != nullptr) older_->newer_ = this;
  newest_unfinished = this;
}

RemovedOnSignal::~RemovedOnSignal() {
  const HeldList held;
  if (older_ != nullptr) older_->newer_ = newer_;
  (newer_ != nullptr ? newer_->older_ : newest_unfinished) = older_;
}

}  // namespace softarm::app
