// Variational integrator for trees. The cost of a step is linear in the number of links.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "integrators/multibody/armature.h"
#include "integrators/multibody/discrete_forces.h"
#include "integrators/multibody/joint_state.h"
#include "integrators/multibody/refusals.h"

namespace polhode {
namespace {

using multibody::RotationMaps;

/// Discrete Lagrangian h L(m, v), where m is the midpoint between x_k and x_k+1 = x_k exp(h v); forces use the same
/// rule (Marsden & West 2001, 2.3 and 3.2). For additive coordinates, with p and f = dT/dx + Q at (m, v):
///   p - (h/2) f = p_k,   p_k+1 = p + (h/2) f,   x_k+1 = x_k + h v
/// Attitudes use the maps of RotationMaps. The first equation is solved for v by quasi-Newton steps with
/// (M(m) + (h/2) c + (h^2/4) k)^-1, c and k of the joints' dampers and springs: one recursion per step.
class VariationalTree : public multibody::JointState {
  public:
    explicit VariationalTree(const Problem& problem)
        : JointState(problem), rest_speed_(1e-6 * std::max(problem.scales.angular_velocity, problem.scales.velocity)) {
        for (const Link<double>& link : tree().links().links)
            for (int k = 0; k < link.rates(); ++k) {
                const bool has_joint = link.kind != LinkJoint::free;
                damping_.push_back(has_joint ? link.damping : 0), stiffness_.push_back(has_joint ? link.stiffness : 0);
            }
        update_momenta();
    }
    void restart() {
        JointState::restart();
        update_momenta();
        failed_ = false, evaluations_ = 0;
    }
    void enter(const Segment& segment) {
        update_rates();
        JointState::enter(segment);
        update_momenta();
    }
    void step(double t, double h) {
        if (failed_) return;
        constexpr int max_iterations = 60;
        constexpr double near_solution = 1e-6, round_off = 4 * std::numeric_limits<double>::epsilon();
        const std::size_t n = rates();
        std::vector<double> v = guess_;
        armature_.resize(n);
        for (std::size_t k = 0; k < n; ++k) {
            v[k] += h * acceleration_[k];
            armature_[k] = h / 2 * damping_[k] + h * h / 4 * stiffness_[k];
        }
        double before = std::numeric_limits<double>::infinity();
        bool solved = false;
        for (int i = 0; i < max_iterations && !solved; ++i) {
            evaluate_midpoint(h, v);
            solver_.copy_links(tree(), tree().work<double>());
            solver_.factorize(tree(), armature_);
            residual_.resize(n);
            for_each_end(h, v, [&](std::size_t k, double begin, double) { residual_[k] = begin - momenta_[k]; });
            solver_.solve(tree(), residual_, change_);
            double size = 0, whole = 0;
            for (std::size_t k = 0; k < n; ++k) {
                v[k] -= change_[k];
                size += change_[k] * change_[k], whole += v[k] * v[k];
            }
            if (!std::isfinite(size)) break;
            // iterate until rounding prevents further reduction
            whole = std::max(whole, rest_speed_ * rest_speed_);
            solved = size <= round_off * round_off * whole ||
                     (size <= near_solution * near_solution * whole && !(size < before));
            before = size;
        }
        failed_ = !solved, failed_at_ = t;
        if (failed_) return;
        evaluate_midpoint(h, v);
        for_each_end(h, v, [&](std::size_t k, double, double end) { momenta_[k] = end; });
        std::copy(v.begin(), v.end(), y_.begin() + static_cast<std::ptrdiff_t>(coordinates()));
        advance_coordinates(h, y_);
        guess_ = v;
        acceleration_.assign(dy_.begin() + static_cast<std::ptrdiff_t>(coordinates()), dy_.end());
        ++steps_;
    }
    std::vector<Sample> sample(double t) const {
        VariationalTree here(*this);
        here.update_rates();
        return here.JointState::sample(t);
    }
    bool finite() const { return JointState::finite() && all_finite(std::span<const double>(momenta_)); }
    long rhs_evaluations() const { return evaluations_; }
    bool failed() const { return failed_; }
    void explain(Trajectory& trajectory) const { report_unsolved_step(trajectory, sample(failed_at_)); }

  private:
    std::vector<double> momenta_;               // p_k
    std::vector<double> guess_, acceleration_;  // v of the previous step, and its acceleration
    std::vector<double> mid_, damping_, stiffness_, armature_, residual_, change_;
    multibody::DiscreteForces forces_;
    multibody::JointSweeps sweeps_;
    multibody::ArmatureSolver solver_;
    double rest_speed_;  ///< rates below this value count as rest
    long evaluations_ = 0;
    bool failed_ = false;
    double failed_at_ = 0;  ///< s

