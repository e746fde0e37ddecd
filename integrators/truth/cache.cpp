// Cache files of reference solutions: one text file per key, written atomically and checked by a checksum.
//
// encode() writes the mark, the key, the message, the samples (doubles in hexadecimal, then decimals), the impacts and,
// for several bodies, the system's invariants and the reactions. decode() reads them through WordReader, which throws
// on any malformed word; decode() then returns nothing, and the reference is computed again. cache_key() hashes the
// scene, the sample times, the digits and the identity of the program. CacheClaim prevents two processes from computing
// one key.
#include "integrators/truth/cache.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmp.h>
#include <mpfr.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "scene/scene_file.h"
#include "text/atomic_file.h"
#include "text/content_hash.h"
#include "text/sealed.h"

namespace polhode::truth {
namespace {

namespace fs = std::filesystem;

// first line of every cache file
constexpr std::string_view file_mark = "polhode truth";
constexpr std::string_view checksum_word = "checksum ";
// precedes the data that only references of several bodies have
constexpr std::string_view bodies_word = "bodies";
// precedes the data that only references with contact modes have
constexpr std::string_view contacts_word = "contacts";
// indices of planes, joints or pairs of bodies are below this
constexpr std::size_t most_places = 100'000'000;

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

// visits every Pair of a sample, in the same order for writing and reading
template <class SampleType, class Visit>
void visit_pairs(SampleType& sample, Visit&& visit) {
    visit(sample.q.w), visit(sample.q.x), visit(sample.q.y), visit(sample.q.z);
    for (auto* block : {&sample.angular_velocity_B, &sample.angular_momentum_W, &sample.position_W, &sample.velocity_W})
        for (int i = 0; i < 3; ++i) visit((*block)[i]);
    visit(sample.energy);
}

// visits every Pair of a system's invariants, and of a reaction
template <class SystemType, class Visit>
void visit_system_pairs(SystemType& system, Visit&& visit) {
    visit(system.kinetic), visit(system.energy);
    for (auto* block : {&system.angular_momentum_W, &system.linear_momentum_W})
        for (int i = 0; i < 3; ++i) visit((*block)[i]);
}
template <class ReactionType, class Visit>
void visit_reaction_pairs(ReactionType& reaction, Visit&& visit) {
    for (auto* block : {&reaction.force_W, &reaction.torque_W})
        for (int i = 0; i < 3; ++i) visit((*block)[i]);
}

void put(std::string& text, double value) {
    char buffer[40];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::hex);
    text.append(buffer, end.ptr).append(" ");
}

// Reads words separated by blanks. Throws std::runtime_error if a word does not have the requested type.
class WordReader {
  public:
    explicit WordReader(std::string_view text) : rest_(text) {}

    std::string_view line() {
        const std::size_t end = rest_.find('\n');
        if (end == rest_.npos) throw std::runtime_error("truncated");
        const std::string_view line = rest_.substr(0, end);
        rest_.remove_prefix(end + 1);
        return line;
    }
    std::string_view word() {
        rest_.remove_prefix(std::min(rest_.find_first_not_of(" \n"), rest_.size()));
        const std::string_view word = rest_.substr(0, rest_.find_first_of(" \n"));
        if (word.empty()) throw std::runtime_error("truncated");
        rest_.remove_prefix(word.size());
        return word;
    }
    double real() {
        const std::string_view text = word();
        double value = 0;
        const auto [stop, fault] =
            std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::hex);
        if (stop != text.data() + text.size() || fault != std::errc{}) throw std::runtime_error("not a number");
        return value;
    }
    std::size_t count(std::size_t most) {
        const std::string_view text = word();
        std::size_t value = 0;
        const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (stop != text.data() + text.size() || fault != std::errc{} || value > most)
            throw std::runtime_error("not a count");
        return value;
    }
    bool next_is(std::string_view word) const {
        WordReader ahead = *this;
        return ahead.more() && ahead.word() == word;
    }
    bool more() const { return rest_.find_first_not_of(" \n") != rest_.npos; }
    std::size_t left() const { return rest_.size(); }

  private:
    std::string_view rest_;
};

