// Numbers of a scene and of its truth in 50 digits, for the formulas of closed_forms_contact.cpp and
// closed_forms_joints.cpp.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "body/mass_properties.h"
#include "experiment/kinds/closed_forms.h"
#include "integrators/series/real.h"

namespace polhode::closed_forms {

/// 50 digits.
using Exact = Real<50>;

/// The motion of a body at a sample.
struct ExactMotion {
    Quaternion<Exact> q;                ///< body to world
    Vector3<Exact> angular_velocity_W;  ///< rad/s
    Vector3<Exact> position_W;          ///< centre of mass, m
    Vector3<Exact> velocity_W;          ///< m/s
};

/// Collects the comparisons of one scene.
class Comparison {
  public:
    Comparison(const Scene& scene, const truth::Truth& truth, std::string source);

    const Scene& scene;

    /// Adds a quantity. The difference is relative to max(|expected|, scale).
    void add(const std::string& quantity, const std::string& form, const Exact& expected,
             const std::optional<Exact>& computed, const Exact& scale = 0);
    /// Adds a first integral: its values at the first and the last sample. The difference is relative to
    /// max(|first|, scale).
    void add_constant(const std::string& quantity, const Exact& first, const Exact& last, const Exact& scale = 0);

    /// The motion at a sample, at the first and at the last sample.
    ExactMotion at(std::size_t sample, std::size_t body = 0) const;
    ExactMotion first(std::size_t body = 0) const { return at(0, body); }
    ExactMotion last(std::size_t body = 0) const { return at(last_sample(), body); }
    /// The index of the last sample.
    std::size_t last_sample() const { return truth_.decimals.size() / bodies() - 1; }
    /// The index of the last sample before the time t > 0.
    std::size_t last_sample_before(const Exact& t) const;
    /// The time of a sample, s.
    Exact time(std::size_t sample) const { return truth_.reference.samples.at(sample * bodies()).t; }
    /// The time of the event of this name with index n, counted from 0, s.
    std::optional<Exact> event(std::string_view name, std::size_t n = 0) const;
    /// The event of this name with index n; null if there is none.
    const DecimalContactEvent* find_event(std::string_view name, std::size_t n = 0) const;
    /// All events, by time.
    const std::vector<DecimalContactEvent>& events() const;
    /// The number of events of this name.
    std::size_t count(std::string_view name) const;

    Exact duration() const { return scene.duration; }
    /// Acceleration by the scene's first load, m/s^2.
    Vector3<Exact> gravity() const;
    const MassProperties<Exact>& body(std::size_t b = 0) const { return bodies_.at(b); }
    std::size_t bodies() const { return bodies_.size(); }
    /// The radius of the body's first piece: of a sphere, a capsule or a spherical tip, m.
    Exact radius(std::size_t b = 0) const;
    /// Kinetic energy plus potential energy of the first load at a sample, J.
    Exact energy(std::size_t sample) const;
    /// Sum of p x v m and of I w about the world's origin, world axes.
    Vector3<Exact> angular_momentum_W(const ExactMotion& motion, std::size_t b = 0) const;

    std::vector<FormComparison> take() { return std::move(all_); }

  private:
    const truth::Truth& truth_;
    std::string source_;
    std::vector<MassProperties<Exact>> bodies_;
    std::vector<FormComparison> all_;
};

/// The closed forms of one scene.
struct SceneForms {
    std::string_view scene;        ///< name
    std::string_view source;       ///< author and year
    void (*compare)(Comparison&);  ///< adds the comparisons
};
std::span<const SceneForms> contact_forms();
std::span<const SceneForms> joint_forms();

/// pi in 50 digits.
inline Exact pi() { return acos(Exact(-1)); }
/// The rotation angle of a body that rotates about its axis y, in (-pi, pi].
inline Exact angle_about_y(const ExactMotion& motion) { return 2 * atan2(motion.q.y, motion.q.w); }

}  // namespace polhode::closed_forms
