// What a method is, and how it is called: once per trajectory, through a function pointer, never once per step.
//
// A method of one's own, from outside the tree, is the same descriptor handed to solve().
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
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// How a method is told how accurate to be.
enum class Control {
    none,                    ///< it is not: it has neither a step nor a tolerance
    fixed_step,              ///< by Settings::step
    tolerance,               ///< by Settings::tolerance
    fixed_step_or_tolerance  ///< by either
};

/// What a run is asked for.
struct Settings {
    std::optional<double> step;       ///< s; rounded down so that whole steps meet every sample
    std::optional<double> tolerance;  ///< relative; absolute = this times the component's scale
    long samples = 100;               ///< N: samples at k T / N, k = 0..N
    /// Sample times of the caller's own (s) in place of those: each later than the one before, none before 0 or beyond
    /// the scene's duration, at which the run ends as ever. A fixed step is rounded down in each interval between them.
    std::vector<double> times{};
    /// Limits of one integration: a run that needs more is `failed`, with Trajectory::limit_reached and a message that
    /// names the limit. They are looked at before each step, and between the attempts at one. The defaults end any run
    /// within an hour or so.
    long max_steps = 1'000'000'000;
    long max_evaluations = 10'000'000'000;  ///< of right-hand sides
    double seconds_limit = 3600;            ///< s, of the thread's own time; looked at every 10 ms or each step
    /// false: the same steps, but only the last sample is kept (what timings measure).
    bool record = true;
    /// The integration is repeated this often inside one call and the time divided: for runs near the clock's grain.
    int repetitions = 1;
    Formulation formulation = Formulation::reduced;  ///< by which solve() poses a scene
};

/// What kind of scheme a method is.
enum class Family {
    unnamed,           ///< not said
    closed_form,       ///< evaluated at each sample, nothing is stepped
    series,            ///< Taylor series
    extrapolation,     ///< of a scheme of low order to step zero
    runge_kutta,       ///< stages within a step, explicit or implicit
    multistep,         ///< from several steps before
    splitting,         ///< flows of parts of the motion, one after the other
    rotation_group,    ///< made for the rotation group or for what the motion keeps
    published_update,  ///< a step as an article, a course or slides for game programmers print it
    engine_update,     ///< a step as physics engines take it
    points,            ///< the body is made of points
    reference,         ///< the truth that errors are measured against
    engine,            ///< a physics engine itself, in a process of its own
};

/// The arithmetic of a method's steps.
enum class Precision {
    binary64,        ///< double
    binary32,        ///< float
    multiprecision,  ///< more than 64 bits
};

inline constexpr std::string_view sundials_library = "SUNDIALS";    ///< for Method::library
inline constexpr std::string_view odeint_library = "Boost.Odeint";  ///< for Method::library
inline constexpr std::string_view gsl_library = "GSL";              ///< for Method::library

/// A method: what is known of it, and the function that runs it. All that tables and pictures go by stands here;
/// nothing reads it off the name. Texts are views: those of a method made at run time belong to what make_method()
/// returns.
struct Method {
    std::string_view name{};           ///< letters, digits and _; a discrete order stands in it
    std::string_view documentation{};  ///< Markdown, a paragraph; the table of methods shows its first sentence
    std::string_view source{};         ///< author, year, where
    /// What the text that it is from calls it, where that is not its name: "article: update_body_orientation, as
    /// printed".
    std::string_view described_as{};
    std::string_view conserves{};     ///< what it keeps by construction: "nothing", "|q|", ..
    Control control = Control::none;  ///< what it is told
    bool planes = false;       ///< it follows impacts on planes; without it a scene that has any is `unsupported`
    bool own_systems = false;  ///< it takes a system of the user's own (motion/own_system.h); else `unsupported`
    int order = 0;             ///< claimed, of a fixed step; 0 = variable. tests/order_test.cpp measures it
    /// Solves a problem; called once a trajectory, with settings that solve() has found in order.
    Trajectory (*solve)(const Problem&, const Settings&) = nullptr;
    /// Linear stability: the spectral radius of one step on y' = lambda y, as a function of z = h lambda.
    double (*growth)(std::complex<double> z) = nullptr;
    /// Linear stability of a scheme that is not one for first-order systems: the spectral radius of one step on
    /// theta'' = -gamma theta' - k theta, as a function of (h gamma, h^2 k).
    double (*pendulum_growth)(double damping, double stiffness) = nullptr;
    Family family = Family::unnamed;            ///< what kind of scheme it is
    std::string_view library{};                 ///< whose steps they are, sundials_library, ..; empty: this one's own
    Precision precision = Precision::binary64;  ///< of its steps
    std::string_view in_binary64{};             ///< of a method in binary32: the name of its twin in binary64
    /// What it integrates whatever formulation the problem was posed by; empty: the formulation asked for.
    std::optional<Formulation> formulation{};
    /// Why it does not solve the problem, as far as that is known before any step; empty where it does. Ask refusal(),
    /// which knows of planes too.
    std::string (*refuses)(const Problem&) = nullptr;
    /// Of a method that needs more than problem and settings (a command line, a function of the user's own): called in
    /// place of `solve`, with `context` as it stands here.
    Trajectory (*solve_in)(const void* context, const Problem&, const Settings&) = nullptr;
    const void* context = nullptr;  ///< what `solve_in` is given
    /// Of a method that is no part of the program: what its results are told apart by from those of another of its
    /// name, where results are kept.
    std::string_view identity{};
};

