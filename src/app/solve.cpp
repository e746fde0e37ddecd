// polhode solve: computes one trajectory.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "app/contact_output.h"
#include "app/lookup.h"
#include "integrators/analysis/joint_history.h"
#include "integrators/contact/solve_contacts.h"
#include "integrators/contact/solve_joints.h"
#include "integrators/contact/solve_spheres.h"
#include "integrators/method.h"
#include "measure/contact_errors.h"
#include "motion/mechanism_motion.h"
#include "motion/trajectory_csv.h"
#include "scene/scene_file.h"
#include "scene/scene_formulas.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr long most_samples = 10'000'000, most_steps = 1'000'000'000'000, most_evaluations = 1'000'000'000'000'000;

struct SolveOptions {
    std::string scene, method = "auto", output, reactions, joints;
    std::optional<double> step, tolerance, duration;
    std::optional<long> steps;
    long samples = 100, max_steps = Settings{}.max_steps, max_evaluations = Settings{}.max_evaluations;
    double max_seconds = Settings{}.seconds_limit;
    bool full = false;
    ContactOptions contacts;
};

void require_sane(const SolveOptions& options) {
    if (options.step) require_positive("--step", *options.step);
    if (options.tolerance) require_positive("--tolerance", *options.tolerance);
    if (options.duration) require_positive("--duration", *options.duration);
    if (options.steps) require_count("--steps", *options.steps, most_steps);
    require_count("--samples", options.samples, most_samples);
    require_count("--max-steps", options.max_steps, most_steps);
    require_count("--max-evaluations", options.max_evaluations, most_evaluations);
    require_positive("--max-seconds", options.max_seconds);
    require_output(options.output);
    require_output(options.reactions);
    require_output(options.joints);
}

Choice chosen(const SolveOptions& options, const Problem& problem, const Settings& settings) {
    const Choice choice =
        options.method == "auto" ? choose_method(problem, settings) : Choice{&method_named(options.method), ""};
    const std::string name(choice.method->name);
    if ((options.step || options.steps) && !takes_step(*choice.method))
        throw UsageError(fmt::format("{} does not take a step; remove {}", name, options.step ? "--step" : "--steps"));
    if (options.tolerance && !takes_tolerance(*choice.method))
        throw UsageError(fmt::format("{} does not take a tolerance; remove --tolerance", name));
    return choice;
}

