#include "interrupt.h"

#include <signal.h>

namespace softarm::app::batch {
namespace {

volatile sig_atomic_t kept = 0;

}  // namespace

void keep_signals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { kept = signal; };
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  ::sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
}

int signal_kept() {
  return kept;
}

}  // namespace softarm::app::batch
