// The time that a thread has worked.
#pragma once

#include <ctime>

namespace polhode {

/// s, of this thread alone: what other work on the machine takes away does not count.
inline double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace polhode
