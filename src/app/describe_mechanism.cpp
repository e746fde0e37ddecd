// The description of a scene of several bodies: overview, the tree of joints as an indented list, loops, initial state,
// loads, the system posed and omitted variables. Description blocks shared with one body are in description.cpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "app/description.h"
#include "body/fast_principal_frame.h"
#include "integrators/truth/reference.h"
#include "motion/conserved_by_mechanism.h"
#include "motion/formula_mechanism.h"
#include "motion/mechanism.h"
#include "motion/mechanism_motion.h"
#include "scene/joint_file.h"
#include "text/message.h"

namespace polhode {
namespace {

using namespace description;

// values below 1e-15 are rounding errors of zero
std::string brief(double value) { return fmt::format("{:.6g}", std::abs(value) < 1e-15 ? 0 : value); }
std::string brief(const Vector3<double>& v) {
    return fmt::format("({}, {}, {})", brief(v[0] + 0.0), brief(v[1] + 0.0), brief(v[2] + 0.0));
}
std::string format_count(std::size_t count, const char* noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

// "3: 2 revolute, 1 fixed"
template <class Parts>
std::string kinds_of(const Parts& parts) {
    if (parts.empty()) return "none";
    std::vector<std::pair<std::string, int>> kinds;
    for (const auto& part : parts) {
        const auto at = std::ranges::find(kinds, name_of(part.type), &std::pair<std::string, int>::first);
        if (at == kinds.end())
            kinds.emplace_back(name_of(part.type), 1);
        else
            ++at->second;
    }
    std::vector<std::string> words;
    for (const auto& [kind, count] : kinds) words.push_back(fmt::format("{} {}", count, kind));
    return fmt::format("{}: {}", parts.size(), fmt::join(words, ", "));
}

// Returns the coordinates and rates of a joint at t = 0, its spring and its damper.
std::string state_of(const Scene& scene, const Tree<double>& tree, std::size_t j, const std::vector<double>& y) {
    const Joint& joint = scene.joints[j];
    const int last = tree.links().link_of_joint[j];
    std::string text;
    const auto link = [&](int i) -> const Link<double>& { return tree.links().links[static_cast<std::size_t>(i)]; };
    const auto at = [&](int i) { return brief(y[static_cast<std::size_t>(i)] + 0.0); };
    switch (joint.type) {
        case JointType::revolute:
            text = fmt::format("at {} rad, {} rad/s", at(link(last).coordinate), at(link(last).rate));
            break;
        case JointType::prismatic:
            text = fmt::format("at {} m, {} m/s", at(link(last).coordinate), at(link(last).rate));
            break;
        case JointType::universal:
            text = fmt::format("at {} and {} rad, {} and {} rad/s", at(link(last - 1).coordinate),
                               at(link(last).coordinate), at(link(last - 1).rate), at(link(last).rate));
            break;
        case JointType::spherical:
            text = fmt::format("rotating at {} rad/s, child axes", brief(joint.angular_velocity));
            break;
        case JointType::fixed:
            break;
    }
    const auto both = [&](const std::array<double, 2>& k) {
        return joint.type == JointType::universal ? brief(k[0]) + " and " + brief(k[1]) : brief(k[0]);
    };
    if (joint.stiffness[0] != 0 || joint.stiffness[1] != 0) text += "; spring " + both(joint.stiffness);
    if (joint.damping[0] != 0 || joint.damping[1] != 0) text += "; damping " + both(joint.damping);
    if (joint.armature[0] != 0 || joint.armature[1] != 0) text += "; armature " + both(joint.armature);
    if (joint.friction != 0) text += "; friction " + brief(joint.friction);
    if (joint.limits.any())
        text += fmt::format("; limits {} to {}, restitution {}", brief(joint.limits.lower), brief(joint.limits.upper),
                            brief(joint.limits.restitution));
    if (!joint.motion.empty()) text += "; prescribed: " + one_line(joint.motion, 60);
    for (const Coupling& coupling : scene.couplings)
        if (coupling.second == joint.name)
            text += fmt::format("; = {} times {} + {}", brief(coupling.ratio), one_line(coupling.first, 26),
                                brief(coupling.offset));
    if (joint.dependent) text += "; adjusted until the loops close";
    return text;
}

std::string axis_of(const Joint& joint) {
    switch (joint.type) {
        case JointType::revolute:
            return "revolute about " + brief(joint.axes[0]);
        case JointType::prismatic:
            return "prismatic along " + brief(joint.axes[0]);
        case JointType::universal:
            return fmt::format("universal about {} and {}", brief(joint.axes[0]), brief(joint.axes[1]));
        case JointType::spherical:
            return "spherical";
        case JointType::fixed:
            break;
    }
    return "fixed";
}

// Prints the tree, each child below its parent. Long trees are truncated.
class Drawing {
  public:
    Drawing(Report& report, const Problem& problem) : report_(report), scene_(problem.scene), tree_(tree_of(problem)) {
        start_.resize(static_cast<std::size_t>(tree_.dimension()));
        tree_.initial(start_.data());
        children_.resize(scene_.bodies.size() + 1);
        for (std::size_t j = 0; j < scene_.joints.size(); ++j) children_[at(scene_.joints[j].parent)].push_back(j);
    }

    void draw() {
        report_.title("Tree: joint, type and axis in the child's axes -> child, mass");
        if (!children_[0].empty()) {
            report_.line("world");
            below(0);
        }
        for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
            if (tree_.links().carrier[b] < 0) {
                line(0, fmt::format("{}, {} kg, free: six degrees of freedom", name(scene_.bodies[b].name),
                                    number(scene_.bodies[b].body.mass)));
                below(b + 1);
            }
        if (lines_ > most_lines) report_.line(fmt::format(".. {} more", lines_ - most_lines));
    }

  private:
    // limits of the output for large trees
    static constexpr std::size_t most_lines = 60, most_indent = 24;

    Report& report_;
    const Scene& scene_;
    const Tree<double>& tree_;
    std::vector<double> start_;
    std::vector<std::vector<std::size_t>> children_;
    std::size_t lines_ = 0;

    static std::string name(const std::string& words) { return one_line(words, 60); }
    std::size_t at(const std::string& body) const { return static_cast<std::size_t>(body_index(scene_, body)) + 1; }

    void line(std::size_t depth, const std::string& words) {
        if (++lines_ > most_lines) return;
        const std::string indent = depth <= most_indent
                                       ? std::string(2 * depth, ' ')
                                       : fmt::format("{}[{}] ", std::string(2 * most_indent, ' '), depth);
        report_.line(indent + words);
    }
    void below(std::size_t root) {
        // explicit stack of (joint, depth): recursion would be deep for long chains
        std::vector<std::pair<std::size_t, std::size_t>> still;
        const auto push = [&](std::size_t body, std::size_t depth) {
            for (std::size_t k = children_[body].size(); k-- > 0;) still.emplace_back(children_[body][k], depth);
        };
        push(root, 1);
        while (!still.empty()) {
            const auto [j, depth] = still.back();
            still.pop_back();
            const Joint& joint = scene_.joints[j];
            const std::size_t child = at(joint.child);
            const std::string state = state_of(scene_, tree_, j, start_);
            line(depth, fmt::format("{}: {} -> {}, {} kg{}", name(joint.name), axis_of(joint), name(joint.child),
                                    number(scene_.bodies[child - 1].body.mass), state.empty() ? "" : "; " + state));
            push(child, depth + 1);
        }
    }
};

std::size_t mobility(const Tree<double>& tree) {
    return static_cast<std::size_t>(tree.links().rates) - tree.independent_loop_rows();
}

void overview(Report& report, const Problem& problem) {
    const Scene& scene = problem.scene;
    const Tree<double>& tree = tree_of(problem);
    double mass = 0;
    for (const NamedBody& body : scene.bodies) mass += body.body.mass;
    report.title("Mechanism");
    report.line("bodies", fmt::format("{}, total mass {} kg", scene.bodies.size(), number(mass)));
    report.line("joints", kinds_of(scene.joints));
    report.line("loops", kinds_of(scene.loops));
    const std::size_t rates = static_cast<std::size_t>(tree.links().rates);
    if (!scene.couplings.empty())
        report.line("couplings", format_count(scene.couplings.size(), "constraint of joint coordinates"));
    report.line("degrees of freedom", scene.loops.empty() && scene.couplings.empty()
                                          ? std::to_string(rates)
                                          : fmt::format("{}: {} of the tree minus {} removed by loops and couplings",
                                                        mobility(tree), rates, tree.independent_loop_rows()));
}

void loops(Report& report, const Problem& problem) {
    const Scene& scene = problem.scene;
    if (scene.loops.empty()) return;
    const Tree<double>& tree = tree_of(problem);
    report.title("Loops");
    int begin = 0;
    for (std::size_t i = 0; i < scene.loops.size(); ++i) {
        const Loop& loop = scene.loops[i];
        const int rows = tree.loops()[i].rows();
        const auto chosen =
            std::ranges::count_if(tree.chosen_rows(), [&](int row) { return row >= begin && row < begin + rows; });
        begin += rows;
        report.line(one_line(loop.name, 26),
                    fmt::format("{}, {} - {}: {}, {} used", name_of(loop.type), loop.first, loop.second,
                                format_count(static_cast<std::size_t>(rows), "condition"), chosen));
    }
    const std::size_t all = tree.loop_rows(), independent = tree.independent_loop_rows();
    report.line("all loops", fmt::format("{}: {} independent at the start, {} redundant",
                                         format_count(all, "condition"), independent, all - independent));
    report.line("mobility", fmt::format("{}: {} of the tree minus {} independent loop conditions", mobility(tree),
                                        tree.links().rates, independent));
}

void start(Report& report, const Problem& problem) {
    const Scene& scene = problem.scene;
    constexpr std::size_t most_bodies = 60;
    report.title("Bodies at the start: mass properties, centre of mass and motion, world axes");
    const std::vector<BodyMotion<double>> motions = mechanism_initial_motions(scene);
    for (std::size_t b = 0; b < std::min(most_bodies, motions.size()); ++b) {
        const Body& body = scene.bodies[b].body;
        const BodyMotion<double>& m = motions[b];
        report.line(one_line(scene.bodies[b].name, 26),
                    fmt::format("{} kg, principal moments {} kg m^2; at {} m", number(body.mass),
                                brief(fast_principal_frame(body.inertia_B).moments), brief(m.position_W)));
        report.line("",
                    fmt::format("v {} m/s, w {} rad/s", brief(m.velocity_W), brief(rotate(m.q, m.angular_velocity_B))));
    }
    if (motions.size() > most_bodies) report.line(fmt::format(".. {} more", motions.size() - most_bodies));
}

void system_of(Report& report, const Problem& problem) {
    const Tree<double>& tree = tree_of(problem);
    report.title("System posed");
    report.line("system",
                fmt::format("{}, {} variables: {} and {}", name_of(problem.needs.system), tree.dimension(),
                            format_count(static_cast<std::size_t>(tree.links().coordinates), "joint coordinate"),
                            format_count(static_cast<std::size_t>(tree.links().rates), "rate")));
    if (has_formula_loads(problem.scene))
        report.line("",
                    fmt::format("and the time, with {} for formulas",
                                format_count(static_cast<std::size_t>(problem.needs.dimension - tree.dimension() - 1),
                                             "auxiliary variable")));
    report.line("equations", "articulated-body recursion (Featherstone 2008) in joint coordinates");
    if (has_formula_loads(problem.scene)) formulas(report, problem);
    if (tree.has_loops())
        report.line("", "loops: multipliers on accelerations; positions and rates are projected after each step");
    std::vector<std::string> events;
    // sampled formulas have an event per sample
    constexpr std::size_t most_events = 60;
    for (std::size_t k = 1; k < std::min(problem.segments.size(), most_events); ++k)
        events.push_back(number(problem.segments[k].begin));
    if (problem.segments.size() > most_events)
        events.push_back(fmt::format(".. {} more", problem.segments.size() - most_events));
    if (!events.empty())
        report.line("events at", fmt::format("{} s: loads change or impulses act", join_with_commas(events)));
}

void add_omissions(Report& report, const Problem& problem) {
    const Scene& scene = problem.scene;
    const Links<double>& links = tree_of(problem).links();
    report.title("Omitted, and why");
    const std::size_t full = 13 * scene.bodies.size(), taken = static_cast<std::size_t>(problem.needs.dimension);
    if (full > taken)
        report.line(format_count(full - taken, "variable"),
                    fmt::format("eliminated by joints, of the {} of free bodies", full));
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        if (links.carrier[b] < 0) continue;
        const Joint& joint = scene.joints[static_cast<std::size_t>(links.carrier[b])];
        if (links.bodies[b].link == world_link)
            report.line(one_line(joint.child, 26), "does not move: fixed to the world");
        else if (joint.type == JointType::fixed)
            report.line(one_line(joint.child, 26), fmt::format("merged with {} by the fixed joint {}",
                                                               one_line(joint.parent, 60), one_line(joint.name, 60)));
    }
    const bool free_base = std::ranges::any_of(links.carrier, [](int joint) { return joint < 0; });
    if (!free_base)
        report.line("p and v of the base",
                    "the base is jointed to the world: joint coordinates determine its position");
    if (const auto normal = plane_of_motion(problem))
        report.line("the third dimension",
                    fmt::format("all bodies move in planes normal to {}: taylor's recorded right-hand side omits the "
                                "terms that are zero",
                                brief(*normal)));
    const Tree<double>& tree = tree_of(problem);
    const std::size_t redundant = tree.loop_rows() - tree.independent_loop_rows();
    if (redundant > 0) report.line(format_count(redundant, "loop condition"), "implied by the other conditions");
    const bool all_free = std::ranges::all_of(links.carrier, [](int joint) { return joint < 0; });
    if (full <= taken && all_free && redundant == 0) report.line("nothing");
}

// Lists the constructs that the import of a robot does not model, and the values that it assumed.
void import_notes(Report& report, const Scene& scene) {
    const auto list = [&](const char* title, const std::vector<std::string>& phrases) {
        if (phrases.empty()) return;
        report.title(title);
        for (const std::string& phrase : phrases) report.line(one_line(phrase, 500));
    };
    list("Constructs of the robot file that are not modelled", scene.omitted);
    list("Assumptions of the import", scene.assumed);
}

}  // namespace

void description::mechanism(Report& report, const Problem& problem) {
    overview(report, problem);
    Drawing(report, problem).draw();
    loops(report, problem);
    start(report, problem);
    loads(report, problem.scene);
    system_of(report, problem);
    add_omissions(report, problem);
    import_notes(report, problem.scene);
    choice(report, problem);
    report.title("Truth");
    report.line("computed by", std::string(truth_method(problem)) +
                                   " in joint coordinates and, by independent code, in maximal coordinates with "
                                   "multipliers");
    invariants(report, problem,
               has_formula_loads(problem.scene) ? "none known: symmetries of formulas are not searched"
                                                : "none known: loads or joints change energy and momenta");
}

}  // namespace polhode
