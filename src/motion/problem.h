// A scene prepared for solving: its needs, its posed system, and its segments between events.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "motion/body_equations.h"
#include "motion/equations.h"
#include "motion/exact_body.h"
#include "motion/itinerary.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

template <class S>
class ContactGeometry;

/// Which variables are integrated.
enum class Formulation {
    reduced,         ///< only what the scene needs
    full_principal,  ///< all 13 variables, in the principal frame
    full,            ///< all 13 variables, with the tensor as given in body axes
};

/// The name of a formulation: "reduced", "full in the principal frame" or "full as written".
const char* name_of(Formulation formulation);

/// The systems of motion/systems.h, and those with a user-defined or mechanism model.
enum class SystemKind {
    principal_axis_rotation,
    free_rotation,
    loaded_rotation,
    loaded_motion,
    full_motion,
    user_defined,
    mechanism,
    body_with_formulas,      ///< one body whose loads are formulas
    mechanism_with_formulas  ///< several bodies whose loads are formulas
};
/// How many principal moments of a body are equal.
enum class Symmetry {
    spherical,   ///< all three are equal
    symmetric,   ///< two are equal
    asymmetric,  ///< all differ
};
/// How the translation of the centre of mass is computed.
enum class Translation {
    fixed,        ///< a pivot, or a centre of mass that never moves
    closed_form,  ///< constant acceleration and linear drag, piecewise
    integrated,   ///< integrated by the method together with the rotation
};

/// A variable or term that is omitted, and why.
struct Omission {
    std::string what;  ///< "p and v", ..
    std::string why;   ///< in a few words
};
/// The former name of Omission.
using LeftOut [[deprecated("renamed to Omission")]] = Omission;

/// The properties of a scene that determine its system.
struct Needs {
    SystemKind system = SystemKind::full_motion;        ///< the system as which it is posed
    int dimension = 13;                                 ///< size of the state
    Symmetry symmetry = Symmetry::asymmetric;           ///< symmetry of the body
    Translation translation = Translation::integrated;  ///< translation of the centre of mass
    bool torque_free = false;                           ///< no torque at any time (impulses excepted)
    bool time_dependent = false;                        ///< events inside the duration, or a user-defined torque
    bool user_torque = false;                           ///< a user-defined torque acts
    std::vector<Omission> omitted;                      ///< omitted variables and terms, with reasons
};

/// A leg of the run with the loads that act on it.
struct Segment : Leg {
    std::vector<PosedImpulse<double>> impulses;  ///< applied at `begin`
    Forcing<double> forcing;                     ///< in posed axes
    AxisEquations<double> about_axis;            ///< for principal_axis_rotation
    Vector3<double> position_W;                  ///< closed-form translation: centre of mass at `begin`, m
    Vector3<double> velocity_W;  ///< closed-form translation: its velocity at `begin` after impulses, m/s
};

/// Estimates of the largest |w|, |p| and |v| (SI) over the run, by which absolute tolerances are multiplied.
struct Scales {
    double angular_velocity = 1;  ///< rad/s
    double position = 1;          ///< m
    double velocity = 1;          ///< m/s
};

class ErasedModel;

/// The body of a posed scene, with the quantities that its equations need in posed axes.
struct PosedBody : ExactBody<double> {
    PrincipalFrame principal;  ///< principal frame of the tensor about the pivot or the centre of mass
    Quaternion<double> q_BP;   ///< posed axes to body axes: principal.q_BP, or 1 if the tensor is used as given
    PrincipalInertia<double> principal_inertia;  ///< posed axes, if these are principal axes
    FullInertia<double> full_inertia;            ///< body axes
    Vector3<double> axis;                        ///< posed axes, unit: the axis of a principal_axis_rotation
    Vector3<double> initial_angular_velocity;    ///< posed axes, rad/s
    Quaternion<double> initial_q;                ///< posed axes to world
    /// The scene's planes and the body's hull in posed axes (motion/contact.h); never null.
    std::shared_ptr<const ContactGeometry<double>> geometry;

    WidePrincipalFrame wide_principal;            ///< `principal` before rounding
    Vector3<Wide> wide_initial_angular_velocity;  ///< in the axes of wide_principal, rad/s
};

/// The equations of one body (motion/systems.h), selected by `Needs::system`.
struct OneBody {};
/// A user-defined system, without a body or a scene.
struct UserSystem {
    std::shared_ptr<const ErasedModel> model;  ///< never null
};
/// A scene of several bodies in joint coordinates (mechanism_of()).
struct MechanismSystem {
    std::shared_ptr<const ErasedModel> model;  ///< never null
};

/// A posed scene, the input of every method.
struct Problem {
    Scene scene;                                     ///< as posed
    Formulation formulation = Formulation::reduced;  ///< the formulation in which it was posed
    Needs needs;                                     ///< the properties that determine its system
    std::vector<Segment> segments;                   ///< the legs between events, with their loads
    Scales scales;                                   ///< estimated size of the motion
    bool reactions = false;                          ///< whether samples of several bodies include joint reactions

    PosedBody body;  ///< data of the system of one body, rounded once from 128 bits
    /// The kind of system, with its model if it is not one body's.
    std::variant<OneBody, UserSystem, MechanismSystem> system;

    /// The model of a user-defined system or of several bodies; null for one body.
    std::shared_ptr<const ErasedModel> model() const {
        if (const auto* user = std::get_if<UserSystem>(&system)) return user->model;
        if (const auto* several = std::get_if<MechanismSystem>(&system)) return several->model;
        return nullptr;
    }
};

/// Poses a valid scene (see validate) in a formulation. The run has the scene's duration. Throws InputError if the
/// equations would ignore a part of the scene: for several bodies a UserTorque, `pivot`, `planes`, `body` or
/// `initial`; for one body joints, loops, motors, point springs or loads of a named body.
Problem pose(const Scene& scene, Formulation formulation = Formulation::reduced);

/// The index of the segment at time t (s): the last one whose begin <= t.
std::size_t segment_at(const Problem& problem, double t);

/// The centre of mass at a time `after` (s) the start of the segment, if its motion has a closed form.
void translated(const Segment& segment, double after, Vector3<double>& position_W, Vector3<double>& velocity_W);

/// The name of a system for readers: "loaded rotation".
const char* name_of(SystemKind system);

/// An upper bound of the kinetic energy of a sane run (J): 10^6 times the energy at the problem's scales. A run with
/// more energy has diverged. Infinite for a user-defined system that does not define it.
double energy_bound(const Problem& problem);

}  // namespace polhode
