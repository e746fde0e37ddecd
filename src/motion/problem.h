// A scene made ready to be solved: what it really needs, the system posed, the pieces between its events.
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

/// How much of the motion is integrated.
enum class Formulation {
    reduced,         ///< what the scene needs and no more
    full_principal,  ///< all 13 variables, in the principal frame
    full,            ///< all 13 variables, the tensor as given in body axes
};

/// The name of a formulation: "reduced", "full in the principal frame" or "full as written".
const char* name_of(Formulation formulation);

/// Which of motion/systems.h.
enum class SystemKind {
    principal_axis_rotation,
    free_rotation,
    loaded_rotation,
    loaded_motion,
    full_motion,
    own,
    mechanism
};
/// How the principal moments of a body are alike.
enum class Symmetry {
    spherical,   ///< all three agree
    symmetric,   ///< two agree
    asymmetric,  ///< none agree
};
/// How the centre of mass moves.
enum class Translation {
    fixed,        ///< pivot, or a centre of mass that never moves
    closed_form,  ///< constant acceleration and linear drag, piecewise
    integrated,   ///< by the method, with the rotation
};

/// Something that the scene does not have, and why.
struct LeftOut {
    std::string what;  ///< "p and v", ..
    std::string why;   ///< in a few words
};

/// What the scene really has, found once.
struct Needs {
    SystemKind system = SystemKind::full_motion;        ///< which it is posed as
    int dimension = 13;                                 ///< of its state
    Symmetry symmetry = Symmetry::asymmetric;           ///< of the body
    Translation translation = Translation::integrated;  ///< of the centre of mass
    bool torque_free = false;                           ///< no torque at any time (impulses apart)
    bool time_dependent = false;                        ///< events inside the duration, or a user's torque
    bool user_torque = false;                           ///< a torque of the user's own acts
    std::vector<LeftOut> left_out;                      ///< what is not integrated, and why
};

/// A leg of the run, with what acts on it.
struct Segment : Leg {
    std::vector<PosedImpulse<double>> impulses;  ///< at `begin`, before the motion goes on
    Forcing<double> forcing;                     ///< in posed axes
    AxisEquations<double> about_axis;            ///< where the needs say principal_axis_rotation
    Vector3<double> position_W;  ///< of the centre of mass at `begin`, m, where translation has a closed form
    Vector3<double> velocity_W;  ///< of the centre of mass at `begin`, impulses included, m/s, likewise in closed form
};

/// Estimates of the largest |w|, |p| and |v| (SI) over the run: what absolute tolerances are multiplied by.
struct Scales {
    double angular_velocity = 1;  ///< rad/s
    double position = 1;          ///< m
    double velocity = 1;          ///< m/s
};

class ErasedModel;

/// The body of a posed scene, with what its equations need in the axes that they are posed in.
struct PosedBody : ExactBody<double> {
    PrincipalFrame principal;  ///< of the tensor about the pivot or the centre of mass
    Quaternion<double> q_BP;   ///< posed axes to body axes: principal.q_BP, or 1 where the tensor is as written
    PrincipalInertia<double> principal_inertia;  ///< posed axes, where they are the principal ones
    FullInertia<double> full_inertia;            ///< body axes
    Vector3<double> axis;                        ///< posed axes, unit: the axis of a principal_axis_rotation
    Vector3<double> initial_angular_velocity;    ///< posed axes, rad/s
    Quaternion<double> initial_q;                ///< posed axes to world
    /// The scene's planes and the body's hull in posed axes (motion/contact.h); never null.
    std::shared_ptr<const ContactGeometry<double>> geometry;

    WidePrincipalFrame wide_principal;            ///< `principal` before it was rounded
    Vector3<Wide> wide_initial_angular_velocity;  ///< in the axes of wide_principal, rad/s
};

/// The equations of one body, of motion/systems.h, by `Needs::system`.
struct OneBody {};
/// A system of the user's own, which has no body and no scene.
struct UserSystem {
    std::shared_ptr<const ErasedModel> model;  ///< never null
};
/// A scene of several bodies in joint coordinates (mechanism_of()).
struct MechanismSystem {
    std::shared_ptr<const ErasedModel> model;  ///< never null
};

/// A posed scene: what every method is given.
struct Problem {
    Scene scene;                                     ///< as it was posed
    Formulation formulation = Formulation::reduced;  ///< by which it was posed
    Needs needs;                                     ///< what the motion really has
    std::vector<Segment> segments;                   ///< its itinerary: the legs between events, with what acts on each
    Scales scales;                                   ///< how large the motion gets
    bool reactions = false;                          ///< samples of several bodies carry the reactions of their joints

    PosedBody body;  ///< what the system of one body is made of: rounded once from 128 bits
    std::variant<OneBody, UserSystem, MechanismSystem> system;

    /// The equations of a user's system or of several bodies behind one interface; null for one body.
    std::shared_ptr<const ErasedModel> model() const {
        if (const auto* user = std::get_if<UserSystem>(&system)) return user->model;
        if (const auto* several = std::get_if<MechanismSystem>(&system)) return several->model;
        return nullptr;
    }
};

/// Poses a scene, which must be valid (see validate), by a formulation. The scene's duration is the run's. Throws
/// InputError where the equations would ignore a part of the scene: a UserTorque, `pivot`, `planes`, `body` or
/// `initial` beside several bodies; joints, loops, motors, point springs or loads of a named body beside one body.
Problem pose(const Scene& scene, Formulation formulation = Formulation::reduced);

/// The index of the segment that holds time t (s): the last whose begin <= t.
std::size_t segment_at(const Problem& problem, double t);

/// The centre of mass a time `after` (s) the segment's begin, where its motion has a closed form.
void translated(const Segment& segment, double after, Vector3<double>& position_W, Vector3<double>& velocity_W);

/// The name of a system, for people: "loaded rotation".
const char* name_of(SystemKind system);

/// A bound on the kinetic energy of any sane run (J): 10^6 times what the scales allow. Beyond it a run has diverged.
/// Infinite for a system of the user's own whose masses are not known.
double energy_bound(const Problem& problem);

}  // namespace polhode
