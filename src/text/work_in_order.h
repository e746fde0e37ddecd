// Pieces of something long: worked on by several threads, read and written in their order.
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

/// Carries pieces from read() by work() to write() with at most `threads` threads, each of which takes one piece all
/// the way, so that it stays in that thread's cache. read() gives the next piece, or nothing at the end; it is called
/// by one thread at a time, and so is write(), with the pieces in the order in which they were read; work(piece) runs
/// on all threads at once. At most twice as many pieces as threads are held. The first exception is thrown again here
/// after all threads have stopped; what was not written by then is not. The threads are interrupted with this one.
template <class Read, class Work, class Write>
void work_in_order(int threads, const Read& read, const Work& work, const Write& write) {
    using Piece = typename std::invoke_result_t<Read>::value_type;
    const auto workers = static_cast<std::size_t>(std::max(1, threads));
    std::mutex reading;  // held by who reads
    std::mutex mutex;    // of what follows
    std::condition_variable room;
    std::map<std::size_t, Piece> waiting;  // for those before them to be written
    std::size_t begun = 0, written = 0;
    bool ended = false, failed = false, writing = false;

    const auto next = [&](std::size_t& number) -> std::optional<Piece> {
        const std::lock_guard turn(reading);
        {
            std::unique_lock lock(mutex);
            room.wait(lock, [&] { return ended || begun - written < 2 * workers; });
            if (ended) return {};
        }
        std::optional<Piece> piece = read();
        const std::lock_guard lock(mutex);
        if (!piece) ended = true;
        number = begun;
        begun += piece ? 1 : 0;
        return piece;
    };
    // whoever brings a piece while nobody writes, writes what is due
    const auto hand_in = [&](std::size_t number, Piece piece) {
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
                hand_in(number, std::move(*piece));
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            ended = failed = true;
            room.notify_all();
            throw;
        }
    });
}

}  // namespace polhode
