// Imported robot files against motions computed without polhode (tests/import/README.md), one construct per file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "integrators/method.h"
#include "places.h"
#include "scene/scene_file.h"
#include "text/named_file.h"

namespace polhode {
namespace {

using nlohmann::json;

const std::string battery_folder = source_dir() + "/tests/import";

// Tolerance relative to the motion, and in rad. The solver's tolerance is 1e-12. The expected motions are accurate to
// 4e-10 where MuJoCo reduces a mesh and to 1e-11 elsewhere.
constexpr double allowed = 1e-8;

json read_json(const std::string& name) {
    std::ifstream file(battery_folder + "/" + name);
    return json::parse(file);
}

const json& battery_entries() {
    static const json battery = read_json("battery.json");
    return battery["files"];
}

const json& battery_entry(const std::string& file) {
    for (const json& entry : battery_entries())
        if (entry["file"] == file) return entry;
    throw std::out_of_range("no entry " + file);
}

std::vector<std::string> battery_files() {
    std::vector<std::string> files;
    for (const json& entry : battery_entries()) files.push_back(entry["file"]);
    return files;
}

Scene import_file(const json& entry) {
    json scene = {{"name", "battery"}, {"duration", 0.5}, {"import", entry.value("import", json::object())}};
    scene["import"]["file"] = entry["file"];
    if (entry.value("gravity", "") != "file")
        scene["loads"] = {{{"type", "gravity"}, {"acceleration", {1.5, -2.5, -9}}}};
    return parse_scene(scene.dump(), "battery.json", battery_folder + "/files");
}

bool contains_ignoring_case(const std::string& text, const std::string& phrase) {
    const auto same = [](char a, char b) { return std::tolower(a) == std::tolower(b); };
    return std::search(text.begin(), text.end(), phrase.begin(), phrase.end(), same) != text.end();
}

bool is_reported(const Scene& scene, const json& phrases) {
    for (const std::string phrase : phrases)
        for (const std::string& omission : scene.omitted)
            if (contains_ignoring_case(omission, phrase)) return true;
    return false;
}

Vector3<double> vector_of(const json& x) { return {x[0], x[1], x[2]}; }

double distance(const Vector3<double>& a, const Vector3<double>& b) { return std::sqrt(dot(a - b, a - b)); }

double angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
    const Quaternion<double> r = conjugate(a) * b;
    const Vector3<double> v = vector_part(r);
    return 2 * std::atan2(std::sqrt(dot(v, v)), std::abs(r.w));
}

bool ends_with_scope(const std::string& name, const std::string& last) {
    const std::string tail = "::" + last;
    return name.size() > tail.size() && name.compare(name.size() - tail.size(), tail.size(), tail) == 0;
}

// Matches the scene's bodies with the expected ones: by equal names, then by the last parts of names with ::, then
// expected bodies without a name in order.
std::vector<std::optional<std::size_t>> match_bodies(const Scene& scene, const json& bodies) {
    std::vector<std::optional<std::size_t>> matches(scene.bodies.size());
    std::vector<bool> is_taken(bodies.size());
    const auto match = [&](auto&& same) {
        for (std::size_t i = 0; i < matches.size(); ++i)
            for (std::size_t k = 0; k < bodies.size() && !matches[i]; ++k)
                if (!is_taken[k] && same(scene.bodies[i].name, bodies[k]["name"].get<std::string>()))
                    matches[i] = k, is_taken[k] = true;
    };
    match([](const std::string& a, const std::string& b) { return a == b; });
    match([](const std::string& a, const std::string& b) { return ends_with_scope(a, b) || ends_with_scope(b, a); });
    match([](const std::string&, const std::string& b) { return b.empty(); });
    return matches;
}

struct BatteryDifference {
    double position = 0;  ///< relative to the largest displacement of a centre of mass
    double attitude = 0;  ///< rad
};

// Several links that form one rigid body are one body; its frame is that of the link with its name.
BatteryDifference compare_motions(const Scene& scene, const Trajectory& trajectory, const json& expected,
                                  const std::vector<std::optional<std::size_t>>& matches) {
    const json& moments = expected["moments"];
    double size = 0;
    for (const json& moment : moments)
        for (std::size_t k = 0; k < expected["bodies"].size(); ++k)
            size = std::max(size, distance(vector_of(moment["bodies"][k]["center_of_mass"]),
                                           vector_of(moments[0]["bodies"][k]["center_of_mass"])));
    EXPECT_GT(size, 0.01) << "the file's motion is too small to tell anything";
    BatteryDifference largest;
    for (std::size_t t = 0; t < moments.size(); ++t) {
        for (std::size_t i = 0; i < matches.size(); ++i) {
            if (!matches[i]) continue;
            const json& there = moments[t]["bodies"][*matches[i]];
            const Sample& sample = trajectory.at(t)[i];
            const Body& body = scene.bodies[i].body;
            const Quaternion<double> q = normalized(sample.q), p = {there["attitude"][0], there["attitude"][1],
                                                                    there["attitude"][2], there["attitude"][3]};
            const Vector3<double> origin = sample.position_W - rotate(q, body.center_of_mass);
            double apart = distance(origin, vector_of(there["origin"]));
            const double mass = expected["bodies"][*matches[i]]["mass"];
            if (std::abs(body.mass - mass) <= 1e-12 * mass)
                apart = std::max(apart, distance(sample.position_W, vector_of(there["center_of_mass"])));
            largest.position = std::max(largest.position, apart / size);
            largest.attitude = std::max(largest.attitude, angle_between(p, q));
        }
    }
    return largest;
}

// Every moving rigid body is present with its whole mass, and no other body is.
void expect_same_bodies(const Scene& scene, const json& bodies,
                        const std::vector<std::optional<std::size_t>>& matches) {
    std::map<int, double> expected, imported;
    for (const json& body : bodies)
        if (body["welded_to"] >= 0) expected[body["welded_to"]] += body["mass"].get<double>();
    for (std::size_t i = 0; i < matches.size(); ++i) {
        if (!matches[i]) {
            // a massless link between two joints
            if (scene.bodies[i].body.mass == 0) continue;
            ADD_FAILURE() << "body " << scene.bodies[i].name << " is not expected";
            continue;
        }
        if (const int root = bodies[*matches[i]]["welded_to"]; root >= 0) imported[root] += scene.bodies[i].body.mass;
    }
    for (const auto& [root, mass] : expected)
        EXPECT_NEAR(imported[root], mass, 1e-8 * mass)
            << "mass of " << bodies[root]["name"] << " and what is fixed to it";
}

double mass_of(const Scene& scene) {
    double mass = 0;
    for (const NamedBody& one : scene.bodies) mass += one.body.mass;
    return mass;
}
double mass_of(const json& expected) {
    double mass = 0;
    for (const json& body : expected["bodies"]) mass += body["mass"].get<double>();
    return mass;
}

void record_difference(const std::string& file, const std::string& position, const std::string& attitude,
                       std::string verdict) {
    const char* path = std::getenv("POLHODE_IMPORT_DIFFERENCES");
    if (!path) return;
    std::replace_if(
        verdict.begin(), verdict.end(), [](char c) { return c == '\n' || c == '\t' || c == '|'; }, ' ');
    std::ofstream(path, std::ios::app) << file << '\t' << position << '\t' << attitude << '\t' << verdict << '\n';
}

std::string format_difference(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", x);
    return text;
}

// Imports the file. Returns the message if it is refused, else an empty string.
std::string import_or_refusal(const json& entry, Scene& scene) {
    try {
        scene = import_file(entry);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

class ImportBattery : public ::testing::TestWithParam<std::string> {};

TEST_P(ImportBattery, MovesAsComputedElsewhere) {
    const std::string file = GetParam();
    const json& entry = battery_entry(file);
    static const json expected_files = read_json("expected.json")["files"];
    Scene scene;
    const std::string refusal = import_or_refusal(entry, scene);
    if (entry.contains("refused")) {
        bool is_named = !refusal.empty();
        for (const std::string part : entry["refused"]) {
            EXPECT_TRUE(contains_ignoring_case(refusal, part)) << part << " is not in: " << refusal;
            is_named = is_named && contains_ignoring_case(refusal, part);
        }
        return record_difference(file, "", "", is_named ? "refused as expected" : "WRONG: " + refusal);
    }
    if (entry.contains("refused_or_omitted")) {
        bool is_named = is_reported(scene, entry["refused_or_omitted"]);
        for (const std::string part : entry["refused_or_omitted"])
            is_named = is_named || contains_ignoring_case(refusal, part);
        EXPECT_TRUE(is_named) << refusal;
        return record_difference(file, "", "", is_named ? "refused or reported as omitted" : "WRONG: " + refusal);
    }
    if (!refusal.empty() && entry.contains("may_refuse")) {
        for (const std::string part : entry["may_refuse"])
            EXPECT_TRUE(contains_ignoring_case(refusal, part)) << part << " is not in: " << refusal;
        return record_difference(file, "", "", HasFailure() ? "WRONG: " + refusal : "refused");
    }
    if (!refusal.empty()) {
        record_difference(file, "", "", "REFUSED: " + refusal);
        FAIL() << refusal;
    }

    bool is_omitted = false;
    for (const json& omission : entry.value("omitted", json::array())) {
        const bool is_named = is_reported(scene, omission["phrases"]);
        if (omission.contains("drop"))
            is_omitted = is_named;
        else
            EXPECT_TRUE(is_named) << "omitted without a word: " << omission["phrases"];
    }
    const json& variants = expected_files[file]["variants"];
    std::string variant = is_omitted ? "omitted" : "whole";
    for (const std::string other : entry.value("accepted", json::array()))
        if (std::abs(mass_of(variants[other]) - mass_of(scene)) < std::abs(mass_of(variants[variant]) - mass_of(scene)))
            variant = other;
    const json& expected = variants[variant];
    const std::vector<std::optional<std::size_t>> matches = match_bodies(scene, expected["bodies"]);
    expect_same_bodies(scene, expected["bodies"], matches);

    Settings settings;
    settings.tolerance = 1e-12, settings.samples = 2;
    const Trajectory trajectory = solve(pose(scene), *find_method("dop853"), settings);
    ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
    const BatteryDifference largest = compare_motions(scene, trajectory, expected, matches);
    EXPECT_LE(largest.position, allowed);
    EXPECT_LE(largest.attitude, allowed);
    // published values, to the digits given
    const json at_end = entry.value("at_end", json::object());
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const std::string& name = scene.bodies[i].name;
        if (at_end.contains(name)) {
            EXPECT_LE(distance(trajectory.at(2)[i].position_W, vector_of(at_end[name])), 1e-3) << name;
        }
    }
    record_difference(file, format_difference(largest.position), format_difference(largest.attitude),
                      HasFailure() ? "DIFFERS"
                      : is_omitted ? "agrees; reported as omitted"
                                   : "agrees");
}

INSTANTIATE_TEST_SUITE_P(Files, ImportBattery, ::testing::ValuesIn(battery_files()), [](const auto& name) {
    std::string text = name.param;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return text;
});

// Every file in the folder is in the battery, and every accepted file has an expected motion.
TEST(ImportBatteryFiles, EachFileHasAnExpectedMotionOrARefusal) {
    const json expected = read_json("expected.json")["files"];
    for (const std::string& file : battery_files()) {
        const json& entry = battery_entry(file);
        EXPECT_NE(entry.contains("refused") || entry.contains("refused_or_omitted"), expected.contains(file)) << file;
    }
}

}  // namespace
}  // namespace polhode
