#include "experiment/plan/method_style.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "figure/curve_style.h"
#include "integrators/engines/engine_methods.h"

namespace polhode {
namespace {

TEST(MethodStyle, FamiliesAreColorsAndMembersMarks) {
    std::map<Family, int> color;
    std::map<Family, std::set<int>> marks;
    for (const Method* method : methods()) {
        const MethodStyle style = method_style(*method);
        EXPECT_EQ(color.try_emplace(method->family, style.color).first->second, style.color) << method->name;
        EXPECT_TRUE(marks[method->family].insert(style.mark).second) << method->name;
        EXPECT_LT(style.color, color_count) << method->name;
    }
    std::set<int> colors;
    for (const auto& [family, one] : color) colors.insert(one);
    EXPECT_EQ(colors.size(), color.size());
    for (const auto& [family, places] : marks) {
        EXPECT_EQ(*places.begin(), 0);
        EXPECT_EQ(*places.rbegin(), static_cast<int>(places.size()) - 1);
    }
}

TEST(MethodStyle, ThoseFromOutsideStandBehindTheProgramsOwn) {
    int members = 0;
    for (const Method* method : methods()) members += method->family == Family::runge_kutta;
    Method own;
    own.family = Family::runge_kutta;
    EXPECT_EQ(method_style(own).color, method_style(*find_method("odeint_rk4")).color);
    EXPECT_EQ(method_style(own).mark, members);
    std::set<int> marks;
    for (const EngineMethod& engine : engines()) marks.insert(method_style(*engine.method).mark);
    EXPECT_EQ(marks.size(), engines().size());
}

// the palette has a colour for each family; engine is the last family
TEST(MethodStyle, EachFamilyHasAColor) { EXPECT_EQ(static_cast<int>(Family::engine), color_count - 1); }

}  // namespace
}  // namespace polhode
