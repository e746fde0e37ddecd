// Methods that are added while the program runs.
#include "integrators/own_methods.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "integrators/run/watch.h"

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
    // what was given out before is as it was, and still there
    EXPECT_TRUE(std::ranges::equal(before, copy));
    EXPECT_EQ(first->identity, "first");
    EXPECT_FALSE(has_own_methods());
}

TEST(AddMethod, RefusesNamesOfTheProgramsOwn) {
    const std::size_t count = methods().size();
    EXPECT_THROW(add_method(made("taylor", "")), std::invalid_argument);
    EXPECT_THROW(add_method(made("", "")), std::invalid_argument);
    EXPECT_EQ(methods().size(), count);
}

}  // namespace
}  // namespace polhode
