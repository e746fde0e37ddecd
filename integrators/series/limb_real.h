// Real numbers in radix 2^58 for the sums of products of Taylor coefficients.
//
// A multiple-precision number with an exponent in bits costs a shift, a normalisation and a rounding per product and
// per sum. Here exponents count digits of 58 bits. Products of digits are accumulated in columns of 128 bits without
// carries, and a sum is normalised once. One extra digit compensates for leading zero bits.
//
// LimbReal is the number, LimbReal::Columns the accumulator of a sum of products.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "body/elementary.h"
#include "integrators/series/real.h"
#include "motion/traced.h"

namespace polhode {

/// A number with at least the precision of Real<decimals>:
///
///     sum of digit[i] 2^(58 (exponent + i - (size - 1))),   |digit[i]| <= 2^57,   digit[size - 1] != 0 except for zero
///
/// The relative error of a product or sum is below 2^(-58 (size - 1)). For a sum of products, this bound is relative
/// to the largest product and multiplied by their number. Quotients, roots, sines and cosines are those of
/// Real<decimals>. Infinite values and magnitudes above 2^(58 2^38) become NaN.
template <unsigned decimals>
class LimbReal {
  public:
    static constexpr int bits = std::numeric_limits<Real<decimals>>::digits;
    static constexpr int radix_bits = 58;
    static constexpr int size = (bits + radix_bits - 1) / radix_bits + 1;

    LimbReal() = default;
    explicit LimbReal(int value) {
        if (value != 0) exponent_ = 0, digit_[size - 1] = value;
    }
    /// Exact conversion.
    explicit LimbReal(const Real<decimals>& x) {
        if (x == 0) return;
        if (!is_finite(x)) {
            make_nan();
            return;
        }
        // |x| in [2^(e - 1), 2^e): the first digit is below 2^57, and at least 1 unless |x| is half a power of the
        // radix.
        exponent_ = floor_quotient(mpfr_get_exp(raw(x)), radix_bits);
        Real<decimals> rest;
        mpfr_mul_2si(raw(rest), raw(x), -radix_bits * exponent_, MPFR_RNDN);
        for (int i = size; i-- > 0;) {
            digit_[i] = mpfr_get_si(raw(rest), MPFR_RNDN);
            mpfr_sub_si(raw(rest), raw(rest), digit_[i], MPFR_RNDN);
            mpfr_mul_2si(raw(rest), raw(rest), radix_bits, MPFR_RNDN);
        }
        if (digit_[size - 1] == 0) {
            std::rotate(digit_.begin(), digit_.end() - 1, digit_.end());
            --exponent_;
        }
    }

    /// Rounds to nearest.
    explicit operator Real<decimals>() const {
        Real<decimals> result(0);
        if (is_zero()) return result;
        if (is_nan()) {
            mpfr_set_nan(raw(result));
            return result;
        }
        // Exact, then rounded once.
        Real<(size * radix_bits + 2) * 301 / 1000 + 2> sum(0), term;
        for (int i = size; i-- > 0;) {
            mpfr_set_si_2exp(raw(term), digit_[i], radix_bits * (exponent_ + i - (size - 1)), MPFR_RNDN);
            mpfr_add(raw(sum), raw(sum), raw(term), MPFR_RNDN);
        }
        mpfr_set(raw(result), raw(sum), MPFR_RNDN);
        return result;
    }

    bool is_zero() const { return exponent_ <= zero_exponent; }
    bool is_nan() const { return exponent_ >= nan_exponent; }

    friend LimbReal operator-(LimbReal a) {
        for (Digit& digit : a.digit_) digit = -digit;
        return a;
    }
    friend LimbReal operator*(const LimbReal& a, const LimbReal& b) {
        Columns sum(a.exponent_ + b.exponent_);
        sum.add_product(a, b);
        return sum.value();
    }
    friend LimbReal operator+(const LimbReal& a, const LimbReal& b) {
        Columns sum(std::max(a.exponent_, b.exponent_));
        sum.add(a, 1), sum.add(b, 1);
        return sum.value();
    }
    friend LimbReal operator-(const LimbReal& a, const LimbReal& b) {
        Columns sum(std::max(a.exponent_, b.exponent_));
        sum.add(a, 1), sum.add(b, -1);
        return sum.value();
    }
    friend LimbReal operator/(const LimbReal& a, const LimbReal& b) {
        return LimbReal(Real<decimals>(Real<decimals>(a) / Real<decimals>(b)));
    }
    LimbReal& operator+=(const LimbReal& b) { return *this = *this + b; }
    LimbReal& operator-=(const LimbReal& b) { return *this = *this - b; }
    LimbReal& operator*=(const LimbReal& b) { return *this = *this * b; }

