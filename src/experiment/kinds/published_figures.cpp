#include "experiment/kinds/published_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "body/elementary.h"
#include "experiment/kinds/mechanism_figures.h"
#include "integrators/truth/reference.h"
#include "integrators/truth/rounded_decimal.h"
#include "measure/measures.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"
#include "text/decimal.h"

namespace polhode {
namespace {

constexpr int digits_shown = 20;

// The angle of a point of the plane, in (-pi, pi]: the binary64 result, corrected by the remaining angle.
Wide angle_of(const Wide& sine, const Wide& cosine) {
    const Wide guess = std::atan2(static_cast<double>(sine), static_cast<double>(cosine));
    Wide s, c;
    sine_cosine(guess, s, c);
    const Wide size = square_root(sine * sine + cosine * cosine), left = (sine * c - cosine * s) / size;
    return guess + left + left * left * left / 6;
}

/// The truth of a joint with one degree of freedom at the end.
struct JointState {
    Wide coordinate, rate, acceleration;  ///< the coordinate modulo 2 pi
};

struct FinalState {
    std::string fault;  ///< why there is no truth; else empty
    std::map<std::string, JointState> joints;
    std::map<std::string, Vector3<Wide>> forces;  ///< of joints and loops, N
};

// The last sample of the truth in joint coordinates. All joints of the scene must be revolute.
FinalState compute_final_state(const Scene& scene, long samples) {
    const Reference truth = reference(scene, samples);
    if (!truth.available) return {truth.message, {}, {}};
    FinalState end;
    const std::size_t n = scene.bodies.size(), joints = scene.joints.size();
    std::map<std::string, BodyMotion<Wide>> bodies;
    for (std::size_t b = 0; b < n; ++b)
        bodies[scene.bodies[b].name] = true_motion<Wide>(truth.samples[truth.samples.size() - n + b]);
    bodies["world"].q = {1, 0, 0, 0};
    Tree<Wide> tree(scene, bodies_mass_properties<Wide>(scene));
    std::vector<Wide> y(static_cast<std::size_t>(tree.dimension())), rates(y.size());
    const auto place = [&](const Link<Wide>& link) -> JointState& {
        return end.joints[scene.joints[static_cast<std::size_t>(link.joint)].name];
    };
    for (const Link<Wide>& link : tree.links().links) {
        const Joint& joint = scene.joints[static_cast<std::size_t>(link.joint)];
        const BodyMotion<Wide>&parent = bodies[joint.parent], &child = bodies[joint.child];
        const Vector3<Wide> along = cast<Wide>(joint.axes[0]), axis = (1 / length(along)) * along;
        // q_child = q_parent q0 J
        const Quaternion<Wide> turned =
            conjugate(parent.q * normalized(cast<Wide>(joint.parent_orientation))) * child.q;
        const Vector3<Wide> parent_rate = rotate(conjugate(child.q) * parent.q, parent.angular_velocity_B);
        JointState& now = place(link);
        now.coordinate = 2 * angle_of(dot(axis, vector_part(turned)), turned.w);
        now.rate = dot(axis, child.angular_velocity_B - parent_rate);
        y[static_cast<std::size_t>(link.coordinate)] = now.coordinate;
        y[static_cast<std::size_t>(link.rate)] = now.rate;
    }
    tree.set_loads(scene, scene.duration);
    tree.derivative(y.data(), rates.data());
    for (const Link<Wide>& link : tree.links().links)
        place(link).acceleration = rates[static_cast<std::size_t>(link.rate)];
    const auto wide = [](const Pair& p) { return Wide(p.high) + Wide(p.low); };
    const std::size_t last = truth.reactions.size() - joints - scene.loops.size();
    for (std::size_t i = 0; i < joints + scene.loops.size(); ++i) {
        const Vector3<Pair>& force = truth.reactions[last + i].force_W;
        end.forces[i < joints ? scene.joints[i].name : scene.loops[i - joints].name] = {wide(force[0]), wide(force[1]),
                                                                                        wide(force[2])};
    }
    return end;
}

// The angle congruent to `angle` modulo 2 pi that is nearest to `to`.
Wide nearest_turn(const Wide& angle, const Wide& to) {
    const Wide turn = 2 * Elementary<Wide>::pi();
    return angle + turn * Elementary<Wide>::rounded((to - angle) / turn);
}

/// Collects the comparisons of one mechanism.
class FigureComparison {
  public:
    FigureComparison(std::vector<PublishedFigure>& all, std::string mechanism, const FinalState& end)
        : all_(all), mechanism_(std::move(mechanism)), end_(end) {}

