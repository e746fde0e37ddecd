// A scene of several bodies as a system for all methods that accept user-defined systems. The state consists of joint
// coordinates and their rates.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "motion/mechanism_motion.h"
#include "motion/problem.h"
#include "motion/tree.h"

namespace polhode {

/// A mechanism as a model (motion/user_system.h): its equations in binary64, each constant rounded once from 113 bits.
class MechanismModel {
  public:
    /// From a valid scene of several bodies. Throws InputError if its loops do not close at the start, or if its mass
    /// matrix is singular there.
    explicit MechanismModel(std::shared_ptr<const Scene> scene);

    const Scene& scene() const { return *scene_; }
    const Tree<double>& tree() const { return tree_; }

    int dimension() const { return tree_.dimension(); }
    void initial(double* y) const { tree_.initial(y); }
    template <class S>
    void derivative(const S* y, S* dy) const {
        tree_.derivative(y, dy);
    }
    std::vector<double> scales() const { return scales_; }
    std::vector<Sample> motion(const double* y) const;
    std::vector<Reaction<double>> reactions(const double* y) const { return tree_.reactions(*scene_, y); }
    void enter(double t, double* y);
    /// Projects y back onto the loop constraints.
    bool projects() const { return tree_.has_loops(); }
    void project(double* y) const { tree_.project(y); }
    /// Kinetic energy of all bodies, J.
    double kinetic_energy(const Bodies& bodies) const;
    /// 10^6 times the largest kinetic energy of a coarse run, J.
    double energy_bound() const { return energy_bound_; }
    /// Estimates of the largest |w|, |p| and |v| of any body.
    const Scales& body_scales() const { return body_scales_; }

  private:
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const Tree<Wide>> exact_;
    Tree<double> tree_;
    std::vector<double> scales_;
    std::vector<double> masses_;
    std::vector<Matrix3<double>> inertias_;
    double energy_bound_ = 0;
    Scales body_scales_;

    void scout();
};

/// Poses a scene of several bodies. `problem.system` is a MechanismSystem.
Problem pose_mechanism(const Scene& scene);

/// The model of a problem with several bodies.
const MechanismModel& mechanism_of(const Problem& problem);

/// Why a method that needs the inverse mass and inertia of each body cannot solve a scene: names a body without mass,
/// or with a principal moment below 1e-12 of their sum. Empty if all bodies have both. Includes bodies that fixed
/// joints attach to the world.
std::string body_without_inertia(const Scene& scene);

/// The motion of every body at t = 0 before any impulse: the exact motion, rounded once.
std::vector<BodyMotion<double>> mechanism_initial_motions(const Scene& scene);

/// One sample per body.
std::vector<Sample> samples_of_bodies(double t, const std::vector<BodyMotion<double>>& motions);

}  // namespace polhode
