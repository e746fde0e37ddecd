// Source of the tape interpreter. One .cpp file for each instruction set includes it.
//
// Everything here must have internal linkage. The linker would merge shared functions and could keep a version with
// instructions that the processor lacks.
//
// `Line` is eight doubles in one AVX-512 register, two AVX2 registers or an array. `Order` performs one order of the
// recurrences in tape_program.h. Sums of products are updated as soon as a new coefficient is known, so that the
// lanes of one order are independent of each other.
#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include "integrators/tape/tape_interpreter.h"

namespace polhode {
namespace {  // NOLINT(cert-dcl59-cpp): so that each file that includes this has functions of its own

double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }
double root(double a) { return __builtin_sqrt(a); }

/// Eight numbers side by side in the available registers.
#if defined(__AVX512F__)
struct Line {
    __m512d v;
};
Line loaded(const double* from) { return {_mm512_loadu_pd(from)}; }
void store(const Line& x, double* to) { _mm512_storeu_pd(to, x.v); }
Line eight(double x) { return {_mm512_set1_pd(x)}; }
Line fused(const Line& a, const Line& b, const Line& c) { return {_mm512_fmadd_pd(a.v, b.v, c.v)}; }
Line operator+(const Line& a, const Line& b) { return {_mm512_add_pd(a.v, b.v)}; }
Line operator-(const Line& a, const Line& b) { return {_mm512_sub_pd(a.v, b.v)}; }
Line operator*(const Line& a, const Line& b) { return {_mm512_mul_pd(a.v, b.v)}; }
Line operator/(const Line& a, const Line& b) { return {_mm512_div_pd(a.v, b.v)}; }
Line root(const Line& a) { return {_mm512_maskz_sqrt_pd(0xFF, a.v)}; }
Line magnitude(const Line& a) { return {_mm512_abs_pd(a.v)}; }
/// Returns whether any element is above the limit or NaN.
bool any_above(const Line& a, double limit) { return _mm512_cmp_pd_mask(a.v, _mm512_set1_pd(limit), _CMP_NLE_UQ) != 0; }
/// The first `count` elements of `first`, the others of `rest`.
Line first_of(int count, const Line& first, const Line& rest) {
    const unsigned taken = count >= 8 ? 0xFF : count <= 0 ? 0 : (1U << static_cast<unsigned>(count)) - 1;
    return {_mm512_mask_blend_pd(static_cast<__mmask8>(taken), rest.v, first.v)};
}
#elif defined(__AVX2__)
struct Line {
    __m256d low, high;
};
Line loaded(const double* from) { return {_mm256_loadu_pd(from), _mm256_loadu_pd(from + 4)}; }
void store(const Line& x, double* to) { _mm256_storeu_pd(to, x.low), _mm256_storeu_pd(to + 4, x.high); }
Line eight(double x) { return {_mm256_set1_pd(x), _mm256_set1_pd(x)}; }
Line fused(const Line& a, const Line& b, const Line& c) {
    return {_mm256_fmadd_pd(a.low, b.low, c.low), _mm256_fmadd_pd(a.high, b.high, c.high)};
}
Line operator+(const Line& a, const Line& b) { return {_mm256_add_pd(a.low, b.low), _mm256_add_pd(a.high, b.high)}; }
Line operator-(const Line& a, const Line& b) { return {_mm256_sub_pd(a.low, b.low), _mm256_sub_pd(a.high, b.high)}; }
Line operator*(const Line& a, const Line& b) { return {_mm256_mul_pd(a.low, b.low), _mm256_mul_pd(a.high, b.high)}; }
Line operator/(const Line& a, const Line& b) { return {_mm256_div_pd(a.low, b.low), _mm256_div_pd(a.high, b.high)}; }
Line root(const Line& a) { return {_mm256_sqrt_pd(a.low), _mm256_sqrt_pd(a.high)}; }
Line magnitude(const Line& a) {
    const __m256d sign = _mm256_set1_pd(-0.0);
    return {_mm256_andnot_pd(sign, a.low), _mm256_andnot_pd(sign, a.high)};
}
bool any_above(const Line& a, double limit) {
    const __m256d most = _mm256_set1_pd(limit);
    return _mm256_movemask_pd(
               _mm256_or_pd(_mm256_cmp_pd(a.low, most, _CMP_NLE_UQ), _mm256_cmp_pd(a.high, most, _CMP_NLE_UQ))) != 0;
}
/// The first `count` elements of `first`, the others of `rest`.
Line first_of(int count, const Line& first, const Line& rest) {
    const __m256i end = _mm256_set1_epi64x(count);
    const auto taken = [&](long long from) {
        return _mm256_castsi256_pd(_mm256_cmpgt_epi64(end, _mm256_setr_epi64x(from, from + 1, from + 2, from + 3)));
    };
    return {_mm256_blendv_pd(rest.low, first.low, taken(0)), _mm256_blendv_pd(rest.high, first.high, taken(4))};
}
#else
struct Line {
    double v[8];
};
Line loaded(const double* from) {
    Line x{};
    __builtin_memcpy(x.v, from, sizeof x.v);
    return x;
}
void store(const Line& x, double* to) { __builtin_memcpy(to, x.v, sizeof x.v); }
template <class Each>
Line by_each(const Each& each) {
    Line x{};
    for (int i = 0; i < 8; ++i) x.v[i] = each(i);
    return x;
}
// clang-format off
Line eight(double x) { return by_each([&](int) { return x; }); }
Line fused(const Line& a, const Line& b, const Line& c) { return by_each([&](int i) { return fused(a.v[i], b.v[i], c.v[i]); }); }
Line operator+(const Line& a, const Line& b) { return by_each([&](int i) { return a.v[i] + b.v[i]; }); }
Line operator-(const Line& a, const Line& b) { return by_each([&](int i) { return a.v[i] - b.v[i]; }); }
Line operator*(const Line& a, const Line& b) { return by_each([&](int i) { return a.v[i] * b.v[i]; }); }
Line operator/(const Line& a, const Line& b) { return by_each([&](int i) { return a.v[i] / b.v[i]; }); }
Line root(const Line& a) { return by_each([&](int i) { return root(a.v[i]); }); }
Line magnitude(const Line& a) { return by_each([&](int i) { return __builtin_fabs(a.v[i]); }); }
bool any_above(const Line& a, double limit) {
    bool is_above = false;
    for (const double x : a.v) is_above |= !(x <= limit);
    return is_above;
}
/// The first `count` elements of `first`, the others of `rest`.
Line first_of(int count, const Line& first, const Line& rest) { return by_each([&](int i) { return i < count ? first.v[i] : rest.v[i]; }); }
// clang-format on
#endif
Line operator-(const Line& a) { return eight(-0.0) - a; }

/// Sines and cosines of eight numbers. The outputs must not overlap the input. The argument is reduced to x = k pi/2
/// + r,
/// |r| <= pi/4, with pi/2 in two parts, of which the first gives an exact difference (Cody & Waite 1980). The
/// polynomials are those of fdlibm (Sun Microsystems 1993, k_sin.c and k_cos.c), evaluated in pairs of terms (Estrin
/// 1960). Beyond |x| = 10^5 the C library's functions are called.
void compute_sines_cosines(const double* x, double* sines, double* cosines) {
    constexpr double largest = 1e5, whole = 0x1.8p52;
    const Line angle = loaded(x), one = eight(1);
    const auto rounded = [&](const Line& y) { return (y + eight(whole)) - eight(whole); };
    const Line k = rounded(angle * eight(0x1.45f306dc9c883p-1));
    const Line r = fused(k, eight(-0x1.1a62633145c07p-54), fused(k, eight(-0x1.921fb54442d18p0), angle));
    const Line z = r * r, zz = z * z;
    const auto pair = [&](double a, double b) { return fused(z, eight(b), eight(a)); };
    const Line s_high =
        fused(zz, eight(1.58969099521155010221e-10), pair(2.75573137070700676789e-06, -2.50507602534068634195e-08));
    const Line s_low = pair(-1.66666666666666324348e-01, 8.33333333332248946124e-03);
    const Line s = fused(r * z, fused(zz, fused(z, s_high, eight(-1.98412698298579493134e-04)), s_low), r);
    const Line c_high =
        fused(zz, eight(-1.13596475577881948265e-11), pair(-2.75573143513906633035e-07, 2.08757232129817482790e-09));
    const Line c_low = pair(4.16666666666666019037e-02, -1.38888888888741095749e-03);
    const Line c_rest = fused(zz, fused(z, c_high, eight(2.48015872894767294178e-05)), c_low);
    const Line w = pair(1, -0.5), c = w + fused(zz, c_rest, fused(z, eight(-0.5), one - w));
    // j = k mod 4 from -2 to 2: cos(j pi/2) = 1 - |j|, sin(j pi/2) = j (2 - |j|)
    const Line j = fused(rounded(k * eight(0.25)), eight(-4), k), size = magnitude(j);
    const Line even = one - size, odd = j * (eight(2) - size);
    store(fused(even, s, odd * c), sines), store(fused(even, c, -(odd * s)), cosines);
    if (!any_above(magnitude(angle), largest)) return;
    for (int i = 0; i < 8; ++i)
        if (!(__builtin_fabs(x[i]) <= largest)) sines[i] = __builtin_sin(x[i]), cosines[i] = __builtin_cos(x[i]);
}
void compute_four_sines_cosines(const double* x, double* sines, double* cosines) {
    double angle[8]{}, sine[8], cosine[8];
    __builtin_memcpy(angle, x, 4 * sizeof *x);
    compute_sines_cosines(angle, sine, cosine);
    __builtin_memcpy(sines, sine, 4 * sizeof *x), __builtin_memcpy(cosines, cosine, 4 * sizeof *x);
}

/// Result of any operation except sine_cosine and sum, for one number or eight.
template <class Number>
Number apply_operation(TapeProgram::Kind kind, const Number& a, const Number& b, const Number& c) {
    using Kind = TapeProgram::Kind;
    switch (kind) {
        case Kind::add:
            return a + b;
        case Kind::subtract:
            return a - b;
        case Kind::multiply:
            return a * b;
        case Kind::product_plus:
            return fused(a, b, c);
        case Kind::product_minus:
            return fused(a, b, -c);
        case Kind::minus_product:
            return fused(-a, b, c);
        case Kind::minus_product_minus:
            return fused(-a, b, -c);
        case Kind::divide:
            return a / b;
        default:
            return root(a);
    }
}

/// The work of one order on `memory`. `states` are the coefficients of the previous order.
template <int lanes>
class Order {
    static constexpr int lines = lanes / 8;

