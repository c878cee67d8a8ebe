// The same work on many things, on several cores.
#pragma once

#include <cstddef>
#include <functional>

namespace softarm::math {

/// Calls work(0) ... work(count - 1), each once, from up to `jobs` threads; 0: as many as there are cores.
/// Rethrows the first exception once all have stopped; what had not been begun by then is not.
void in_parallel(std::size_t count, unsigned jobs, const std::function<void(std::size_t)>& work);

}  // namespace softarm::math