    friend LimbReal sqrt(const LimbReal& a) {
        return LimbReal(Real<decimals>(square_root(static_cast<Real<decimals>>(a))));
    }
    static void sine_cosine(const LimbReal& x, LimbReal& sine, LimbReal& cosine) {
        Real<decimals> s(0), c(0);
        polhode::sine_cosine(static_cast<Real<decimals>>(x), s, c);
        sine = LimbReal(s), cosine = LimbReal(c);
    }

    /// result = a b + c d, where a and c are often 1 or -1. The last argument exists for the general interface.
    friend void combine(LimbReal& result, const LimbReal& a, const LimbReal& b, const LimbReal& c, const LimbReal& d,
                        LimbReal&) {
        Columns sum(std::max(a.exponent_ + b.exponent_, c.exponent_ + d.exponent_));
        const auto add = [&](const LimbReal& factor, const LimbReal& x) {
            if (const Digit unit = factor.unit())
                sum.add(x, unit);
            else
                sum.add_product(factor, x);
        };
        add(a, b), add(c, d);
        result = sum.value();
    }
    /// result = sum of a[j] b[k - j] for j = 0..k. `result` must not be one of these.
    friend void convolve(LimbReal& result, const LimbReal* a, const LimbReal* b, int k, LimbReal&) {
        // For a square, each pair once.
        const bool square = a == b;
        const int terms = square ? (k + 1) / 2 : k + 1;
        std::int64_t largest = square && k % 2 == 0 ? 2 * a[k / 2].exponent_ : 2 * zero_exponent;
        for (int j = 0; j < terms; ++j) largest = std::max(largest, a[j].exponent_ + b[k - j].exponent_);
        Columns sum(largest);
        for (int j = 0; j < terms; ++j) sum.add_product(a[j], b[k - j]);
        if (square) {
            sum.twice();
            if (k % 2 == 0) sum.add_product(a[k / 2], a[k / 2]);
        }
        result = sum.value();
    }
    /// x /= n in place; n < 2^31.
    friend void divide(LimbReal& x, unsigned long n) {
        if (x.is_zero() || x.is_nan()) return;
        // Half a digit at a time, with one digit more than is kept, since the highest may vanish.
        constexpr int half = radix_bits / 2;
        const auto divisor = static_cast<Digit>(n);
        Columns quotient(x.exponent_);
        Digit rest = 0;
        for (int i = size; i >= 0; --i) {
            const Digit digit = i > 0 ? x.digit_[i - 1] : 0, high = digit >> half;
            const Digit upper = (rest << half) + high;
            const Digit lower = ((upper % divisor) << half) + (digit - (high << half));
            rest = lower % divisor;
            quotient.column[i] = (static_cast<Column>(upper / divisor) << half) + lower / divisor;
        }
        x = quotient.value();
    }
    /// log2 |x| in double precision; -infinity for zero.
    friend double log2_magnitude(const LimbReal& x) {
        if (x.is_zero()) return -std::numeric_limits<double>::infinity();
        if (x.is_nan()) return std::numeric_limits<double>::quiet_NaN();
        const double mantissa = static_cast<double>(x.digit_[size - 1]) +
                                static_cast<double>(x.digit_[size - 2]) * 0x1p-58 +
                                static_cast<double>(x.digit_[size - 3]) * 0x1p-116;
        return std::log2(std::abs(mantissa)) + radix_bits * static_cast<double>(x.exponent_);
    }

  private:
    using Digit = std::int64_t;
    __extension__ using Column = __int128;

    // Beyond the exponents of numbers. The sum of one of these and a number's exponent stays on its side of +-2^39.
    static constexpr std::int64_t zero_exponent = -(std::int64_t{1} << 40U), nan_exponent = std::int64_t{1} << 42U,
                                  most_exponent = std::int64_t{1} << 38U;

    std::array<Digit, size> digit_{};
    std::int64_t exponent_ = zero_exponent;

