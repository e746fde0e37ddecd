// Extrapolation of the explicit midpoint rule for many motions side by side, one per lane.
//
// ExtrapolatedLanes::advance interleaves two registers of eight motions. Kernels holds the parts of a step for one
// register, compiled for each instruction set: the start of a column (begin_column) and the end of all columns
// (end_columns), which extrapolates, accepts or rejects, and selects the next step size of each lane.
#include "integrators/own/extrapolated_lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "integrators/lanes/lane_math.h"
#include "integrators/lanes/rotation_lanes.h"
#include "integrators/own/extrapolation_control.h"
#include "text/decimal.h"
#include "text/interruption.h"

namespace polhode {
/// The data of a step's end, in whole registers: eight numbers per variable.
struct ExtrapolatedLanes::StepEnd {
    int size;
    const char* is_moving;
    const int* units;
    double tolerance, span, max_steps;
    const ExtrapolationRow* row;
    const double* const* columns;
    double *sizes, *next, *next_lost, *start, *lost;
    Control* control;
};

/// Functions for one register, in whole registers.
struct ExtrapolatedLanes::Kernels {
    void (*begin)(const Control&, double span, int n, std::size_t end, const double* rate, double* twice_h, double* now,
                  double* before);
    void (*end)(const StepEnd&);

    static const Kernels& select_kernels(InstructionSet set);

    POLHODE_INLINE static Octet step_size(const Control& c, double span) {
        return smaller(octet_at(c.step), span - octet_at(c.time));
    }

    // z_1 = h f(y), z_0 = 0.
    POLHODE_INLINE static void begin_column(const Control& c, double span, int n, std::size_t end, const double* rate,
                                            double* twice_h, double* now, double* before) {
        const Octet h = step_size(c, span) / octet(n);
        put(twice_h, 2.0 * h);
        for (std::size_t i = 0; i < end; i += 8) put(now + i, h * octet_at(rate + i)), put(before + i, octet(0));
    }

    // Computes y + T_KK with its rounding error. Returns the square of T_KK - T_K,K-1 in units of the allowed error.
    POLHODE_INLINE static Octet extrapolate(const StepEnd& s) {
        for (int i = 0; i < s.size; ++i) {
            double* const size = s.sizes + 8 * s.units[i];
            put(size, larger(octet_at(size), magnitude(octet_at(s.start + 8 * i))));
        }
        const int last = s.row->columns - 1;
        const double slack = 0x1p-53 * s.row->amplification;
        Octet squared = octet(0);
        for (int i = 0; i < s.size; ++i) {
            if (!s.is_moving[i]) continue;
            const Octet finest = octet_at(s.columns[last] + 8 * i);
            Octet value = octet(0), error = octet(0);
            for (int j = 0; j < last; ++j) {
                const Octet difference = octet_at(s.columns[j] + 8 * i) - finest;
                value += s.row->weights.value[j] * difference;
                error += s.row->weights.error[j] * difference;
            }
            const Octet allowed = s.tolerance * octet_at(s.sizes + 8 * s.units[i]) + slack * magnitude(finest);
            const Octet relative = error / allowed;
            squared += relative * relative;
            const Octet y = octet_at(s.start + 8 * i), sum = y + finest;
            const Octet rest = (value + octet_at(s.lost + 8 * i)) + Octet{rounded_away(y.v, finest.v, sum.v)};
            const Octet next = sum + rest;
            put(s.next + 8 * i, next);
            put(s.next_lost + 8 * i, Octet{rounded_away(sum.v, rest.v, next.v)});
        }
        return squared;
    }

