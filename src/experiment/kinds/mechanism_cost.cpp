// The kind `mechanism_cost`: time per evaluation of the right-hand side against the number of links, for chains of
// hinges and of ball joints.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "measure/statistics.h"
#include "motion/mechanism.h"

namespace polhode {
namespace {

constexpr long link_counts[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
constexpr double batch_seconds = 1e-3;  // shortest batch of evaluations that is timed

// A hanging chain of links of 1/8 kg and 1/8 m, bent slightly at every joint, so that no term vanishes. Successive
// hinges are perpendicular, as in mechanisms/chain_10.
Scene chain_of(long links, JointType type) {
    Scene scene;
    scene.name = fmt::format("chain of {} links", links), scene.duration = 1;
    scene.loads = {Gravity{{0, 0, -9.81}, {}}};
    for (long i = 0; i < links; ++i) {
        NamedBody link;
        link.name = fmt::format("link_{}", i + 1);
        link.body.mass = 0.125;
        link.body.inertia_B = diagonal(Vector3<double>(1.7e-4, 1.6e-4, 1e-5));
        Joint joint;
        joint.name = fmt::format("joint_{}", i + 1), joint.type = type;
        joint.child = link.name, joint.child_point = {0, 0, 0.0625};
        if (i > 0) joint.parent = scene.bodies.back().name, joint.parent_point = {0, 0, -0.0625};
        const double bend = 0.02 * static_cast<double>(i % 7 - 3);
        joint.axes[0] = i % 2 == 0 ? Vector3<double>{0, 1, 0} : Vector3<double>{1, 0, 0};
        joint.coordinate[0] = bend, joint.rate[0] = bend;
        joint.orientation = {std::cos(bend), std::sin(bend), 0, 0};
        joint.angular_velocity = {bend, 2 * bend, -bend};
        scene.bodies.push_back(std::move(link)), scene.joints.push_back(std::move(joint));
    }
    return scene;
}

/// A chain in its initial state, and the measured times of its right-hand side.
struct TimedChain {
    const char* joint;
    long links;
    Tree<double> tree;
    std::vector<double> y, dy;
    long evaluations = 1;           ///< per batch
    std::vector<double> seconds{};  ///< per evaluation, one value per round

    TimedChain(const char* name, const Scene& scene)
        : joint(name),
          links(static_cast<long>(scene.bodies.size())),
          tree(loaded(scene)),
          y(static_cast<std::size_t>(tree.dimension())),
          dy(y.size()) {
        tree.initial(y.data());
    }
    double batch() {
        const auto begin = std::chrono::steady_clock::now();
        for (long i = 0; i < evaluations; ++i) tree.derivative(y.data(), dy.data());
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }

  private:
    static Tree<double> loaded(const Scene& scene) {
        Tree<Wide> exact(scene, bodies_mass_properties<Wide>(scene));
        exact.set_loads(scene, 0);
        return Tree<double>(exact);
    }
};

}  // namespace

Findings run_mechanism_cost(const Plan& plan, const RunOptions& options) {
    std::vector<TimedChain> chains;
    for (const auto& [name, type] : {std::pair{"revolute", JointType::revolute}, {"spherical", JointType::spherical}})
        for (const long links : link_counts) chains.emplace_back(name, chain_of(links, type));
    // warm up, and find the number of evaluations per batch
    for (TimedChain& chain : chains) {
        double seconds = chain.batch();
        while (seconds < batch_seconds) {
            chain.evaluations *= 2;
            seconds = chain.batch();
        }
    }
    const int rounds = options.quick ? 20 : 20 * plan.experiment.repeats;
    for (int round = 0; round < rounds; ++round)
        for (TimedChain& chain : chains)
            chain.seconds.push_back(chain.batch() / static_cast<double>(chain.evaluations));

    NamedTable table = make_named_table("", "",
                                        {{"joint", "joints"},
                                         {"links", "links"},
                                         {"variables", "variables"},
                                         {"microseconds_min", "time (us)"},
                                         {"microseconds_median", "median (us)"},
                                         {"nanoseconds_per_link", "ns per link"},
                                         {"median_per_link", ""},
                                         {"over_100_links", "relative to 100 links"},
                                         {"evaluations", ""}});
    NamedFigure figure{"mechanism_cost", {"Time per evaluation of the right-hand side of a chain", 1, {}, ""}};
    Panel panel{"", "links", "time per link (ns)", true, true, {}};
    const auto least_of = [](const TimedChain& chain) {
        return *std::min_element(chain.seconds.begin(), chain.seconds.end());
    };
    const auto per_link = [&](const TimedChain& chain) {
        return 1e9 * least_of(chain) / static_cast<double>(chain.links);
    };
    for (const TimedChain& chain : chains) {
        const auto hundred = std::find_if(chains.begin(), chains.end(), [&](const TimedChain& other) {
            return other.joint == chain.joint && other.links == 100;
        });
        const double middle = median(chain.seconds);
        table.table.rows.push_back(
            {std::string(chain.joint), chain.links, static_cast<long>(chain.y.size()), 1e6 * least_of(chain),
             1e6 * middle, per_link(chain), 1e9 * middle / static_cast<double>(chain.links),
             per_link(chain) / per_link(*hundred), static_cast<long>(chain.seconds.size()) * chain.evaluations});
        Curve& curve = find_or_add_curve(panel.curves, chain.joint);
        curve.x.push_back(static_cast<double>(chain.links)), curve.y.push_back(per_link(chain));
    }
    figure.figure.panels.push_back(std::move(panel));
    return {{std::move(table)}, {std::move(figure)}};
}

}  // namespace polhode
