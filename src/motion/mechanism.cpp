#include "motion/mechanism.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "motion/contact.h"
#include "motion/scout.h"
#include "motion/user_system.h"
#include "text/message.h"

namespace polhode {
namespace {

// limit on components times steps, so that a thousand bodies take no longer than one
constexpr long scout_work = 4'000'000, most_scout_steps = 20000, least_scout_steps = 200;

// The largest values of a run: for each kind of component, of all bodies, and the kinetic energy.
class LargestValues {
  public:
    /// The model must outlive this object.
    explicit LargestValues(const MechanismModel& model)
        : model_(model), kind_(static_cast<std::size_t>(model.dimension()), unit) {
        for (const Link<double>& link : model.tree().links().links) {
            const std::size_t x = static_cast<std::size_t>(link.coordinate), rate = static_cast<std::size_t>(link.rate);
            if (link.kind == LinkJoint::prismatic) kind_[x] = place;
            for (int k = 0; k < link.rates(); ++k)
                kind_[rate + static_cast<std::size_t>(k)] =
                    link.kind == LinkJoint::prismatic || k >= 3 ? speed : turning;
            if (link.kind == LinkJoint::free)
                for (std::size_t k = 4; k < 7; ++k) kind_[x + k] = place;
        }
    }

    void include(const std::vector<double>& y) {
        for (std::size_t i = 0; i < kind_.size(); ++i)
            if (std::isfinite(y[i])) largest_[kind_[i]] = std::max(largest_[kind_[i]], std::abs(y[i]));
        const std::vector<Sample> now = model_.motion(y.data());
        for (const Sample& body : now) {
            bodies_.angular_velocity = std::max(bodies_.angular_velocity, length(body.angular_velocity_B));
            bodies_.position = std::max(bodies_.position, length(body.position_W));
            bodies_.velocity = std::max(bodies_.velocity, length(body.velocity_W));
        }
        if (const double energy = model_.kinetic_energy(now); std::isfinite(energy))
            kinetic_energy_ = std::max(kinetic_energy_, energy);
    }

    /// The largest component of a difference, relative to the larger of `next` and the largest value of its kind.
    double change_of(const std::vector<double>& difference, const std::vector<double>& next) const {
        double worst = 0;
        for (std::size_t i = 0; i < kind_.size(); ++i) {
            const double change = std::abs(difference[i]), size = std::max(largest_[kind_[i]], std::abs(next[i]));
            if (!(change <= 0)) worst = std::max(worst, size > 0 ? change / size : 1.0);
            if (!std::isfinite(next[i])) worst = std::numeric_limits<double>::infinity();
        }
        return worst;
    }

    /// The scale of each component. A motion at rest has no scale: one radian and one metre over the duration T, s.
    std::vector<double> scales(double T) const {
        std::array<double, 4> largest = largest_;
        if (largest[turning] == 0) largest[turning] = 1 / T;
        if (largest[place] == 0) largest[place] = 1;
        if (largest[speed] == 0) largest[speed] = largest[place] / T;
        std::vector<double> result;
        for (const Kind kind : kind_) result.push_back(largest[kind]);
        return result;
    }
    /// The scales of all bodies, with the same convention for a motion at rest.
    Scales body_scales(double T) const {
        Scales bodies = bodies_;
        if (bodies.angular_velocity == 0) bodies.angular_velocity = 1 / T;
        if (bodies.position == 0) bodies.position = 1;
        if (bodies.velocity == 0) bodies.velocity = bodies.position / T;
        return bodies;
    }
    /// The largest kinetic energy, J.
    double kinetic_energy() const { return kinetic_energy_; }

  private:
    // kinds of components: angles and quaternions (scale 1), positions, angular rates, speeds
    enum Kind : std::size_t { unit, place, turning, speed };

    const MechanismModel& model_;
    std::vector<Kind> kind_;
    std::array<double, 4> largest_{1, 0, 0, 0};
    double kinetic_energy_ = 0;
    Scales bodies_{0, 0, 0};
};

}  // namespace

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
    const std::size_t n = static_cast<std::size_t>(dimension());
    LargestValues largest(*this);
    using Y = std::vector<double>;
    MechanismModel model(*this);
    Y y(n);
    model.initial(y.data());
    largest.include(y);
    // the limit is exceeded only after one more attempt
    const long most_steps = std::clamp(scout_work / static_cast<long>(n), least_scout_steps, most_scout_steps) + 1;
    long steps = 0;
    bool going = true;
    const auto rate = [&](double, const Y& at, Y& dy) { model.derivative(at.data(), dy.data()); };
    const auto change_of = [&](const Y& difference, const Y& next) { return largest.change_of(difference, next); };
    const auto on_step = [&](double, Y& at) {
        if (model.projects()) model.project(at.data());
        largest.include(at);
        return model.projects();
    };
    for (const Leg& leg : itinerary(*scene_)) {
        model.enter(leg.begin, y.data());
        largest.include(y);
        going = going && scout_leg(leg, y, steps, most_steps, rate, change_of, on_step);
    }
    const double T = scene_->duration;
    scales_ = largest.scales(T);
    body_scales_ = largest.body_scales(T);
    double most_energy = largest.kinetic_energy();
    if (most_energy == 0)
        for (std::size_t b = 0; b < masses_.size(); ++b)
            most_energy += masses_[b] * body_scales_.velocity * body_scales_.velocity / 2;
    energy_bound_ = 1e6 * most_energy;
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
