// Extended position-based dynamics of bodies with joints: M. Mueller, M. Macklin, N. Chentanez, S. Jeschke, T.-Y. Kim
// 2020, Detailed Rigid Body Simulation with Extended Position Based Dynamics, Computer Graphics Forum 39(8), algorithm
// 2, with the small steps of M. Macklin, K. Storey, M. Lu, P. Terdiman, N. Chentanez, S. Jeschke, M. Mueller 2019,
// Small Steps in Physics Simulation, SCA.
#include <limits>
#include <span>

#include "integrators/multibody/binary32_variants.h"
#include "integrators/multibody/maximal_state.h"

namespace polhode {
namespace {

/// A step consists of `substeps` substeps of length h:
///   v += h F / m,  w += h I_W^-1 (tau - w x I_W w),  x += h v,  q += (h/2) (0, w) q
///   each joint once, its axes and then its points, without compliance. For its bodies a and b (b gets +, a gets -):
///     rotation phi = theta n:  lambda = -theta / (n . (I_a^-1 + I_b^-1) n),
///                              q_b += (1/2) (0, lambda I_b^-1 n) q_b
///     gap d = c n:             lambda = -c / (1/m_a + (r_a x n) . I_a^-1 (r_a x n) + ..b),  p = lambda n,
///                              x_b += p/m_b,  q_b += (1/2) (0, I_b^-1 (r_b x p)) q_b
///   v = (x - x_old) / h,  w = +-2 vec(q q_old*) / h
template <class S, int substeps>
class XpbdJoints : public multibody::MaximalState<S> {
    using Base = multibody::MaximalState<S>;
    using Base::bodies_, Base::steps_;
    using Body = multibody::MovingBody<S>;
    using View = multibody::PairView<S>;

  public:
    /// `step`: length of a step that no event cuts, s.
    XpbdJoints(const Problem& problem, double step) : Base(problem), min_step_(step / 64) {}
    void step(double, double step) {
        const S h = S(step) / substeps;
        for (int i = 0; i < substeps; ++i) {
            const std::vector<Body> before = bodies_;
            this->template accelerate<GyroscopicTerm::explicit_euler>(h);
            for (Body& body : bodies_) {
                if (!body.movable) continue;
                body.x = body.x + h * body.v;
                body.rotate_first_order(h * body.w);
                body.update_rotation();
            }
            ++steps_;
            // velocities come from the change of positions; in a very short step that change is mostly rounding error
            if (step < min_step_) continue;
            for (const auto& pair : this->pairs()) solve_joint(pair);
            for (std::size_t b = 0; b < bodies_.size(); ++b) {
                Body& body = bodies_[b];
                if (!body.movable) continue;
                body.v = (1 / h) * (body.x - before[b].x);
                const Quaternion<S> change = body.q * conjugate(before[b].q);
                body.w = ((change.w < 0 ? S(-2) : S(2)) / h) * vector_part(change);
            }
        }
    }

  private:
    double min_step_;  ///< s; a shorter step leaves the joints to the next step

