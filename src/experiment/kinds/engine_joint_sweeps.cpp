// The follow-up of the kind `engine_joints`: joint errors of a rope with a heavy end, and time per step against the
// number of links.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/engine_joints.h"
#include "experiment/kinds/kinds.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr double sweep_step = 1.0 / 240;
constexpr std::array mass_ratios{1, 10, 100, 1000};
constexpr std::array chain_lengths{10, 25, 50, 100};

std::string rope_label(int ratio) { return fmt::format("rope 1:{}", ratio); }
std::string chain_label(int links) { return fmt::format("chain of {}", links); }

PlannedScene with_label(Scene scene, const std::string& label) {
    scene.name = label;
    return {label, scene, write_scene(scene)};
}

// mechanisms/rope_mass_ratio with a ball of `ratio` times a link's mass
PlannedScene heavy_rope(int ratio) {
    Scene scene = find_scene("mechanisms/rope_mass_ratio");
    Body& ball = scene.bodies.back().body;
    const double mass = ratio * scene.bodies.front().body.mass, factor = mass / ball.mass;
    ball.mass = mass;
    for (int i = 0; i < 3; ++i) ball.inertia_B[i] = factor * ball.inertia_B[i];
    ball.source = nullptr;
    // light links rotate fast between heavy ends: the truth of one second takes an hour
    scene.duration = 0.25;
    return with_label(std::move(scene), rope_label(ratio));
}

// mechanisms/chain_10 with more links, released near the vertical
PlannedScene hanging_chain(int links) {
    const Scene ten = find_scene("mechanisms/chain_10");
    Scene scene = ten;
    scene.bodies.clear(), scene.joints.clear();
    std::erase_if(scene.loads, [](const Load& load) { return std::holds_alternative<Impulse>(load); });
    // short, because only the cost is measured
    scene.duration = 0.05;
    for (int i = 0; i < links; ++i) {
        const std::size_t like = static_cast<std::size_t>(i % 2);
        NamedBody body = ten.bodies[like];
        body.name = fmt::format("link_{}", i + 1);
        body.body.source = nullptr;
        Joint joint = ten.joints[i == 0 ? 0 : 1 + like];
        if (i > 1) joint.axes = ten.joints[like].axes;
        joint.name = fmt::format("hinge_{}", i + 1), joint.child = body.name;
        joint.parent = i == 0 ? "world" : fmt::format("link_{}", i);
        joint.parent_point = i == 0 ? Vector3<double>() : ten.joints[1].parent_point;
        joint.coordinate[0] = i < 2 ? 0.25 : 0;
        scene.bodies.push_back(std::move(body)), scene.joints.push_back(std::move(joint));
    }
    return with_label(std::move(scene), chain_label(links));
}

const Result* find_sweep_row(const Plan& plan, const std::vector<Result>& rows, const PlannedCurve& curve,
                             const std::string& label) {
    for (const PlannedScene& scene : plan.scenes)
        if (scene.label == label)
            for (const Result* row : select_rows(rows, scene, curve)) return row;
    return nullptr;
}

NamedTable ropes_table(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<ColumnChoice> columns{{"method", "method"}};
    for (const int ratio : mass_ratios)
        columns.push_back({fmt::format("gap_{}", ratio), fmt::format("gap 1:{} (m)", ratio)});
    for (const int ratio : mass_ratios)
        columns.push_back({fmt::format("attitude_{}", ratio), fmt::format("attitude 1:{} (rad)", ratio)});
    columns.push_back({"message", "message"});
    NamedTable named = make_named_table("mass_ratio", "A heavy ball on a rope of ten links", columns);
    for (const PlannedCurve& curve : plan.curves) {
        std::vector<Cell> gaps, attitudes;
        std::string message;
        for (const int ratio : mass_ratios) {
            const Result* row = find_sweep_row(plan, rows, curve, rope_label(ratio));
            const bool succeeded = row && row->status == Status::ok;
            if (row && !succeeded && message.empty()) message = one_line(row->message, 100);
            gaps.push_back(succeeded ? cell_of(row->errors["joint_gap"].max) : Cell());
            attitudes.push_back(succeeded ? cell_of(row->errors["attitude"].max) : Cell());
        }
        std::vector<Cell> cells{std::string(curve.method->name)};
        cells.insert(cells.end(), gaps.begin(), gaps.end());
        cells.insert(cells.end(), attitudes.begin(), attitudes.end());
        cells.push_back(message);
        named.table.rows.push_back(std::move(cells));
    }
    return named;
}

