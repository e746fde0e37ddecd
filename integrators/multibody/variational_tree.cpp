// A variational integrator of trees, linear in the number of links at each step.
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "integrators/multibody/armature.h"
#include "integrators/multibody/refusals.h"
#include "integrators/run/march.h"
#include "motion/mechanism.h"

namespace polhode {
namespace {

/// What the discrete equations ask of a state (x, v), in the order of the rates.
struct DiscreteForces {
    std::vector<double> momentum;  ///< p = dT/dv
    std::vector<double> force;     ///< dT/dx + Q
};

/// Sweeps over a tree of joints of one coordinate each: momenta, what kinetic energy changes by coordinates, and by
/// Newton and Euler's equations the generalized forces Q that bring about accelerations.
class JointSweeps {
  public:
    /// `y` = (x, v), `a`: the accelerations under the loads.
    void run(const Tree<double>& tree, const TreeWork<double>& at, const double* y, const double* a,
             DiscreteForces& out) {
        const Links<double>& all = tree.links();
        const std::size_t n = all.links.size();
        u_.resize(n), momentum_.resize(n), acceleration_.resize(n), wrench_.resize(n);
        out.momentum.resize(n), out.force.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            const Link<double>& link = all.links[i];
            const LinkWork<double>& w = at.links[i];
            Vector3<double>&u = u_[i], &alpha = acceleration_[i].turning, &linear = acceleration_[i].linear;
            u = alpha = linear = {};
            if (link.parent >= 0) {
                const std::size_t p = static_cast<std::size_t>(link.parent);
                u = transposed_times(w.R, Vector3<double>(u_[p] + cross(at.links[p].w, w.r)));
                const Pair6<double>& parent = acceleration_[p];
                alpha = transposed_times(w.R, parent.turning);
                linear = transposed_times(w.R, Vector3<double>(parent.linear + cross(parent.turning, w.r)));
            }
            alpha = alpha + w.bias.turning, linear = linear + w.bias.linear;
            const std::size_t k = static_cast<std::size_t>(link.rate - all.coordinates);
            if (link.kind == LinkJoint::revolute)
                alpha[2] += a[k];
            else
                u[2] += y[link.rate], linear[2] += a[k];
            const ArticulatedInertia<double>& I = w.inertia;
            momentum_[i] = {I.J * w.w + I.B * u, transposed_times(I.B, w.w) + I.M * u};
            wrench_[i] = {I.J * alpha + I.B * linear + I.n, transposed_times(I.B, alpha) + I.M * linear + I.f};
        }
        for (std::size_t i = n; i-- > 0;) {
            const Link<double>& link = all.links[i];
            const LinkWork<double>& w = at.links[i];
            const std::size_t k = static_cast<std::size_t>(link.rate - all.coordinates);
            const Pair6<double>&own = momentum_[i], &load = wrench_[i];
            // dT/dx = momentum . [V, S], V the twist and S the joint's axis
            const Vector3<double> z(0, 0, 1), turning = cross(w.w, z);
            if (link.kind == LinkJoint::revolute) {
                out.momentum[k] = own.turning[2];
                out.force[k] = dot(own.turning, turning) + dot(own.linear, cross(u_[i], z)) + load.turning[2];
            } else {
                out.momentum[k] = own.linear[2];
                out.force[k] = dot(own.linear, turning) + load.linear[2];
            }
            if (link.parent < 0) continue;
            const std::size_t p = static_cast<std::size_t>(link.parent);
            carry(w, own, momentum_[p]), carry(w, load, wrench_[p]);
        }
    }

  private:
    std::vector<Vector3<double>> u_;  // of the links' origins, their axes
    std::vector<Pair6<double>> momentum_, acceleration_, wrench_;