    // evaluates the forces at the midpoint of a step with rates v
    void evaluate_midpoint(double h, const std::vector<double>& v) {
        mid_ = y_;
        std::copy(v.begin(), v.end(), mid_.begin() + static_cast<std::ptrdiff_t>(coordinates()));
        advance_coordinates(h / 2, mid_);
        evaluate(mid_);
    }
    // the momenta at the start and the end of the step that follow from the midpoint forces
    template <class Action>
    void for_each_end(double h, const std::vector<double>& v, Action&& action) {
        for (const Link<double>& link : tree().links().links) {
            std::size_t k = static_cast<std::size_t>(link.rate) - coordinates();
            const std::size_t end = k + static_cast<std::size_t>(link.rates());
            const auto force = [&](std::size_t i) { return h / 2 * forces_.force[i]; };
            if (link.rates() > 1) {
                const auto three = [&](const std::vector<double>& all) {
                    return Vector3<double>(all[k], all[k + 1], all[k + 2]);
                };
                const RotationMaps maps(h * three(v));
                const Vector3<double> p = three(forces_.momentum), f = (h / 2) * three(forces_.force);
                const Vector3<double> start_momentum = maps.start_momentum(p, f),
                                      end_momentum = maps.end_momentum(p, f);
                for (std::size_t c = 0; c < 3; ++c) action(k + c, start_momentum[c], end_momentum[c]);
                k += 3;
            }
            for (; k < end; ++k) action(k, forces_.momentum[k] - force(k), forces_.momentum[k] + force(k));
        }
    }
    void evaluate(const std::vector<double>& y) {
        tree().derivative(y.data(), dy_.data());
        TreeWork<double>& at = tree().work<double>();
        tree().move(y.data(), at);
        sweeps_.compute(tree(), at, y.data(), dy_.data() + coordinates(), forces_);
        ++evaluations_;
    }
    // computes p and the initial estimates from (x, v)
    void update_momenta() {
        evaluate(y_);
        momenta_ = forces_.momentum;
        guess_.assign(y_.begin() + static_cast<std::ptrdiff_t>(coordinates()), y_.end());
        acceleration_.assign(rates(), 0);
    }
    // v = M^-1 p
    void update_rates() {
        TreeWork<double>& at = tree().work<double>();
        tree().move(y_.data(), at);
        solver_.copy_links(tree(), at);
        armature_.assign(rates(), 0);
        solver_.factorize(tree(), armature_);
        solver_.solve(tree(), momenta_, change_);
        std::copy(change_.begin(), change_.end(), y_.begin() + static_cast<std::ptrdiff_t>(coordinates()));
    }
};

std::string variational_tree_refusal(const Problem& problem) {
    if (std::string why = multibody::mechanism_refusal(problem); !why.empty()) return why;
    for (const Joint& joint : problem.scene.joints)
        if (joint.armature != std::array<double, 2>{}) return "this method does not support armature of joints";
    if (!problem.scene.couplings.empty()) return "this method does not support couplings of joints";
    return problem.scene.loops.empty() ? "" : "this method supports only trees, not loops";
}

Trajectory solve_variational_tree(const Problem& problem, const Settings& settings) {
    return march<VariationalTree>(problem, settings);
}

constexpr Method variational_tree_variants[] = {
    {.name = "variational_tree",
     .documentation =
         "A variational integrator for trees: the action is summed by the midpoint rule in joint coordinates, with "
         "exponentials for rotations of spherical joints and free bases, and the motion makes it stationary (discrete "
         "Euler-Lagrange equations). Symplectic: without dampers and motors the energy error stays bounded by the "
         "order of the square of the step over any number of steps, and momenta of symmetries are conserved to "
         "rounding. The equations of a step are solved to rounding by quasi-Newton steps, each of one articulated-body "
         "recursion, so that the cost is linear in the number of links. A heavy body on light links with ball joints "
         "requires short steps: the discrete torque of the whole acts on the first link's own twist. Rates at samples "
         "are those of the momenta, M^-1 p. Order 2.",
     .source =
         "J. E. Marsden & M. West 2001, Discrete mechanics and variational integrators, Acta Numerica 10; J. Lee, "
         "C. K. Liu, F. C. Park, S. S. Srinivasa 2016, A Linear-Time Variational Integrator for Multibody "
         "Systems, WAFR (recursions as the quasi-Newton matrix; there on SE(3))",
     .conserves = "|q|; joints closed; the symplectic form, and therefore nearly the energy; momenta of symmetries",
     .control = Control::fixed_step,
     .general_systems = true,
     .order = 2,
     .solve = solve_variational_tree,
     .family = Family::rotation_group,
     .refusal = variational_tree_refusal},
};

}  // namespace

extern const std::span<const Method> variational_tree_methods{variational_tree_variants};

}  // namespace polhode
