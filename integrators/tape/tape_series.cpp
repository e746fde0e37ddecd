#include "integrators/tape/tape_series.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <unordered_map>

#include "body/elementary.h"

namespace polhode {
namespace {

std::uint64_t mix_hash(std::uint64_t hash, std::uint64_t word) {
    hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
    return hash ^ (hash >> 29U);
}

struct Key {
    Recording<double> recording;
    TapeOptions options;

    bool matches(const Recording<double>& r, const TapeOptions& options_) const {
        const auto equal = [](const Traced<double>& a, const Traced<double>& b) {
            return a.node == b.node && a.factor == b.factor;
        };
        return options == options_ && recording.tape.nodes == r.tape.nodes &&
               std::equal(recording.rates.begin(), recording.rates.end(), r.rates.begin(), r.rates.end(), equal);
    }
};
std::uint64_t hash_recording(const Recording<double>& recording) {
    std::uint64_t hash = 0;
    for (const TapeNode<double>& node : recording.tape.nodes) {
        hash = mix_hash(hash, (static_cast<std::uint64_t>(node.kind) << 60U) ^
                                  (static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.a)) << 28U) ^
                                  static_cast<std::uint32_t>(node.b));
        hash = mix_hash(hash,
                        std::bit_cast<std::uint64_t>(node.factor_a) + 3 * std::bit_cast<std::uint64_t>(node.factor_b));
    }
    for (const Traced<double>& rate : recording.rates)
        hash = mix_hash(hash, std::bit_cast<std::uint64_t>(rate.factor) + static_cast<std::uint64_t>(rate.node));
    return hash;
}

/// Process-wide cache of tapes. Cleared completely when it would exceed `most` bytes.
class TapeCache {
  public:
    std::shared_ptr<const PreparedTape> find(std::uint64_t hash, const Recording<double>& recording,
                                             const TapeOptions& options) {
        const std::lock_guard lock(mutex_);
        const auto [first, last] = tapes_.equal_range(hash);
        for (auto at = first; at != last; ++at)
            if (at->second.first.matches(recording, options)) return at->second.second;
        return nullptr;
    }
    void insert(std::uint64_t hash, Key key, std::shared_ptr<const PreparedTape> tape) {
        const std::size_t size = (tape->code ? tape->code->size() : 0) + 16 * tape->layout.end;
        const std::lock_guard lock(mutex_);
        if (size_ + size > most) tapes_.clear(), size_ = 0;
        size_ += size;
        tapes_.emplace(hash, std::pair(std::move(key), std::move(tape)));
    }

  private:
    static constexpr std::size_t most = std::size_t{64} << 20U;  ///< bytes

    std::mutex mutex_;
    std::size_t size_ = 0;
    std::unordered_multimap<std::uint64_t, std::pair<Key, std::shared_ptr<const PreparedTape>>> tapes_;
};

}  // namespace

void scalar_sine_cosine(double x, double& sine, double& cosine) { sine_cosine(x, sine, cosine); }

const TapeInterpreter& tape_interpreter(InstructionSet set) {
    constexpr const TapeInterpreter* all[] = {&tape_interpreter_plain, &tape_interpreter_avx2,
                                              &tape_interpreter_avx512};
    return *all[static_cast<std::size_t>(set)];
}

PreparedTape::PreparedTape(const Recording<double>& recording, const TapeOptions& options_)
    : program(recording, options_.purpose),
      layout(program, options_.purpose == TapeProgram::Purpose::rates ? 2
                      : options_.order > 0                            ? options_.order
                                                                      : best_order(program, options_.tolerance)),
      options(options_) {
    if (!options.compiled) return;
    code = options.purpose == TapeProgram::Purpose::rates
               ? compile_rates(program, options.instructions)
               : compile_series(program, layout, options.careful, options.instructions);
}

std::shared_ptr<const PreparedTape> prepare_tape(const Recording<double>& recording, const TapeOptions& options) {
    static TapeCache cache;
    const std::uint64_t hash = hash_recording(recording);
    if (std::shared_ptr<const PreparedTape> kept = cache.find(hash, recording, options)) return kept;
    auto tape = std::make_shared<const PreparedTape>(recording, options);
    cache.insert(hash, {recording, options}, tape);
    return tape;
}

int best_order(const TapeProgram& program, double tolerance) {
    // Approximate operation counts, for vectors of at most four numbers.
    const double once = static_cast<double>(program.begin.size()) + 250;
    const double each = static_cast<double>(program.step.size() + 2 * program.rates.size());
    const double lanes = 2.0 * static_cast<double>(program.pairs.size() + program.sums.size()) +
                         1.5 * static_cast<double>(program.rows.size());
    int best = 0;
    double least = HUGE_VAL;
    for (int order = 8; order <= TapeLayout::most_order; order += 2) {
        const TapeLayout layout(program, order);
        double work = once + each * order;
        for (int m = 1; m + 1 < order; ++m) {
            const int quarters = (layout.filled(m) + 3) / 4;
            work += lanes * quarters;
        }
        const double step = std::pow(tolerance, 1.0 / order) * std::exp(-0.7 / (order - 1));
        if (work / step < least) least = work / step, best = order;
    }
    return best;
}

TapeSeries::TapeSeries(const Recording<double>& recording, const TapeOptions& options)
    : tape_(prepare_tape(recording, options)),
      interpreter_(&tape_interpreter(options.instructions)),
      memory_(tape_->layout.end, 0.0) {
    for (const TapeProgram::Constant& constant : tape_->program.constants) memory_[constant.slot] = constant.value;
}

TapeRates::TapeRates(const Recording<double>& recording, TapeOptions options)
    : interpreter_(&tape_interpreter(options.instructions)) {
    options.purpose = TapeProgram::Purpose::rates;
    tape_ = prepare_tape(recording, options);
    memory_.resize(static_cast<std::size_t>(tape_->program.slots) * lanes);
    zeros_.resize(static_cast<std::size_t>(tape_->program.states) * lanes);
    for (const TapeProgram::Constant& constant : tape_->program.constants)
        std::fill_n(&memory_[static_cast<std::size_t>(constant.slot) * lanes], lanes, constant.value);
}

void TapeRates::find(const double* y, double* rates) {
    alignas(64) static constexpr double one[lanes] = {1, 1, 1, 1, 1, 1, 1, 1};
    std::fill_n(rates, zeros_.size(), 0);
    (*this)({y, zeros_.data(), one, rates});
}

}  // namespace polhode
