// Limits and motors of joints in Bullet's btMultiBody: E. Coumans, Bullet 3.24, btMultiBodyJointLimitConstraint,
// btMultiBodyJointMotor and btMultiBodyConstraintSolver.
#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "integrators/multibody/reduced_rows.h"
#include "integrators/multibody/reduced_steps.h"
#include "integrators/multibody/refusals.h"

namespace polhode {
namespace {

/// x' += h M^-1 f, then 10 iterations over the rows of limits that are passed and of friction, each in the opposite
/// order of the previous one, from impulses of zero:
///   d = (target - J x') / (J M^-1 J^T),  lambda' = clamp(lambda + d),  x' += M^-1 J^T (lambda' - lambda)
///   limit     target = -erp g / h, erp = 0.2, or 0 for g <= -0.04 (m or rad);  0 <= lambda <= 100
///   friction  target = 0: a motor at speed zero;  |lambda| <= F h
/// x += h x'. Gaps g, M and J are those of the start of the step.
///
/// Bullet sorts its constraints by the number of their island. All constraints of a tree are in one island, and its
/// sort (btAlignedObjectArray::quickSort) reverses equal elements, then those of each half, and so on. The order
/// matters because the iterations do not converge.
class BulletJoints : public multibody::SemiImplicitSteps {
  public:
    explicit BulletJoints(const Problem& problem)
        : SemiImplicitSteps(problem), rows_(problem.scene, tree()), place_(rows_.constraints()) {
        std::vector<std::size_t> sorted(place_.size());
        std::iota(sorted.begin(), sorted.end(), std::size_t{0});
        reverse_halves(sorted);
        for (std::size_t i = 0; i < sorted.size(); ++i) place_[sorted[i]] = i;
    }
    void step(double, double h) {
        const std::vector<double> a = accelerations();
        const std::vector<multibody::ReducedRow>& rows = rows_.select(tree(), y_.data());
        std::vector<double> matrix;
        if (!rows.empty()) matrix = rows_.inverse_inertia(tree(), y_.data());
        advance_rates(h, a);
        if (!rows.empty()) rows_.apply(impulses(rows, matrix, h), y_.data() + coordinates());
        move(h);
    }

  private:
    static constexpr int iterations = 10;
    static constexpr double erp = 0.2, deepest_correction = -0.04, largest_impulse = 100;

    multibody::ReducedRows rows_;
    std::vector<std::size_t> place_;  // by constraint: its index in Bullet's order

    static void reverse_halves(std::span<std::size_t> part) {
        if (part.size() < 2) return;
        std::ranges::reverse(part);
        reverse_halves(part.first(part.size() / 2));
        reverse_halves(part.last(part.size() / 2));
    }
    std::vector<double> impulses(const std::vector<multibody::ReducedRow>& rows, const std::vector<double>& matrix,
                                 double h) const {
        const std::size_t n = rows.size();
        std::vector<std::size_t> order(n);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t i) { return place_[rows[i].constraint]; });
        std::vector<double> impulse(n, 0.0);
        for (int iteration = 0; iteration < iterations; ++iteration)
            for (std::size_t k = 0; k < n; ++k) {
                const std::size_t i = order[iteration % 2 == 1 ? k : n - 1 - k];
                const multibody::ReducedRow& row = rows[i];
                const bool is_friction = row.friction > 0;
                double missing = -row.sign * y_[coordinates() + row.rate];
                if (!is_friction && row.gap > deepest_correction) missing -= erp * row.gap / h;
                for (std::size_t j = 0; j < n; ++j) missing -= matrix[i * n + j] * impulse[j];
                const double bound = is_friction ? row.friction * h : largest_impulse;
                impulse[i] = std::clamp(impulse[i] + missing / matrix[i * n + i], is_friction ? -bound : 0.0, bound);
            }
        return impulse;
    }
};

Trajectory solve_bullet_joints(const Problem& problem, const Settings& settings) {
    return march<BulletJoints>(problem, settings);
}

constexpr Method bullet_joints_variants[] = {
    {.name = "bullet_joints",
     .documentation =
         "`reduced_semi_implicit_euler` with limits and friction of joints as in Bullet's btMultiBody: impulses "
         "along the coordinates, by 10 iterations of projected Gauss-Seidel from zero. A limit acts in the step "
         "after it is passed, with an impulse of at most 100 N s or N m s, and corrects 0.2 of the gap per step; "
         "gaps of 0.04 m or rad and more are not corrected. Friction F is a motor at speed zero with an impulse of "
         "at most F h. The rate that corrects a gap is not removed: a joint leaves a limit with 0 to 0.2 of its "
         "speed of arrival, depending on when in the step it arrives, and with more if the largest impulse does not "
         "stop it in one step. Friction and limits otherwise only remove energy. Order 1 with friction; after an "
         "arrival at a limit the motion does not converge. Restitution, loops and couplings are not supported. "
         "Bullet's default damping of links is omitted.",
     .solve = solve_bullet_joints},
};

constexpr auto bullet_joints_family =
    apply_defaults({.source = "E. Coumans, Bullet 3.24, btMultiBodyJointLimitConstraint, btMultiBodyJointMotor",
                    .conserves = "joints closed; |q|",
                    .control = Control::fixed_step,
                    .general_systems = true,
                    .order = 1,
                    .family = Family::engine_update,
                    .refusal = multibody::reduced_limit_refusal},
                   bullet_joints_variants);

}  // namespace

extern const std::span<const Method> bullet_joints_methods{bullet_joints_family};

}  // namespace polhode
