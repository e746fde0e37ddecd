#include "motion/formula_mechanism.h"

#include <utility>

#include "motion/contact.h"
#include "motion/mechanism.h"
#include "motion/mechanism_scout.h"

namespace polhode {

FormulaMechanismModel::FormulaMechanismModel(const std::shared_ptr<const Scene>& scene)
    : FormulaModelBase(scene, FormulaTree<Wide>(*scene, compile_formulas(*scene, scene->name),
                                                bodies_mass_properties<Wide>(*scene))) {
    FormulaMechanismModel model(*this);
    std::vector<double> y(static_cast<std::size_t>(dimension()));
    initial(y.data());
    for (const Leg& leg : itinerary(*scene_)) {
        model.enter(leg.begin, y.data());
        has_switches_ = has_switches_ || model.form_.terms().has_switches();
    }
    MechanismScales found = scout_mechanism(*this, *scene_);
    scales_ = std::move(found.scales), body_scales_ = found.bodies, energy_bound_ = found.energy_bound;
}

template <class S>
void FormulaMechanismModel::derivative(const S* y, S* dy) const {
    form_.derivative(y, dy);
}
template void FormulaMechanismModel::derivative(const double*, double*) const;
template void FormulaMechanismModel::derivative(const Dual<jacobian_directions>*, Dual<jacobian_directions>*) const;
template void FormulaMechanismModel::derivative(const Traced<double>*, Traced<double>*) const;
template void FormulaMechanismModel::derivative(const Traced<long double>*, Traced<long double>*) const;

template <class S>
void FormulaMechanismModel::derivative_by_signs(const S* y, S* dy) const {
    form_.derivative_by(y, dy, true);
}
template void FormulaMechanismModel::derivative_by_signs(const double*, double*) const;
template void FormulaMechanismModel::derivative_by_signs(const Dual<jacobian_directions>*,
                                                         Dual<jacobian_directions>*) const;

std::vector<Sample> FormulaMechanismModel::motion(const double* y) const {
    return samples_of_bodies(0, tree().motions(y));
}

double FormulaMechanismModel::kinetic_energy(const Bodies& bodies) const {
    const std::vector<LinkBody<double>>& all = tree().links().bodies;
    double energy = 0;
    for (std::size_t b = 0; b < bodies.size() && b < all.size(); ++b) {
        const Vector3<double>&w = bodies[b].angular_velocity_B, &v = bodies[b].velocity_W;
        energy += dot(w, all[b].inertia_B * w) / 2 + all[b].mass * dot(v, v) / 2;
    }
    return energy;
}

Problem pose_formula_mechanism(const Scene& scene) {
    Problem problem;
    problem.scene = scene;
    const auto model = std::make_shared<const Erased<FormulaMechanismModel>>(
        FormulaMechanismModel(std::make_shared<const Scene>(scene)));
    problem.needs.system = SystemKind::mechanism_with_formulas;
    problem.needs.dimension = model->dimension();
    for (const Leg& leg : itinerary(scene)) {
        Segment segment;
        static_cast<Leg&>(segment) = leg;
        problem.segments.push_back(std::move(segment));
    }
    problem.needs.time_dependent = true;
    problem.body.geometry = std::make_shared<const ContactGeometry<double>>();
    problem.scales = model->model().body_scales();
    problem.system = UserSystem{model};
    return problem;
}

const FormulaMechanismModel& formula_mechanism_of(const Problem& problem) {
    return static_cast<const Erased<FormulaMechanismModel>&>(*std::get<UserSystem>(problem.system).model).model();
}

const Tree<double>& tree_of(const Problem& problem) {
    return std::holds_alternative<MechanismSystem>(problem.system) ? mechanism_of(problem).tree()
                                                                   : formula_mechanism_of(problem).tree();
}

std::vector<double> tree_scales(const Problem& problem) {
    return std::holds_alternative<MechanismSystem>(problem.system) ? mechanism_of(problem).scales()
                                                                   : formula_mechanism_of(problem).scales();
}

}  // namespace polhode
