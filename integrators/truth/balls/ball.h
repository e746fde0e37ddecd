// Ball arithmetic: a Ball is a midpoint and a radius that together enclose a real number with certainty (Arb;
// F. Johansson 2017, IEEE Transactions on Computers 66, 1281). A Bound is an upper bound whose operations round upward.
// WorkingPrecision sets the precision of the thread. Only .cpp files of the certified reference include this header.
#pragma once

#include <arb.h>

#include <cmath>
#include <concepts>
#include <limits>
#include <utility>

#include "body/elementary.h"

namespace polhode::truth {

/// A real number known to lie in [midpoint - radius, midpoint + radius]. Results are rounded to the thread's working
/// precision, and the rounding error is added to the radius. operator== returns true only for provably equal numbers,
/// that is exact ones. Code that folds on x == 0 or merges equal tape nodes therefore never merges different numbers.
class Ball {
  public:
    Ball() { arb_init(x_); }
    /// Exactly `value`; NaN becomes the whole real line.
    template <std::floating_point F>
    explicit Ball(F value) : Ball() {
        arb_set_d(x_, static_cast<double>(value));
    }
    template <std::integral N>
    explicit Ball(N value) : Ball() {
        arb_set_si(x_, static_cast<slong>(value));
    }
    Ball(const Ball& other) : Ball() { arb_set(x_, other.x_); }
    Ball(Ball&& other) noexcept : Ball() { arb_swap(x_, other.x_); }
    Ball& operator=(const Ball& other) {
        if (this != &other) arb_set(x_, other.x_);
        return *this;
    }
    Ball& operator=(Ball&& other) noexcept {
        arb_swap(x_, other.x_);
        return *this;
    }
    ~Ball() { arb_clear(x_); }

    arb_ptr raw() { return x_; }
    arb_srcptr raw() const { return x_; }

    /// Working precision of the thread, bits.
    static slong precision() { return precision_; }

    bool is_exact() const { return arb_is_exact(x_) != 0; }
    bool is_finite() const { return arb_is_finite(x_) != 0; }
    bool is_positive() const { return arb_is_positive(x_) != 0; }
    bool is_negative() const { return arb_is_negative(x_) != 0; }
    bool contains_zero() const { return arb_contains_zero(x_) != 0; }
    bool is_zero() const { return arb_is_zero(x_) != 0; }
    /// The midpoint, exact.
    Ball midpoint() const {
        Ball m;
        arb_get_mid_arb(m.x_, x_);
        return m;
    }
    /// A double near the midpoint.
    double near() const { return arf_get_d(arb_midref(x_), ARF_RND_NEAR); }
    /// Approximation of log2 |midpoint|; -infinity for zero.
    double log2_near() const {
        if (arf_is_zero(arb_midref(x_))) return -std::numeric_limits<double>::infinity();
        mag_t size;
        mag_init(size);
        arf_get_mag(size, arb_midref(x_));
        const double result = mag_get_d_log2_approx(size);
        mag_clear(size);
        return result;
    }