NamedTable step_costs_table(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<ColumnChoice> columns{{"method", "method"}};
    for (const int links : chain_lengths)
        columns.push_back({fmt::format("microseconds_{}", links), fmt::format("{} links (us per step)", links)});
    columns.insert(columns.end(), {{"exponent", "exponent of growth"}, {"message", "message"}});
    NamedTable named = make_named_table("cost", "Time per step against the number of links", columns);
    for (const PlannedCurve& curve : plan.curves) {
        std::vector<Cell> cells{std::string(curve.method->name)};
        std::vector<double> seconds;
        std::string message;
        for (const int links : chain_lengths) {
            const Result* row = find_sweep_row(plan, rows, curve, chain_label(links));
            const bool succeeded = row && row->status == Status::ok && row->seconds_min && row->steps.value_or(0) > 0;
            if (row && !succeeded && message.empty()) message = one_line(row->message, 100);
            if (succeeded) seconds.push_back(*row->seconds_min / static_cast<double>(*row->steps));
            cells.push_back(succeeded ? Cell(1e6 * seconds.back()) : Cell());
        }
        const bool all = seconds.size() == chain_lengths.size();
        cells.push_back(all ? Cell(std::log(seconds.back() / seconds.front()) /
                                   std::log(static_cast<double>(chain_lengths.back()) / chain_lengths.front()))
                            : Cell());
        cells.push_back(message);
        named.table.rows.push_back(std::move(cells));
    }
    return named;
}

Findings conclude_joint_sweeps(const Plan& plan, const std::vector<Result>& rows) {
    const NamedTable ropes = ropes_table(plan, rows), costs = step_costs_table(plan, rows);
    Findings findings{{ropes, costs}};
    const std::string step = step_name(sweep_step);
    findings.page = fmt::format(
        "## Mass ratio\n\nA rope of ten links on ball joints carries a ball of 1 to 1000 times a link's mass at its "
        "end. It is run for 0.25 s at a step of {}. The table lists the largest joint gap and the largest attitude "
        "error.\n\n{}\n",
        step, markdown(page_of(ropes)));
    findings.page += fmt::format(
        "## Cost against the number of links\n\nHanging chains of hinges are run for 0.05 s at a step of {}. The table "
        "lists the time per step and the exponent p of its growth as (number of links)^p from 10 to 100 links.\n\n{}\n",
        step, markdown(page_of(costs)));
    return findings;
}

}  // namespace

Plan joint_sweeps(const Plan& plan) {
    static const ExperimentKind kind{.name = "engine_joints", .reads = {}, .conclude = conclude_joint_sweeps};
    Plan sweeps{plan.experiment, {}, {}, plan.quick};
    sweeps.experiment.kind = &kind, sweeps.experiment.samples = 6;
    // several repeats, since the minimum is used: other work on the machine only adds time
    sweeps.experiment.repeats = plan.quick ? 3 : 9;
    for (const int ratio : mass_ratios) sweeps.scenes.push_back(heavy_rope(ratio));
    for (const int links : chain_lengths) sweeps.scenes.push_back(hanging_chain(links));
    for (const PlannedCurve& curve : plan.curves)
        if (curve.kind == SettingKind::step) sweeps.curves.emplace_back(curve).settings = {sweep_step};
    return sweeps;
}

}  // namespace polhode
