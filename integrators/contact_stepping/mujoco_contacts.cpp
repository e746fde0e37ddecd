// MuJoCo's soft contact: accelerations as the minimum of a convex function, with elliptic and pyramidal friction cones.
//
// For each contact with a gap r < 0, its rows J (normal and two tangents) and reference acceleration:
//   a_ref = -b u - k d(r) r (tangents: -b u),   b = 2 / (d_max T),   k = 1 / (d_max T z)^2,   T = max(0.02 s, 2 h), z =
//   1 impedance d(r) from 0.9 at r = 0 to d_max = 0.95 at |r| = 0.001 m, piecewise quadratic regularisation R = (1 - d)
//   / (d m),   D = 1/R
// The acceleration x = (dv/dt, dw/dt) minimises (x - x0).M (x - x0) / 2 + sum of s(J x - a_ref), x0 without contact:
//   elliptic: with N = mu y_n, T = mu |y_t|: 0 if N >= mu T (open); D |y|^2 / 2 if mu N + T <= 0 (sticks);
//             D (N - mu T)^2 / (2 mu^2 (1 + mu^2)) else (slides)
//   pyramidal: edges e = y_n +- mu y_t1, y_n +- mu y_t2, each D' min(0, e)^2 / 2, D' = D / (2 mu^2 (1 + mu^2))
// solved by Newton's method with a line search. Then v += h dv/dt, w += h dw/dt, q = exp(h w) q, x += h v.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/game/soft_constraint.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

template <class S>
using Six = std::array<S, 6>;

template <class S>
S dot_six(const Six<S>& a, const Six<S>& b) {
    S sum = S(0);
    for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i];
    return sum;
}

/// Solves H x = b for a symmetric positive definite H by Cholesky's method; H is overwritten.
template <class S>
Six<S> solve_six(std::array<Six<S>, 6>& H, Six<S> b) {
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t k = 0; k <= i; ++k) {
            S sum = H[i][k];
            for (std::size_t j = 0; j < k; ++j) sum -= H[i][j] * H[k][j];
            H[i][k] = i == k ? std::sqrt(sum) : sum / H[k][k];
        }
        for (std::size_t j = 0; j < i; ++j) b[i] -= H[i][j] * b[j];
        b[i] /= H[i][i];
    }
    for (std::size_t i = 6; i-- > 0;) {
        for (std::size_t j = i + 1; j < 6; ++j) b[i] -= H[j][i] * b[j];
        b[i] /= H[i][i];
    }
    return b;
}

/// The cost of one contact as a function of y = J x - a_ref: minus its derivative is the force.
template <class S>
struct SoftCone {
    bool elliptic = true;
    S mu = S(0), D = S(0);

    /// Adds the gradient to g and, if H is not null, the second derivative to H.
    void differentiate(const Vector3<S>& y, Vector3<S>& g, Matrix3<S>* H) const {
        if (!(mu > S(0))) return add_edge(y, Vector3<S>(S(1), S(0), S(0)), D, g, H);
        if (!elliptic) {
            const S edge_D = D / (S(2) * mu * mu * (S(1) + mu * mu));
            for (const S sign : {S(1), S(-1)}) {
                add_edge(y, Vector3<S>(S(1), sign * mu, S(0)), edge_D, g, H);
                add_edge(y, Vector3<S>(S(1), S(0), sign * mu), edge_D, g, H);
            }
            return;
        }
        const S N = mu * y[0], size = std::hypot(y[1], y[2]), T = mu * size;
        if (N >= mu * T) return;
        if (mu * N + T <= S(0)) {
            for (std::size_t i = 0; i < 3; ++i) {
                g[i] += D * y[i];
                if (H) (*H)[i][i] += D;
            }
            return;
        }
        // (N - mu T)^2 Dm / 2 with N - mu T = mu (y_n - mu |y_t|)
        const S Dm = D / (S(1) + mu * mu), gap = y[0] - mu * size, t1 = y[1] / size, t2 = y[2] / size;
        const Vector3<S> slope(S(1), -mu * t1, -mu * t2);
        for (std::size_t i = 0; i < 3; ++i) {
            g[i] += Dm * gap * slope[i];
            if (!H) continue;
            for (std::size_t k = 0; k < 3; ++k) (*H)[i][k] += Dm * slope[i] * slope[k];
        }
        if (!H) return;
        const S bend = -Dm * gap * mu / size;
        (*H)[1][1] += bend * t2 * t2, (*H)[2][2] += bend * t1 * t1;
        (*H)[1][2] -= bend * t1 * t2, (*H)[2][1] -= bend * t1 * t2;
    }

