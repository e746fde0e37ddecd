// Multiprecision constants requested by two threads at once: TSan detects constants initialised without a lock.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "body/elementary.h"
#include "integrators/series/real.h"

namespace polhode::truth {
namespace {

template <unsigned digits>
void check_constants() {
    using P = Real<digits>;
    constexpr int threads = 4;
    std::atomic<int> waiting = 0, wrong = 0;
    std::vector<std::thread> all;
    for (int i = 0; i < threads; ++i)
        all.emplace_back([&] {
            ++waiting;
            while (waiting < threads) std::this_thread::yield();
            const P one_more = P(1) + Elementary<P>::epsilon(), halfway = P(1) + Elementary<P>::epsilon() / 4;
            if (!(one_more > 1) || halfway != 1 || !(Elementary<P>::infinity() > P(1e300))) ++wrong;
        });
    for (std::thread& thread : all) thread.join();
    EXPECT_EQ(wrong, 0);
}

TEST(ConstantsThreads, AreWholeInEachThread) {
    check_constants<40>();
    check_constants<50>();
    check_constants<100>();
}

}  // namespace
}  // namespace polhode::truth