    Ball& operator+=(const Ball& b) {
        arb_add(x_, x_, b.x_, precision_);
        return *this;
    }
    Ball& operator-=(const Ball& b) {
        arb_sub(x_, x_, b.x_, precision_);
        return *this;
    }
    Ball& operator*=(const Ball& b) {
        arb_mul(x_, x_, b.x_, precision_);
        return *this;
    }
    Ball& operator/=(const Ball& b) {
        arb_div(x_, x_, b.x_, precision_);
        return *this;
    }
    friend Ball operator+(const Ball& a, const Ball& b) {
        Ball c;
        arb_add(c.x_, a.x_, b.x_, precision_);
        return c;
    }
    friend Ball operator-(const Ball& a, const Ball& b) {
        Ball c;
        arb_sub(c.x_, a.x_, b.x_, precision_);
        return c;
    }
    friend Ball operator-(const Ball& a) {
        Ball c;
        arb_neg(c.x_, a.x_);
        return c;
    }
    friend Ball operator*(const Ball& a, const Ball& b) {
        Ball c;
        arb_mul(c.x_, a.x_, b.x_, precision_);
        return c;
    }
    friend Ball operator/(const Ball& a, const Ball& b) {
        Ball c;
        arb_div(c.x_, a.x_, b.x_, precision_);
        return c;
    }
    friend Ball sqrt(const Ball& a) {
        Ball c;
        arb_sqrt(c.x_, a.x_, precision_);
        return c;
    }
    friend bool operator==(const Ball& a, const Ball& b) { return arb_eq(a.x_, b.x_) != 0; }
    friend bool operator==(const Ball& a, int b) { return arb_equal_si(a.x_, b) != 0; }
    /// True only if the relation is proven; where the balls overlap both a < b and a >= b are false.
    friend bool operator<(const Ball& a, const Ball& b) { return arb_lt(a.x_, b.x_) != 0; }
    friend bool operator>(const Ball& a, const Ball& b) { return arb_gt(a.x_, b.x_) != 0; }
    friend bool operator<=(const Ball& a, const Ball& b) { return arb_le(a.x_, b.x_) != 0; }
    friend bool operator>=(const Ball& a, const Ball& b) { return arb_ge(a.x_, b.x_) != 0; }
    friend bool operator<(const Ball& a, int b) { return a < Ball(b); }
    friend bool operator>(const Ball& a, int b) { return a > Ball(b); }
    explicit operator double() const { return near(); }

  private:
    friend class WorkingPrecision;
    static inline thread_local slong precision_ = 128;
    arb_t x_;
};

/// Sets the thread's working precision for the lifetime of this object.
class WorkingPrecision {
  public:
    explicit WorkingPrecision(long bits) : before_(std::exchange(Ball::precision_, bits)) {}
    WorkingPrecision(const WorkingPrecision&) = delete;
    WorkingPrecision& operator=(const WorkingPrecision&) = delete;
    ~WorkingPrecision() { Ball::precision_ = before_; }

  private:
    slong before_;
};

/// An upper bound of a non-negative number: mag_t with a 30-bit mantissa, every operation rounded upward. A Bound named
/// `least` is a lower bound, rounded downward.
class Bound {
  public:
    Bound() { mag_init(x_); }
    explicit Bound(double value) : Bound() { mag_set_d(x_, value); }
    /// Upper bound of |ball|.
    explicit Bound(const Ball& ball) : Bound() { arb_get_mag(x_, ball.raw()); }
    Bound(const Bound& other) : Bound() { mag_set(x_, other.x_); }
    Bound(Bound&& other) noexcept : Bound() { mag_swap(x_, other.x_); }
    Bound& operator=(const Bound& other) {
        if (this != &other) mag_set(x_, other.x_);
        return *this;
    }
    Bound& operator=(Bound&& other) noexcept {
        mag_swap(x_, other.x_);
        return *this;
    }
    ~Bound() { mag_clear(x_); }

    static Bound radius_of(const Ball& ball) {
        Bound r;
        mag_set(r.x_, arb_radref(ball.raw()));
        return r;
    }
    /// A lower bound of |ball|.
    static Bound least_of(const Ball& ball) {
        Bound r;
        arb_get_mag_lower(r.x_, ball.raw());
        return r;
    }

    mag_ptr raw() { return x_; }
    mag_srcptr raw() const { return x_; }
    bool is_finite() const { return mag_is_finite(x_) != 0; }
    bool is_zero() const { return mag_is_zero(x_) != 0; }
    double log2_near() const {
        return is_zero() ? -std::numeric_limits<double>::infinity() : mag_get_d_log2_approx(x_);
    }
    double near() const { return mag_get_d(x_); }
    /// The bound as an exact ball.
    Ball ball() const {
        Ball b;
        arf_set_mag(arb_midref(b.raw()), x_);
        return b;
    }