    void make_nan() { exponent_ = nan_exponent, digit_[size - 1] = 1; }
    /// Returns x if it is 1 or -1, otherwise 0.
    Digit unit() const {
        const Digit highest = digit_[size - 1];
        if (exponent_ != 0 || (highest != 1 && highest != -1)) return 0;
        for (int i = 0; i < size - 1; ++i)
            if (digit_[i] != 0) return 0;
        return highest;
    }
    static std::int64_t floor_quotient(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

    // A sum of products and numbers. `exponent` is the largest exponent among them (for a product, the sum of its
    // factors' exponents); column[i] has the weight 2^(58 (exponent + i - size)). Holds up to 2^12 products.
    struct Columns {
        std::int64_t exponent;
        std::array<Column, size + 1> column{};

        explicit Columns(std::int64_t exponent_) : exponent(exponent_) {}

        [[gnu::always_inline]] void add_product(const LimbReal& a, const LimbReal& b) {
            add_product(exponent - (a.exponent_ + b.exponent_), a, b, std::make_index_sequence<size + 1>());
        }
        [[gnu::always_inline]] void add(const LimbReal& a, Digit sign) {
            const std::int64_t below = exponent - a.exponent_;
            if (below == 0) {
                for (int i = 0; i < size; ++i) column[i + 1] += sign * a.digit_[i];
                return;
            }
            for (std::int64_t i = std::max<std::int64_t>(below - 1, 0); i < size; ++i)
                column[i + 1 - below] += sign * a.digit_[i];
        }
        void twice() {
            for (Column& sum : column) sum += sum;
        }
        LimbReal value() const {
            LimbReal result;
            if (exponent > most_exponent) result.make_nan();
            if (exponent > most_exponent || exponent < -most_exponent) return result;
            std::array<Digit, size + 3> digits{};
            Column carry = 0;
            for (int i = 0; i < size + 3; ++i) {
                if (i <= size) carry += column[i];
                // The lowest bits, sign-extended.
                constexpr unsigned above = 64 - radix_bits;
                digits[i] = static_cast<Digit>(static_cast<std::uint64_t>(carry) << above) >> above;
                carry = (carry - digits[i]) >> radix_bits;
            }
            int top = size + 2;
            while (top >= 0 && digits[top] == 0) --top;
            if (top < 0) return result;
            for (int i = 0; i < size; ++i) {
                const int from = top - (size - 1) + i;
                result.digit_[i] = from >= 0 ? digits[from] : 0;
            }
            result.exponent_ = exponent + top - size;
            return result;
        }

      private:
        template <std::size_t... below>
        [[gnu::always_inline]] void add_product(std::int64_t wanted, const LimbReal& a, const LimbReal& b,
                                                std::index_sequence<below...>) {
            static_cast<void>(
                ((wanted == static_cast<std::int64_t>(below) && (add_below<static_cast<int>(below)>(a, b), true)) ||
                 ...));
        }
        // A product `below` digits under the largest one. Parts below the columns are dropped.
        template <int below>
        [[gnu::always_inline]] void add_below(const LimbReal& a, const LimbReal& b) {
#pragma GCC unroll 16
            for (int i = 0; i < size; ++i)
#pragma GCC unroll 16
                for (int j = std::max(size - 2 + below - i, 0); j < size; ++j)
                    column[i + j - (size - 2) - below] += static_cast<Column>(a.digit_[i]) * b.digit_[j];
        }
    };
};

/// The type for computing the Taylor coefficients of a solution in P.
template <class P>
struct SeriesScalar {
    using Type = P;
};
template <unsigned decimals>
struct SeriesScalar<Real<decimals>> {
    using Type = LimbReal<decimals>;
};

/// The recording with its factors converted to another scalar.
template <class T, class P>
Recording<T> cast_recording(Recording<P> recording) {
    if constexpr (std::same_as<T, P>) {
        return recording;
    } else {
        Recording<T> result;
        result.tape.nodes.reserve(recording.tape.nodes.size());
        for (const TapeNode<P>& node : recording.tape.nodes)
            result.tape.nodes.push_back({static_cast<typename TapeNode<T>::Kind>(node.kind), node.a, node.b,
                                         T(node.factor_a), T(node.factor_b)});
        for (const Traced<P>& rate : recording.rates) result.rates.emplace_back(T(rate.factor), rate.node, nullptr);
        return result;
    }
}

/// @cond specialisations
template <unsigned decimals>
struct Elementary<LimbReal<decimals>> {
    using S = LimbReal<decimals>;
    static void sine_cosine(const S& x, S& sine, S& cosine) { S::sine_cosine(x, sine, cosine); }
};
/// @endcond
}  // namespace polhode
