// The truth cache: exact round trip, keys, corrupted files, location.
#include "integrators/truth/cache.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "catalogue.h"
#include "integrators/truth/fresh_cache.h"
#include "places.h"

namespace polhode::truth {
namespace {

Scene scene_of(double rate) {
    Scene scene;
    scene.name = "cached";
    scene.duration = 1;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    scene.initial.angular_velocity = {rate, 0.5, 0.25};
    return scene;
}

std::string read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}
void write(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

void expect_same(const Truth& a, const Truth& b) {
    ASSERT_EQ(a.reference.samples.size(), b.reference.samples.size());
    EXPECT_EQ(a.reference.bound, b.reference.bound);
    EXPECT_EQ(a.reference.message, b.reference.message);
    EXPECT_EQ(a.decimals, b.decimals);
    EXPECT_EQ(a.steps, b.steps);
    for (std::size_t i = 0; i < a.reference.samples.size(); ++i) {
        const ReferenceSample &x = a.reference.samples[i], &y = b.reference.samples[i];
        EXPECT_EQ(x.t, y.t);
        EXPECT_EQ(x.q.w.high, y.q.w.high);
        EXPECT_EQ(x.q.z.low, y.q.z.low);
        EXPECT_EQ(x.angular_velocity_B[2].low, y.angular_velocity_B[2].low);
        EXPECT_EQ(x.angular_momentum_W[1].low, y.angular_momentum_W[1].low);
        EXPECT_EQ(x.energy.high, y.energy.high);
        EXPECT_EQ(x.energy.low, y.energy.low);
    }
}

TEST(TruthCache, ReadsBackTheSameBits) {
    const FreshCache cache;
    const Truth made = find_truth(scene_of(1), 5, 25);
    ASSERT_TRUE(made.reference.available);
    const std::optional<Truth> kept = read_cached(cache_key(scene_of(1), 5, 25));
    ASSERT_TRUE(kept);
    expect_same(made, *kept);
}

TEST(TruthCache, IsWhatIsUsed) {
    const FreshCache cache;
    Truth marked = find_truth(scene_of(1), 5, 25);
    marked.reference.message = "from the cache";
    store(cache_key(scene_of(1), 5, 25), marked);
    EXPECT_EQ(find_truth(scene_of(1), 5, 25).reference.message, "from the cache");
    EXPECT_NE(find_truth(scene_of(2), 5, 25).reference.message, "from the cache");
}

TEST(TruthCache, KeyIsTheMotionNotTheTexts) {
    Scene renamed = scene_of(1), longer = scene_of(1);
    renamed.name = "other", renamed.about = "told differently", renamed.tolerated["attitude"] = 1;
    longer.duration = 2;
    const std::string key = cache_key(scene_of(1), 5, 25);
    EXPECT_EQ(cache_key(renamed, 5, 25), key);
    EXPECT_NE(cache_key(longer, 5, 25), key);
    EXPECT_NE(cache_key(scene_of(1), 6, 25), key);
    EXPECT_NE(cache_key(scene_of(1), 5, 26), key);
    EXPECT_NE(cache_key(scene_of(1.0000000000000002), 5, 25), key);
}

TEST(TruthCache, WhatOtherCodeComputedIsNotFound) {
    const FreshCache cache;
    Truth other = find_truth(scene_of(1), 5, 25);
    other.reference.message = "of another program";
    std::filesystem::remove(cache_path(cache_key(scene_of(1), 5, 25)));
    const std::string there = cache_key(scene_of(1), 5, 25, "another " + program());
    store(there, other);
    ASSERT_EQ(read_cached(there)->reference.message, "of another program");
    EXPECT_FALSE(read_cached(cache_key(scene_of(1), 5, 25)));
    EXPECT_NE(find_truth(scene_of(1), 5, 25).reference.message, "of another program");
    const std::vector<double> times{0, 0.3};
    EXPECT_NE(cache_key(scene_of(1), times, 25, "another " + program()), cache_key(scene_of(1), times, 25));
}

// The key covers every folder included by the truth, except the thread clock, which does not affect digits, and the
// proofs in a subfolder, which are not cached.
TEST(TruthCache, TheProgramsKeyHoldsAllThatATruthIncludes) {
    const std::set<std::string> folders{"src/text",
                                        "src/body",
                                        "src/formula",
                                        "src/scene",
                                        "src/motion",
                                        "integrators/series",
                                        "integrators/closed_form",
                                        "integrators/maximal",
                                        "integrators/lanes",
                                        "integrators/tape",
                                        "integrators/contact",
                                        "integrators/truth"};
    int files = 0;
    for (const std::string& folder : folders) {
        EXPECT_NE(read(source_dir() + "/integrators/CMakeLists.txt").find(folder), std::string::npos) << folder;
        for (const auto& entry : std::filesystem::directory_iterator(source_dir() + "/" + folder)) {
            // the method `truth` only returns a computed truth; solve_*.h are for methods in binary64
            const std::string stem = entry.path().stem().string();
            if (!entry.is_regular_file() || stem == "truth_method" || stem.starts_with("solve_")) continue;
            std::istringstream lines(read(entry.path().string()));
            for (std::string line; std::getline(lines, line);) {
                if (line.rfind("#include \"", 0) != 0) continue;
                std::string path = line.substr(10, line.rfind('"') - 10);
                if (path.rfind("integrators/", 0) != 0) path = "src/" + path;
                if (path == "integrators/run/processor_time.h") continue;
                EXPECT_TRUE(folders.count(path.substr(0, path.rfind('/')))) << entry.path() << " includes " << path;
                ++files;
            }
        }
    }
    EXPECT_GT(files, 100);
}

TEST(TruthCache, BrokenFilesAreComputedAgain) {
    const FreshCache cache;
    const std::string key = cache_key(scene_of(1), 5, 25), path = cache_path(key);
    const Truth made = find_truth(scene_of(1), 5, 25);
    const std::string sound = read(path);
    ASSERT_FALSE(sound.empty());
    std::string changed = sound;
    const std::size_t digit = changed.find("p-", changed.size() / 2) - 1;
    changed[digit] = changed[digit] == '1' ? '2' : '1';
    find_truth(scene_of(2), 5, 25);
    const std::string foreign = read(cache_path(cache_key(scene_of(2), 5, 25)));
    for (const std::string& broken :
         {std::string(), sound.substr(0, sound.size() / 2), sound.substr(0, sound.size() - 1), changed, foreign,
          std::string("nonsense\n"), sound + "more\n"}) {
        write(path, broken);
        EXPECT_FALSE(read_cached(key)) << broken.size();
        expect_same(find_truth(scene_of(1), 5, 25), made);
        EXPECT_TRUE(read_cached(key));
    }
}

// A truth of two bodies at three times with four joints, in which every number is different.
Truth of_several_bodies(bool with_reactions) {
    Truth truth;
    Reference& r = truth.reference;
    double next = 1.0 / 3;
    const auto pair = [&] { return next *= 1.25, Pair(next, next * 0x1p-60); };
    const auto vector = [&] { return Vector3<Pair>(pair(), pair(), pair()); };
    const auto word = [&](std::string& decimal) { decimal = std::to_string(next *= 1.25); };
    r.available = true, r.message = "by hand, not computed", r.bound = 1e-26, r.bodies = 2;
    truth.steps = 7, truth.seconds = 0.125;
    for (int k = 0; k < 6; ++k) {
        ReferenceSample s;
        s.t = k / 2, s.q = {pair(), pair(), pair(), pair()};
        s.angular_velocity_B = vector(), s.position_W = vector(), s.velocity_W = vector();
        r.samples.push_back(s);
        for (std::string& decimal : truth.decimals.emplace_back()) word(decimal);
    }
    for (int k = 0; k < 3; ++k) r.system.push_back({1.0 * k, pair(), pair(), vector(), vector()});
    for (int k = 0; with_reactions && k < 12; ++k) {
        r.reactions.push_back({vector(), vector()});
        for (std::string& decimal : truth.reaction_decimals.emplace_back()) word(decimal);
    }
    return truth;
}

TEST(TruthCache, SeveralBodiesReadBackTheSameBits) {
    for (const bool with_reactions : {false, true})
        for (const bool with_impacts : {false, true}) {
            Truth made = of_several_bodies(with_reactions);
            if (with_impacts) made.reference.impact_times = {Pair(0.5, 1e-20)}, made.impact_decimals = {"0.5"};
            const std::string text = encode("key", made);
            const std::optional<Truth> back = decode("key", text);
            ASSERT_TRUE(back);
            expect_same(made, *back);
            EXPECT_EQ(back->reference.bodies, 2);
            EXPECT_EQ(back->reference.moments(), 3u);
            EXPECT_EQ(back->reference.impact_times, made.reference.impact_times);
            EXPECT_EQ(back->reference.reactions, made.reference.reactions);
            EXPECT_EQ(back->reaction_decimals, made.reaction_decimals);
            EXPECT_EQ(back->decimals, made.decimals);
            ASSERT_EQ(back->reference.system.size(), 3u);
            for (std::size_t k = 0; k < 3; ++k) {
                const ReferenceSystem &x = made.reference.system[k], &y = back->reference.system[k];
                EXPECT_EQ(x.t, y.t);
                EXPECT_EQ(x.kinetic, y.kinetic);
                EXPECT_EQ(x.energy, y.energy);
                EXPECT_EQ(x.angular_momentum_W, y.angular_momentum_W);
                EXPECT_EQ(x.linear_momentum_W, y.linear_momentum_W);
            }
            EXPECT_EQ(encode("key", *back), text);
        }
}

// A reference from the cache has the events of the computed one: spheres, joints, one body.
TEST(TruthCache, EventsReadBack) {
    const FreshCache cache;
    for (const char* name : {"contact/newtons_cradle", "joints/bouncing_slider", "contact/bowling_ball"}) {
        const Scene scene = find_scene(name);
        const DecimalReference computed = decimal_reference(scene, 1);
        const DecimalReference again = decimal_reference(scene, 1);
        ASSERT_TRUE(computed.available) << name << ": " << computed.message;
        EXPECT_FALSE(computed.contact_events.empty()) << name;
        EXPECT_EQ(again.contact_events, computed.contact_events) << name;
        EXPECT_EQ(again.contact_intervals, computed.contact_intervals) << name;
        EXPECT_EQ(again.reactions, computed.reactions) << name;
    }
}

TEST(TruthCache, SeveralBodiesThatDoNotFitTheirSamplesAreRefused) {
    for (const int bodies : {0, 4, 7, -1}) {
        Truth made = of_several_bodies(true);
        made.reference.bodies = bodies;
        EXPECT_FALSE(decode("key", encode("key", made))) << bodies;
    }
    Truth made = of_several_bodies(true);
    made.reaction_decimals.back().back().clear();
    EXPECT_FALSE(decode("key", encode("key", made)));
}

TEST(TruthCache, NoPlaceForItIsNoFault) {
    const FreshCache cache;
    ::setenv("POLHODE_CACHE", "/proc/no/such/place", 1);
    EXPECT_TRUE(find_truth(scene_of(1), 2, 25).reference.available);
}

TEST(TruthCache, LiesWhereTheEnvironmentSays) {
    const FreshCache cache;
    const auto before = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
    const std::string home = before("HOME"), base = before("XDG_CACHE_HOME");
    EXPECT_EQ(cache_path("k"), cache.directory() + "/truth-k.txt");
    ::unsetenv("POLHODE_CACHE");
    ::setenv("HOME", "/some/one", 1), ::setenv("XDG_CACHE_HOME", "/some/cache", 1);
    EXPECT_EQ(cache_path("k"), "/some/cache/polhode/truth-k.txt");
    // the specification requires that relative paths are ignored
    ::setenv("XDG_CACHE_HOME", "relative", 1);
    EXPECT_EQ(cache_path("k"), "/some/one/.cache/polhode/truth-k.txt");
    ::unsetenv("HOME"), ::unsetenv("XDG_CACHE_HOME");
    EXPECT_EQ(cache_path("k"), "");
    EXPECT_FALSE(read_cached("k"));
    if (!home.empty()) ::setenv("HOME", home.c_str(), 1);
    if (!base.empty()) ::setenv("XDG_CACHE_HOME", base.c_str(), 1);
}

TEST(TruthCache, KeyHasTheTimes) {
    EXPECT_NE(cache_key(scene_of(1), std::vector<double>{0, 1}, 25),
              cache_key(scene_of(1), std::vector<double>{0, 0.5}, 25));
    EXPECT_NE(cache_key(scene_of(1), std::vector<double>{0, 1}, 25),
              cache_key(scene_of(1), std::vector<double>{0, 1}, 26));
}

// A renamed file, or one with the key of another: the key inside the file decides.
TEST(TruthCache, AFileUnderAnotherNameIsNotTaken) {
    Truth made;
    made.reference.available = true, made.reference.message = "by hand";
    EXPECT_TRUE(decode("one", encode("one", made)));
    EXPECT_FALSE(decode("other", encode("one", made)));
    EXPECT_TRUE(decode("one", encode("one", made))->reference.available);
    made.reference.available = false;
    EXPECT_FALSE(decode("one", encode("one", made))->reference.available);
}

}  // namespace
}  // namespace polhode::truth
