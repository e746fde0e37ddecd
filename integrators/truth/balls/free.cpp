// Closed-form rotation of a free rigid body in ball arithmetic. The formulas are documented in free.h.
//
// AsymmetricRotation::from() orders the principal axes by the side of the separatrix, computes the constants of the
// motion and reduces u0 by quarter periods. state() evaluates w, the tilt and the integral G at one time by theta
// functions and Carlson's R_J (van Zon & Schofield 2007, J. Comput. Phys. 225, 145). principal_axes() encloses the
// moments by Rump's method and the axes by cross products. free_rotation() selects the kind of rotation.
#include "integrators/truth/balls/free.h"

#include <acb.h>
#include <acb_elliptic.h>
#include <acb_mat.h>
#include <acb_modular.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace polhode::truth {
namespace {

// complex balls, for functions that Arb provides only for complex arguments
struct Complex {
    acb_t z;
    Complex() { acb_init(z); }
    explicit Complex(const Ball& x) : Complex() { acb_set_arb(z, x.raw()); }
    Complex(const Complex&) = delete;
    Complex& operator=(const Complex&) = delete;
    ~Complex() { acb_clear(z); }
    Ball real() const {
        Ball x;
        arb_set(x.raw(), acb_realref(z));
        return x;
    }
};

Ball carlson_rf(const Ball& x, const Ball& y) {
    const Complex a(x), b(y), one(Ball(1));
    Complex result;
    acb_elliptic_rf(result.z, a.z, b.z, one.z, 0, Ball::precision());
    return result.real();
}
Ball carlson_rj(const Ball& x, const Ball& y, const Ball& p) {
    const Complex a(x), b(y), one(Ball(1)), d(p);
    Complex result;
    acb_elliptic_rj(result.z, a.z, b.z, one.z, d.z, 0, Ball::precision());
    return result.real();
}

struct Thetas {
    Ball one, two, three, four;
};
// theta functions at z with tau = i `ratio`
Thetas theta_functions(const Ball& z, const Ball& ratio) {
    Complex t1, t2, t3, t4, tau;
    arb_set(acb_imagref(tau.z), ratio.raw());
    acb_modular_theta(t1.z, t2.z, t3.z, t4.z, Complex(z).z, tau.z, Ball::precision());
    return {t1.real(), t2.real(), t3.real(), t4.real()};
}

Ball cosine(const Ball& x) {
    Ball c;
    arb_cos(c.raw(), x.raw(), Ball::precision());
    return c;
}
Ball sine(const Ball& x) {
    Ball s;
    arb_sin(s.raw(), x.raw(), Ball::precision());
    return s;
}
Ball arctangent(const Ball& x) {
    Ball a;
    arb_atan(a.raw(), x.raw(), Ball::precision());
    return a;
}
Ball half_pi() { return Elementary<Ball>::pi() / Ball(2); }
// K for the complementary modulus k1: pi / (2 agm(1, k1))
Ball complete_integral(const Ball& k1) {
    Ball mean;
    arb_agm(mean.raw(), Ball(1).raw(), k1.raw(), Ball::precision());
    return half_pi() / mean;
}

// The argument u0 of the elliptic functions at the start: u0 = N K + v. sn v and cn v are taken from the nearer axis,
// where the cosine is positive. None if the balls are too wide to show that it is.
std::optional<Ball> initial_argument(const Vector3<Ball>& w, const Vector3<Ball>& amplitudes, const Ball& k1,
                                     const Ball& K) {
    const Ball cn = w[0] / amplitudes[0], sn = w[1] / amplitudes[1], dn = w[2] / amplitudes[2];
    const bool even = std::abs(sn.near()) <= std::abs((cn / dn).near());
    long N = 0;
    Ball s, c, d;
    if (even) {
        N = cn.is_positive() ? 0 : 2;
        s = N == 0 ? sn : -sn, c = N == 0 ? cn : -cn, d = dn;
    } else {
        N = sn.is_positive() ? 1 : 3;
        d = k1 / dn;
        s = N == 1 ? -cn / dn : cn / dn, c = N == 1 ? sn * d : -sn * d;
    }
    if (!c.is_positive()) return {};
    return Ball(N) * K + s * carlson_rf(c * c, d * d);
}

// quaternion of the rotation by the vector w t
Quaternion<Ball> rotation(const Vector3<Ball>& w, const Ball& t) {
    const Ball half = t / Ball(2), angle = sqrt(dot(w, w)) * half;
    Ball ratio;
    arb_sinc(ratio.raw(), angle.raw(), Ball::precision());
    const Vector3<Ball> v = (ratio * half) * w;
    return {cosine(angle), v[0], v[1], v[2]};
}

bool is_zero(const Vector3<Ball>& v) { return v[0].is_zero() && v[1].is_zero() && v[2].is_zero(); }

bool is_diagonal(const Matrix3<Ball>& m) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (i != j && !m[i][j].is_zero()) return false;
    return true;
}