    void solve_joint(const multibody::JointPair<S>& pair) {
        using maximal::Kind;
        Body &a = bodies_[pair.from], &b = bodies_[pair.to];
        const View at{pair, a, b};
        if (pair.kind == Kind::fixed || pair.kind == Kind::prismatic) {
            correct_rotation(at.twist(), a, b);
        } else if (pair.kind == Kind::revolute) {
            correct_rotation(cross(at.first_axis(), at.axis_to(0)), a, b);
        } else if (pair.kind == Kind::universal) {
            // C = cos - e1 . e2, its gradient e1 x e2
            const Vector3<S> e1 = at.first_axis(), e2 = at.axis_to(1), n = cross(e1, e2);
            correct_rotation(((pair.between - dot(e1, e2)) / dot(n, n)) * n, a, b);
        }
        const Vector3<S> gap = at.gap(), arm_to = at.arm_to();
        if (pair.kind == Kind::distance) {
            const S distance = length(gap);
            correct_gap(((distance - pair.length) / distance) * gap, at.arm_from(), arm_to, a, b);
        } else if (pair.kind == Kind::prismatic) {
            // the part across the axis; the force on both bodies acts at the child's point
            const Vector3<S> axis = at.first_axis();
            correct_gap(gap - dot(axis, gap) * axis, at.arm_from() + gap, arm_to, a, b);
        } else {
            correct_gap(gap, at.arm_from(), arm_to, a, b);
        }
    }
    // `turn`: rotation of b relative to a
    static void correct_rotation(const Vector3<S>& turn, Body& a, Body& b) {
        const S angle = hypotenuse(turn);
        if (!(angle > std::numeric_limits<S>::min())) return;
        const Vector3<S> n = (1 / angle) * turn, response_a = a.inverse_I_W * n, response_b = b.inverse_I_W * n;
        const S lambda = -angle / (dot(n, response_a) + dot(n, response_b));
        rotate_body(b, lambda * response_b), rotate_body(a, -lambda * response_a);
    }
    // `gap`: from the point of a to the point of b
    static void correct_gap(const Vector3<S>& gap, const Vector3<S>& arm_a, const Vector3<S>& arm_b, Body& a, Body& b) {
        const S distance = hypotenuse(gap);
        if (!(distance > std::numeric_limits<S>::min())) return;
        const Vector3<S> n = (1 / distance) * gap, lever_a = cross(arm_a, n), lever_b = cross(arm_b, n);
        const Vector3<S> response_a = a.inverse_I_W * lever_a, response_b = b.inverse_I_W * lever_b;
        const S lambda =
            -distance / (a.inverse_mass + b.inverse_mass + dot(lever_a, response_a) + dot(lever_b, response_b));
        b.x = b.x + (lambda * b.inverse_mass) * n;
        a.x = a.x - (lambda * a.inverse_mass) * n;
        rotate_body(b, lambda * response_b), rotate_body(a, -lambda * response_a);
    }
    static void rotate_body(Body& body, const Vector3<S>& turn) {
        if (!body.movable) return;
        body.rotate_first_order(turn);
        body.update_rotation();
    }
};

template <class S, int substeps>
Trajectory solve_xpbd_joints(const Problem& problem, const Settings& settings) {
    const double step = longest_step(problem, settings);
    return march<XpbdJoints<S, substeps>>(problem, settings, step);
}

constexpr Method xpbd_joints_variants[] = {
    {.name = "xpbd_joints_10",
     .documentation =
         "Extended position-based dynamics of jointed bodies in 10 substeps per step: bodies move with their "
         "velocities, each joint is solved once for its axes and points, by attitudes and positions, without "
         "compliance, and the new velocities are the displacements divided by the length of the substep. Springs, "
         "dampers and motors of joints are forces at the start of the substep. The remaining joint errors carry over "
         "to the next substep, so that a long chain stretches. Motion that is fast compared with a substep is damped. "
         "Rounding adds 2^-53 |x| / h to v (2^-24 |x| / h in binary32), so very short steps increase the error. Order "
         "1.",
     .solve = solve_xpbd_joints<double, 10>},
    {.name = "xpbd_joints_1",
     .documentation = "`xpbd_joints_10` without substeps.",
     .solve = solve_xpbd_joints<double, 1>},
    {.name = "xpbd_joints_20",
     .documentation = "`xpbd_joints_10` with 20 substeps per step.",
     .solve = solve_xpbd_joints<double, 20>},
};

constexpr auto xpbd_joints_binary64_family = apply_defaults(
    {.source = "M. Mueller, M. Macklin, N. Chentanez, S. Jeschke, T.-Y. Kim 2020, Detailed Rigid Body "
               "Simulation with Extended Position Based Dynamics, Computer Graphics Forum 39(8), algorithm 2; "
               "M. Macklin et al. 2019, Small Steps in Physics Simulation, Symposium on Computer Animation",
     .conserves = "|q|; linear momentum of a mechanism that is not connected to the world",
     .control = Control::fixed_step,
     .general_systems = true,
     .order = 1,
     .family = Family::engine_update,
     .refusal = multibody::inertia_refusal},
    xpbd_joints_variants);

constexpr auto xpbd_joints_family =
    multibody::with_binary32_variants<xpbd_joints_binary64_family, solve_xpbd_joints<float, 10>,
                                      solve_xpbd_joints<float, 1>, solve_xpbd_joints<float, 20>>();

}  // namespace

extern const std::span<const Method> xpbd_joints_methods{xpbd_joints_family};

}  // namespace polhode