std::string plural(long count, const char* noun) { return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s"); }

// Returns the largest violations of joints and loops in the trajectory (several bodies).
std::string joint_errors(const Scene& scene, const Trajectory& trajectory) {
    if (trajectory.samples.empty() || (scene.joints.empty() && scene.loops.empty())) return "";
    const MechanismMeasure<double> measure(scene);
    const std::vector<std::string> names = joint_names(scene);
    JointViolations<double> most;
    for (std::size_t k = 0; k < trajectory.moments(); ++k) {
        std::vector<BodyMotion<double>> motions;
        for (const Sample& s : trajectory.at(k)) motions.push_back(s), motions.back().q = normalized(s.q);
        const JointViolations<double> now = measure.violations(motions);
        if (!(now.gap <= most.gap)) most.gap = now.gap, most.gap_joint = now.gap_joint;
        if (!(now.turn <= most.turn)) most.turn = now.turn, most.turn_joint = now.turn_joint;
    }
    const auto where = [&](std::size_t joint) {
        return joint < names.size() ? fmt::format(" at {}", one_line(names[joint], 100)) : std::string();
    };
    return fmt::format("joints   joint_gap_max {:.3g} m{}, joint_turn_max {:.3g} rad{}\n", most.gap,
                       where(most.gap_joint), most.turn, where(most.turn_joint));
}

// Returns the errors at contacts that need no reference (planes). Those that need one are columns of result tables.
std::string contact_summary(const Scene& scene, const Trajectory& trajectory) {
    const ContactErrors errors = contact_errors(scene, trajectory, {});
    if (!errors.penetration) return "";
    std::string text = fmt::format("contacts penetration_max {:.3g} m", *errors.penetration);
    if (errors.energy_gain) text += fmt::format(", contact_energy_gain {:.3g} J", *errors.energy_gain);
    return text + '\n';
}

// Returns the summary of the run, one topic per line.
std::string summary(const SolveOptions& options, const Problem& problem, const Choice& choice, const Settings& settings,
                    const Trajectory& trajectory) {
    const double T = problem.scene.duration;
    std::string text = fmt::format("scene    {}: {}, {} variables, {} s\n", one_line(problem.scene.name, 100),
                                   name_of(problem.needs.system), problem.needs.dimension, T);
    text += fmt::format("method   {}", choice.method->name);
    if (!choice.why.empty()) text += fmt::format(" (auto: {})", choice.why);
    if (settings.tolerance) text += fmt::format(", tolerance {}", *settings.tolerance);
    text += '\n';
    if (trajectory.step > 0) {
        text += fmt::format("step     {} s", trajectory.step);
        const double asked = settings.step ? *settings.step : trajectory.step;
        if (trajectory.step < asked * (1 - 1e-9))
            text +=
                fmt::format(", rounded down from {} s so that whole steps meet all {} samples", asked, options.samples);
        text += '\n';
    }
    text += fmt::format("status   {}{}{}\n", name_of(trajectory.status), trajectory.message.empty() ? "" : ": ",
                        one_line(trajectory.message, 500));
    text += fmt::format("cost     {}, {}", plural(trajectory.steps, "step"),
                        plural(trajectory.rhs_evaluations, "right-hand side"));
    const SolverCounts& counts = trajectory.counts;
    if (counts.rejected_steps.value_or(0) > 0)
        text += fmt::format(", {} rejected", plural(*counts.rejected_steps, "step"));
    if (counts.newton_failures.value_or(0) > 0)
        text += fmt::format(", {}", plural(*counts.newton_failures, "nonlinear solver failure"));
    if (counts.order_reductions.value_or(0) > 0)
        text += fmt::format(", {} for stability", plural(*counts.order_reductions, "order reduction"));
    text += fmt::format(", {:.6f} s\n", trajectory.seconds);
    return text + joint_errors(problem.scene, trajectory) + contact_summary(problem.scene, trajectory);
}

// Writes the file of joint coordinates, if there is one. Returns whether that was possible.
bool write_joints(const SolveOptions& options, const Problem& problem, const Choice& choice, const Settings& settings,
                  const Trajectory& trajectory) {
    if (options.joints.empty() || trajectory.samples.empty()) return true;
    const JointHistory<double> history = joint_history(problem, choice.method, settings, trajectory);
    if (history.fault.empty()) {
        std::vector<std::string> names = joint_names(problem.scene);
        names.resize(problem.scene.joints.size());  // without loops
        write_output(options.joints, joints_csv(history.times, history.motions, names));
        return true;
    }
    std::fputs(fmt::format("polhode: {} was not written: {}\n", one_line(options.joints, 200), history.fault).c_str(),
               stderr);
    return false;
}

// Writes the events and modes of the method, if it records them. Returns whether they were written.
bool report_contacts(const SolveOptions& options, const Problem& problem, const Method& method,
                     const Settings& settings) {
    if (!options.contacts.any()) return true;
    const Scene& scene = problem.scene;
    const bool to_stdout = !options.output.empty();
    if (contact::has_joint_events(scene) && follows_events(method)) {
        write_joint_events(scene, options.contacts,
                           contact::follow_joints_in_binary64(problem, settings, method.steps).events);
    } else if (method.family == Family::reference) {
        constexpr int digits = 17;
        write_contacts(scene, options.contacts, decimal_reference(scene, options.samples, digits), to_stdout);
    } else if (follows_contacts(method)) {
        write_contacts(scene, options.contacts, contact::record_contacts(problem, settings, method.steps), to_stdout);
    } else {
        std::fputs(fmt::format("polhode: --modes and --events: {} does not record contacts; use taylor or truth\n",
                               method.name)
                       .c_str(),
                   stderr);
        return false;
    }
    return true;
}

int solve_command(const SolveOptions& options) {
    require_sane(options);
    if (options.method != "auto") method_named(options.method);
    Scene scene = read_scene_with_notes(options.scene);
    if (options.duration) scene.duration = *options.duration;
    require_states(scene, options.samples);
    Settings settings;
    settings.samples = options.samples;
    settings.max_steps = options.max_steps, settings.max_evaluations = options.max_evaluations;
    settings.seconds_limit = options.max_seconds;
    settings.formulation = options.full ? Formulation::full : Formulation::reduced;
    settings.step = options.steps ? scene.duration / static_cast<double>(*options.steps) : options.step;
    settings.tolerance = options.tolerance;
    if (settings.step) require_positive("the step", *settings.step);
    if (options.full) require_one_body(scene, "--full", "the full formulation supports one body");
    require_joint_files(scene, options.reactions, options.joints, options.output);
    require_contacts(scene, options.contacts, options.output, options.reactions);
    Problem problem = pose(scene, settings.formulation);
    problem.reactions = !options.reactions.empty();
    const Choice choice = chosen(options, problem, settings);
    settings = with_defaults(problem, *choice.method, settings);
    const Trajectory trajectory = solve(problem, *choice.method, settings);
    // an incomplete trajectory is also written: it shows how far the method got
    if (!trajectory.samples.empty())
        write_trajectory_output(options.output, trajectory_csv(trajectory, body_names(scene)));
    const bool no_joints = !write_joints(options, problem, choice, settings, trajectory);
    const bool no_reactions = trajectory.status == Status::ok && problem.reactions && trajectory.reactions.empty();
    if (problem.reactions && !trajectory.reactions.empty())
        write_output(options.reactions, reactions_csv(trajectory, joint_names(scene)));
    std::fputs(summary(options, problem, choice, settings, trajectory).c_str(), stderr);
    if (no_reactions)
        std::fputs(
            fmt::format("polhode: {} was not written: {} does not compute joint reactions; use taylor or another "
                        "method in joint coordinates\n",
                        one_line(options.reactions, 200), choice.method->name)
                .c_str(),
            stderr);
    if (no_reactions || no_joints) return 1;
    if (trajectory.status == Status::ok && !report_contacts(options, problem, *choice.method, settings)) return 1;
    return trajectory.status == Status::ok ? 0 : 1;
}

}  // namespace