// quaternion of a proper rotation matrix; divides by the largest component to avoid cancellation
Quaternion<Ball> quaternion_of(const Matrix3<Ball>& m) {
    const Ball one(1), trace = m[0][0] + m[1][1] + m[2][2];
    const std::array<Ball, 4> squares{one + trace, one + m[0][0] - m[1][1] - m[2][2], one - m[0][0] + m[1][1] - m[2][2],
                                      one - m[0][0] - m[1][1] + m[2][2]};
    int best = 0;
    for (int i = 1; i < 4; ++i)
        if (squares[i].near() > squares[best].near()) best = i;
    const Ball twice = sqrt(squares[best]), quarter = Ball(1) / (twice + twice), own = twice / Ball(2);
    const Ball x = (m[2][1] - m[1][2]) * quarter, y = (m[0][2] - m[2][0]) * quarter, z = (m[1][0] - m[0][1]) * quarter;
    const Ball xy = (m[0][1] + m[1][0]) * quarter, xz = (m[0][2] + m[2][0]) * quarter,
               yz = (m[1][2] + m[2][1]) * quarter;
    switch (best) {
        case 0:
            return {own, x, y, z};
        case 1:
            return {x, own, xy, xz};
        case 2:
            return {y, xy, own, yz};
        default:
            return {z, xz, yz, own};
    }
}

}  // namespace

FreeMotion PermanentRotation::after(const Ball& t) const { return {w_B, rotation(w_B, t)}; }

FreeMotion SymmetricRotation::after(const Ball& t) const {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const Ball angle = rate * t, c = cosine(angle), s = sine(angle);
    FreeMotion motion;
    motion.angular_velocity_B = w_B;
    motion.angular_velocity_B[i] = c * w_B[i] - s * w_B[j];
    motion.angular_velocity_B[j] = c * w_B[j] + s * w_B[i];
    Vector3<Ball> back;
    back[axis] = -rate;
    motion.q = rotation(L_over_equal_moment, t) * rotation(back, t);
    return motion;
}

std::optional<AsymmetricRotation> AsymmetricRotation::from(const Vector3<Ball>& moments, const Matrix3<Ball>& axes,
                                                           const Vector3<Ball>& w_B) {
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return moments[a].near() < moments[b].near(); });
    const Vector3<Ball> w_given = transposed(axes) * w_B;
    const auto [low, middle, high] = order;
    // D2 = L^2 - 2 E I2 without cancellation; its sign selects the axis that the polhode encircles
    const Ball D2 = moments[low] * (moments[low] - moments[middle]) * (w_given[low] * w_given[low]) +
                    moments[high] * (moments[high] - moments[middle]) * (w_given[high] * w_given[high]);
    if (D2.contains_zero() || !D2.is_finite()) return {};
    const std::array<int, 3> chosen = D2.is_positive() ? order : std::array<int, 3>{high, middle, low};

    AsymmetricRotation r;
    for (int i = 0; i < 3; ++i) {
        r.moments_[i] = moments[chosen[i]];
        for (int j = 0; j < 3; ++j) r.axes_[j][i] = axes[j][chosen[i]];
    }
    // an odd permutation of the axes is made right-handed by reversing one axis
    if ((chosen[1] - chosen[0] + 3) % 3 != 1)
        for (int j = 0; j < 3; ++j) r.axes_[j][0] = -r.axes_[j][0];
    r.q_axes_ = quaternion_of(r.axes_);
    const Vector3<Ball> w = transposed(r.axes_) * w_B;
    if (w[2].contains_zero()) return {};
    const Ball &I1 = r.moments_[0], &I2 = r.moments_[1], &I3 = r.moments_[2];
    r.D3_ = I1 * (I1 - I3) * (w[0] * w[0]) + I2 * (I2 - I3) * (w[1] * w[1]);
    const Ball D1 = I2 * (I2 - I1) * (w[1] * w[1]) + I3 * (I3 - I1) * (w[2] * w[2]);
    r.L_ = sqrt(dot(Vector3<Ball>(I1 * w[0], I2 * w[1], I3 * w[2]), Vector3<Ball>(I1 * w[0], I2 * w[1], I3 * w[2])));
    const Ball a1 = sqrt(r.D3_ / (I1 * (I1 - I3))), size2 = sqrt(r.D3_ / (I2 * (I2 - I3))),
               size3 = sqrt(D1 / (I3 * (I3 - I1)));
    r.sense_ = D2.is_positive() == w[2].is_positive() ? 1 : -1;
    r.amplitudes_ = {a1, r.sense_ > 0 ? size2 : -size2, w[2].is_positive() ? size3 : -size3};
    r.rate_ = sqrt(D1 * (I3 - I2) / (I1 * I2 * I3));
    r.m_ = r.D3_ * (I1 - I2) / (D1 * (I3 - I2));
    const Ball m1 = D2 * (I3 - I1) / (D1 * (I3 - I2));
    r.k1_ = sqrt(m1);
    r.K_ = complete_integral(r.k1_);
    r.tau_ = complete_integral(sqrt(r.m_)) / r.K_;
    const auto squared = [](const Ball& x) { return x * x; };
    r.alpha2_ = squared(I3 * size3 / r.L_);
    r.beta1_ = squared(I1 * a1 / r.L_);
    r.beta2_ = squared(I2 * size2 / r.L_);
    const Thetas at_zero = theta_functions(Ball(0), r.tau_);
    r.theta2_ = at_zero.two, r.theta3_ = at_zero.three, r.theta4_ = at_zero.four;
    // 1 - nu = beta2 / beta1 with nu = -alpha^2 m / beta1
    const Ball nu = -r.alpha2_ * r.m_ / r.beta1_;
    r.whole_ = (r.K_ + nu / Ball(3) * carlson_rj(Ball(0), m1, r.beta2_ / r.beta1_)) / r.beta1_;

    const std::optional<Ball> u0 = initial_argument(w, r.amplitudes_, r.k1_, r.K_);
    if (!u0) return {};
    r.u0_ = *u0;
    if (!r.u0_.is_finite() || !r.whole_.is_finite() || !r.theta4_.is_finite()) return {};
    r.start_ = r.state(Ball(0));
    return r;
}