    /// log2 x for x >= 0, from the bits of x: up to 0.09 too small, -1023 for 0.
    POLHODE_INLINE static Octet rough_log2(const Octet& x) {
        const Octet shifted = from_bits(((bits(x) >> 12) & 0x0007'ffff'ffff'ffff) | bits(octet(0x1p52)));
        return (shifted - 0x1p52) * 0x1p-40 - 1023.0;
    }
    /// Rounds H down to about thirty binary digits and a multiple of all n_j, so that every H/n_j and the sum of the
    /// steps are exact.
    POLHODE_INLINE static Octet on_grid(const Octet& H, int odd_multiple) {
        const Octet unit = from_bits(bits(H) & 0x7ff0'0000'0000'0000) * (0x1p-30 * odd_multiple);
        return select(H > octet(1e-200), rounded(H / unit - 0.5) * unit, H);
    }
    POLHODE_INLINE static Octet infinite() { return octet(std::numeric_limits<double>::infinity()); }

    // Accepts or rejects the step and selects the next H: the least of the last four suggestions (see OrderControl).
    POLHODE_INLINE static void end_columns(const StepEnd& s) {
        Control& c = *s.control;
        const Octet squared = extrapolate(s), H = step_size(c, s.span), step = octet_at(c.step),
                    time = octet_at(c.time);
        const OctetMask accepted = squared <= octet(1), is_finite = squared * 0.0 == octet(0);
        for (int i = 0; i < s.size; ++i) {
            if (!s.is_moving[i]) continue;
            put(s.start + 8 * i, select(accepted, octet_at(s.next + 8 * i), octet_at(s.start + 8 * i)));
            put(s.lost + 8 * i, select(accepted, octet_at(s.next_lost + 8 * i), octet_at(s.lost + 8 * i)));
        }
        constexpr double ln2 = 0x1.62e42fefa39efp-1;
        const Octet exponent = (usual_log2_aim - 0.5 * rough_log2(squared)) * (1.0 / (2 * s.row->columns - 1));
        const Octet factor = step_safety * exponential(ln2 * smaller(larger(exponent, octet(least_log2_factor)),
                                                                     octet(largest_log2_factor)));
        Octet least = H * select(is_finite, factor, octet(0.1));
        least = select(accepted, least, smaller(least, 0.9 * H));
        for (double* const suggested : c.suggested) {
            const Octet before = select(is_finite, octet_at(suggested), infinite());
            put(suggested, least);
            least = smaller(before, least);
        }
        const Octet next = on_grid(least, s.row->odd_multiple);
        // A step that was shortened at the end of the span does not limit the next one.
        put(c.step, select(accepted, select(H < step, larger(next, step), next), next));
        const Octet now = select(accepted, select(s.span - time <= H, octet(s.span), time + H), time);
        const Octet taken = octet_at(c.taken) + 1.0;
        const auto code = [](LaneMotion::End how) { return octet(1 + static_cast<int>(how)); };
        Octet ended = select(now + octet_at(c.step) > now, octet(0),
                             select(is_finite, code(LaneMotion::End::too_short), code(LaneMotion::End::not_finite)));
        ended = select(taken < octet(s.max_steps), ended, code(LaneMotion::End::too_many_steps));
        put(c.ended, select(now == octet(s.span), code(LaneMotion::End::reached), ended));
        put(c.time, now), put(c.taken, taken);
    }

    static void begin_plain(const Control& c, double span, int n, std::size_t end, const double* rate, double* twice_h,
                            double* now, double* before) {
        begin_column(c, span, n, end, rate, twice_h, now, before);
    }
    POLHODE_TARGET_AVX2 static void begin_avx2(const Control& c, double span, int n, std::size_t end,
                                               const double* rate, double* twice_h, double* now, double* before) {
        begin_column(c, span, n, end, rate, twice_h, now, before);
    }
    POLHODE_TARGET_AVX512 static void begin_avx512(const Control& c, double span, int n, std::size_t end,
                                                   const double* rate, double* twice_h, double* now, double* before) {
        begin_column(c, span, n, end, rate, twice_h, now, before);
    }
    static void end_plain(const StepEnd& s) { end_columns(s); }
    POLHODE_TARGET_AVX2 static void end_avx2(const StepEnd& s) { end_columns(s); }
    POLHODE_TARGET_AVX512 static void end_avx512(const StepEnd& s) { end_columns(s); }
};

const ExtrapolatedLanes::Kernels& ExtrapolatedLanes::Kernels::select_kernels(InstructionSet set) {
    static constexpr Kernels all[] = {{begin_plain, end_plain}, {begin_avx2, end_avx2}, {begin_avx512, end_avx512}};
    return all[static_cast<std::size_t>(set)];
}

LaneFailure describe_failure(const LaneMotion& motion, double begin, long max_steps) {
    const std::string at = shortest_decimal(begin + motion.reached);
    if (motion.end == LaneMotion::End::too_many_steps)
        return {Status::failed, "more than " + std::to_string(max_steps) + " steps are needed"};
    if (motion.end == LaneMotion::End::interrupted) return {Status::failed, "interrupted at t = " + at};
    if (motion.end == LaneMotion::End::too_short)
        return {Status::tolerance_not_met, "step size below the spacing of numbers at t = " + at};
    return {Status::diverged, "the motion is not finite after t = " + at};
}

ExtrapolatedLanes::ExtrapolatedLanes(const Recording<double>& recording, std::vector<int> units, double tolerance,
                                     long max_steps, const TapeOptions& options)
    : size_(static_cast<int>(recording.rates.size())),
      tolerance_(tolerance),
      max_steps_(max_steps),
      row_(&extrapolation_rows[static_cast<std::size_t>(initial_row(tolerance, max_columns))]),
      units_(std::move(units)),
      kernels_(&Kernels::select_kernels(options.instructions)),
      rates_(recording, options) {
    for (int i = 0; i < size_; ++i) {
        is_moving_.push_back(rates_.is_parameter(i) ? 0 : 1);
        if (is_moving_.back()) moving_ = i + 1;
    }
    const std::size_t end = index_of(size_, 0);
    for (Register& r : registers_) {
        for (Numbers8* const list : {&r.start, &r.lost, &r.rate, &r.scratch, &r.next, &r.next_lost})
            list->assign(end, 0);
        r.sizes.assign(end, 1), r.twice_h.assign(lanes, 0);
        for (Numbers8& column : r.column) column.assign(end, 0);
    }
}

void ExtrapolatedLanes::fill(Register& r, int lane, std::vector<LaneMotion>& motions, std::size_t& next) {
    if (r.motion[lane]) --r.busy;
    LaneMotion* const motion = next < motions.size() ? &motions[next++] : nullptr;
    r.motion[lane] = motion;
    if (motion) ++r.busy, r.has_new = true;
    Control& c = r.control;
    // Lanes without a motion do not advance.
    c.time[lane] = c.ended[lane] = 0, c.step[lane] = motion ? motion->step : 0;
    c.taken[lane] = motion ? static_cast<double>(motion->steps) : 0;
    for (double* const suggested : c.suggested) suggested[lane] = std::numeric_limits<double>::infinity();
    for (int i = 0; i < size_; ++i) {
        r.start[index_of(i, lane)] = motion ? motion->y[i] : 0, r.lost[index_of(i, lane)] = 0;
        r.sizes[index_of(i, lane)] = motion ? motion->sizes[i] : 1;
    }
}

// A step in which no variable changes by more than half its scale.
double ExtrapolatedLanes::first_step(const Register& r, int lane, double span) const {
    double rate = 0;
    for (int i = 0; i < size_; ++i)
        rate = std::max(rate, std::abs(r.rate[index_of(i, lane)]) / r.sizes[index_of(units_[i], lane)]);
    return rate > 0 && rate * span > 0.5 ? 0.5 / rate : span;
}

void ExtrapolatedLanes::begin_step(Register& r, double span) {
    rates_.find(r.start.data(), r.rate.data());
    if (!std::exchange(r.has_new, false)) return;
    for (int lane = 0; lane < lanes; ++lane)
        if (r.motion[lane] && r.control.step[lane] == 0)
            r.control.step[lane] = step_on_grid(first_step(r, lane, span), row_->odd_multiple);
}

void ExtrapolatedLanes::end_step(Register& r, double span, std::vector<LaneMotion>& motions, std::size_t& next) {
    std::array<const double*, max_columns> columns{};
    for (int j = 0; j < row_->columns; ++j) columns[j] = r.column[j].data();
    kernels_->end({moving_, is_moving_.data(), units_.data(), tolerance_, span, static_cast<double>(max_steps_), row_,
                   columns.data(), r.sizes.data(), r.next.data(), r.next_lost.data(), r.start.data(), r.lost.data(),
                   &r.control});
    for (int lane = 0; lane < lanes; ++lane) {
        LaneMotion* const motion = r.motion[lane];
        if (!motion || r.control.ended[lane] == 0) continue;
        motion->end = static_cast<LaneMotion::End>(static_cast<int>(r.control.ended[lane]) - 1);
        for (int i = 0; i < moving_; ++i)
            if (is_moving_[i]) motion->y[i] = r.start[index_of(i, lane)];
        motion->step = r.control.step[lane], motion->reached = r.control.time[lane];
        motion->steps = static_cast<long>(r.control.taken[lane]);
        fill(r, lane, motions, next);
    }
}

void ExtrapolatedLanes::advance(std::vector<LaneMotion>& motions, double span) {
    std::size_t next = 0;
    for (Register& r : registers_)
        for (int lane = 0; lane < lanes; ++lane) fill(r, lane, motions, next);
    constexpr int check_interval = 64;
    for (int until_check = check_interval;; --until_check) {
        if (until_check == 0) {
            until_check = check_interval;
            // Interrupted motions keep the state from the start of the span; waiting ones are not started.
            if (Interruption::is_requested()) {
                for (const Register& r : registers_)
                    for (LaneMotion* const motion : r.motion)
                        if (motion) motion->end = LaneMotion::End::interrupted;
                for (; next < motions.size(); ++next) motions[next].end = LaneMotion::End::interrupted;
                return;
            }
        }
        std::array<Register*, 2> busy{};
        std::size_t count = 0;
        for (Register& r : registers_)
            if (r.busy > 0) busy[count++] = &r;
        if (count == 0) return;
        for (std::size_t k = 0; k < count; ++k) begin_step(*busy[k], span);
        for (int j = 0; j < row_->columns; ++j) {
            const int n = row_->substeps[j];
            for (std::size_t k = 0; k < count; ++k) {
                Register& r = *busy[k];
                // n is even: n - 1 swaps leave the result in the column.
                r.now = {r.scratch.data(), r.column[j].data()};
                kernels_->begin(r.control, span, n, index_of(moving_, 0), r.rate.data(), r.twice_h.data(), r.now[0],
                                r.now[1]);
            }
            for (int m = 1; m < n; ++m)
                for (std::size_t k = 0; k < count; ++k) {
                    Register& r = *busy[k];
                    rates_({r.start.data(), r.now[0], r.twice_h.data(), r.now[1]});
                    std::swap(r.now[0], r.now[1]);
                }
        }
        for (std::size_t k = 0; k < count; ++k) end_step(*busy[k], span, motions, next);
    }
}

}  // namespace polhode