void encode_contacts(const Truth& truth, std::string& text) {
    // encode() writes the reactions of several bodies with their data
    const bool writes_reactions = truth.reference.system.empty();
    text += fmt::format("{} {} {} {}\n", contacts_word, truth.contact_events.size(), truth.contact_intervals.size(),
                        writes_reactions ? truth.reaction_decimals.size() : 0);
    for (const DecimalContactEvent& e : truth.contact_events)
        text += fmt::format("{} {} {} {} {}\n", e.t, e.plane, e.event, e.normal_impulse,
                            fmt::join(e.tangential_impulse, " "));
    for (const DecimalContactInterval& in : truth.contact_intervals) {
        text += fmt::format("{} {} {} {} ", in.from, in.to, in.plane, in.mode);
        put(text, in.largest_ratio);
        text += '\n';
    }
    if (!writes_reactions) return;
    for (const ReactionDecimals& decimals : truth.reaction_decimals)
        text += fmt::format("{}\n", fmt::join(decimals, " "));
}

// Reads the data that encode_contacts() writes.
void read_contacts(WordReader& in, Truth& truth) {
    if (in.word() != contacts_word) throw std::runtime_error("foreign");
    const std::size_t events = in.count(in.left() / 14), intervals = in.count(in.left() / 10);
    const std::size_t forces = in.count(in.left() / 12);
    truth.contact_events.resize(events), truth.contact_intervals.resize(intervals);
    std::vector<ReactionDecimals> reactions(forces);
    for (DecimalContactEvent& e : truth.contact_events) {
        e.t = in.word(), e.plane = in.count(most_places), e.event = in.word(), e.normal_impulse = in.word();
        for (std::string& component : e.tangential_impulse) component = in.word();
    }
    for (DecimalContactInterval& interval : truth.contact_intervals) {
        interval.from = in.word(), interval.to = in.word(), interval.plane = in.count(most_places);
        interval.mode = in.word(), interval.largest_ratio = in.real();
    }
    for (ReactionDecimals& decimals : reactions)
        for (std::string& decimal : decimals) decimal = in.word();
    if (forces > 0) truth.reaction_decimals = std::move(reactions);
}

}  // namespace

std::string encode(const std::string& key, const Truth& truth) {
    const Reference& reference = truth.reference;
    std::string text = fmt::format("{}\n{}\n{}\n{} {} {} ", file_mark, key, reference.message, reference.samples.size(),
                                   reference.available ? 1 : 0, truth.steps);
    put(text, reference.bound);
    put(text, truth.seconds);
    text += '\n';
    for (std::size_t i = 0; i < reference.samples.size(); ++i) {
        put(text, reference.samples[i].t);
        visit_pairs(reference.samples[i], [&](const Pair& pair) { put(text, pair.high), put(text, pair.low); });
        for (const std::string& decimal : truth.decimals[i]) text.append(decimal).append(" ");
        text += '\n';
    }
    // Written only if there are impacts: files of scenes without planes keep their format.
    if (!reference.impact_times.empty()) {
        text += fmt::format("{} ", reference.impact_times.size());
        put(text, reference.impact_time_error);
        for (std::size_t i = 0; i < reference.impact_times.size(); ++i) {
            put(text, reference.impact_times[i].high), put(text, reference.impact_times[i].low);
            text.append(truth.impact_decimals[i]).append(" ");
        }
        text += '\n';
    }
    // written only for several bodies
    if (!reference.system.empty()) {
        const auto pair = [&](const Pair& p) { put(text, p.high), put(text, p.low); };
        text += fmt::format("{} {} {}\n", bodies_word, reference.bodies, reference.reactions.size());
        for (const ReferenceSystem& system : reference.system) {
            put(text, system.t), visit_system_pairs(system, pair);
            text += '\n';
        }
        for (std::size_t i = 0; i < reference.reactions.size(); ++i) {
            visit_reaction_pairs(reference.reactions[i], pair);
            for (const std::string& decimal : truth.reaction_decimals[i]) text.append(decimal).append(" ");
            text += '\n';
        }
    }
    if (!truth.contact_events.empty() || !truth.contact_intervals.empty()) encode_contacts(truth, text);
    const std::string checksum = content_hash(text);
    return text.append(checksum_word).append(checksum).append("\n");
}

namespace {

// Reads the data of several bodies that encode() writes.
void read_system(WordReader& in, Truth& truth) {
    Reference& reference = truth.reference;
    const auto pair = [&](Pair& p) { p.high = in.real(), p.low = in.real(); };
    if (in.word() != bodies_word) throw std::runtime_error("foreign");
    const std::size_t bodies = in.count(std::max<std::size_t>(reference.samples.size(), 1));
    const std::size_t reactions = in.count(in.left() / 36);
    if (bodies < 1 || reference.samples.size() % bodies != 0) throw std::runtime_error("inconsistent");
    reference.bodies = static_cast<int>(bodies);
    reference.system.resize(reference.samples.size() / bodies);
    for (ReferenceSystem& system : reference.system) system.t = in.real(), visit_system_pairs(system, pair);
    reference.reactions.resize(reactions), truth.reaction_decimals.resize(reactions);
    for (std::size_t i = 0; i < reactions; ++i) {
        visit_reaction_pairs(reference.reactions[i], pair);
        for (std::string& decimal : truth.reaction_decimals[i]) decimal = in.word();
    }
}

}  // namespace

