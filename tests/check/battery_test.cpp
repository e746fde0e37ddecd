// Three small engines broken in some fifty ways on a dozen scenes: which faults are named, rightly or wrongly, and
// which are not. POLHODE_BATTERY=FILE.md runs all of it and writes the table of results/check_battery.md.
#include "check/battery.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "build_kind.h"
#include "check/diagnosis.h"
#include "text/parallel.h"

namespace polhode {
namespace {

// How a file is made of an engine's run.
struct Written {
    const char* name;
    double hertz;
    bool exact = false, binary32 = false, bare = false;
    bool rotation_only = false;  ///< without p and v
};

constexpr Written all_written[] = {
    {"60 Hz", 60},
    {"60 Hz, binary32", 60, false, true},
    {"60 Hz, no w", 60, false, false, true},
    {"240 Hz", 240},
    {"240 Hz, binary32", 240, false, true},
    {"240 Hz, no w", 240, false, false, true},
    {"240 Hz, no p and v", 240, false, false, false, true},
    {"1000 Hz", 1000},
    {"near exact, 60 rows a second", 60, true},
    {"near exact, 240 rows a second", 240, true},
    {"near exact, 240 rows a second, binary32", 240, true, true},
};

struct Count {
    int right = 0, wrong = 0, silent = 0;
    int all() const { return right + wrong + silent; }
    void operator+=(const Count& other) { right += other.right, wrong += other.wrong, silent += other.silent; }
};
using Counts = std::map<std::string, Count>;  // by fault; "sound" for none

bool differs(const TrajectoryFile& a, const TrajectoryFile& b) {
    if (a.rows.size() != b.rows.size()) return true;
    const auto apart = [](const Vector3<double>& x, const Vector3<double>& y) { return length(x - y) > 1e-5; };
    for (std::size_t k = 0; k < a.rows.size(); ++k) {
        const TrajectoryRow &x = a.rows[k], &y = b.rows[k];
        if (apart(x.angular_velocity_W, y.angular_velocity_W) || apart(x.position_W, y.position_W) ||
            apart(x.velocity_W, y.velocity_W) || apart({x.q.x, x.q.y, x.q.z}, {y.q.x, y.q.y, y.q.z}))
            return true;
    }
    return false;
}
// takes off the columns that are not written
void leave_out(TrajectoryFile& file, const Written& written) {
    for (TrajectoryRow& row : file.rows) {
        if (written.rotation_only) row.position_W = row.velocity_W = {};
        if (written.bare) row.angular_velocity_W = {};
    }
    if (written.rotation_only) file.has_position = file.has_velocity = false;
    if (written.bare) file.has_angular_velocity = false;
}

// A file of two seconds and 400 rows at the most; none where the fault means nothing there.
std::optional<TrajectoryFile> broken_file(const Scene& scene, const battery::Fault* fault, battery::EngineKind kind,
                                          const Written& written) {
    Scene given = scene;
    battery::Knobs knobs;
    if (fault && (!fault->engine(given, knobs) || !battery::has(kind, knobs))) return {};
    if (fault && fault->needs_rates && written.bare) return {};
    const int rows = std::min(static_cast<int>(2 * written.hertz), 400), every = written.exact ? 50 : 1;
    const double h = 1 / written.hertz / every;
    TrajectoryFile file = written.binary32 ? battery::run<float>(given, knobs, kind, h, every, rows)
                                           : battery::run<double>(given, knobs, kind, h, every, rows);
    if (fault && !fault->file(scene, file)) return {};
    leave_out(file, written);
    if (!fault) return file;
    TrajectoryFile sound = battery::run<double>(scene, {}, kind, h, every, rows);
    leave_out(sound, written);
    // what cannot be seen in the file cannot be told
    if (!differs(file, sound)) return {};
    return file;
}

// Every `stride`-th of all files.
Counts counted(const Written& written, std::size_t stride, std::string& told) {
    const std::vector<battery::Fault> faults = battery::faults();
    const std::vector<Scene> scenes = battery::scenes();
    struct Job {
        const Scene* scene;
        const battery::Fault* fault;
        battery::EngineKind kind;
    };
    std::vector<Job> jobs;
    for (const Scene& scene : scenes)
        for (const auto kind :
             {battery::EngineKind::world_rate, battery::EngineKind::momentum, battery::EngineKind::midpoint}) {
            if (written.exact && kind != battery::EngineKind::midpoint) continue;
            jobs.push_back({&scene, nullptr, kind});
            for (const battery::Fault& fault : faults) jobs.push_back({&scene, &fault, kind});
        }
    Counts counts;
    std::mutex lock;
    parallel_for(jobs.size() / stride, static_cast<int>(std::thread::hardware_concurrency()), [&](std::size_t i) {
        const Job& job = jobs[i * stride];
        const std::optional<TrajectoryFile> file = broken_file(*job.scene, job.fault, job.kind, written);
        if (!file) return;
        const std::vector<Diagnosis> found = diagnose(*job.scene, *file).faults;
        const bool right = job.fault && std::any_of(found.begin(), found.end(), [&](const Diagnosis& d) {
                               return std::ranges::find(job.fault->words, d.fault) != job.fault->words.end();
                           });
        const std::lock_guard guard(lock);
        Count& count = counts[job.fault ? job.fault->name : "sound"];
        ++(found.empty() ? count.silent : right ? count.right : count.wrong);
        if (right || (found.empty() && !job.fault)) return;
        told += fmt::format("{}, {}, engine {}:", job.fault ? job.fault->name : "sound", job.scene->name,
                            static_cast<int>(job.kind));
        for (const Diagnosis& d : found) told += " " + d.fault;
        told += "\n";
    });
    return counts;
}

Count sum_of_faults(const Counts& counts) {
    Count sum;
    for (const auto& [name, count] : counts)
        if (name != "sound") sum += count;
    return sum;
}

double percent(int part, int whole) { return whole == 0 ? 0 : 100.0 * part / whole; }

class Battery : public ::testing::TestWithParam<Written> {};

// A part of the battery; the goals are those of the whole.
TEST_P(Battery, FaultsAreNamedAndSoundFilesAreNot) {
    std::string told;
    const Counts counts = counted(GetParam(), optimised_build ? 19 : 997, told);
    const Count sum = sum_of_faults(counts);
    // a build that is not optimised runs too few for shares
    if (!optimised_build) return;
    ASSERT_GT(sum.all(), 15);
    const bool coarse = GetParam().hertz <= 60 && !GetParam().exact;
    EXPECT_GE(percent(sum.right, sum.all()), coarse ? 85 : 95) << told;
    EXPECT_LE(percent(sum.wrong, sum.all()), coarse || GetParam().bare ? 2 : 1) << told;
    if (const auto sound = counts.find("sound"); sound != counts.end()) {
        EXPECT_EQ(sound->second.silent, sound->second.all()) << told;
    }
}

std::string name_of_written(const ::testing::TestParamInfo<Written>& info) {
    std::string name;
    for (const char c : std::string(info.param.name))
        if (std::isalnum(static_cast<unsigned char>(c))) name += c;
    return name;
}
INSTANTIATE_TEST_SUITE_P(Files, Battery, ::testing::ValuesIn(all_written), name_of_written);

// Not a test but the table: only where a file is asked for.
TEST(BatteryTable, IsWritten) {
    const char* const path = std::getenv("POLHODE_BATTERY");
    if (!path) GTEST_SKIP() << "POLHODE_BATTERY names no file";
    std::string told;
    std::vector<Counts> all;
    for (const Written& written : all_written) all.push_back(counted(written, 1, told));
    std::string text =
        "# What check names\n\n"
        "Three small engines, written apart from the catalogue and from what `check` predicts with, broken in some "
        "fifty ways on\ntwelve scenes (tests/check/battery.h): how many files had their fault named rightly, how many "
        "were told another fault, and how\nmany nothing. A file in which the fault cannot be seen (an asymmetric "
        "body's "
        "fault on a ball) is not made. Written by\n`POLHODE_BATTERY=results/check_battery.md build/tests/check_tests "
        "--gtest_filter=BatteryTable.*`.\n\n"
        "| files | right | wrong | silent | of | right, % | wrong, % | sound files | of them told a fault |\n"
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    Counts by_fault;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Count sum = sum_of_faults(all[i]), sound = all[i]["sound"];
        text += fmt::format("| {} | {} | {} | {} | {} | {:.1f} | {:.1f} | {} | {} |\n", all_written[i].name, sum.right,
                            sum.wrong, sum.silent, sum.all(), percent(sum.right, sum.all()),
                            percent(sum.wrong, sum.all()), sound.all(), sound.all() - sound.silent);
        for (const auto& [name, count] : all[i])
            if (name != "sound") by_fault[name] += count;
    }
    text +=
        "\nBy fault, over all of these files:\n\n| fault | right | wrong | silent |\n| --- | ---: | ---: | ---: |\n";
    for (const auto& [name, count] : by_fault)
        text += fmt::format("| {} | {} | {} | {} |\n", name, count.right, count.wrong, count.silent);
    std::ofstream(path) << text;
    SUCCEED() << told;
}

}  // namespace
}  // namespace polhode