AsymmetricRotation::State AsymmetricRotation::state(const Ball& t) const {
    const Ball u = rate_ * t + u0_;
    Ball N;
    arf_floor(arb_midref(N.raw()), arb_midref((u / K_ + Ball(0.5)).raw()));
    if (!u.is_finite() || !N.is_finite()) {
        State unknown;
        arb_indeterminate(unknown.integral.raw());
        return unknown;
    }
    fmpz_t count;
    fmpz_init(count);
    arf_get_fmpz(count, arb_midref(N.raw()), ARF_RND_FLOOR);
    const auto quarter = static_cast<int>(fmpz_fdiv_ui(count, 4));
    fmpz_clear(count);
    const bool even = quarter % 2 == 0;
    const Ball sign(quarter < 2 ? 1 : -1);

    const Ball v = u - N * K_;
    const Thetas theta = theta_functions(v / (K_ + K_), tau_);
    const Ball s = theta3_ * theta.one / (theta2_ * theta.four), c = theta4_ * theta.two / (theta2_ * theta.four),
               d = theta4_ * theta.three / (theta3_ * theta.four);
    const Ball s2 = s * s, c2 = c * c, d2 = d * d;
    const Ball b1 = moments_[0] * amplitudes_[0], b2 = moments_[1] * (sense_ > 0 ? amplitudes_[1] : -amplitudes_[1]);

    State result;
    Ball angle;  // of (b1 cn u, b2 sn u), from the axis at N quarter rotations
    if (even) {
        result.w = {amplitudes_[0] * (sign * c), amplitudes_[1] * (sign * s), amplitudes_[2] * d};
        angle = arctangent(b2 * s / (b1 * c));
        // 1 - alpha^2 dn^2 = beta1 (1 - nu sn^2)
        const Ball nu = -alpha2_ * m_ / beta1_;
        result.integral = (v + nu / Ball(3) * (s2 * s) * carlson_rj(c2, d2, Ball(1) - nu * s2)) / beta1_;
    } else {
        // u = K + v: cn = -k' sn/dn, sn = cn/dn, dn = k'/dn
        result.w = {amplitudes_[0] * (-sign * k1_ * s / d), amplitudes_[1] * (sign * c / d), amplitudes_[2] * k1_ / d};
        angle = arctangent(b1 * k1_ * s / (b2 * c));
        // 1 / (1 - alpha^2 k'^2 / dn^2) = 1 + alpha^2 k'^2 / (beta2 (1 - nu sn^2))
        const Ball nu = m_ / beta2_;
        const Ball third = v + nu / Ball(3) * (s2 * s) * carlson_rj(c2, d2, Ball(1) - nu * s2);
        result.integral = v + alpha2_ * (k1_ * k1_) / beta2_ * third;
    }
    result.integral += N * whole_;

    const Ball zeta = N * half_pi() + angle;
    const Ball half_chi = (half_pi() - (sense_ > 0 ? zeta : -zeta)) / Ball(2);
    // sin^2 theta = (L1^2 + L2^2) / L^2 gives the half angle whose sine or cosine is small
    const Ball L1 = moments_[0] * result.w[0], L2 = moments_[1] * result.w[1], L3 = moments_[2] * result.w[2];
    const bool up = amplitudes_[2].is_positive();
    const Ball large = (L_ + (up ? L3 : -L3)) / (L_ + L_), small = (L1 * L1 + L2 * L2) / (Ball(4) * (L_ * L_) * large);
    const Ball cos_half = sqrt(up ? large : small), sin_half = sqrt(up ? small : large);
    result.tilt = {cos_half * cosine(half_chi), sin_half * cosine(half_chi), -(sin_half * sine(half_chi)),
                   cos_half * sine(half_chi)};
    return result;
}