    Bound& operator+=(const Bound& b) {
        mag_add(x_, x_, b.x_);
        return *this;
    }
    Bound& operator*=(const Bound& b) {
        mag_mul(x_, x_, b.x_);
        return *this;
    }
    friend Bound operator+(const Bound& a, const Bound& b) {
        Bound c;
        mag_add(c.x_, a.x_, b.x_);
        return c;
    }
    friend Bound operator*(const Bound& a, const Bound& b) {
        Bound c;
        mag_mul(c.x_, a.x_, b.x_);
        return c;
    }
    /// `least` is a lower bound of the divisor; the result is infinite if it is 0.
    friend Bound operator/(const Bound& a, const Bound& least) {
        Bound c;
        mag_div(c.x_, a.x_, least.x_);
        return c;
    }
    /// A lower bound of least - b, or 0.
    friend Bound least_difference(const Bound& least, const Bound& b) {
        Bound c;
        if (b < least) mag_sub_lower(c.x_, least.x_, b.x_);
        return c;
    }
    friend Bound root(const Bound& a) {
        Bound c;
        mag_sqrt(c.x_, a.x_);
        return c;
    }
    friend bool operator<(const Bound& a, const Bound& b) { return mag_cmp(a.x_, b.x_) < 0; }

  private:
    mag_t x_;
};

/// Upper bound of exp(x).
inline Bound exponential(const Ball& x) {
    Ball e;
    arb_exp(e.raw(), x.raw(), 64);
    return Bound(e);
}

/// The ball widened by `radius`.
inline Ball widened(Ball ball, const Bound& radius) {
    arb_add_error_mag(ball.raw(), radius.raw());
    return ball;
}

// Operations that Series<Ball> requires of its scalar.

/// sum += a b, in place.
inline void add_product(Ball& sum, const Ball& a, const Ball& b, Ball&) {
    arb_addmul(sum.raw(), a.raw(), b.raw(), Ball::precision());
}
/// f(x) for a function of Arb.
inline Ball apply(void (*f)(arb_t, const arb_t, slong), const Ball& x) {
    Ball result;
    f(result.raw(), x.raw(), Ball::precision());
    return result;
}
/// x /= n, in place.
inline void divide(Ball& x, unsigned long n) { arb_div_ui(x.raw(), x.raw(), n, Ball::precision()); }

static_assert(sizeof(Ball) == sizeof(arb_struct));
/// sum of a[j] b[k - j] for j = 0..k. arb_dot works in place because Ball has the memory layout of arb_struct.
inline void convolve(Ball& result, const Ball* a, const Ball* b, int k, Ball&) {
    arb_dot(result.raw(), nullptr, 0, a->raw(), 1, b[k].raw(), -1, k + 1, Ball::precision());
}

}  // namespace polhode::truth

namespace polhode {

/// The elementary functions that the mass properties of a body and formulas require.
template <>
struct Elementary<truth::Ball> {
    static truth::Ball pi() {
        truth::Ball pi;
        arb_const_pi(pi.raw(), truth::Ball::precision());
        return pi;
    }
    static void sine_cosine(const truth::Ball& x, truth::Ball& sine, truth::Ball& cosine) {
        arb_sin_cos(sine.raw(), cosine.raw(), x.raw(), truth::Ball::precision());
    }
    static truth::Ball magnitude(const truth::Ball& x) {
        truth::Ball size;
        arb_abs(size.raw(), x.raw());
        return size;
    }
    static truth::Ball exponential(const truth::Ball& x) { return truth::apply(arb_exp, x); }
    static truth::Ball cube_root(const truth::Ball& x) {
        // arb_root_ui requires a positive number
        if (x.is_negative()) return -cube_root(-x);
        truth::Ball root;
        arb_root_ui(root.raw(), x.raw(), 3, truth::Ball::precision());
        return root;
    }
};

}  // namespace polhode
