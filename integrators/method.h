// Interface of a method: a descriptor with a function that is called once per trajectory, never once per step.
//
// User-defined methods use the same descriptor and are passed to solve(). The main types are Method (the descriptor),
// Settings (the parameters of a run), Control (which accuracy setting a method takes) and Choice (the result of
// `auto`). methods() lists the methods of this build; refusal() tells whether a method supports a problem.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "motion/problem.h"
#include "motion/system_steps.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// Which accuracy setting a method takes.
enum class Control {
    none,                    ///< neither a step nor a tolerance
    fixed_step,              ///< Settings::step
    tolerance,               ///< Settings::tolerance
    fixed_step_or_tolerance  ///< either of the two
};

/// Parameters of a run.
struct Settings {
    std::optional<double> step;       ///< s; rounded down so that whole steps meet every sample
    std::optional<double> tolerance;  ///< relative; absolute = this times the component's scale
    long samples = 100;               ///< N: samples at k T / N, k = 0..N
    /// Sample times, s, instead of equally spaced samples. They must increase and lie between 0 and the scene's
    /// duration. The run always ends at the duration. A fixed step is rounded down in each interval between them.
    std::vector<double> times{};
    /// Limits of one integration. A run that exceeds one is `failed`, with Trajectory::limit_reached and a message that
    /// names the limit. They are checked before each step and between attempts at one. The defaults end any run within
    /// about an hour.
    long max_steps = 1'000'000'000;
    long max_evaluations = 10'000'000'000;  ///< right-hand-side evaluations
    double seconds_limit = 3600;            ///< processor time of the thread, s; checked every 10 ms or every step
    /// false: takes the same steps but records only the last sample (used for timings).
    bool record = true;
    /// Repetitions of the integration per call; the time is divided by it. For runs near the clock's resolution.
    int repetitions = 1;
    Formulation formulation = Formulation::reduced;  ///< formulation in which solve() poses a scene
};

/// Kind of numerical scheme.
enum class Family {
    unnamed,           ///< not specified
    closed_form,       ///< evaluated at each sample, without steps
    series,            ///< Taylor series
    extrapolation,     ///< extrapolation of a low-order scheme to step zero
    runge_kutta,       ///< stages within a step, explicit or implicit
    multistep,         ///< uses several previous steps
    splitting,         ///< composition of flows of parts of the motion
    rotation_group,    ///< preserves the rotation group or invariants of the motion
    published_update,  ///< a step as printed in an article, course or slides for game programmers
    engine_update,     ///< a step as in physics engines
    points,            ///< the body consists of point masses
    reference,         ///< the reference that errors are measured against
    engine,            ///< a physics engine in its own process
};

/// The arithmetic of a method's steps.
enum class Precision {
    binary64,        ///< double
    binary32,        ///< float
    multiprecision,  ///< more than 64 bits
};

inline constexpr std::string_view sundials_library = "SUNDIALS";    ///< a value of Method::library
inline constexpr std::string_view odeint_library = "Boost.Odeint";  ///< a value of Method::library
inline constexpr std::string_view gsl_library = "GSL";              ///< a value of Method::library

/// Descriptor of a method: its properties and the function that runs it. Tables and figures use only these properties;
/// nothing is derived from the name. The texts are views: those of a method made at run time belong to the result of
/// make_method().
struct Method {
    std::string_view name{};           ///< letters, digits and _; includes a discrete order
    std::string_view documentation{};  ///< one Markdown paragraph; the table of methods shows its first sentence
    std::string_view source{};         ///< author, year, publication
    /// Description of its origin if the source does not name it: "article: update_body_orientation, as printed".
    std::string_view origin{};
    std::string_view conserves{};     ///< invariants that it preserves by construction: "nothing", "|q|", ..
    Control control = Control::none;  ///< which accuracy setting it takes
    bool planes = false;              ///< supports impacts on planes; otherwise scenes with planes are `unsupported`
    /// Supports systems other than one body (motion/user_system.h); otherwise they are `unsupported`.
    bool general_systems = false;
    int order = 0;  ///< claimed order at a fixed step; 0 = variable. Measured by tests/integrators/order_test.cpp
    /// Solves a problem. Called once per trajectory, with settings that solve() has validated.
    Trajectory (*solve)(const Problem&, const Settings&) = nullptr;
    /// Linear stability: the spectral radius of one step on y' = lambda y, as a function of z = h lambda.
    double (*amplification)(std::complex<double> z) = nullptr;
    /// Linear stability of a scheme that is not for first-order systems: the spectral radius of one step on theta'' =
    /// -gamma theta' - k theta, as a function of (h gamma, h^2 k).
    double (*pendulum_amplification)(double damping, double stiffness) = nullptr;
    /// Makes steps through the smooth parts of motions with contact, joint limits or dry friction. The drivers of
    /// integrators/contact locate the events. Null: such scenes are `unsupported`, unless `solve` handles them itself.
    MakeSystemSteps steps = nullptr;
    Family family = Family::unnamed;  ///< kind of numerical scheme
    std::string_view library{};       ///< library that performs the steps: sundials_library, ..; empty: polhode
    Precision precision = Precision::binary64;  ///< arithmetic of its steps
    std::string_view binary64_name{};           ///< for a binary32 method: the name of the same method in binary64
    /// Formulation that it always integrates; empty: the requested formulation.
    std::optional<Formulation> formulation{};
    /// Why it does not support the problem, as far as this is known before the run; empty if it does. Call refusal()
    /// instead, which also checks planes.
    std::string (*refusal)(const Problem&) = nullptr;
    /// For methods that need more than problem and settings, such as a command line or a user-defined function. Called
    /// instead of `solve`, with `context`.
    Trajectory (*solve_in)(const void* context, const Problem&, const Settings&) = nullptr;
    const void* context = nullptr;  ///< first argument of `solve_in`
    /// For methods outside the program: distinguishes stored results from those of another method of this name.
    std::string_view identity{};
};

