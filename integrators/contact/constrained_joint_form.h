// A mechanism with limits and friction of joints in maximal coordinates and in binary64, for methods that solve the
// differential-algebraic equations of each mode (IDA).
//
// The joints that are held and those with prescribed motions are rows of constraints; friction of a moving joint is a
// constant force on its coordinate. ConstrainedMode has the equations of one mode. The state of the bodies drifts from
// the constraints by the errors of the steps, so that it is projected onto them at the start of each mode, and joints
// that come to rest are stopped by impulses.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "integrators/contact/joint_maximal_form.h"
#include "integrators/maximal/constrained.h"
#include "integrators/series/linear_algebra.h"

namespace polhode::contact {

/// The equations of a mode from a given state on, and the values that locked joints must have.
class ConstrainedMode {
  public:
    using System = maximal::System<double>;
    using Equations = maximal::ConstrainedEquations<double>;

    /// `system`: with rows for the joints that are held, then for those with prescribed motions, whose number is
    /// `prescribed.size()`. `begin`: time at the start of the mode, s.
    ConstrainedMode(std::unique_ptr<System> system, maximal::Index index, PrescribedMotions<double> prescribed,
                    double begin)
        : system_(std::move(system)), equations_(*system_, index), prescribed_(std::move(prescribed)), begin_(begin) {}

    const System& system() const { return *system_; }
    Equations& equations() { return equations_; }
    /// Locks the joints that are held at their coordinates in z.
    void hold(const std::vector<int>& joints, const double* z) {
        std::vector<maximal::CoordinateTarget<double>>& targets = equations_.targets();
        const std::size_t first = targets.size() - prescribed_.size() - joints.size();
        for (std::size_t k = 0; k < joints.size(); ++k)
            targets[first + k].value = equations_.coordinate(static_cast<std::size_t>(joints[k]), z);
    }
    /// Sets the time of formulas and the values of prescribed coordinates at s after the start of the mode.
    void set_time(double s) {
        const double t = begin_ + s;
        equations_.set_time(t);
        if (prescribed_.size() == 0) return;
        const auto states = prescribed_.states(t);
        const std::vector<double> accelerations = prescribed_.accelerations<double>(t, nullptr);
        std::vector<maximal::CoordinateTarget<double>>& targets = equations_.targets();
        for (std::size_t k = 0; k < states.size(); ++k)
            targets[targets.size() - states.size() + k] = {states[k].coordinate, states[k].rate, accelerations[k]};
    }

  private:
    std::unique_ptr<System> system_;  // not moved: the equations refer to it
    Equations equations_;
    PrescribedMotions<double> prescribed_;
    double begin_;
};

class ConstrainedJointForm : public JointMaximalForm<double> {
    using Base = JointMaximalForm<double>;

  public:
    /// As JointMaximalForm. `scales`: of the motion.
    ConstrainedJointForm(const Scene& scene, const Scales& scales, Motions start,
                         std::vector<std::array<double, 2>> coordinates)
        : Base(scene, std::move(start), std::move(coordinates), joints_in_state(scene)), scales_(scales) {
        constexpr int points = 200;
        for (int i = 0; prescribed().size() > 0 && i <= points; ++i) {
            const auto states = prescribed().states(scene.duration * i / points);
            for (std::size_t k = 0; k < states.size(); ++k) {
                const bool slides = scene.joints[prescribed().joint(k)].type == JointType::prismatic;
                double& largest = slides ? scales_.velocity : scales_.angular_velocity;
                largest = std::max(largest, std::abs(states[k].rate));
            }
        }
        // the scene's estimates do not include the motion that prescribed ones cause
        if (prescribed().size() > 0 && scales_.position > 0)
            scales_.angular_velocity = std::max(scales_.angular_velocity, scales_.velocity / scales_.position);
    }

    /// The scales of the motion, at least the largest rates of prescribed motions.
    const Scales& scales() const { return scales_; }
    void enter(double begin, double* y) {
        stopped_.clear(), equations_.reset();
        Base::enter(begin, y);
    }
    void select(const std::vector<double>& forces, const std::vector<std::size_t>& held) {
        stopped_.clear();
        Base::select(forces, held);
        forces_ = forces, held_joints_.clear();
        for (const std::size_t e : held) held_joints_.push_back(static_cast<int>(joints()[e].joint));
        equations_.emplace(mode_system(), maximal::Index::two);
    }

    int dimension() const { return rate_function(joints().size()); }
    /// Index of the integral of the rate of a joint's coordinate.
    int rate_function(std::size_t e) const { return Base::dimension() + static_cast<int>(e); }
    template <class S>
    void derivative(const S* y, S* dy) const {
        Base::derivative(y, dy);
        for (std::size_t e = 0; e < joints().size(); ++e) dy[rate_function(e)] = dy[coordinate(e)];
    }

