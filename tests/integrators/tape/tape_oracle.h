// Requirement on any tape: machine code and the interpreter with every instruction set give the same bits.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "integrators/tape/tape_series.h"

namespace polhode::testing {

/// Equal bits, or both NaN: the sign and payload of a NaN come from either operand.
inline bool same_bits(double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// Throws std::logic_error if a variant differs from the plain interpreter. Returns the number of variants compared.
inline int compare_ways(const Recording<double>& recording, int order, bool careful, const std::vector<double>& start) {
    const auto made = [&](InstructionSet set, bool compiled) {
        return TapeSeries(recording, {.instructions = set, .compiled = compiled, .careful = careful, .order = order});
    };
    TapeSeries plain = made(InstructionSet::plain, false);
    const std::vector<double> elsewhere(start.size(), 0.3);
    // an expansion must not depend on an earlier one
    plain.expand(elsewhere.data());
    plain.expand(start.data());
    int ways = 0;
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512})
        for (const bool compiled : {false, true}) {
            if (set > widest_instruction_set()) continue;
            TapeSeries other = made(set, compiled);
            other.expand(start.data());
            for (int k = 0; k <= order; ++k)
                for (int i = 0; i < plain.dimension(); ++i)
                    if (!same_bits(plain.coefficient(i, k), other.coefficient(i, k)))
                        throw std::logic_error(std::string(name_of(set)) + (compiled ? " code" : " interpreted") +
                                               ": other bits in order " + std::to_string(k));
            ++ways;
        }
    return ways;
}

using LaneNumbers = std::vector<double, LineAllocator<double>>;

/// The rates of eight states at once.
inline LaneNumbers rates_of(TapeRates& tape, const LaneNumbers& y) {
    LaneNumbers rates(y.size());
    tape.find(y.data(), rates.data());
    return rates;
}

/// compare_ways() for substeps of eight states at once: `start` and states near it.
inline int compare_ways_of_rates(const Recording<double>& recording, const std::vector<double>& start) {
    constexpr int lanes = TapeRates::lanes;
    LaneNumbers y(start.size() * lanes), now(y.size()), change(y.size()), scale(lanes);
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double lane = static_cast<double>(i % lanes);
        y[i] = start[i / lanes] * (1 + 0.25 * lane), now[i] = 0.125 * (lane - 2), change[i] = 1 - lane;
        scale[i % lanes] = 0.1 + lane;
    }
    const auto changed = [&](const TapeOptions& options) {
        TapeRates rates(recording, options);
        LaneNumbers to = change;
        // twice, because the result must not depend on memory left by the first call
        for (int time = 0; time < 2; ++time) to = change, rates({y.data(), now.data(), scale.data(), to.data()});
        return to;
    };
    const LaneNumbers plain = changed({.instructions = InstructionSet::plain, .compiled = false});
    int ways = 0;
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512})
        for (const bool compiled : {false, true}) {
            if (set > widest_instruction_set()) continue;
            const LaneNumbers other = changed({.instructions = set, .compiled = compiled});
            for (std::size_t i = 0; i < y.size(); ++i)
                if (!same_bits(plain[i], other[i]))
                    throw std::logic_error(std::string(name_of(set)) + (compiled ? " code" : " interpreted") +
                                           ": another rate of variable " + std::to_string(i / lanes));
            ++ways;
        }
    return ways;
}

/// Builds a tape from arbitrary bytes: a few for the states and the order, then some per operation. It does not read
/// beyond the end, and the same bytes give the same tape.
class TapeOfBytes {
  public:
    TapeOfBytes(const std::uint8_t* data, std::size_t size) : data_(data), end_(data + size) {
        using Kind = TapeNode<double>::Kind;
        const int states = 1 + next() % 20;
        order = 2 + next() % (TapeLayout::most_order - 1);
        careful = next() % 4 == 0;
        Tape<double>& tape = recording.tape;
        for (int i = 0; i < states; ++i) {
            tape.nodes.push_back({Kind::state, i, 0, 0, 0});
            start.push_back(number());
        }
        while (data_ < end_ && tape.nodes.size() < 300) {
            const Kind kind = static_cast<Kind>(1 + next() % 6);
            const int a = place(), b = place();
            switch (kind) {
                case Kind::combination:
                    if (a == b)
                        tape.nodes.push_back({kind, a, -1, factor(), next() % 2 == 0 ? 0 : factor()});
                    else
                        tape.nodes.push_back({kind, a, b, factor(), factor()});
                    break;
                case Kind::product:
                    tape.nodes.push_back({kind, a, b, 0, 0});
                    break;
                case Kind::quotient:
                    tape.nodes.push_back({kind, next() % 4 == 0 ? -1 : a, b, 0, 0});
                    break;
                case Kind::root:
                    tape.nodes.push_back({kind, a, -1, 0, 0});
                    break;
                default:
                    tape.add_sine(a);
            }
        }
        for (int i = 0; i < states; ++i) {
            const bool is_constant = next() % 8 == 0;
            const bool is_parameter = is_constant && next() % 2 == 0;
            recording.rates.emplace_back(is_parameter ? 0 : factor(), is_constant ? -1 : place(), nullptr);
        }
    }

    Recording<double> recording;
    std::vector<double> start;
    int order = 0;
    bool careful = false;

  private:
    const std::uint8_t *data_, *end_;

    int next() { return data_ < end_ ? *data_++ : 0; }
    /// The index of one of the last nodes.
    int place() {
        const int count = static_cast<int>(recording.tape.nodes.size());
        return count - 1 - next() % count;
    }
    double number() { return (next() - 128) / 64.0; }
    double factor() {
        static constexpr double often[] = {1, -1, 2, -2, 0.5, -0.5, 1.0 / 3, 3e200, -7e-200};
        const int i = next();
        return i < 150 ? often[i % 9] : (i - 200) / 16.0 + 0.01;
    }
};

}  // namespace polhode::testing
