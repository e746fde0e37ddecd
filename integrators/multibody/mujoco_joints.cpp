// MuJoCo's limits and friction of joints: soft constraints in joint coordinates.
#include <span>
#include <utility>
#include <vector>

#include "integrators/contact/box_forces.h"
#include "integrators/game/soft_constraint.h"
#include "integrators/multibody/reduced_rows.h"
#include "integrators/multibody/reduced_steps.h"
#include "integrators/multibody/refusals.h"

namespace polhode {
namespace {

/// Which parameters the soft constraints of joints have.
enum class JointSoftness { defaults, stiffest };

/// Rows J of limits that are passed and of friction, with a_ref, R and the impedance of game/soft_constraint.h, where
/// the inverse mass 1/m is that of the coordinate with all coordinates zero. Friction has r = 0.
///   a = a_0 + M^-1 J^T f,   J a - a_ref + R f = 0 within the bounds of f: f >= 0 or |f| <= F
///   (M + h D) a' = M a,   x' += h a',  x += h x'
/// The forces f are the unique solution of a convex problem.
class MujocoJoints : public multibody::ImplicitDamping {
  public:
    MujocoJoints(const Problem& problem, const JointSoftness& softness)
        : ImplicitDamping(problem), softness_(softness), rows_(problem.scene, tree()) {}
    void step(double t, double h) {
        std::vector<double> a = accelerations();
        failed_ = !add_forces(h, a), failed_at_ = t;
        if (failed_) return;
        damp(h, a);
        advance(h, a);
    }
    bool failed() const { return failed_; }
    void explain(Trajectory& trajectory) const { report_unsolved_step(trajectory, sample(failed_at_)); }

  private:
    JointSoftness softness_;
    multibody::ReducedRows rows_;
    bool failed_ = false;
    double failed_at_ = 0;  // s

    bool add_forces(double h, std::vector<double>& a) {
        const std::vector<multibody::ReducedRow>& rows = rows_.select(tree(), y_.data());
        if (rows.empty()) return true;
        const std::size_t n = rows.size();
        std::vector<double> matrix = rows_.inverse_inertia(tree(), y_.data()), residual;
        std::vector<contact::Box<double>> boxes;
        SoftConstraint<double> soft{.step = h};
        if (softness_ == JointSoftness::stiffest) soft.time = 0, soft.least = soft.most = 0.9999;
        for (std::size_t i = 0; i < n; ++i) {
            const multibody::ReducedRow& row = rows[i];
            const bool is_friction = row.friction > 0;
            const double d = soft.impedance(-row.gap);
            const double reference = -soft.damping() * row.velocity - soft.stiffness() * d * row.gap;
            residual.push_back(row.sign * a[row.rate] - reference);
            matrix[i * n + i] += (1 - d) / d * row.inverse_inertia;
            boxes.push_back({-row.friction, row.friction, true, is_friction});
        }
        const auto found = contact::BoxForces<double>(std::move(matrix), std::move(residual), std::move(boxes)).solve();
        if (found) rows_.apply(found->forces, a.data());
        return found.has_value();
    }
};

template <JointSoftness softness>
Trajectory solve_mujoco_joints(const Problem& problem, const Settings& settings) {
    return march<MujocoJoints>(problem, settings, softness);
}

constexpr Method mujoco_joints_variants[] = {
    {.name = "mujoco_joints",
     .documentation =
         "`reduced_implicit_damping` with MuJoCo's soft limits and dry friction of joints in their default "
         "parameters (solref 0.02 s and damping ratio 1, solimp 0.9, 0.95, 0.001 m or rad): accelerations minimise "
         "a convex function in which a limit that is passed is a critically damped spring and friction is "
         "regularised. MuJoCo iterates; here the forces are computed to rounding. A joint at rest on a limit passes "
         "it, and a joint that friction should hold creeps; the step decreases neither. A limit cannot pull, so "
         "that a joint leaves it with exp(-2) = 0.135 of its speed of arrival. Friction and limits only remove "
         "energy. Order 1, to the motion of this soft model. Restitution, loops and couplings (soft in MuJoCo) are "
         "not supported.",
     .solve = solve_mujoco_joints<JointSoftness::defaults>},
    {.name = "mujoco_joints_stiff",
     .documentation =
         "`mujoco_joints` with the stiffest parameters that MuJoCo permits: a time constant of two steps and an "
         "impedance of 0.9999. Converges with order 1 to dry friction and to rest on a limit. A joint that leaves a "
         "limit does so with 0 to 0.25 of its speed of arrival, depending on when in the step it arrives; after "
         "that the motion does not converge to that of a limit without restitution.",
     .solve = solve_mujoco_joints<JointSoftness::stiffest>},
};

constexpr auto mujoco_joints_family =
    apply_defaults({.source = "E. Todorov 2014, Convex and analytically-invertible dynamics with contacts and "
                              "constraints, ICRA; Google DeepMind, MuJoCo 2.2.2, integrator Euler, solref and solimp",
                    .conserves = "joints closed; |q|",
                    .control = Control::fixed_step,
                    .general_systems = true,
                    .order = 1,
                    .family = Family::engine_update,
                    .refusal = multibody::reduced_limit_refusal},
                   mujoco_joints_variants);

}  // namespace

extern const std::span<const Method> mujoco_joints_methods{mujoco_joints_family};

}  // namespace polhode
