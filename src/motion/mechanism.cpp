#include "motion/mechanism.h"

#include <fmt/format.h>

#include <utility>

#include "motion/contact.h"
#include "motion/mechanism_scout.h"
#include "motion/user_system.h"
#include "text/message.h"

namespace polhode {

std::vector<Sample> samples_of_bodies(double t, const std::vector<BodyMotion<double>>& motions) {
    std::vector<Sample> samples;
    for (const BodyMotion<double>& m : motions) samples.emplace_back(t, m);
    return samples;
}

std::string body_without_inertia(const Scene& scene) {
    for (const NamedBody& body : scene.bodies) {
        const std::string name = one_line(body.name, 60);
        if (body.body.mass == 0) return fmt::format("body \"{}\" has no mass, and the method divides by it", name);
        if (!has_three_moments(body.body.inertia_B))
            return fmt::format("body \"{}\" has a moment of inertia of zero, and the method divides by it", name);
    }
    return "";
}

std::vector<BodyMotion<double>> mechanism_initial_motions(const Scene& scene) {
    const Tree<Wide> tree(scene, bodies_mass_properties<Wide>(scene));
    std::vector<Wide> y(static_cast<std::size_t>(tree.dimension()));
    tree.initial(y.data());
    std::vector<BodyMotion<double>> all;
    for (const BodyMotion<Wide>& m : tree.motions(y.data())) all.push_back(cast<double>(m));
    return all;
}

MechanismModel::MechanismModel(std::shared_ptr<const Scene> scene)
    : scene_(std::move(scene)),
      exact_(std::make_shared<const Tree<Wide>>(*scene_, bodies_mass_properties<Wide>(*scene_))),
      tree_(*exact_) {
    for (const LinkBody<double>& body : tree_.links().bodies)
        masses_.push_back(body.mass), inertias_.push_back(body.inertia_B);
    scout();
}

std::vector<Sample> MechanismModel::motion(const double* y) const { return samples_of_bodies(0, tree_.motions(y)); }

void MechanismModel::enter(double t, double* y) {
    tree_.convert_loads(exact_->loads_at(*scene_, t));
    tree_.apply_impulses(*scene_, t, y);
}

double MechanismModel::kinetic_energy(const Bodies& bodies) const {
    double energy = 0;
    for (std::size_t b = 0; b < bodies.size() && b < masses_.size(); ++b) {
        const Sample& sample = bodies[b];
        const Vector3<double>& w = sample.angular_velocity_B;
        energy += dot(w, inertias_[b] * w) / 2 + masses_[b] * dot(sample.velocity_W, sample.velocity_W) / 2;
    }
    return energy;
}

// Estimates the scale of each component: the largest value of its kind in a coarse run.
void MechanismModel::scout() {
    const MechanismScales found = scout_mechanism(*this, *scene_);
    scales_ = found.scales, body_scales_ = found.bodies, energy_bound_ = found.energy_bound;
}

Problem pose_mechanism(const Scene& scene) {
    Problem problem;
    problem.scene = scene;
    const auto model =
        std::make_shared<const Erased<MechanismModel>>(MechanismModel(std::make_shared<const Scene>(scene)));
    problem.needs.system = SystemKind::mechanism, problem.needs.dimension = model->dimension();
    for (const Leg& leg : itinerary(scene)) {
        Segment segment;
        static_cast<Leg&>(segment) = leg;
        problem.segments.push_back(std::move(segment));
    }
    problem.needs.time_dependent = problem.segments.size() > 1;
    problem.body.geometry = std::make_shared<const ContactGeometry<double>>();
    problem.scales = model->model().body_scales();
    problem.system = MechanismSystem{model};
    return problem;
}

const MechanismModel& mechanism_of(const Problem& problem) {
    return static_cast<const Erased<MechanismModel>&>(*std::get<MechanismSystem>(problem.system).model).model();
}

}  // namespace polhode