    void from(std::string source) { source_ = std::move(source); }
    void add(const std::string& quantity, const std::string& published, Wide computed) {
        PublishedFigure figure{mechanism_, source_, quantity, published, "", {}, {}, {}};
        figure.digits_printed = printed(published);
        if (end_.fault.empty()) {
            const Wide theirs = parse_wide(published), off = Elementary<Wide>::magnitude(theirs - computed);
            figure.computed = format_wide(computed, digits_shown);
            figure.difference = static_cast<double>(off / Elementary<Wide>::magnitude(computed));
            const double right = std::floor(-std::log10(std::max(*figure.difference, 1e-40)));
            figure.correct_digits = std::clamp(static_cast<long>(right), 0L, *figure.digits_printed);
        } else {
            figure.computed = end_.fault;
        }
        all_.push_back(std::move(figure));
    }
    void add(const std::string& quantity, double published, const Wide& computed) {
        add(quantity, shortest_decimal(published), computed);
    }
    /// Adds an angle that is not wrapped; `unit` is the published unit in rad.
    template <class Number>
    void add_angle(const std::string& quantity, const Number& published, const Wide& angle, const Wide& unit = 1) {
        const Wide theirs = unit * parse_wide(text(published));
        add(quantity, text(published), nearest_turn(angle, theirs) / unit);
    }
    JointState joint(const char* name) const { return end_.fault.empty() ? end_.joints.at(name) : JointState{}; }
    Vector3<Wide> force(const char* name) const { return end_.fault.empty() ? end_.forces.at(name) : Vector3<Wide>{}; }

  private:
    std::vector<PublishedFigure>& all_;
    std::string mechanism_, source_;
    const FinalState& end_;

