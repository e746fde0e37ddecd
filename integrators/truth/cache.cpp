#include "integrators/truth/cache.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "scene/scene_file.h"
#include "table/atomic_file.h"
#include "table/content_hash.h"

namespace polhode::truth {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view checksum_word = "checksum ";

fs::path cache_directory() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return fs::path(value ? value : "");
    };
    if (fs::path own = variable("POLHODE_CACHE"); !own.empty()) return own;
    if (const fs::path base = variable("XDG_CACHE_HOME"); base.is_absolute()) return base / "polhode";
    if (const fs::path home = variable("HOME"); !home.empty()) return home / ".cache" / "polhode";
    return {};
}

// every pair of a sample, in one order for writing and reading
template <class SampleType, class Visit>
void each_pair(SampleType& sample, Visit&& visit) {
    visit(sample.q.w), visit(sample.q.x), visit(sample.q.y), visit(sample.q.z);
    for (auto* block : {&sample.angular_velocity_B, &sample.angular_momentum_W, &sample.position_W, &sample.velocity_W})
        for (int i = 0; i < 3; ++i) visit((*block)[i]);
    visit(sample.energy);
}

void put(std::string& text, double value) {
    char buffer[40];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::hex);
    text.append(buffer, end.ptr).append(" ");
}

double take(std::istream& in) {
    std::string word;
    in >> word;
    double value = 0;
    const char* end = word.data() + word.size();
    const auto [stop, fault] = std::from_chars(word.data(), end, value, std::chars_format::hex);
    if (word.empty() || stop != end || fault != std::errc{}) throw std::runtime_error("no number");
    return value;
}

std::string encoded(const std::string& key, const Truth& truth) {
    const Reference& reference = truth.reference;
    std::string text = fmt::format("{}\n{}\n{}\n{}\n", cache_version, key, reference.message, reference.samples.size());
    put(text, reference.available ? 1 : 0);
    put(text, reference.bound);
    put(text, static_cast<double>(truth.steps));
    put(text, truth.seconds);
    text += '\n';
    for (std::size_t i = 0; i < reference.samples.size(); ++i) {
        put(text, reference.samples[i].t);
        each_pair(reference.samples[i], [&](const Pair& pair) { put(text, pair.high), put(text, pair.low); });
        for (const std::string& decimal : truth.decimals[i]) text.append(decimal).append(" ");
        text += '\n';
    }
    const std::string checksum = content_hash(text);
    return text.append(checksum_word).append(checksum).append("\n");
}

// throws where the text is not what encoded() wrote
Truth decoded(const std::string& key, const std::string& text) {
    const std::size_t mark = text.rfind(checksum_word);
    if (mark == std::string::npos) throw std::runtime_error("torn");
    const std::string body = text.substr(0, mark);
    if (text.substr(mark) != std::string(checksum_word) + content_hash(body) + "\n") throw std::runtime_error("torn");
    std::istringstream in(body);
    std::string version, own_key, count;
    Truth truth;
    std::getline(in, version), std::getline(in, own_key), std::getline(in, truth.reference.message);
    std::getline(in, count);
    if (version != cache_version || own_key != key) throw std::runtime_error("foreign");
    truth.reference.available = take(in) != 0;
    truth.reference.bound = take(in);
    truth.steps = static_cast<long>(take(in));
    truth.seconds = take(in);
    truth.reference.samples.resize(std::stoul(count));
    truth.decimals.resize(truth.reference.samples.size());
    for (std::size_t i = 0; i < truth.decimals.size(); ++i) {
        truth.reference.samples[i].t = take(in);
        each_pair(truth.reference.samples[i], [&](Pair& pair) { pair.high = take(in), pair.low = take(in); });
        for (std::string& decimal : truth.decimals[i]) in >> decimal;
    }
    if (!in) throw std::runtime_error("torn");
    return truth;
}

}  // namespace

std::string cache_key(const Scene& scene, long samples, int digits) {
    Scene bare = scene;
    bare.name = "truth";
    bare.about.clear(), bare.source.clear();
    bare.tolerated_attitude.reset();
    return content_hash(fmt::format("{}\n{}\n{}\n{}", cache_version, samples, digits, write_scene(bare)));
}

std::string cache_path(const std::string& key) {
    const fs::path directory = cache_directory();
    return directory.empty() ? "" : (directory / ("truth-" + key + ".txt")).string();
}

std::optional<Truth> cached(const std::string& key) {
    const std::string path = cache_path(key);
    std::ifstream file(path, std::ios::binary);
    if (path.empty() || !file) return {};
    try {
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        return decoded(key, text);
    } catch (const std::exception&) {
        return {};
    }
}

void keep(const std::string& key, const Truth& truth) {
    const std::string path = cache_path(key);
    if (path.empty()) return;
    try {
        fs::create_directories(fs::path(path).parent_path());
        write_atomically(path, encoded(key, truth));
    } catch (const std::exception&) {
        // left uncached
    }
}

}  // namespace polhode::truth
