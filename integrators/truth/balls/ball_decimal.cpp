#include "integrators/truth/balls/ball_decimal.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace polhode::truth {
namespace {

// x 10^exponent: exact if the exponent is not negative, otherwise with at least 256 guard bits
Ball scaled(const Ball& x, long exponent) {
    Ball power, result;
    arb_set_ui(power.raw(), 10);
    arb_pow_ui(power.raw(), power.raw(), static_cast<ulong>(std::labs(exponent)), ARF_PREC_EXACT);
    if (exponent >= 0)
        arb_mul(result.raw(), x.raw(), power.raw(), ARF_PREC_EXACT);
    else
        arb_div(result.raw(), x.raw(), power.raw(), 2 * Ball::precision() + 256);
    return result;
}

struct Integer {
    fmpz_t n;
    Integer() { fmpz_init(n); }
    Integer(const Integer&) = delete;
    Integer& operator=(const Integer&) = delete;
    ~Integer() { fmpz_clear(n); }
    std::string text() const {
        char* raw = fmpz_get_str(nullptr, 10, n);
        std::string result(raw);
        flint_free(raw);
        return result;
    }
};

}  // namespace

std::string decimal_above(const Bound& bound) {
    if (bound.is_zero()) return "0";
    if (!bound.is_finite()) return "inf";
    long exponent = static_cast<long>(std::floor(bound.log2_near() * std::log10(2.0)));
    for (;; ++exponent) {
        // the least integer not below bound 10^(1 - exponent): two digits, or three if the exponent is too small
        const Ball x = scaled(bound.ball(), 1 - exponent);
        Integer above;
        Ball upper;
        arb_get_ubound_arf(arb_midref(upper.raw()), x.raw(), 64);
        arf_get_fmpz(above.n, arb_midref(upper.raw()), ARF_RND_CEIL);
        const std::string digits = above.text();
        if (digits.size() > 2) continue;
        // one digit only if the estimated exponent is too large: still an upper bound, with one digit less
        return digits.size() == 1 ? fmt::format("0.{}e{}", digits, exponent)
                                  : fmt::format("{}.{}e{}", digits[0], digits[1], exponent);
    }
}

std::string decimal_near(const Ball& ball, long place, Bound& error) {
    const Ball x = scaled(ball.midpoint(), -place);
    Integer rounded;
    arf_get_fmpz(rounded.n, arb_midref(x.raw()), ARF_RND_NEAR);
    Ball exact;
    arb_set_fmpz(exact.raw(), rounded.n);
    // |decimal - midpoint| + radius
    Ball difference;
    arb_sub(difference.raw(), scaled(exact, place).raw(), ball.midpoint().raw(), 2 * Ball::precision() + 256);
    error = Bound(difference) + Bound::radius_of(ball);

    std::string text = rounded.text();
    if (text == "0") return text;
    const std::size_t first = text[0] == '-' ? 1 : 0, last = text.find_last_not_of('0');
    const long exponent = place + static_cast<long>(text.size() - first) - 1;
    return fmt::format("{}{}{}{}e{}", first == 1 ? "-" : "", text[first], last > first ? "." : "",
                       std::string_view(text).substr(first + 1, last - first), exponent);
}

}  // namespace polhode::truth