    static std::string text(double value) { return shortest_decimal(value); }
    static std::string text(const char* value) { return value; }
    static long printed(const std::string& number) {
        const std::string mantissa = number.substr(0, number.find('e'));
        const std::size_t first = mantissa.find_first_of("123456789");
        return first == mantissa.npos
                   ? 1
                   : static_cast<long>(std::count_if(mantissa.begin() + static_cast<long>(first), mantissa.end(),
                                                     [](char c) { return c >= '0' && c <= '9'; }));
    }
};

template <class Set>
void add_andrews(FigureComparison& comparison, const Set& set) {
    for (std::size_t j = 0; j < figures::andrews_joints.size(); ++j) {
        const char* name = figures::andrews_joints[j];
        const JointState now = comparison.joint(name);
        comparison.add_angle(fmt::format("{} (rad)", name), set.angles[j], now.coordinate);
        comparison.add(fmt::format("{}' (rad/s)", name), set.rates[j], now.rate);
        comparison.add(fmt::format("{}'' (rad/s^2)", name), set.accelerations[j], now.acceleration);
    }
    for (std::size_t i = 0; i < set.multipliers.size(); ++i)
        comparison.add(fmt::format("lambda_{} (N)", i + 1), set.multipliers[i],
                       comparison.force(figures::andrews_loops[i / 2])[static_cast<int>(i % 2)]);
}

void add_babyboot(FigureComparison& comparison, const figures::BabybootFigures& set) {
    const JointState a = comparison.joint("hinge"), b = comparison.joint("swivel");
    const Wide one_degree = Elementary<Wide>::pi() / 180;
    comparison.add_angle("q_A (deg)", set.q_A, a.coordinate, one_degree);
    comparison.add_angle("q_B (deg)", set.q_B, b.coordinate, one_degree);
    comparison.add("q_A' (rad/s)", set.rate_A, a.rate);
    comparison.add("q_B' (rad/s)", set.rate_B, b.rate);
    comparison.add("q_A'' (rad/s^2)", set.accel_A, a.acceleration);
    comparison.add("q_B'' (rad/s^2)", set.accel_B, b.acceleration);
}

// The double four-bar over 10 s passes singular positions, where its equations lose rank. The uprights stay parallel
// and the bars do not rotate, so that 3 a'' = 3.5 g sin a from a = 0, a' = 1. A pendulum of mass 7 kg, with its centre
// of mass 1/2 m above the hinge and a moment of 3 kg m^2 about it, has the same equation.
Scene make_four_bar_pendulum() {
    Scene scene;
    scene.name = "double_four_bar as a pendulum", scene.duration = 10;
    NamedBody rod;
    rod.name = "rod", rod.body.mass = 7, rod.body.center_of_mass = {0, 0, 0.5};
    rod.body.inertia_B = diagonal(Vector3<double>(1.25, 1.25, 1));
    Joint foot;
    foot.name = "foot", foot.child = "rod", foot.axes[0] = {0, 1, 0}, foot.rate[0] = 1;
    scene.bodies = {rod}, scene.joints = {foot};
    scene.loads = {Gravity{{0, 0, -9.81}, {}}};
    return scene;
}

void add_four_bar(FigureComparison& comparison, const figures::FourBarFigures& set) {
    const JointState foot = comparison.joint("foot");
    Wide sine, cosine;
    sine_cosine(foot.coordinate, sine, cosine);
    comparison.add("x (m)", set.x, sine);
    comparison.add("y (m)", set.z, cosine);
    comparison.add("x' (m/s)", set.vx, cosine * foot.rate);
    comparison.add("y' (m/s)", set.vz, -sine * foot.rate);
}

}  // namespace

std::string format_wide(const Wide& value, int digits) {
    Wide rest = Elementary<Wide>::magnitude(value);
    if (!(rest > 0)) return "0";
    int exponent = static_cast<int>(std::floor(std::log10(static_cast<double>(rest))));
    rest *= power_of_ten(-exponent);
    if (rest >= 10) rest /= 10, ++exponent;
    if (rest < 1) rest *= 10, --exponent;
    std::string all(value < 0 ? "-" : "");
    for (int i = 0; i < 31; ++i) {
        const int digit = std::clamp(static_cast<int>(rest), 0, 9);
        all += static_cast<char>('0' + digit);
        if (i == 0) all += '.';
        rest = 10 * (rest - digit);
    }
    std::string scientific = truth::rounded_decimal(all + "e" + std::to_string(exponent), digits);
    const std::size_t mark = scientific.find('e');
    exponent = std::stoi(scientific.substr(mark + 1));
    if (exponent < -4 || exponent > 8) return scientific;
    std::string plain;
    for (const char c : scientific.substr(0, mark))
        if (c >= '0' && c <= '9') plain += c;
    if (exponent < 0) plain.insert(0, static_cast<std::size_t>(-exponent), '0');
    const std::size_t whole = static_cast<std::size_t>(std::max(exponent, 0)) + 1;
    while (plain.size() < whole) plain += '0';
    if (plain.size() > whole) plain.insert(whole, ".");
    return (value < 0 ? "-" : "") + plain;
}

std::vector<PublishedFigure> compare_figures(bool quick, long samples) {
    std::vector<PublishedFigure> all;
    if (!quick) {
        const FinalState andrews = compute_final_state(find_scene("mechanisms/andrews_squeezer"), samples);
        FigureComparison squeezer(all, "andrews_squeezer", andrews);
        squeezer.from("IVP Test Set 2.4");
        add_andrews(squeezer, figures::andrews_published);
        squeezer.from("equations of the source, extrapolation in 32 digits");
        add_andrews(squeezer, figures::andrews_recomputed);

        const FinalState kane = compute_final_state(find_scene("mechanisms/babyboot"), samples);
        FigureComparison babyboot(all, "babyboot", kane);
        for (const auto& [source, set] : {std::pair{"Drake, expected", figures::babyboot_expected},
                                          std::pair{"Drake, simulation A", figures::babyboot_simulation_a},
                                          std::pair{"Drake, simulation B", figures::babyboot_simulation_b},
                                          std::pair{"Drake, ode45", figures::babyboot_ode45}}) {
            babyboot.from(source);
            add_babyboot(babyboot, set);
        }
        babyboot.from("Kane's two equations, Taylor series in 40 digits");
        const JointState a = babyboot.joint("hinge"), b = babyboot.joint("swivel");
        babyboot.add_angle("q_A (rad)", figures::babyboot_recomputed[0], a.coordinate);
        babyboot.add_angle("q_B (rad)", figures::babyboot_recomputed[1], b.coordinate);
        babyboot.add("q_A' (rad/s)", figures::babyboot_recomputed[2], a.rate);
        babyboot.add("q_B' (rad/s)", figures::babyboot_recomputed[3], b.rate);
    }
    const FinalState pendulum = compute_final_state(make_four_bar_pendulum(), samples);
    FigureComparison four_bar(all, "double_four_bar over 10 s", pendulum);
    four_bar.from("Exudyn");
    add_four_bar(four_bar, figures::double_four_bar_exudyn);
    four_bar.from("quadrature of the pendulum equation");
    add_four_bar(four_bar, figures::double_four_bar_quadrature);
    return all;
}

}  // namespace polhode
