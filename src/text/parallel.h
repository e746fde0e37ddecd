// A parallel loop.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "text/interruption.h"

namespace polhode {

/// Calls work(i) for i = 0..count-1 on at most `jobs` threads, each index once. After all threads have stopped,
/// rethrows the first exception. An interruption of this thread interrupts all of them. work(i) must only write data
/// that belongs to i.
template <class Work>
void parallel_for(std::size_t count, int jobs, const Work& work) {
    const std::size_t threads = std::min<std::size_t>(count, jobs < 1 ? 1 : static_cast<std::size_t>(jobs));
    if (threads <= 1) {
        for (std::size_t i = 0; i < count; ++i) work(i);
        return;
    }
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    {
        // declared before the threads, which are joined before later declarations are destroyed
        const Interruption::Callback* interruption = Interruption::current();
        const auto help = [&] {
            const Interruption inherited(interruption);
            for (std::size_t i = next++; i < count; i = next++) {
                try {
                    work(i);
                } catch (...) {
                    const std::lock_guard lock(failure_mutex);
                    if (!failure) failure = std::current_exception();
                    next = count;
                }
            }
        };
        std::vector<std::jthread> pool;
        pool.reserve(threads);
        try {
            while (pool.size() < threads) pool.emplace_back(help);
        } catch (const std::system_error&) {
            // continue with the threads that the system granted, or with this one if there are none
            if (pool.empty()) help();
        } catch (...) {
            next = count;
            throw;
        }
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace polhode