  private:
    static void add_edge(const Vector3<S>& y, const Vector3<S>& edge, const S& weight, Vector3<S>& g, Matrix3<S>* H) {
        const S e = dot(edge, y);
        if (!(e < S(0))) return;
        g = g + (weight * e) * edge;
        if (!H) return;
        for (std::size_t i = 0; i < 3; ++i) (*H)[i] = (*H)[i] + (weight * edge[i]) * edge;
    }
};

template <class S>
class MujocoContacts : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Velocity = contact_stepping::Twist<S>;
    using Base::contacts_, Base::v_, Base::w_;

  public:
    MujocoContacts(const Problem& problem, const bool& elliptic) : Base(problem), elliptic_(elliptic) {}
    void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(this->q_);
        this->find_contacts(R, S(0));
        Velocity u = this->template free_velocity<GyroscopicTerm::explicit_euler>(t, h, R);
        if (!contacts_.empty()) {
            const Velocity free{(S(1) / h) * (u.v - v_), (S(1) / h) * (u.w - w_)};
            const Six<S> x =
                solve_acceleration(h, R, {free.v[0], free.v[1], free.v[2], free.w[0], free.w[1], free.w[2]});
            u.v = v_ + h * Vector3<S>(x[0], x[1], x[2]);
            u.w = w_ + h * Vector3<S>(x[3], x[4], x[5]);
        }
        v_ = u.v, w_ = u.w;
        // every penetrating point is pushed
        this->note_impacts(t, h, [](const Constraint&) { return true; });
        this->move(h, u);
        this->move_to_pivot();
    }

  private:
    static constexpr int most_iterations = 50;

    struct Row {
        std::array<Six<S>, 3> J{};
        Vector3<S> reference;
        SoftCone<S> cone;
    };

    void set_row(const Constraint& c, const S& h) {
        const SoftConstraint<S> soft{.step = h};
        const S d = soft.impedance(-c.gap), b = soft.damping(), k = soft.stiffness();
        Row row;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) row.J[i][j] = c.axis_W[i][j], row.J[i][j + 3] = c.moment_W[i][j];
            row.reference[i] = -b * c.velocity(i, this->twist());
        }
        row.reference[0] -= k * d * c.gap;
        row.cone = {elliptic_, c.friction, d / ((S(1) - d) * c.inverse_mass)};
        rows_.push_back(row);
    }
    /// The gradient of the cost at x, and its second derivative if H is not null.
    Six<S> differentiate(const Six<S>& x, const Six<S>& x0, std::array<Six<S>, 6>* H) const {
        Six<S> gradient{};
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t k = 0; k < 6; ++k) gradient[i] += mass_[i][k] * (x[k] - x0[k]);
        if (H) *H = mass_;
        for (const Row& row : rows_) {
            Vector3<S> y, g;
            Matrix3<S> second;
            for (std::size_t i = 0; i < 3; ++i) y[i] = dot_six(row.J[i], x) - row.reference[i];
            row.cone.differentiate(y, g, H ? &second : nullptr);
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t a = 0; a < 6; ++a) {
                    gradient[a] += row.J[i][a] * g[i];
                    if (!H) continue;
                    for (std::size_t k = 0; k < 3; ++k)
                        for (std::size_t b = 0; b < 6; ++b) (*H)[a][b] += row.J[i][a] * second[i][k] * row.J[k][b];
                }
        }
        return gradient;
    }
    Six<S> solve_acceleration(const S& h, const Matrix3<S>& R, const Six<S>& x0) {
        rows_.clear();
        for (const Constraint& c : contacts_) set_row(c, h);
        const Matrix3<S> inertia_W = R * (this->inertia_.tensor * transposed(R));
        mass_ = {};
        for (std::size_t i = 0; i < 3; ++i) {
            mass_[i][i] = S(1) / contacts_.front().inverse_mass;
            for (std::size_t k = 0; k < 3; ++k) mass_[i + 3][k + 3] = inertia_W[i][k];
        }
        Six<S> x = x0;
        S smallest = Elementary<S>::infinity();
        for (int i = 0; i < most_iterations; ++i) {
            std::array<Six<S>, 6> H{};
            const Six<S> gradient = differentiate(x, x0, &H);
            Six<S> direction = solve_six(H, gradient);
            for (S& entry : direction) entry = -entry;
            // Newton's decrement, in units of energy over time squared: iterates until rounding stops it
            const S decrement = -dot_six(gradient, direction);
            const S scale = dot_six(multiply_mass(x), x) + dot_six(multiply_mass(x0), x0);
            if (!(decrement > S(0)) || (decrement < accuracy * scale && !(decrement < smallest / S(4)))) return x;
            smallest = std::min(smallest, decrement);
            const S length_of_step = search_line(x, x0, direction, -decrement);
            for (std::size_t k = 0; k < 6; ++k) x[k] += length_of_step * direction[k];
        }
        ++this->unconverged_;
        return x;
    }
    /// The step along `direction` at which the slope of the cost vanishes, or 1 if the slope is not positive there.
    S search_line(const Six<S>& x, const Six<S>& x0, const Six<S>& direction, const S& slope_at_0) const {
        const auto slope = [&](const S& a) {
            Six<S> at = x;
            for (std::size_t k = 0; k < 6; ++k) at[k] += a * direction[k];
            return dot_six(differentiate(at, x0, nullptr), direction);
        };
        S low = S(0), low_slope = slope_at_0, high = S(1), high_slope = slope(high);
        for (int i = 0; i < 10 && high_slope < S(0); ++i)
            low = high, low_slope = high_slope, high *= S(2), high_slope = slope(high);
        S a = high;
        for (int i = 0; i < 30 && std::abs(high_slope) > S(1e-3) * std::abs(slope_at_0); ++i) {
            a = (low * high_slope - high * low_slope) / (high_slope - low_slope);
            if (i % 3 == 2) a = (low + high) / S(2);
            const S found = slope(a);
            if (std::abs(found) <= S(1e-3) * std::abs(slope_at_0)) return a;
            (found < S(0) ? low : high) = a;
            (found < S(0) ? low_slope : high_slope) = found;
        }
        return a;
    }
    Six<S> multiply_mass(const Six<S>& x) const {
        Six<S> product{};
        for (std::size_t i = 0; i < 6; ++i) product[i] = dot_six(mass_[i], x);
        return product;
    }

    static constexpr S accuracy =
        S(sizeof(S) == sizeof(float) ? 1e-10 : 1e-24);  // relative to the squared acceleration

    const bool elliptic_;
    std::array<Six<S>, 6> mass_{};
    std::vector<Row> rows_;
};

