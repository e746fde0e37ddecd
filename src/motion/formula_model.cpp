#include "motion/formula_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "motion/formula_potential.h"
#include "motion/itinerary.h"
#include "motion/scout.h"
#include "motion/user_system.h"

namespace polhode {
namespace {

template <class P>
FormulaBody<P> exact_formula_body(const Scene& scene) {
    return {scene, compile_formulas(scene, scene.name), exact_body<P>(scene), mass_properties<P>(scene.body).inertia};
}

constexpr long formula_scout_steps = 20000;

}  // namespace

FormulaModel::FormulaModel(const std::shared_ptr<const Scene>& scene)
    : FormulaModelBase(scene, exact_formula_body<Wide>(*scene)) {
    scout();
}

std::vector<Sample> FormulaModel::motion(const double* y) const {
    Sample sample;
    sample.q = FormulaBody<double>::attitude(y);
    sample.angular_velocity_B = FormulaBody<double>::angular_velocity(y);
    form_.center(y, sample.position_W, sample.velocity_W);
    return {sample};
}

double FormulaModel::kinetic_energy(const Bodies& bodies) const {
    const Sample& sample = bodies[0];
    const ExactBody<double>& b = form_.body();
    const Vector3<double>& w = sample.angular_velocity_B;
    double energy = dot(w, b.inertia_B * w) / 2;
    if (!b.pivoted) energy += b.mass * dot(sample.velocity_W, sample.velocity_W) / 2;
    return energy;
}

// Estimates the scale of each component: the largest value of its kind in a coarse run.
void FormulaModel::scout() {
    using Y = std::vector<double>;
    const std::size_t n = static_cast<std::size_t>(dimension());
    Scales largest{0, 0, 0};
    double most_energy = 0;
    Y y(n), sizes(n, 0.0);
    FormulaModel model(*this);
    const auto include = [&](const Y& at) {
        const std::vector<Sample> now = model.motion(at.data());
        const auto raise = [](double& scale, double value) {
            if (std::isfinite(value)) scale = std::max(scale, value);
        };
        raise(largest.angular_velocity, length(now[0].angular_velocity_B));
        raise(largest.position, length(now[0].position_W));
        raise(largest.velocity, length(now[0].velocity_W));
        raise(most_energy, model.kinetic_energy(now));
        for (std::size_t i = 0; i < n; ++i) raise(sizes[i], std::abs(at[i]));
    };
    const auto scale_of = [&](std::size_t i) {
        const std::size_t time = static_cast<std::size_t>(form_.time_index());
        if (i < 3) return largest.angular_velocity;
        if (i < 7) return 1.0;
        if (i == time) return scene_->duration;
        if (i > time) return sizes[i];
        return i < 10 ? largest.position : largest.velocity;
    };
    const auto change_of = [&](const Y& difference, const Y& next) {
        double worst = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double change = std::abs(difference[i]), size = std::max(scale_of(i), std::abs(next[i]));
            if (!(change <= 0)) worst = std::max(worst, size > 0 ? change / size : 1.0);
            if (!std::isfinite(next[i])) worst = HUGE_VAL;
        }
        return worst;
    };
    const auto on_step = [&](double, Y& at) {
        model.refresh(at.data());
        include(at);
        return false;
    };
    const auto rate = [&](double, const Y& at, Y& dy) { model.derivative(at.data(), dy.data()); };
    model.initial(y.data());
    long steps = 0;
    bool going = true;
    for (const Leg& leg : itinerary(*scene_)) {
        model.enter(leg.begin, y.data());
        has_switches_ = has_switches_ || model.form_.terms().has_switches();
        include(y);
        going = going && scout_leg(leg, y, steps, formula_scout_steps, rate, change_of, on_step);
    }
    if (largest.angular_velocity == 0) largest.angular_velocity = 1 / scene_->duration;
    if (largest.position == 0) largest.position = 1;
    if (largest.velocity == 0) largest.velocity = largest.position / scene_->duration;
    for (std::size_t i = 0; i < n; ++i) scales_.push_back(scale_of(i) > 0 ? scale_of(i) : 1);
    body_scales_ = largest;
    const ExactBody<double>& b = form_.body();
    if (most_energy == 0)
        for (int i = 0; i < 3; ++i)
            most_energy += b.inertia_B[i][i] * largest.angular_velocity * largest.angular_velocity / 2;
    energy_bound_ = 1e6 * most_energy;
}

void pose_formula_loads(Problem& problem) {
    const auto model =
        std::make_shared<const Erased<FormulaModel>>(FormulaModel(std::make_shared<const Scene>(problem.scene)));
    const FormulaModel& formulas = model->model();
    Needs& needs = problem.needs;
    needs.system = SystemKind::body_with_formulas, needs.dimension = formulas.dimension();
    needs.translation = problem.body.pivoted ? Translation::fixed : Translation::integrated;
    needs.torque_free = false;
    needs.time_dependent = true;
    needs.omitted.clear();
    if (problem.body.pivoted) needs.omitted.push_back({"p and v", "the pivot is fixed: q and w determine both"});
    problem.scales = formulas.body_scales();
    problem.system = UserSystem{model};
}

const FormulaModel& formula_model_of(const Problem& problem) {
    return static_cast<const Erased<FormulaModel>&>(*std::get<UserSystem>(problem.system).model).model();
}

bool has_switches(const Problem& problem) {
    if (problem.needs.system == SystemKind::mechanism_with_formulas)
        return formula_mechanism_of(problem).has_switches();
    return problem.needs.system == SystemKind::body_with_formulas && formula_model_of(problem).has_switches();
}

bool has_variable_roots(const Problem& problem) {
    if (!has_formula_loads(problem.scene)) return false;
    FormulaSystem system(problem);
    std::vector<double> y(static_cast<std::size_t>(system.size()));
    system.initial(y.data());
    return std::ranges::any_of(problem.segments, [&](const Segment& segment) {
        return system.enter(segment, y.data()) && system.has_roots();
    });
}

template double formula_potential(const Scene&, double, const Quaternion<double>&, const Vector3<double>&);
template double formula_potential_of_bodies(const Scene&, double, std::span<const BodyMotion<double>>);
template Wide formula_potential_of_bodies(const Scene&, double, std::span<const BodyMotion<Wide>>);
template Wide formula_potential(const Scene&, double, const Quaternion<Wide>&, const Vector3<Wide>&);

void FormulaSystem::scales(double* scales) const {
    const std::vector<double> s = std::visit([](const auto& model) { return model.scales(); }, model_);
    std::copy(s.begin(), s.end(), scales);
}

std::vector<double> SwitchedSystem::switch_values(const double* y) const {
    std::vector<double> refreshed(y, y + size()), all;
    std::visit([&](const auto& model) { model.refresh(refreshed.data()); }, model_);
    for (const SwitchOf<double>& point : switching_points()) {
        const double distance = refreshed[static_cast<std::size_t>(point.component)] - point.threshold;
        const double rounding = 1e-12 * std::max(1.0, std::abs(point.threshold));
        all.push_back(point.sign == 0 ? rounding - std::abs(distance) : point.sign * distance);
    }
    return all;
}

}  // namespace polhode