/// Returns `methods` with unset members taken from `defaults`, except name, documentation, origin and solve.
template <std::size_t count>
constexpr std::array<Method, count> apply_defaults(const Method& defaults, const Method (&methods)[count]) {
    std::array<Method, count> all{};
    for (std::size_t i = 0; i < count; ++i) {
        all[i] = methods[i];
        const auto apply = [&]<class T>(T Method::*part) {
            T& value = all[i].*part;
            if constexpr (std::is_pointer_v<T>) {
                if (!value) value = defaults.*part;
            } else {
                if (value == T{}) value = defaults.*part;
            }
        };
        apply(&Method::source), apply(&Method::conserves), apply(&Method::control), apply(&Method::planes);
        apply(&Method::general_systems), apply(&Method::steps), apply(&Method::order), apply(&Method::amplification);
        apply(&Method::pendulum_amplification), apply(&Method::family), apply(&Method::library);
        apply(&Method::precision), apply(&Method::formulation), apply(&Method::refusal);
    }
    return all;
}

/// Makes a method at run time from `description`, solved by `solve`. The result owns its texts and the function: keep
/// it as long as any pointer or reference to the method. `solve` is called from several threads at once when
/// trajectories are computed in parallel.
std::shared_ptr<const Method> make_method(const Method& description,
                                          std::function<Trajectory(const Problem&, const Settings&)> solve);

/// Whether the method follows the limits and dry friction of joints from event to event, with a record of the events.
/// False for the reference, whose events DecimalReference lists.
bool follows_events(const Method& method);
/// Whether the method also follows contact with friction from event to event.
bool follows_contacts(const Method& method);

/// Why the method does not support the problem (planes, loads, bodies), in one line. Empty if it may support it. A run
/// can still end as `unsupported` for reasons that appear only during the run or depend on the step.
std::string refusal(const Method& method, const Problem& problem);

/// All methods of this build, in the order of the list in integrators/CMakeLists.txt.
std::span<const Method* const> methods();

/// The method of this name, or nullptr. `auto` is not a method: see choose_method().
const Method* find_method(std::string_view name);

/// A method that users may look for but that is not available, and the reason.
struct OmittedMethod {
    std::string_view name;    ///< name under which users may look for it
    std::string_view reason;  ///< one Markdown paragraph
};
/// All methods that were considered and omitted.
std::span<const OmittedMethod> omitted_methods();
/// The former name of OmittedMethod.
using MethodLeftOut [[deprecated("use OmittedMethod")]] = OmittedMethod;
/// The former name of omitted_methods().
[[deprecated("use omitted_methods()")]] inline std::span<const OmittedMethod> methods_left_out() {
    return omitted_methods();
}

/// The method that `auto` selects.
struct Choice {
    const Method* method;  ///< never null
    std::string_view why;  ///< short reason
};
/// Default tolerance.
inline constexpr double default_tolerance = 1e-10;

/// The method that `auto` selects: `exact` if possible, otherwise the fastest at the accuracy of the tolerance.
Choice choose_method(const Problem& problem, double tolerance = default_tolerance);

/// The method that `auto` selects for settings with a step or a tolerance: the most accurate one that takes this
/// setting. Without either, as choose_method(problem).
Choice choose_method(const Problem& problem, const Settings& settings);

/// True if the method takes a step.
bool takes_step(const Method& method);
/// True if the method takes a tolerance.
bool takes_tolerance(const Method& method);

/// Fills in tolerance 1e-10 or step T / 10^4 if `settings` have neither and the method takes one.
Settings with_defaults(const Problem& problem, const Method& method, Settings settings);

/// Poses the scene and solves it. Without step and tolerance: tolerance 1e-10 if the method takes one, otherwise a step
/// of T / 10^4. A step, tolerance, duration, count or limit out of range gives Status::failed with a message and does
/// not throw. Throws InputError if the scene is invalid.
Trajectory solve(const Scene& scene, const Method& method, const Settings& settings = {});

/// Solves a posed problem in its formulation. Otherwise as solve() for a scene.
Trajectory solve(const Problem& problem, const Method& method, const Settings& settings = {});

}  // namespace polhode
