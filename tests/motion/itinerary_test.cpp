// The sequence of legs and samples of a run, for every case of its rule.
#include "motion/itinerary.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace polhode {
namespace {

Scene scene_with(std::vector<double> impulses, double duration) {
    Scene scene;
    scene.duration = duration;
    for (const double at : impulses) {
        Impulse impulse;
        impulse.at = at;
        scene.loads.push_back(impulse);
    }
    return scene;
}

// "0:" enters leg 0, "a" to "d" show the samples in order, and "|" integrates along the leg.
std::string walked(const std::vector<Leg>& legs, SampleQueue samples) {
    std::string text;
    char name = 'a';
    const auto show = [&](double) {
        text += name++;
        return true;
    };
    const auto enter = [&](const Leg& leg) {
        text += std::to_string(leg.index) + ":";
        return true;
    };
    follow(legs, samples, enter, show, [&](const Leg& leg) {
        text += "|";
        for (; samples.due(leg, leg.end); samples.pop()) show(samples.front());
        return true;
    });
    return text;
}

TEST(Itinerary, LegsFollowEachOtherWithoutAGap) {
    const std::vector<Leg> legs = itinerary(scene_with({1, 0, 2.5, 1, 4}, 4));
    ASSERT_EQ(legs.size(), 4u);
    EXPECT_EQ(legs.front().begin, 0);
    for (std::size_t i = 0; i < legs.size(); ++i) {
        EXPECT_EQ(legs[i].index, i);
        EXPECT_EQ(legs[i].last, i == 3);
        if (i > 0) {
            EXPECT_EQ(legs[i].begin, legs[i - 1].end);
        }
    }
    EXPECT_EQ(legs[3].begin, 4) << "the impulse at the end opens a leg of no length";
    EXPECT_EQ(legs[3].end, 4);
}

TEST(Itinerary, ASampleAtAnEventShowsTheMotionAfterIt) {
    // samples at 0, 1, 2, 3
    EXPECT_EQ(walked(itinerary(scene_with({}, 3)), {3, 3}), "0:a|bcd") << "the last leg shows its end";
    EXPECT_EQ(walked(itinerary(scene_with({0}, 3)), {3, 3}), "0:a|bcd") << "an event at 0 comes before all samples";
    EXPECT_EQ(walked(itinerary(scene_with({1}, 3)), {3, 3}), "0:a|1:b|cd");
    EXPECT_EQ(walked(itinerary(scene_with({1.5}, 3)), {3, 3}), "0:a|b1:|cd");
    EXPECT_EQ(walked(itinerary(scene_with({3}, 3)), {3, 3}), "0:a|bc1:d|") << "an event at the end is shown";
    EXPECT_EQ(walked(itinerary(scene_with({1, 2, 3}, 3)), {3, 3}), "0:a|1:b|2:c|3:d|");
}

TEST(Itinerary, ALegWithoutLengthThatIsNotTheLastShowsNothing) {
    EXPECT_EQ(walked({{0, 0, 1, false}, {1, 1, 1, false}, {2, 1, 3, true}}, {3, 3}), "0:a|1:|2:b|cd");
}

TEST(Itinerary, TimesOfTheCallersOwnMayBeginLateAndRepeat) {
    const std::array<double, 4> times{0.5, 1, 1, 2};
    EXPECT_EQ(walked(itinerary(scene_with({1}, 3)), SampleQueue(times)), "0:|a1:bc|d");
    EXPECT_EQ(walked(itinerary(scene_with({1}, 3)), SampleQueue()), "0:|1:|");
}

TEST(Itinerary, WhatStopsTheWalkStopsItAtOnce) {
    const std::vector<Leg> legs = itinerary(scene_with({1}, 3));
    for (int stop = 0; stop < 3; ++stop) {
        SampleQueue samples(3, 3);
        int calls = 0;
        const auto unless = [&](int i) {
            return [&, i](auto&&) {
                ++calls;
                return i != stop;
            };
        };
        EXPECT_FALSE(follow(legs, samples, unless(0), unless(1), unless(2)));
        EXPECT_EQ(calls, stop + 1);
        EXPECT_EQ(samples.front(), stop < 2 ? 0 : 1) << "a sample that was refused is not taken off";
    }
}

// A driver that goes from sample to sample applies each event at the same place as one that goes from event to event.
TEST(Itinerary, EventsAreDueWhereTheirLegShowsTheSample) {
    const std::vector<Leg> legs = itinerary(scene_with({0, 0.5, 1, 3}, 3));
    EventQueue<Leg> events(legs);
    for (const double t : {0.0, 0.4, 0.5, 1.0, 2.0, 3.0}) {
        const Leg* leg = nullptr;
        while (events.due(t)) leg = &events.pop();
        for (const Leg& other : legs)
            if (leg && t >= other.begin) {
                EXPECT_EQ(other.shows(t), &other == leg) << t;
            }
        EXPECT_EQ(leg != nullptr, t != 0.4 && t != 2) << t;
    }
    EXPECT_FALSE(events.due(3));
}

}  // namespace
}  // namespace polhode
