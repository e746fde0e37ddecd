// A coarse run of a model in joint coordinates, which estimates the scale of each component of its state.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "motion/itinerary.h"
#include "motion/links.h"
#include "motion/problem.h"
#include "motion/scout.h"

namespace polhode {

/// The largest values of a run: for each kind of component, of all bodies, and the kinetic energy. A state may have
/// more components than the coordinates and rates of the links; each of these is a separate kind.
template <class Model>
class LargestValues {
  public:
    /// The model must outlive this object.
    explicit LargestValues(const Model& model)
        : model_(model),
          kind_(static_cast<std::size_t>(model.tree().dimension()), unit),
          others_(static_cast<std::size_t>(model.dimension()) - kind_.size(), 0.0) {
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
        for (std::size_t i = 0; i < others_.size(); ++i)
            if (const double value = y[kind_.size() + i]; std::isfinite(value))
                others_[i] = std::max(others_[i], std::abs(value));
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
        for (const double size : others_) result.push_back(size > 0 ? size : 1);
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

    const Model& model_;
    std::vector<Kind> kind_;
    std::array<double, 4> largest_{1, 0, 0, 0};
    std::vector<double> others_;
    double kinetic_energy_ = 0;
    Scales bodies_{0, 0, 0};
};

/// Estimates of a coarse run.
struct MechanismScales {
    std::vector<double> scales;  ///< scale of each component of the state
    Scales bodies;               ///< motions of all bodies
    double energy_bound = 0;     ///< 10^6 times the largest kinetic energy, J
};

/// Runs a model over a scene. The model is entered at each event.
template <class Model>
MechanismScales scout_mechanism(const Model& from, const Scene& scene) {
    // limit on components times steps, so that a thousand bodies take no longer than one
    constexpr long scout_work = 4'000'000, most_scout_steps = 20000, least_scout_steps = 200;
    const std::size_t n = static_cast<std::size_t>(from.dimension());
    LargestValues<Model> largest(from);
    using Y = std::vector<double>;
    Model model(from);
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
        if constexpr (requires { model.refresh(at.data()); }) model.refresh(at.data());
        largest.include(at);
        return model.projects();
    };
    for (const Leg& leg : itinerary(scene)) {
        model.enter(leg.begin, y.data());
        largest.include(y);
        going = going && scout_leg(leg, y, steps, most_steps, rate, change_of, on_step);
    }
    MechanismScales result{largest.scales(scene.duration), largest.body_scales(scene.duration), 0};
    double most_energy = largest.kinetic_energy();
    if (most_energy == 0)
        for (const LinkBody<double>& body : from.tree().links().bodies)
            most_energy += body.mass * result.bodies.velocity * result.bodies.velocity / 2;
    result.energy_bound = 1e6 * most_energy;
    return result;
}

}  // namespace polhode