template <class S, bool elliptic>
Trajectory solve_mujoco_contacts(const Problem& problem, const Settings& settings) {
    return march<MujocoContacts<S>>(problem, settings, elliptic);
}

std::string mujoco_contact_refusal(const Problem& problem) {
    for (const Plane& plane : problem.scene.planes)
        if (plane.restitution > 0)
            return "MuJoCo's contacts have no coefficient of restitution: only e = 0 is supported";
    return contact_stepping::contact_refusal(problem);
}

constexpr Method mujoco_contacts_variants[] = {
    {.name = "mujoco_contacts_elliptic",
     .documentation = "MuJoCo's contact with its default parameters (solref 0.02 s and damping ratio 1, solimp 0.9, "
                      "0.95, 0.001 m, impratio 1) and the elliptic cone: accelerations minimise a convex function in "
                      "which a contact is a critically damped spring with regularised friction, solved by Newton's "
                      "method; then semi-implicit Euler with an explicit gyroscopic term. A body at rest penetrates, "
                      "and a body that should stick creeps: the step decreases neither. The regularisation couples "
                      "slip and normal force, so that a sliding body is pushed up and a block rocks. Order 1, to the "
                      "motion of this soft model. It has no coefficient of restitution and refuses scenes with one.",
     .solve = solve_mujoco_contacts<double, true>},
    {.name = "mujoco_contacts_pyramidal",
     .documentation =
         "`mujoco_contacts_elliptic` with the pyramidal cone, MuJoCo's default: four edges n +- mu t per contact. "
         "Friction is inscribed in Coulomb's cone and at 45 degrees between the axes sqrt(1/2) of it.",
     .solve = solve_mujoco_contacts<double, false>},
};

constexpr auto mujoco_contacts_binary64_family =
    apply_defaults({.source = "E. Todorov 2014, Convex and analytically-invertible dynamics with contacts and "
                              "constraints, ICRA; Google DeepMind, MuJoCo, documentation of solver parameters",
                    .conserves = "|q|",
                    .control = Control::fixed_step,
                    .planes = true,
                    .order = 1,
                    .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
                    .family = Family::engine_update,
                    .formulation = Formulation::full,
                    .refusal = mujoco_contact_refusal},
                   mujoco_contacts_variants);

constexpr auto mujoco_contacts_family =
    with_binary32<mujoco_contacts_binary64_family, binary32_refusal, solve_mujoco_contacts<float, true>,
                  solve_mujoco_contacts<float, false>>();

}  // namespace

extern const std::span<const Method> mujoco_contacts_methods{mujoco_contacts_family};

}  // namespace polhode
