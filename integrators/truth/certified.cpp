#include "integrators/truth/certified.h"

#include <arb.h>
#include <flint/flint.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <stdexcept>

#include "integrators/truth/ball_decimal.h"
#include "integrators/truth/ball_flow.h"
#include "motion/problem.h"
#include "scene/scene_file.h"
#include "table/content_hash.h"

namespace polhode {
namespace {

using truth::Ball;
using truth::Bound;
using truth::Enclosure;
using truth::EulerForm;
using truth::Piece;
using truth::PiecePlan;

constexpr double bits_per_digit = 3.3219280948873623;
// what a series costs grows with the third power of the bits: beyond these, hours
constexpr long most_bits = 3000;

// The columns of a trajectory file after t, as balls: blocks q, w, p, v.
using Columns = std::array<Ball, 13>;
constexpr int block_begin[] = {0, 4, 7, 10, 13};

struct Attempt {
    std::string fault;
    std::set<std::string> methods;
    long steps = 0;
    std::vector<Columns> columns;
};

Columns columns_of(const EulerForm<Ball>& form, const std::vector<Ball>& y) {
    const truth::Motion<Ball> m = form.motion(y.data());
    const Vector3<Ball> w = rotate(m.q, m.angular_velocity_B);
    return {
        m.q.w,           m.q.x,           m.q.y,           m.q.z,           w[0],           w[1], w[2], m.position_W[0],
        m.position_W[1], m.position_W[2], m.velocity_W[0], m.velocity_W[1], m.velocity_W[2]};
}

// The motion at the working precision, piece by piece.
Attempt attempted(const Scene& scene, const std::vector<double>& times, const std::vector<PiecePlan>& plans) {
    Attempt attempt;
    EulerForm<Ball> form(scene);
    std::vector<Ball> y(form.dimension());
    form.initial(y.data());
    const std::vector<double> events = event_times(scene);
    std::size_t next = 0;  // the first sample still to come
    for (std::size_t i = 0; i + 1 < events.size(); ++i) {
        const double begin = events[i], end = events[i + 1];
        const bool last = i + 2 == events.size();
        form.enter(begin, y.data());
        Piece piece{form, begin, end, {}, plans[i]};
        // samples at an event belong to the piece that it opens
        const auto belongs = [&](double t) { return t < end || (last && t == end); };
        for (; next < times.size() && times[next] == begin && belongs(begin); ++next)
            attempt.columns.push_back(columns_of(form, y));
        for (; next < times.size() && belongs(times[next]); ++next) piece.sample_times.push_back(times[next]);
        Enclosure enclosure = truth::enclose_by_taylor(piece, y);
        attempt.methods.insert("Taylor series with a proven defect, errors carried by the logarithmic norm");
        attempt.steps += enclosure.steps;
        if (!enclosure.fault.empty()) {
            attempt.fault = enclosure.fault;
            return attempt;
        }
        for (const std::vector<Ball>& state : enclosure.samples) attempt.columns.push_back(columns_of(form, state));
        y = std::move(enclosure.end);
    }
    return attempt;
}

// log2 of the largest length of each block over the run; -infinity where it is zero
std::array<double, 4> block_sizes(const std::vector<Columns>& all) {
    std::array<double, 4> sizes;
    for (int b = 0; b < 4; ++b) {
        sizes[b] = -std::numeric_limits<double>::infinity();
        for (const Columns& columns : all) {
            Ball sum;
            for (int c = block_begin[b]; c < block_begin[b + 1]; ++c) sum += columns[c] * columns[c];
            sizes[b] = std::max(sizes[b], sum.log2_near() / 2);
        }
    }
    return sizes;
}

// What a radius in a block of that size may be for `digits` proven digits: at most 10^-digits, and that times the size.
double allowed_log2(double log2_size, int digits) {
    return -digits * bits_per_digit + (std::isfinite(log2_size) ? std::min(log2_size, 0.0) : 0.0);
}

void write(const std::vector<Columns>& all, int digits, CertifiedReference& result) {
    const std::array<double, 4> sizes = block_sizes(all);
    Bound largest;
    result.digits = digits;
    bool any = false;
    for (const Columns& columns : all) {
        result.columns.emplace_back();
        Bound widest;
        for (int b = 0; b < 4; ++b)
            for (int c = block_begin[b]; c < block_begin[b + 1]; ++c) {
                const double allowed = allowed_log2(sizes[b], digits) / bits_per_digit;
                const double radius = Bound::radius_of(columns[c]).log2_near() / bits_per_digit;
                // rounded where the radius begins, or three digits below what is allowed
                const long place = static_cast<long>(std::floor(std::max(radius, allowed - 3))) - 1;
                CertifiedNumber& number = result.columns.back()[c];
                Bound error;
                number.value = truth::decimal_near(columns[c], place, error);
                number.radius = truth::decimal_above(error);
                number.digits = digits;
                if (error.is_zero()) continue;
                const double size = std::isfinite(sizes[b]) ? sizes[b] : 0.0;
                number.digits = static_cast<int>(std::floor((size - error.log2_near()) / bits_per_digit - 1e-6));
                result.digits = any ? std::min(result.digits, number.digits) : number.digits;
                any = true;
                if (widest < error) widest = error;
            }
        result.bounds.push_back(truth::decimal_above(widest));
        if (largest < widest) largest = widest;
    }
    result.radius = truth::decimal_above(largest);
}

// log2 of the largest radius over what is allowed
double excess_bits(const std::vector<Columns>& all, int digits) {
    const std::array<double, 4> sizes = block_sizes(all);
    double worst = -std::numeric_limits<double>::infinity();
    for (const Columns& columns : all)
        for (int b = 0; b < 4; ++b)
            for (int c = block_begin[b]; c < block_begin[b + 1]; ++c) {
                if (!columns[c].is_finite()) return std::numeric_limits<double>::infinity();
                worst = std::max(worst, Bound::radius_of(columns[c]).log2_near() - allowed_log2(sizes[b], digits));
            }
    return worst;
}

}  // namespace

CertifiedReference certified_reference(const Scene& scene, long samples, int digits) {
    if (samples < 1) throw std::invalid_argument("the number of samples is below 1");
    if (digits < 1) throw std::invalid_argument("the number of digits is below 1");
    validate(scene, scene.name);
    CertifiedReference result;
    result.requested_digits = digits;
    result.scene_hash = content_hash(write_scene(scene));
    for (const Load& load : scene.loads)
        if (std::holds_alternative<UserTorque>(load)) {
            result.message = "no certified truth: a user's torque has none";
            return result;
        }
    const auto start = std::chrono::steady_clock::now();
    for (long k = 0; k <= samples; ++k) result.times.push_back(sample_time(scene.duration, k, samples));

    const std::vector<PiecePlan> plans = truth::plan_pieces(pose(scene));
    double growth = 0, spread = 0;
    for (const PiecePlan& plan : plans) growth += plan.growth_bits, spread = std::max(spread, plan.spread_bits);
    double bits = digits * bits_per_digit + growth + spread + 40;
    std::string fault;
    for (int attempts = 0; attempts < 6 && bits <= static_cast<double>(most_bits); ++attempts) {
        result.working_bits = (static_cast<long>(bits) + 31) / 32 * 32;
        const truth::WorkingPrecision precision(result.working_bits);
        Attempt attempt = attempted(scene, result.times, plans);
        fault = attempt.fault;
        // a decimal's rounding may add half as much again
        const double excess = fault.empty() ? excess_bits(attempt.columns, digits) + 1 : 0.3 * bits;
        if (fault.empty() && excess <= 0) {
            result.available = true;
            result.steps = attempt.steps;
            write(attempt.columns, digits, result);
            for (const std::string& method : attempt.methods)
                result.method += (result.method.empty() ? "" : "; ") + method;
            break;
        }
        bits = static_cast<double>(result.working_bits) + std::min(excess, bits) + 16;
    }
    flint_cleanup();
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (result.available) {
        result.message = fmt::format("{}, {} bits", result.method, result.working_bits);
    } else {
        const double had = digits - (bits - static_cast<double>(most_bits)) / bits_per_digit;
        result.times.clear();
        result.message = had < 1 ? fmt::format("no certified truth: the motion loses all digits of {} bits", most_bits)
                                 : fmt::format("no certified truth to {} digits: {} can be had", digits,
                                               static_cast<int>(std::floor(had)));
    }
    return result;
}

std::string ball_arithmetic_version() { return fmt::format("{} (FLINT {})", arb_version, FLINT_VERSION); }

}  // namespace polhode