    static void carry(const LinkWork<double>& w, const Pair6<double>& child, Pair6<double>& parent) {
        const Vector3<double> f = w.R * child.linear;
        parent.linear = parent.linear + f;
        parent.turning = parent.turning + (w.R * child.turning + cross(w.r, f));
    }
};

/// The discrete Lagrangian h L(m, v), m = (x_k + x_k+1)/2, v = (x_k+1 - x_k)/h, in joint coordinates, with forces by
/// the same rule (Marsden & West 2001, 2.3 and 3.2):
///   p(m, v) - (h/2) (dT/dx + Q)(m, v) = p_k,   p_k+1 = p(m, v) + (h/2) (dT/dx + Q)(m, v),   x_k+1 = x_k + h v
/// The first is solved for v by steps of (M(m) + (h/2) c + (h^2/4) k)^-1, c and k of the joints' dampers and springs:
/// one recursion each.
class VariationalTree {
  public:
    explicit VariationalTree(const Problem& problem)
        : posed_(std::shared_ptr<const MechanismModel>(problem.own, &mechanism_of(problem))) {
        const Links<double>& links = posed_->tree().links();
        n_ = static_cast<std::size_t>(links.rates);
        for (const Link<double>& link : links.links)
            damping_.push_back(link.damping), stiffness_.push_back(link.stiffness);
        y_.resize(2 * n_), mid_.resize(2 * n_), dy_.resize(2 * n_);
        restart();
    }
    void restart() {
        model_ = posed_;
        model_->initial(y_.data());
        take_momenta();
        steps_ = evaluations_ = 0;
        failed_ = false;
    }
    void enter(const Segment& segment) {
        find_rates();
        auto next = std::make_shared<MechanismModel>(*model_);
        next->enter(segment.begin, y_.data());
        model_ = std::move(next);
        take_momenta();
    }
    void step(double t, double h) {
        if (failed_) return;
        constexpr int most_iterations = 60;
        std::vector<double> v = guess_;
        for (std::size_t k = 0; k < n_; ++k) v[k] += h * acceleration_[k];
        armature_.resize(n_);
        for (std::size_t k = 0; k < n_; ++k) armature_[k] = h / 2 * damping_[k] + h * h / 4 * stiffness_[k];
        double before = std::numeric_limits<double>::infinity();
        bool solved = false;
        for (int i = 0; i < most_iterations && !solved; ++i) {
            look(h, v);
            residual_.resize(n_);
            for (std::size_t k = 0; k < n_; ++k)
                residual_[k] = forces_.momentum[k] - h / 2 * forces_.force[k] - momenta_[k];
            solver_.solve(model_->tree(), residual_, change_);
            double size = 0, whole = 0;
            for (std::size_t k = 0; k < n_; ++k) {
                v[k] -= change_[k];
                size += change_[k] * change_[k], whole += v[k] * v[k];
            }
            // until rounding keeps it from getting smaller
            constexpr double near = 1e-10;
            solved = size == 0 || (size <= near * near * whole && !(size < before / 4));
            if (!std::isfinite(size)) break;
            before = size;
        }
        failed_ = !solved, failed_at_ = t;
        if (failed_) return;
        look(h, v);
        for (std::size_t k = 0; k < n_; ++k) {
            momenta_[k] = forces_.momentum[k] + h / 2 * forces_.force[k];
            y_[k] += h * v[k];
        }
        guess_ = v;
        acceleration_.assign(dy_.begin() + static_cast<std::ptrdiff_t>(n_), dy_.end());
        ++steps_;
    }
    std::vector<Sample> sample(double t) const {
        VariationalTree here(*this);
        here.find_rates();
        std::vector<Sample> samples = model_->motion(here.y_.data());
        for (Sample& sample : samples) sample.t = t;
        return samples;
    }
    bool finite() const {
        return all_finite(std::span<const double>(y_)) && all_finite(std::span<const double>(momenta_));
    }
    long rhs_evaluations() const { return evaluations_; }
    bool failed() const { return failed_; }
    void explain(Trajectory& trajectory) const { explain_unsolved(trajectory, sample(failed_at_)); }