FreeMotion AsymmetricRotation::after(const Ball& t) const {
    const State now = state(t);
    const Ball& I3 = moments_[2];
    const Ball phi = L_ * t / I3 - D3_ / (I3 * L_ * rate_) * (now.integral - start_.integral);
    const Ball half = phi / Ball(2);
    const Quaternion<Ball> precession{cosine(half), Ball(0), Ball(0), sine(half)};
    const Quaternion<Ball> between = conjugate(start_.tilt) * precession * now.tilt;
    return {axes_ * now.w, q_axes_ * between * conjugate(q_axes_)};
}

std::optional<PrincipalAxes> principal_axes(const Matrix3<Ball>& tensor) {
    PrincipalAxes result;
    if (is_diagonal(tensor)) {
        result.axes = diagonal(Vector3<Ball>(Ball(1), Ball(1), Ball(1)));
        for (int i = 0; i < 3; ++i) result.moments[i] = tensor[i][i];
        return result;
    }
    acb_mat_t A, R;
    acb_mat_init(A, 3, 3);
    acb_mat_init(R, 3, 3);
    acb_ptr values = _acb_vec_init(3);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) acb_set_arb(acb_mat_entry(A, i, j), tensor[i][j].raw());
    acb_mat_approx_eig_qr(values, nullptr, R, A, nullptr, 0, Ball::precision());
    const bool simple = acb_mat_eig_simple_rump(values, nullptr, nullptr, A, values, R, Ball::precision()) != 0;
    // a symmetric matrix has real eigenvalues, one in each of the disjoint balls
    for (int i = 0; i < 3; ++i) arb_set(result.moments[i].raw(), acb_realref(values + i));
    _acb_vec_clear(values, 3);
    acb_mat_clear(A);
    acb_mat_clear(R);
    if (!simple) return {};
    Vector3<Ball> axis[3];
    for (int i = 0; i < 2; ++i) {
        // the axis is orthogonal to all rows of tensor - moment 1
        Matrix3<Ball> rest = tensor;
        for (int j = 0; j < 3; ++j) rest[j][j] -= result.moments[i];
        Vector3<Ball> best;
        for (int j = 0; j < 3; ++j) {
            const Vector3<Ball> candidate = cross(rest[j], rest[(j + 1) % 3]);
            if (dot(candidate, candidate).near() > dot(best, best).near()) best = candidate;
        }
        axis[i] = (Ball(1) / sqrt(dot(best, best))) * best;
    }
    axis[2] = cross(axis[0], axis[1]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result.axes[j][i] = axis[i][j];
    return result;
}

std::optional<FreeRotation> free_rotation(const Matrix3<Ball>& inertia_B, const Vector3<Ball>& w_B) {
    if (is_zero(cross(inertia_B * w_B, w_B))) return FreeRotation(PermanentRotation{w_B});
    const bool own_axes = is_diagonal(inertia_B);
    for (int axis = 0; axis < 3 && own_axes; ++axis) {
        const Ball &I = inertia_B[(axis + 1) % 3][(axis + 1) % 3], &J = inertia_B[(axis + 2) % 3][(axis + 2) % 3];
        if (!(I == J)) continue;
        const Ball rate = (inertia_B[axis][axis] - I) / I * w_B[axis];
        return FreeRotation(SymmetricRotation{axis, w_B, (Ball(1) / I) * (inertia_B * w_B), rate});
    }
    const std::optional<PrincipalAxes> principal = principal_axes(inertia_B);
    if (!principal) return {};
    std::optional<AsymmetricRotation> general = AsymmetricRotation::from(principal->moments, principal->axes, w_B);
    if (!general) return {};
    return FreeRotation(*std::move(general));
}

}  // namespace polhode::truth
