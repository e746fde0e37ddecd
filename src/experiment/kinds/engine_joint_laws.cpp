// The kind `engine_joint_laws`: limits, friction and gears of joints in physics engines and in polhode's methods, and
// control in engines.
//
// Rows of the sweep give the errors for each scene. probe_joint_laws() runs each method at the usual and at the fine
// step on motions with known results: an arm without gravity that hits a stop, a pendulum that friction holds, and a
// pendulum geared to a rotor.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "body/orientation.h"
#include "experiment/kinds/contact_tables.h"
#include "experiment/kinds/engine_joints.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/step_rows.h"
#include "scene/scene_file.h"
#include "table/markup.h"
#include "text/message.h"

namespace polhode {
namespace {

/// Results of the motions at one step. Empty if the method does not support the motion or did not complete it.
struct JointLawProbe {
    std::optional<double> depth;     ///< largest angle beyond the stop, rad, exactly 0
    std::optional<double> rebound;   ///< speed after an inelastic impact over that before, exactly 0
    std::optional<double> late;      ///< time of the impact minus the exact one, s
    std::optional<double> elastic;   ///< speed after an impact with restitution 0.75 over that before, exactly 0.75
    std::optional<double> creep;     ///< path in 4 s of a pendulum held at half the friction's limit, rad, exactly 0
    std::optional<double> mismatch;  ///< largest |w2 - r w1| of a gear over the largest |w2|, exactly 0
    std::optional<double> geared;    ///< error of the geared pendulum's angle after 1 s, rad
    std::string limits_fault, elastic_fault, friction_fault, gears_fault;  ///< why a result is missing
};

struct LawsPlace : EngineStanding {
    JointLawProbe usual, fine;
};

constexpr double impact_speed = 4, stop_angle = 0.5;                         // rad/s, rad
constexpr double impact_time = stop_angle / impact_speed;                    // s
constexpr double stop_duration = 0.3, hold_duration = 4, gear_duration = 1;  // s
constexpr double restitution_probed = 0.75;

// The angle about y of a body that started with the world's axes.
double angle_about_y(const Sample& s) { return 2 * std::atan2(s.q.y, s.q.w); }

// A sample after each step. Without samples, and with the reason in `fault`, if the run was not completed.
std::vector<Sample> run_law(const Method& method, Scene scene, double duration, double step, std::string& fault) {
    scene.duration = duration;
    Settings settings;
    settings.samples = std::lround(duration / step), settings.seconds_limit = 10;
    if (takes_step(method)) settings.step = step;
    Trajectory trajectory = solve(scene, method, settings);
    if (trajectory.status == Status::ok) return trajectory.samples;
    fault = one_line(trajectory.message, 120);
    return {};
}

// The arm of joints/pendulum_with_stops without gravity.
Scene make_stopped_arm(double restitution) {
    Scene scene = find_scene("joints/pendulum_with_stops");
    scene.loads.clear();
    scene.joints[0].limits.restitution = restitution;
    return scene;
}

void probe_stop(const Method& method, double step, JointLawProbe& probe) {
    const std::vector<Sample> run = run_law(method, make_stopped_arm(0), stop_duration, step, probe.limits_fault);
    double depth = 0, slowest = impact_speed;
    for (const Sample& s : run) {
        depth = std::max(depth, angle_about_y(s) - stop_angle);
        const double rate = s.angular_velocity_B[1];
        slowest = std::min(slowest, rate);
        if (!probe.late && rate < 0.5 * impact_speed) probe.late = s.t - impact_time;
    }
    if (run.empty()) return;
    probe.depth = depth, probe.rebound = std::max(0.0, -slowest / impact_speed);
}

void probe_restitution(const Method& method, double step, JointLawProbe& probe) {
    const std::vector<Sample> run =
        run_law(method, make_stopped_arm(restitution_probed), stop_duration, step, probe.elastic_fault);
    if (!run.empty()) probe.elastic = std::max(0.0, -run.back().angular_velocity_B[1] / impact_speed);
}

void probe_creep(const Method& method, double step, JointLawProbe& probe) {
    Scene scene = find_scene("joints/coulomb_pendulum");
    // m g l sin a = F / 2
    const double start = std::asin(0.5 * scene.joints[0].friction / (1.5 * 9.75 * 0.5));
    scene.joints[0].coordinate[0] = start;
    const std::vector<Sample> run = run_law(method, scene, hold_duration, step, probe.friction_fault);
    if (!run.empty()) probe.creep = std::abs(angle_about_y(run.back()) - start);
}

void probe_gear(const Method& method, double step, JointLawProbe& probe) {
    const Scene scene = find_scene("joints/pendulum_with_rotor");
    const double ratio = scene.couplings[0].ratio;
    const std::vector<Sample> run = run_law(method, scene, gear_duration, step, probe.gears_fault);
    if (run.empty()) return;
    std::string fault;
    const std::vector<Sample> truth = run_law(*find_method("taylor"), scene, gear_duration, step, fault);
    double mismatch = 0, fastest = 0;
    for (std::size_t k = 0; k + 1 < run.size(); k += 2) {
        const double first = run[k].angular_velocity_B[1], second = run[k + 1].angular_velocity_B[1];
        mismatch = std::max(mismatch, std::abs(second - ratio * first)), fastest = std::max(fastest, std::abs(second));
    }
    probe.mismatch = mismatch / fastest;
    if (truth.size() == run.size())
        probe.geared = rotation_angle_between(run[run.size() - 2].q, truth[truth.size() - 2].q);
}

JointLawProbe probe_joint_laws(const Method& method, double step) {
    JointLawProbe probe;
    probe_stop(method, step, probe), probe_restitution(method, step, probe);
    probe_creep(method, step, probe), probe_gear(method, step, probe);
    return probe;
}

bool has_laws(const LawsPlace& place) {
    return place.is_available() && (!place.engine || !place.report.hello.laws.empty());
}

/// A column of a table of probes, at the usual and at the fine step.
struct LawColumn {
    const char *name, *heading;
    std::optional<double> JointLawProbe::*value;
};

NamedTable laws_table(const char* name, const char* title, const std::vector<LawsPlace>& places,
                      const std::vector<LawColumn>& probed, std::string JointLawProbe::*fault) {
    std::vector<ColumnChoice> columns{{"method", "method"}};
    for (const LawColumn& column : probed)
        for (const double step : {default_engine_step, fine_step})
            columns.push_back({fmt::format("{} at {}", column.name, step_name(step)),
                               fmt::format("{}, {}", column.heading, step_name(step))});
    columns.push_back({"message", "not measured because"});
    NamedTable named = make_named_table(name, title, columns);
    for (const LawsPlace& place : places) {
        if (!has_laws(place)) continue;
        std::vector<Cell> row{std::string(place.curve->method->name)};
        for (const LawColumn& column : probed)
            row.insert(row.end(), {cell_of(place.usual.*column.value), cell_of(place.fine.*column.value)});
        row.emplace_back(place.usual.*fault);
        named.table.rows.push_back(std::move(row));
    }
    return named;
}

std::string describe_limits(const LawsPlace& place) {
    const JointLawProbe& p = place.fine;
    if (!p.depth) return fmt::format(" Limits: not supported ({}).", p.limits_fault);
    const bool is_rigid = *p.depth <= 1.01 * impact_speed * fine_step;
    std::string text = fmt::format(" Limits are {}: at {} the arm goes {} beyond the stop", is_rigid ? "rigid" : "soft",
                                   step_name(fine_step), format_amount(p.depth, " rad"));
    text +=
        *p.rebound < 0.01 ? " and stays there." : fmt::format(" and rebounds with {:.2f} of its speed.", *p.rebound);
    if (!p.elastic)
        text += " Restitution is not supported.";
    else if (*p.elastic < 0.01)
        text += " With a restitution of 0.75 the arm does not rebound.";
    else
        text += fmt::format(" With a restitution of 0.75 the arm rebounds with {:.2f} of its speed.", *p.elastic);
    return text;
}

std::string describe_friction(const LawsPlace& place) {
    const JointLawProbe& p = place.fine;
    if (!p.creep) return fmt::format(" Friction: not supported ({}).", p.friction_fault);
    const double rounding = place.curve->method->precision == Precision::binary32 ? 1e-5 : 1e-8;
    if (*p.creep < rounding) return " Friction holds.";
    return fmt::format(" Friction creeps: {} in 4 s at half of its limit.", format_amount(p.creep, " rad"));
}

std::string describe_gears(const LawsPlace& place) {
    const JointLawProbe& p = place.fine;
    if (!p.mismatch) return fmt::format(" Gears: not supported ({}).", p.gears_fault);
    const bool is_unbalanced = p.geared && *p.geared > 0.1;
    const char* kind = is_unbalanced && *p.mismatch > 0.1
                           ? "Gears act one way: the driving joint does not feel the driven one"
                       : is_unbalanced      ? "Gears keep the ratio, but their torques are not in balance"
                       : *p.mismatch < 1e-4 ? "Gears are rigid"
                                            : "Gears are soft";
    return fmt::format(" {}. The error of the ratio of the rates is {}, that of the pendulum's angle after 1 s is {}.",
                       kind, format_amount(p.mismatch, ""), format_amount(p.geared, " rad"));
}

const std::string control_about =
    "The drivers evaluate a controller, given by formulas, at the start of each step from the engine's own state and "
    "apply its torque during the step. *Spacecraft*: [formulas/saturated_regulator]"
    "(../experiments/scenes/formulas/saturated_regulator.json), 60 s. *Wheel*: [formulas/flywheel_servo]"
    "(../experiments/scenes/formulas/flywheel_servo.json), 5 s. *Sampled*: the controller is evaluated every 0.1 s, "
    "and "
    "its torque is held. The errors are the largest attitude errors against the reference with the same controller. ";

std::string laws_page(const Plan& plan, const std::vector<LawsPlace>& places, const std::string& control,
                      const Findings& findings) {
    std::string text = "# Limits, friction and gears of joints, and control, in physics engines\n\n" +
                       markdown_text(plan.experiment.about) + ".\n\n";
    text +=
        "[Joints](engine_joints.md) is the corresponding page for joints without these laws. Each engine uses its own "
        "feature; what it does not have is refused. The rigid law is the reference: an impact at the limit with a "
        "coefficient of restitution, Coulomb friction that holds at zero rate, and exact gear ratios. Methods without "
        "a setting are polhode's: the solvers of games and robots, reimplemented from their sources.\n\n";
    text +=
        "*Limits*: an arm without gravity hits a stop with 4 rad/s; *late* is the time of the first sample after the "
        "impact minus the exact time of 0.125 s. *Friction*: a pendulum is held at half the limit of its friction for "
        "4 "
        "s. *Gears*: a pendulum geared to a rotor moves for 1 s.\n\n";
    for (const NamedTable& named : findings.tables)
        if (named.name != "scenes")
            text +=
                fmt::format("## {}\n\n{}{}\n", named.title,
                            named.name == "control" ? control_about + control + "\n\n" : "", markdown(page_of(named)));
    text += "## Details for each engine\n\n";
    for (const auto& own : group_by_engine(places)) {
        text += engine_heading(*own.front());
        if (!own.front()->is_available()) continue;
        const std::vector<std::string>& laws = own.front()->report.hello.laws;
        text += fmt::format("Supported laws of joints: {}.\n\n", laws.empty() ? "none" : listed_words(laws));
        if (laws.empty()) continue;
        for (const LawsPlace* place : own)
            text += fmt::format("- `{}` ({}):{}{}{}\n", place->engine->setting, place->setting_description,
                                describe_limits(*place), describe_friction(*place), describe_gears(*place));
        text += "\n";
    }
    text += fmt::format("## Errors for each scene\n\n[This table]({}_scenes.md) lists all errors on all scenes.\n",
                        plan.experiment.name);
    return text;
}

}  // namespace

Findings conclude_engine_joint_laws(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<LawsPlace> places;
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::step || !has_rows(curve, rows)) continue;
        LawsPlace place;
        static_cast<EngineStanding&>(place) = inspect_curve(curve);
        if (has_laws(place)) {
            place.usual = probe_joint_laws(*curve.method, default_engine_step);
            place.fine = probe_joint_laws(*curve.method, fine_step);
        }
        places.push_back(std::move(place));
    }
    Findings findings;
    findings.tables.push_back(laws_table("limits", "Limits", places,
                                         {{"depth", "depth (rad)", &JointLawProbe::depth},
                                          {"rebound", "rebound, exactly 0", &JointLawProbe::rebound},
                                          {"late", "late (s)", &JointLawProbe::late},
                                          {"restitution", "restitution, exactly 0.75", &JointLawProbe::elastic}},
                                         &JointLawProbe::limits_fault));
    findings.tables.push_back(laws_table("friction", "Friction", places,
                                         {{"creep", "creep in 4 s (rad)", &JointLawProbe::creep}},
                                         &JointLawProbe::friction_fault));
    findings.tables.push_back(laws_table("gears", "Gears", places,
                                         {{"mismatch", "error of the ratio of rates", &JointLawProbe::mismatch},
                                          {"geared", "error of the angle (rad)", &JointLawProbe::geared}},
                                         &JointLawProbe::gears_fault));
    std::vector<const Method*> controlled;
    for (const LawsPlace& place : places)
        if (place.engine && place.is_available()) controlled.push_back(place.curve->method);
    const std::vector<ControlErrors> control = measure_control(controlled);
    findings.tables.push_back(control_table(control));
    findings.tables.push_back(contact_scenes_table(plan, rows, {"attitude", "position"}));
    findings.page = laws_page(plan, places, describe_control(control), findings);
    return findings;
}

}  // namespace polhode