  private:
    std::shared_ptr<const MechanismModel> posed_, model_;
    std::size_t n_ = 0;
    std::vector<double> y_;        // x, and where they are asked for the rates
    std::vector<double> momenta_;  // p
    std::vector<double> guess_, acceleration_;
    std::vector<double> mid_, dy_, damping_, stiffness_, armature_, residual_, change_;
    DiscreteForces forces_;
    JointSweeps sweeps_;
    multibody::ArmatureSolver solver_;
    long steps_ = 0, evaluations_ = 0;
    bool failed_ = false;
    double failed_at_ = 0;  ///< s

    // forces at (x + h/2 v, v), and the matrix there
    void look(double h, const std::vector<double>& v) {
        for (std::size_t k = 0; k < n_; ++k) mid_[k] = y_[k] + h / 2 * v[k], mid_[n_ + k] = v[k];
        evaluate(mid_);
        solver_.factorize(model_->tree(), armature_);
    }
    void evaluate(const std::vector<double>& y) {
        const Tree<double>& tree = model_->tree();
        tree.derivative(y.data(), dy_.data());
        TreeWork<double>& at = tree.work<double>();
        tree.move(y.data(), at);
        sweeps_.run(tree, at, y.data(), dy_.data() + n_, forces_);
        solver_.take(tree, at);
        ++evaluations_;
    }
    // p and the first guesses from (x, x')
    void take_momenta() {
        evaluate(y_);
        momenta_ = forces_.momentum;
        guess_.assign(y_.begin() + static_cast<std::ptrdiff_t>(n_), y_.end());
        acceleration_.assign(n_, 0);
    }
    // x' = M^-1 p
    void find_rates() {
        TreeWork<double>& at = model_->tree().work<double>();
        model_->tree().move(y_.data(), at);
        solver_.take(model_->tree(), at);
        armature_.assign(n_, 0);
        solver_.factorize(model_->tree(), armature_);
        solver_.solve(model_->tree(), momenta_, change_);
        std::copy(change_.begin(), change_.end(), y_.begin() + static_cast<std::ptrdiff_t>(n_));
    }
};

std::string refused_by_variational_tree(const Problem& problem) {
    if (std::string why = multibody::needs_a_mechanism(problem); !why.empty()) return why;
    const Tree<double>& tree = mechanism_of(problem).tree();
    if (!problem.scene.loops.empty()) return "a variational integrator of trees: it closes no loops";
    for (const Link<double>& link : tree.links().links)
        if (link.kind == LinkJoint::spherical || link.kind == LinkJoint::free)
            return link.kind == LinkJoint::free
                       ? "its discrete Lagrangian is of joints of one coordinate: a free base has attitudes"
                       : "its discrete Lagrangian is of joints of one coordinate: a spherical joint has attitudes";
    return "";
}

Trajectory solve_variational_tree(const Problem& problem, const Settings& settings) {
    return march<VariationalTree>(problem, settings);
}

constexpr Method each_variational[] = {
    {.name = "variational_tree",
     .documentation =
         "A variational integrator of trees: the action is summed by the midpoint rule in joint coordinates, and its "
         "stationary points are the motion (discrete Euler and Lagrange's equations). Symplectic: without dampers and "
         "motors the energy stays within a band of the step's square over any number of steps. The equations of a step "
         "are solved to rounding by quasi-Newton steps, each of one "
         "articulated-body recursion: the cost is linear in the number of links. Rates at samples are those of the "
         "momenta, M^-1 p. Order 2.",
     .source =
         "J. E. Marsden & M. West 2001, Discrete mechanics and variational integrators, Acta Numerica 10; J. Lee, "
         "C. K. Liu, F. C. Park, S. S. Srinivasa 2016, A Linear-Time Variational Integrator for Multibody "
         "Systems, WAFR (recursions as the quasi-Newton matrix; there on SE(3))",
     .conserves = "the symplectic form, so nearly the energy; a joint's momentum where nothing turns about it; the "
                  "joints",
     .control = Control::fixed_step,
     .own_systems = true,
     .order = 2,
     .solve = solve_variational_tree,
     .family = Family::rotation_group,
     .refuses = refused_by_variational_tree},
};

}  // namespace

extern const std::span<const Method> variational_tree_methods{each_variational};

}  // namespace polhode
