// Processor time of a thread.
#pragma once

#include <ctime>

namespace polhode {

/// Processor time of the calling thread, s. Time that other processes and threads use is not included.
inline double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace polhode
