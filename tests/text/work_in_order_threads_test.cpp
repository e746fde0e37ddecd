#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "text/work_in_order.h"

namespace polhode {
namespace {

// Squares of 0 .. count-1, computed by `threads` threads with varying delays. Reports the largest number of pieces
// held at once in `most_held`.
std::vector<int> squares(int count, int threads, int* most_held = nullptr) {
    std::vector<int> written;
    int next = 0;
    std::atomic<int> held{0}, most{0}, readers{0}, writers{0};
    work_in_order(
        threads,
        [&]() -> std::optional<int> {
            EXPECT_EQ(readers++, 0);
            const int number = next++;
            if (number < count) {
                const int now = ++held;
                for (int old = most; now > old && !most.compare_exchange_weak(old, now);) continue;
            }
            --readers;
            return number < count ? std::optional(number) : std::nullopt;
        },
        [](int& piece) {
            // the first of every four takes longest
            if (piece % 4 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
            piece *= piece;
        },
        [&](int piece) {
            EXPECT_EQ(writers++, 0);
            written.push_back(piece);
            --writers, --held;
        });
    if (most_held) *most_held = most;
    return written;
}

TEST(WorkInOrder, WritesEachPieceOnceInItsOrder) {
    for (const int threads : {1, 2, 3, 8}) {
        int held = 0;
        const std::vector<int> written = squares(500, threads, &held);
        ASSERT_EQ(written.size(), 500u);
        for (int i = 0; i < 500; ++i) EXPECT_EQ(written[static_cast<std::size_t>(i)], i * i);
        EXPECT_LE(held, 2 * threads);
    }
    EXPECT_TRUE(squares(0, 4).empty());
    EXPECT_EQ(squares(1, 4).size(), 1u);
}

TEST(WorkInOrder, AFaultOfAnyPartEndsAll) {
    for (const int faulty : {0, 1, 2}) {
        for (const int threads : {1, 2, 8}) {
            int next = 0;
            std::vector<int> written;
            const auto fail_at = [faulty](int part, int number) {
                if (part == faulty && number == 50) throw std::runtime_error("part " + std::to_string(part));
            };
            try {
                work_in_order(
                    threads,
                    [&]() -> std::optional<int> {
                        fail_at(0, next);
                        return next++;
                    },
                    [&](int& piece) { fail_at(1, piece); },
                    [&](int piece) {
                        fail_at(2, piece);
                        written.push_back(piece);
                    });
                FAIL() << "no error";
            } catch (const std::runtime_error& error) {
                EXPECT_EQ(error.what(), "part " + std::to_string(faulty));
            }
            // exactly the pieces before the faulty one, in order
            EXPECT_LE(written.size(), 50u);
            for (std::size_t i = 0; i < written.size(); ++i) EXPECT_EQ(written[i], static_cast<int>(i));
        }
    }
}

}  // namespace
}  // namespace polhode