std::optional<Truth> decode(const std::string& key, std::string_view text) {
    const std::size_t checksum_start = text.rfind(checksum_word);
    if (checksum_start == text.npos) return {};
    const std::string_view body = text.substr(0, checksum_start);
    if (text.substr(checksum_start) != std::string(checksum_word) + content_hash(body) + "\n") return {};
    try {
        WordReader in(body);
        Truth truth;
        if (in.line() != file_mark || in.line() != key) return {};
        truth.reference.message = in.line();
        // a sample has 48 words, each with a blank: allocates no more than the text can contain
        const std::size_t samples = in.count(in.left() / 96);
        truth.reference.available = in.count(1) == 1;
        truth.steps = static_cast<long>(in.count(std::numeric_limits<long>::max()));
        truth.reference.bound = in.real();
        truth.seconds = in.real();
        truth.reference.samples.resize(samples);
        truth.decimals.resize(samples);
        for (std::size_t i = 0; i < samples; ++i) {
            truth.reference.samples[i].t = in.real();
            visit_pairs(truth.reference.samples[i], [&](Pair& pair) { pair.high = in.real(), pair.low = in.real(); });
            for (std::string& decimal : truth.decimals[i]) decimal = in.word();
        }
        if (in.more() && !in.next_is(bodies_word) && !in.next_is(contacts_word)) {
            const std::size_t impacts = in.count(in.left() / 6);
            truth.reference.impact_time_error = in.real();
            for (std::size_t i = 0; i < impacts; ++i) {
                const double high = in.real(), low = in.real();
                truth.reference.impact_times.emplace_back(high, low);
                truth.impact_decimals.emplace_back(in.word());
            }
        }
        if (in.next_is(bodies_word)) read_system(in, truth);
        if (in.more()) read_contacts(in, truth);
        return truth;
    } catch (const std::runtime_error&) {
        return {};
    }
}

namespace {

std::string make_key(const Scene& scene, const std::string& samples, int digits, const std::string& by) {
    Scene bare = scene;
    bare.name = "truth";
    bare.about.clear(), bare.source.clear();
    bare.tolerated.clear();
    return content_hash(fmt::format("{}\n{}\n{}\n{}", by, samples, digits, write_scene(bare)));
}

}  // namespace

std::string program() { return fmt::format("{}, MPFR {}, GMP {}", program_sources(), mpfr_get_version(), gmp_version); }

std::string cache_key(const Scene& scene, long samples, int digits, const std::string& by) {
    return make_key(scene, std::to_string(samples), digits, by);
}

std::string cache_key(const Scene& scene, const std::vector<double>& times, int digits, const std::string& by) {
    std::string text = "at ";
    for (const double t : times) put(text, t);
    return make_key(scene, text, digits, by);
}

std::string cache_path(const std::string& key) {
    const fs::path directory = cache_directory();
    return directory.empty() ? "" : (directory / ("truth-" + key + ".txt")).string();
}

std::optional<Truth> read_cached(const std::string& key) {
    const std::string path = cache_path(key);
    std::ifstream file(path, std::ios::binary);
    if (path.empty() || !file) return {};
    std::optional<Truth> truth = decode(key, std::string{std::istreambuf_iterator<char>(file), {}});
    if (!truth) warn_damaged(path);
    return truth;
}

CacheClaim::CacheClaim(const std::string& key, const std::function<bool()>& is_over) {
    const fs::path directory = cache_directory();
    if (directory.empty()) return;
    std::error_code none;
    fs::create_directories(directory, none);
    claims_.emplace((directory / "claims").string());
    while (!(claim_ = claims_->take(key)) && !is_over()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

void store(const std::string& key, const Truth& truth) {
    const std::string path = cache_path(key);
    if (path.empty()) return;
    try {
        const fs::path directory = fs::path(path).parent_path();
        fs::create_directories(directory);
        static std::once_flag once;  // listing the directory is slow
        std::call_once(once, [&] { remove_abandoned(directory.string()); });
        write_atomically(path, encode(key, truth));
    } catch (const std::exception&) {
        // the result stays uncached
    }
}

}  // namespace polhode::truth
