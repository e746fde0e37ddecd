// A parallel pipeline: several threads work on pieces that are read and written in order.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>

#include "text/parallel.h"

namespace polhode {

/// Passes pieces from read() through work() to write() on at most `threads` threads. Each thread takes one piece
/// through all stages, so that it stays in that thread's cache. read() returns the next piece, or nothing at the end.
/// read() and write() are called by one thread at a time; write() receives the pieces in the order in which they were
/// read. work(piece) runs concurrently. At most twice as many pieces as threads are held in memory. After all threads
/// have stopped, rethrows the first exception; pieces not written by then are lost. An interruption of this thread
/// interrupts all of them.
template <class Read, class Work, class Write>
void work_in_order(int threads, const Read& read, const Work& work, const Write& write) {
    using Piece = typename std::invoke_result_t<Read>::value_type;
    const auto workers = static_cast<std::size_t>(std::max(1, threads));
    std::mutex reading;  // held while reading
    std::mutex mutex;    // protects the following variables
    std::condition_variable room;
    std::map<std::size_t, Piece> waiting;  // finished pieces whose predecessors are not written yet
    std::size_t started = 0, written = 0;
    bool finished = false, failed = false, writing = false;

    const auto next = [&](std::size_t& number) -> std::optional<Piece> {
        const std::lock_guard reading_lock(reading);
        {
            std::unique_lock lock(mutex);
            room.wait(lock, [&] { return finished || started - written < 2 * workers; });
            if (finished) return {};
        }
        std::optional<Piece> piece = read();
        const std::lock_guard lock(mutex);
        if (!piece) finished = true;
        number = started;
        started += piece ? 1 : 0;
        return piece;
    };
    // a thread that finishes a piece while no other thread writes, writes all pieces that are due
    const auto submit = [&](std::size_t number, Piece piece) {
        std::unique_lock lock(mutex);
        waiting.emplace(number, std::move(piece));
        if (writing) return;
        writing = true;
        while (!failed && !waiting.empty() && waiting.begin()->first == written) {
            auto due = waiting.extract(waiting.begin());
            lock.unlock();
            write(std::move(due.mapped()));
            lock.lock();
            ++written;
            room.notify_all();
        }
        writing = false;
    };
    parallel_for(workers, threads, [&](std::size_t) {
        try {
            std::size_t number = 0;
            while (std::optional<Piece> piece = next(number)) {
                work(*piece);
                submit(number, std::move(*piece));
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            finished = failed = true;
            room.notify_all();
            throw;
        }
    });
}

}  // namespace polhode