/// `methods`, each with what `common` says wherever it says nothing itself: all but name, documentation, what it is
/// described as and how it is solved.
template <std::size_t count>
constexpr std::array<Method, count> sharing(const Method& common, const Method (&methods)[count]) {
    std::array<Method, count> all{};
    for (std::size_t i = 0; i < count; ++i) {
        all[i] = methods[i];
        const auto share = [&]<class T>(T Method::*part) {
            T& own = all[i].*part;
            if constexpr (std::is_pointer_v<T>) {
                if (!own) own = common.*part;
            } else {
                if (own == T{}) own = common.*part;
            }
        };
        share(&Method::source), share(&Method::conserves), share(&Method::control), share(&Method::planes);
        share(&Method::own_systems), share(&Method::order), share(&Method::growth), share(&Method::pendulum_growth);
        share(&Method::family), share(&Method::library), share(&Method::precision), share(&Method::formulation);
        share(&Method::refuses);
    }
    return all;
}

/// A method made at run time: what `description` says, solved by `solve`. The result owns its texts and the function,
/// and whoever keeps a pointer or reference to the method keeps the result as well. `solve` is called from several
/// threads at once where trajectories are computed side by side.
std::shared_ptr<const Method> make_method(const Method& description,
                                          std::function<Trajectory(const Problem&, const Settings&)> solve);

/// Why the method does not solve the problem, in one line: planes, loads or a body that it has no place for. Empty
/// where it may; a run can still end as `unsupported` where only the run itself shows it, or the step does.
std::string refusal(const Method& method, const Problem& problem);

/// All methods of this build, in the order of the list in integrators/CMakeLists.txt.
std::span<const Method* const> methods();

/// The method of that name, or nullptr if there is none. `auto` is not a method: see choose_method.
const Method* find_method(std::string_view name);

/// A method that one might look for and that is not here, and why.
struct MethodLeftOut {
    std::string_view name;    ///< what one might look for
    std::string_view reason;  ///< Markdown, a paragraph
};
/// All methods that were considered and left out.
std::span<const MethodLeftOut> methods_left_out();

/// What `auto` takes.
struct Choice {
    const Method* method;  ///< never null
    std::string_view why;  ///< in a few words
};
/// The tolerance where none is given.
inline constexpr double default_tolerance = 1e-10;

/// What `auto` takes, and why: exact where it can be; else what is fastest at the accuracy that the tolerance asks for.
Choice choose_method(const Problem& problem, double tolerance = default_tolerance);

/// What `auto` takes where the settings have a step or a tolerance: the most accurate method that can be told it. Of
/// settings without, the same as above.
Choice choose_method(const Problem& problem, const Settings& settings);

/// Whether the method can be told a step.
bool takes_step(const Method& method);
/// Whether the method can be told a tolerance.
bool takes_tolerance(const Method& method);

/// `settings` with tolerance 1e-10 or step T / 10^4 filled in where it has neither and the method takes one.
Settings with_defaults(const Problem& problem, const Method& method, Settings settings);

/// Poses the scene and solves it. With neither step nor tolerance in `settings`: tolerance 1e-10 if the method takes
/// one, else a step of T / 10^4. A step, tolerance, duration, count or limit out of range gives Status::failed with a
/// message, nothing is thrown for it; an invalid scene throws InputError.
Trajectory solve(const Scene& scene, const Method& method, const Settings& settings = {});

/// Solves a problem that is posed already, by the formulation it was posed with. Everything else is as for a scene.
Trajectory solve(const Problem& problem, const Method& method, const Settings& settings = {});

}  // namespace polhode