    /// Stops a joint that is at rest up to the errors of the steps, by impulses on all joints that have been stopped
    /// since the last mode was selected.
    void stop(std::size_t e, double* y) {
        if (std::ranges::find(stopped_, e) == stopped_.end()) stopped_.push_back(e);
        const Eigen::Index n = static_cast<Eigen::Index>(stopped_.size());
        const std::vector<double> matrix = response(stopped_, y), all = rates(y);
        Eigen::VectorXd rest(n);
        for (Eigen::Index i = 0; i < n; ++i) rest[i] = -all[stopped_[static_cast<std::size_t>(i)]];
        // joints that depend on each other in a loop have a singular matrix
        using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const Eigen::VectorXd impulses =
            Eigen::Map<const Matrix>(matrix.data(), n, n).completeOrthogonalDecomposition().solve(rest);
        if (!impulses.allFinite()) return;
        for (Eigen::Index i = 0; i < n; ++i) push(stopped_[static_cast<std::size_t>(i)], impulses[i], y);
    }
    /// Moves y onto the constraints. Joints that are held have no velocity then.
    void project(double* y) {
        if (!equations_) return;
        const PrescribedMotions<double>& motions = prescribed();
        std::vector<maximal::CoordinateTarget<double>>& targets = equations_->targets();
        std::vector<int> locked = held_joints_;
        for (std::size_t k = 0; k < locked.size(); ++k)
            targets[targets.size() - motions.size() - locked.size() + k].value =
                equations_->coordinate(static_cast<std::size_t>(locked[k]), y);
        if (motions.size() > 0) {
            const auto states = motions.states(y[time()]);
            for (std::size_t k = 0; k < states.size(); ++k)
                targets[targets.size() - states.size() + k] = {states[k].coordinate, states[k].rate, 0};
        }
        equations_->project(y);
        read_coordinates(*equations_, y, y);
    }
    /// Writes the coordinates of the joints with events, from the positions of the bodies in z.
    template <class Equations>
    void read_coordinates(const Equations& equations, const double* z, double* y) const {
        for (std::size_t e = 0; e < joints().size(); ++e) y[coordinate(e)] = equations.coordinate(joints()[e].joint, z);
    }
    /// Number of components of the state that belong to the bodies and come first.
    int bodies_dimension() const { return free_system().dimension(); }
    /// Sets the time in a state.
    void set_time(double s, const double* start, double* y) const {
        if (has_time()) y[time()] = start[time()] + s;
    }

    /// The equations of the selected mode from the state y on.
    ConstrainedMode mode(maximal::Index index, const double* y) const {
        std::vector<int> locked = held_joints_;
        for (std::size_t k = 0; k < prescribed().size(); ++k) locked.push_back(static_cast<int>(prescribed().joint(k)));
        const maximal::Mechanism<double>& mechanism = free_system().mechanism();
        std::vector<std::array<double, 2>> coordinates(scene().joints.size(), {0, 0});
        for (std::size_t j = 0; j < coordinates.size(); ++j)
            for (int i = 0; mechanism.links[j].angles >= 0 && i < mechanism.links[j].coordinates(); ++i)
                coordinates[j][static_cast<std::size_t>(i)] = y[free_system().angles() + mechanism.links[j].angles + i];
        auto system =
            std::make_unique<maximal::System<double>>(scene(), free_system().motions(y), coordinates,
                                                      maximal::LoopRows::independent, locked, joints_in_state(scene()));
        system->select_loads(mode_begin());
        for (std::size_t e = 0; e < joints().size(); ++e) system->add_motor(joints()[e].joint, forces_[e]);
        ConstrainedMode result(std::move(system), index, prescribed(), has_time() ? y[time()] : 0);
        if (formulas()) result.equations().set_formulas(*formulas(), formula_variables(y));
        result.hold(held_joints_, y);
        result.set_time(0);
        return result;
    }

  private:
    Scales scales_;
    std::vector<double> forces_;  // selected mode: friction, by event joint
    std::vector<int> held_joints_;
    std::vector<std::size_t> stopped_;                                // event joints
    std::optional<maximal::ConstrainedEquations<double>> equations_;  // selected mode

    // Joints with events, coupled ones and those with prescribed motions.
    static std::vector<int> joints_in_state(const Scene& scene) {
        std::vector<int> some;
        for (const EventJoint<double>& one : event_joints<double>(scene)) some.push_back(static_cast<int>(one.joint));
        for (std::size_t j = 0; j < scene.joints.size(); ++j)
            if (!scene.joints[j].motion.empty()) some.push_back(static_cast<int>(j));
        return maximal::joints_to_count(scene, maximal::Index::two, some);
    }
};

}  // namespace polhode::contact