void add_solve(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "solve", "Solves a scene: writes one trajectory (CSV) to stdout or a file, and a summary to stderr.");
    describe_columns(*command,
                     "Examples:\n"
                     "  polhode solve lagrange_top --method cvode_adams --tolerance 1e-10 --output top.csv\n"
                     "  polhode solve t_handle --method odeint_rk4 --step 0.001 --samples 500\n"
                     "  polhode solve mechanisms/four_bar --reactions forces.csv --output motion.csv\n");
    const auto options = std::make_shared<SolveOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("--method", options->method,
                     "Method (see polhode list methods). auto selects one; polhode describe SCENE prints which and why")
        ->capture_default_str();
    CLI::Option* step =
        command->add_option("--step", options->step,
                            "Fixed step in s, rounded down so that whole steps meet every sample (default T/10^4)");
    CLI::Option* steps =
        command->add_option("--steps", options->steps, "Number of fixed steps over the duration, instead of --step");
    CLI::Option* tolerance = command->add_option(
        "--tolerance", options->tolerance,
        "Relative tolerance (default 1e-10). The absolute tolerance is this times the component's scale");
    step->excludes(steps)->excludes(tolerance);
    steps->excludes(tolerance);
    command->add_option("--samples", options->samples, "Number of sample intervals N: samples at k T/N, k = 0..N")
        ->capture_default_str();
    command->add_option("--duration", options->duration, "Duration T in s (default: the scene's)");
    command->add_option("--max-steps", options->max_steps, "Fail after this many steps")->capture_default_str();
    command
        ->add_option("--max-evaluations", options->max_evaluations, "Fail after this many right-hand-side evaluations")
        ->capture_default_str();
    command->add_option("--max-seconds", options->max_seconds, "Fail after this CPU time of the thread, in s")
        ->capture_default_str();
    add_contact_options(*command, options->contacts);
    add_engines_option(*command);
    add_outside_option(*command);
    command->add_option("--output", options->output, "Output file (default: stdout)");
    command->add_option("--reactions", options->reactions,
                        "CSV file for the reactions of joints and loops (several bodies): t,joint,fx,fy,fz,tx,ty,tz. "
                        "Force in N and torque in N m by the parent on the child, world axes, about the child's point");
    command->add_option("--joints", options->joints,
                        "CSV file for the coordinates of joints (several bodies): t,joint,coordinate,rate, one line "
                        "per coordinate. Angles in rad with full revolutions, displacements in m; the quaternion "
                        "w, x, y, z of a spherical joint");
    command->add_flag("--full", options->full,
                      "Integrate all 13 variables instead of the reduced formulation (one body)");
    command->callback([options, &exit_code] { exit_code = solve_command(*options); });
}

}  // namespace polhode