  public:
    Order(const TapeProgram& program, const TapeLayout& layout, int k, const double* states, double* memory)
        : program_(program), layout_(layout), k_(k), states_(states), memory_(memory) {}

    void compute_inner_sums() {
        for (int i = 0; i < program_.inner; ++i)
            if (k_ > 1)
                add_products(i, k_ - 2);
            else
                memory_[program_.sums.data()[i].to] = 0;
    }
    void operate(const TapeProgram::Operation* at, const TapeProgram::Operation* end) {
        using Kind = TapeProgram::Kind;
        double* const x = memory_;
        const auto number = [x](int slot) { return slot == TapeProgram::none ? 0 : x[slot]; };
        for (; at != end; ++at) {
            if (at->kind == Kind::sum)
                add_products(at->a, k_);
            else if (at->kind == Kind::sine_cosine)
                scalar_sine_cosine(x[at->a], x[at->to], x[at->b]);
            else
                x[at->to] = apply_operation(at->kind, x[at->a], number(at->b), number(at->c));
        }
    }

  private:
    const TapeProgram& program_;
    const TapeLayout& layout_;
    int k_;
    const double* states_;
    double* memory_;

    double newest(int row) const {
        const TapeProgram::Row& of = program_.rows.data()[row];
        return of.is_inner() && of.slot < program_.states ? states_[of.slot] : memory_[of.slot];
    }
    /// A row with its newest coefficient in its lane.
    struct Lanes {
        Line line[lines];
    };
    Lanes row_with(int row, const Line& x, int lane) const {
        double* const at = memory_ + layout_.rows + static_cast<std::size_t>(row) * layout_.lanes;
        Lanes result{};
        for (int v = 0; v < lines; ++v) {
            // Store whole lines: a later vector load that overlaps a recent scalar store would stall.
            const Line old = loaded(at + 8 * v);
            result.line[v] = first_of(lane - 8 * v, old, first_of(lane + 1 - 8 * v, x, old));
            store(result.line[v], at + 8 * v);
        }
        return result;
    }
    // Adds the contributions of the newest order (in lane `lane`) to this sum and to the sums of later orders.
    void add_products(int which, int lane) {
        double* const sum = memory_ + layout_.sums + static_cast<std::size_t>(which) * layout_.lanes;
        const TapeProgram::Sum& of = program_.sums.data()[which];
        const Line zero = eight(0);
        Line p[lines], u[lines];
        for (int v = 0; v < lines; ++v) {
            // Keep only the partial sums that already have contributions.
            p[v] = first_of(lane - 1 - 8 * v, loaded(sum + 8 * v), zero);
            u[v] = zero;
        }
        for (int i = of.first; i < of.end; ++i) {
            const TapeProgram::Pair& pair = program_.pairs.data()[i];
            Line x_m = eight(newest(pair.x)), y_m = eight(newest(pair.y));
            const Lanes x = row_with(pair.x, x_m, lane), y = row_with(pair.y, y_m, lane);
            if (pair.weight != TapeProgram::none) {
                const Line weight = eight(memory_[pair.weight]);
                x_m = x_m * weight, y_m = y_m * weight;
            }
            if (pair.negative) x_m = x_m * eight(-1), y_m = y_m * eight(-1);
            for (int v = 0; v < lines; ++v) {
                p[v] = fused(x_m, y.line[v], p[v]);
                u[v] = i == of.first ? y_m * x.line[v] : fused(y_m, x.line[v], u[v]);
            }
        }
        // Both products for lanes j < lane, only one for j = lane.
        for (int v = 0; v < lines; ++v) p[v] = first_of(lane - 8 * v, p[v] + u[v], p[v]);
        alignas(64) double shifted[lanes];
        for (int v = 0; v < lines; ++v) store(p[v], shifted + 8 * v);
        memory_[of.to] = shifted[0];
        __builtin_memcpy(sum, shifted + 1, sizeof shifted - sizeof(double));
    }
};

void begin_order(const TapeProgram& program, int k, double* x) {
    if (program.order != TapeProgram::none) x[program.order] = k, x[program.inverse_order] = 1.0 / k;
    x[program.next] = k + 1, x[program.inverse_next] = 1.0 / (k + 1);
}

void integrate(const TapeProgram& program, const TapeProgram::Rate* rates, bool careful, double* x, double* next) {
    for (int i = 0; i < program.states; ++i) {
        double rate = x[rates[i].from];
        if (rates[i].factor != TapeProgram::none) rate *= x[rates[i].factor];
        x[i] = next[i] = careful ? rate / x[program.next] : rate * x[program.inverse_next];
    }
}

template <int lanes>
void expand_order(const TapeProgram& program, const TapeLayout& layout, int k, const double* states, double* memory) {
    Order<lanes> order(program, layout, k, states, memory);
    order.compute_inner_sums();
    order.operate(program.step.data(), program.step.data() + program.step.size());
}

void expand(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory) {
    constexpr int line = TapeLayout::line;
    double* coefficients = memory + layout.coefficients;
    for (int i = 0; i < program.states; ++i) coefficients[i] = memory[program.values.data()[i]];
    begin_order(program, 0, memory);
    Order<line>(program, layout, 0, coefficients, memory)
        .operate(program.begin.data(), program.begin.data() + program.begin.size());
    for (std::size_t r = 0, n = program.rows.size(); r < n; ++r) {
        const TapeProgram::Row& row = program.rows.data()[r];
        if (!row.is_inner()) memory[layout.rows + r * layout.lanes] = memory[row.value];
    }
    integrate(program, program.first_rates.data(), careful, memory, coefficients += layout.states);
    for (int k = 1; k < layout.order; ++k) {
        const auto work = layout.filled(k) <= line ? expand_order<line> : expand_order<2 * line>;
        begin_order(program, k, memory);
        work(program, layout, k, coefficients - layout.states, memory);
        integrate(program, program.rates.data(), careful, memory, coefficients += layout.states);
    }
}

void add_rates_of(const TapeProgram& program, double* memory, const TapeSubstep& substep) {
    using Kind = TapeProgram::Kind;
    constexpr int line = TapeLayout::line;
    const auto at = [memory](int slot) { return memory + slot * line; };
    const auto number = [&](int slot) { return slot == TapeProgram::none ? eight(0) : loaded(at(slot)); };
    for (int i = 0; i < program.states; ++i) {
        const Line start = loaded(substep.start + i * line);
        const bool is_moving = program.first_rates.data()[i].from != TapeProgram::none;
        store(is_moving ? start + loaded(substep.now + i * line) : start, at(program.values.data()[i]));
    }
    for (std::size_t n = 0; n < program.begin.size(); ++n) {
        const TapeProgram::Operation& op = program.begin.data()[n];
        if (op.kind == Kind::sine_cosine)
            compute_sines_cosines(at(op.a), at(op.to), at(op.b));
        else
            store(apply_operation(op.kind, number(op.a), number(op.b), number(op.c)), at(op.to));
    }
    const Line scale = loaded(substep.scale);
    for (int i = 0; i < program.states; ++i) {
        const TapeProgram::Rate& rate = program.first_rates.data()[i];
        if (rate.from == TapeProgram::none) continue;
        const Line scaled = rate.factor == TapeProgram::none ? scale : scale * loaded(at(rate.factor));
        double* const to = substep.change + i * line;
        store(fused(loaded(at(rate.from)), scaled, loaded(to)), to);
    }
}

// Even and odd degrees form two independent chains, which halves the latency.
void sum_states(const double* coefficients, int states, int order, int from, double h, double* sums) {
    constexpr int line = TapeLayout::line;
    const Line hh = eight(h * h);
    for (int first = 0; first < states; first += line) {
        const auto degree = [=](int k) { return loaded(coefficients + static_cast<std::size_t>(k) * states + first); };
        Line even = degree(order), odd = degree(order - 1);
        int k = order - 2;
        for (; k > from; k -= 2) even = fused(even, hh, degree(k)), odd = fused(odd, hh, degree(k - 1));
        // The last coefficient of one chain has degree `from`, that of the other from + 1.
        if (k == from)
            even = fused(even, hh, degree(k)), store(fused(odd, eight(h), even), sums + first);
        else
            store(fused(even, eight(h), odd), sums + first);
    }
}

}  // namespace
}  // namespace polhode
