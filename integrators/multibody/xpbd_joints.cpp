// Extended position-based dynamics of bodies with joints: M. Mueller, M. Macklin, N. Chentanez, S. Jeschke, T.-Y. Kim
// 2020, Detailed Rigid Body Simulation with Extended Position Based Dynamics, Computer Graphics Forum 39(8), algorithm
// 2, with the small steps of M. Macklin, K. Storey, M. Lu, P. Terdiman, N. Chentanez, S. Jeschke, M. Mueller 2019,
// Small Steps in Physics Simulation, SCA.
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "integrators/multibody/binary32_variants.h"
#include "integrators/multibody/joint_rows.h"
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
///   dry friction of joints and the rates at limits (joint_rows.h); after an impact with restitution, the velocities
///   of all joints by Gauss-Seidel iteration
/// Limits are solved between a joint's axes and its points, static friction after its points.
template <class S, int substeps>
class XpbdJoints : public multibody::MaximalState<S> {
    using Base = multibody::MaximalState<S>;
    using Base::bodies_, Base::steps_;
    using Body = multibody::MovingBody<S>;
    using View = multibody::PairView<S>;

  public:
    /// `step`: length of a step that no event cuts, s.
    XpbdJoints(const Problem& problem, double step) : Base(problem), min_step_(step / 64) {
        joint_rows_ = multibody::joint_rows(problem.scene, this->pairs());
    }
    void restart() {
        Base::restart();
        for (Row& row : joint_rows_) row.forget();
    }
    void enter(const Segment& segment) {
        Base::enter(segment);
        for (Row& row : joint_rows_) row.forget();
    }
    void step(double, double step) {
        const S h = S(step) / substeps;
        for (int i = 0; i < substeps; ++i) {
            const std::vector<Body> before = bodies_;
            for (Row& row : joint_rows_) row.start_positions(view_of(row), coordinate(row), h);
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
            solve_joints(h);
            for (int pass = 1; pass < most_passes && has_impact(); ++pass)
                if (!(solve_joints(h) > accuracy)) break;
            for (std::size_t b = 0; b < bodies_.size(); ++b) {
                Body& body = bodies_[b];
                if (!body.movable) continue;
                body.v = (1 / h) * (body.x - before[b].x);
                const Quaternion<S> change = body.q * conjugate(before[b].q);
                body.w = ((change.w < 0 ? S(-2) : S(2)) / h) * vector_part(change);
            }
            for (Row& row : joint_rows_) {
                const auto& pair = this->pairs()[row.pair];
                row.solve_velocities(this->view(pair), bodies_[pair.from], bodies_[pair.to]);
            }
            if (has_impact()) solve_impact();
        }
    }

  private:
    using Row = multibody::JointRow<S>;
    // impacts: passes over all joints, and the change relative to the speed of the impact that ends the passes
    static constexpr int most_passes = 1000;
    static constexpr S accuracy = 64 * std::numeric_limits<S>::epsilon();
    double min_step_;  ///< s; a shorter step leaves the joints to the next step
    std::vector<Row> joint_rows_;

    View view_of(const Row& row) const { return this->view(this->pairs()[row.pair]); }
    S coordinate(const Row& row) {
        multibody::update_coordinates(view_of(row), this->coordinates_[row.pair]);
        return this->coordinates_[row.pair][0];
    }
    bool has_impact() const {
        return std::ranges::any_of(joint_rows_, [](const Row& row) { return row.has_impact(); });
    }
    // One pass over the positions of all joints. Returns the largest correction at a limit, see correct_limits().
    S solve_joints(S h) {
        S largest = S(0);
        auto next = joint_rows_.begin();
        for (std::size_t k = 0; k < this->pairs().size(); ++k) {
            const bool has_row = next != joint_rows_.end() && next->pair == k;
            largest = std::max(largest, solve_joint(this->pairs()[k], has_row ? &*next : nullptr, h));
            if (has_row) ++next;
        }
        return largest;
    }
    // Rates at limits that are set joint by joint separate the points of the joints, and the next substeps would lose a
    // part of them. Repeats them with all joints until they do not change.
    void solve_impact() {
        std::vector<multibody::BlockedPair<S>> joints;
        for (const auto& pair : this->pairs()) joints.emplace_back(this->view(pair));
        S change = S(1);
        for (int pass = 0; pass < most_passes && change > accuracy; ++pass) {
            for (std::size_t k = 0; k < joints.size(); ++k) {
                const auto& pair = this->pairs()[k];
                std::array<S, 6> impulses{};
                joints[k].solve({}, impulses, bodies_[pair.from], bodies_[pair.to]);
            }
            change = S(0);
            for (const Row& row : joint_rows_) {
                const auto& pair = this->pairs()[row.pair];
                change = std::max(change, row.set_limit_rate(bodies_[pair.from], bodies_[pair.to]));
            }
        }
    }
    // `row`: limits and friction of the joint, or null
    S solve_joint(const multibody::JointPair<S>& pair, Row* row, S h) {
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
        const S correction = row ? row->correct_limits(at, coordinate(*row), h, a, b) : S(0);
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
        if (row && row->has_friction()) row->hold(at, coordinate(*row), h, a, b);
        return correction;
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
         "dampers and motors of joints are forces at the start of the substep. A limit that is passed is corrected "
         "without compliance; static friction cancels the displacement of a coordinate if this takes less than F h, "
         "dynamic friction and the restitution of limits change velocities at the end of the substep. The article "
         "solves restitution in one pass, which leaves an error that no step reduces where a joint turns a body "
         "about a point off its centre of mass. In a substep with an impact, the passes over positions and "
         "velocities of all joints are therefore repeated until they converge. Friction and inelastic limits only "
         "remove energy; an elastic limit keeps it to the order of the step. The remaining joint errors carry over "
         "to the next substep, so that a long chain stretches. Motion that is fast compared with a substep is "
         "damped. Rounding adds 2^-53 |x| / h to v (2^-24 |x| / h in binary32), so very short steps increase the "
         "error. Order 1.",
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
     .refusal = multibody::impulse_refusal},
    xpbd_joints_variants);

constexpr auto xpbd_joints_family =
    multibody::with_binary32_variants<xpbd_joints_binary64_family, solve_xpbd_joints<float, 10>,
                                      solve_xpbd_joints<float, 1>, solve_xpbd_joints<float, 20>>();

}  // namespace

extern const std::span<const Method> xpbd_joints_methods{xpbd_joints_family};

}  // namespace polhode
