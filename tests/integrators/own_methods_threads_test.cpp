// Methods registered at run time; in a separate program because other tests iterate over the list.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "integrators/run/watch.h"
#include "integrators/user_methods.h"

namespace polhode {
namespace {

std::shared_ptr<const Method> made(const std::string& name, const std::string& message) {
    Method description;
    description.name = name, description.identity = message;
    return make_method(description, [message](const Problem&, const Settings&) { return unsupported(message); });
}

TEST(AddMethod, StandsLastAndIsReplacedByItsName) {
    const std::span<const Method* const> before = methods();
    const std::vector<const Method*> copy(before.begin(), before.end());
    add_method(made("added_here", "first"));
    ASSERT_NE(find_method("added_here"), nullptr);
    EXPECT_EQ(methods().size(), copy.size() + 1);
    EXPECT_EQ(methods().back()->name, "added_here");
    const Method* first = find_method("added_here");
    add_method(made("added_here", "second"));
    EXPECT_EQ(methods().size(), copy.size() + 1);
    EXPECT_NE(find_method("added_here"), first);
    EXPECT_EQ(find_method("added_here")->identity, "second");
    // the list returned earlier is unchanged and still valid
    EXPECT_TRUE(std::ranges::equal(before, copy));
    EXPECT_EQ(first->identity, "first");
    EXPECT_FALSE(has_user_methods());
}

TEST(AddMethod, RefusesNamesOfTheProgramsOwn) {
    const std::size_t count = methods().size();
    EXPECT_THROW(add_method(made("taylor", "")), std::invalid_argument);
    EXPECT_THROW(add_method(made("", "")), std::invalid_argument);
    EXPECT_EQ(methods().size(), count);
}

TEST(AddMethod, GoesOnWhileOthersLook) {
    std::atomic<bool> done = false;
    std::vector<std::jthread> readers;
    std::atomic<long> looked = 0;
    for (int k = 0; k < 2; ++k)
        readers.emplace_back([&] {
            while (!done) {
                for (const Method* method : methods()) ASSERT_FALSE(method->name.empty());
                ++looked;
            }
        });
    for (int i = 0; i < 50 || looked < 4; ++i) add_method(made("added_meanwhile", std::to_string(i)));
    done = true;
    readers.clear();
    EXPECT_NE(find_method("added_meanwhile"), nullptr);
}

}  // namespace
}  // namespace polhode
