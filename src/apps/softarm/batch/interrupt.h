// Ctrl-C and its like, asked for instead of dying of.
#pragma once

namespace softarm::app::batch {

/// From here on SIGINT, SIGTERM and SIGHUP are kept, until the second of them, which ends the process.
void keep_signals();

/// The signal that came; 0: none so far.
int signal_kept();

}  // namespace softarm::app::batch
