// Sensitivities by dual numbers.
//
// VariedTree is the tree whose constants are dual numbers, with the scene's formula loads (motion/formula_tree.h);
// TreeConstants lists the constants of a tree in a fixed order, so that those of three trees can be paired.
// VariationalRun integrates and samples.
//
// Where the equations change at a time T that depends on p, S jumps by (f- - f+) dT/dp, with the rates f- before and f+
// after T. At an event given by its time, such as an impulse, dT/dp is that of the time, and the change between f- and
// f+ applies to y + f- dT. A switch of a formula changes where its argument g reaches the threshold: dT/dp =
// -(dg/dp) / (dg/dt) at constant t (Hairer, Norsett & Wanner 1993, Solving Ordinary Differential Equations I, II.6).
#include "integrators/analysis/sensitivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "integrators/own/dormand_prince.h"
#include "integrators/run/processor_time.h"
#include "motion/dual.h"
#include "motion/formula_mechanism.h"
#include "motion/formula_switches.h"
#include "motion/formula_tree.h"
#include "motion/itinerary.h"
#include "motion/mechanism.h"
#include "motion/tree.h"
#include "text/interruption.h"

namespace polhode {
namespace {

constexpr std::size_t columns = 8;
using Varied = Dual<static_cast<int>(columns)>;

}  // namespace

// Whether a constant is zero with all its derivatives, for the recursion, which omits springs of zero stiffness.
static bool operator==(const Varied& a, const Varied& b) { return a.value == b.value && a.slope == b.slope; }

namespace {

// The constants of a tree that its equations use, in a fixed order.
template <class P>
class TreeConstants {
  public:
    void add(Links<P>& links) {
        for (Link<P>& link : links.links) {
            add(link.q_placement), add(link.turn), add(link.place), add(link.mass), add(link.moment);
            add(link.inertia), add(link.stiffness), add(link.rest), add(link.damping), add(link.rest_orientation);
            add(link.armature);
        }
        for (LinkBody<P>& body : links.bodies) add(body.q), add(body.turn), add(body.origin), add(body.center);
    }
    void add(std::vector<LinkLoop<P>>& loops) {
        for (LinkLoop<P>& loop : loops) {
            add(loop.first.point), add(loop.second.point), add(loop.across[0]), add(loop.across[1]);
            add(loop.second_axis), add(loop.length), add(loop.ratio), add(loop.offset);
        }
    }
    // Values of formulas that depend on no input, and the points of their forces.
    void add(FormulaTree<P>& formulas) {
        for (P& value : formulas.terms().uniform_values()) add(value);
        for (Vector3<P>& point : formulas.points()) add(point);
    }
    void add(LinkLoads<P>& loads) {
        add(loads.gravity_W);
        for (auto& one : loads.constant) add(one.load.turning), add(one.load.linear);
        for (auto& one : loads.in_world) add(one.torque_W), add(one.force_W), add(one.point);
        for (auto& one : loads.at_world_points) add(one.force), add(one.point_W);
        for (auto& one : loads.drags) add(one.rotational), add(one.translational), add(one.center);
        for (auto& one : loads.springs) add(one.stiffness), add(one.q), add(one.rest);
        for (auto& one : loads.between)
            add(one.first.point), add(one.second.point), add(one.stiffness), add(one.rest_length);
        for (P& motor : loads.motors) add(motor);
    }

    const std::vector<P*>& all() const { return all_; }

  private:
    std::vector<P*> all_;

    void add(P& number) { all_.push_back(&number); }
    void add(Vector3<P>& v) {
        for (P& number : v.component) add(number);
    }
    void add(Quaternion<P>& q) { add(q.w), add(q.x), add(q.y), add(q.z); }
    void add(Matrix3<P>& m) {
        for (Vector3<P>& row : m.row) add(row);
    }
    void add(Symmetric3<P>& m) { add(m.xx), add(m.yy), add(m.zz), add(m.xy), add(m.xz), add(m.yz); }
};

template <class Part>
std::vector<Wide> constants_of(Part part) {
    TreeConstants<Wide> constants;
    constants.add(part);
    std::vector<Wide> values;
    for (const Wide* number : constants.all()) values.push_back(*number);
    return values;
}

// A scene of one body as a tree of one link: a free base, or a ball joint at the pivot.
Scene as_mechanism(const Scene& scene) {
    if (is_mechanism(scene)) return scene;
    Scene tree = scene;
    const std::string name = "body";
    tree.bodies.push_back({name, scene.body, scene.initial});
    tree.body = {}, tree.initial = {};
    tree.pivot.reset();
    if (scene.pivot) {
        Joint joint;
        joint.name = "pivot", joint.type = JointType::spherical, joint.child = name;
        joint.child_point = *scene.pivot, joint.orientation = scene.initial.orientation;
        joint.angular_velocity = scene.initial.angular_velocity;
        tree.joints.push_back(joint);
    }
    for (Load& load : tree.loads)
        std::visit(
            [&](auto& one) {
                if constexpr (requires { one.body; }) one.body = name;
            },
            load);
    return tree;
}

std::string unsupported_part(const Scene& scene) {
    if (const std::string part = part_with_events(scene); !part.empty()) return part + " are not supported";
    for (const Load& load : scene.loads)
        if (std::holds_alternative<UserTorque>(load)) return "user-defined torques are not supported";
    return "";
}

// An exact tree with its scene.
struct ExactTree {
    explicit ExactTree(const Scene& any)
        : scene(as_mechanism(any)),
          form(scene, compile_formulas(scene, scene.name), bodies_mass_properties<Wide>(scene)),
          start(any.initial),
          times(event_times(any)) {
        rates_in_world = any.pivot && start.angular_velocity_frame == Frame::world;
    }

    std::vector<Wide> initial() const {
        std::vector<Wide> y(static_cast<std::size_t>(form.dimension()));
        form.initial(y.data());
        if (!rates_in_world) return y;
        const Link<Wide>& link = tree().links().links.front();
        const Quaternion<Wide> q = normalized(cast<Wide>(start.orientation));
        const Vector3<Wide> w_B = rotate_back(q, cast<Wide>(start.angular_velocity));
        for (std::size_t i = 0; i < 3; ++i) y[static_cast<std::size_t>(link.rate) + i] = w_B[i];
        return y;
    }

    const Tree<Wide>& tree() const { return form.tree(); }

    Scene scene;
    FormulaTree<Wide> form;
    Initial start;
    std::vector<double> times;    // of events, s
    bool rates_in_world = false;  // a pivoted body whose initial angular velocity is given in world axes
};

// The tree with dual constants, for at most `columns` changes.
class VariedTree {
  public:
    VariedTree(const Scene& scene, std::span<const SceneChange> changes)
        : base_(scene), rounded_(base_.form), form_(rounded_) {
        for (const SceneChange& change : changes)
            sides_.push_back({ExactTree(change.ahead), ExactTree(change.behind), change.by});
        // the tree is not const; its accessors are
        auto& links = const_cast<Links<Varied>&>(tree().links());                  // NOLINT
        auto& loops = const_cast<std::vector<LinkLoop<Varied>>&>(tree().loops());  // NOLINT
        TreeConstants<Varied> constants;
        constants.add(links);
        set_slopes(constants, [](const ExactTree& side) { return constants_of(side.tree().links()); });
        TreeConstants<Varied> of_loops;
        of_loops.add(loops);
        set_slopes(of_loops, [](const ExactTree& side) { return constants_of(side.tree().loops()); });
        TreeConstants<Varied> of_formulas;
        of_formulas.add(form_);
        set_slopes(of_formulas, [](const ExactTree& side) { return constants_of(side.form); });
    }

    // Why the derivative does not exist; empty if it does.
    const std::string& fault() const { return fault_; }
    const Tree<Varied>& tree() const { return form_.tree(); }
    // With the branches of the current signs of switches.
    void derivative(const Varied* y, Varied* dy) const { form_.derivative_by(y, dy, true); }

    std::vector<Varied> initial() {
        std::vector<Varied> y = varied(base_.initial());
        std::vector<Varied*> numbers;
        for (Varied& number : y) numbers.push_back(&number);
        set_slopes(numbers, [](const ExactTree& side) { return side.initial(); });
        return y;
    }

    // Processes the event at the start of a leg: applies its impulses to y, sets the loads that act from then on, and
    // samples the values that are held.
    void enter(const Leg& leg, std::vector<Varied>& y) {
        const std::array<double, columns> shift = shifts_of(leg.index);
        const bool shifts = shift != std::array<double, columns>{};
        if (shifts) add_motion(y, shift, 1);
        apply_impulses(leg, y);
        const std::size_t time = static_cast<std::size_t>(form_.time_index());
        y[time] = Varied(leg.begin);
        y[time].slope = shift;
        set_loads(leg);
        if (!fault_.empty()) return;
        form_.terms().sample(
            leg.begin, [&] { return form_.formula_state(y.data()); }, y.data() + time + 1);
        std::vector<double> values = values_of(y);
        FormulaSwitches<FormulaTree<double>>(rounded_, base_.scene.duration).resolve_signs(values.data());
        copy_signs();
        if (shifts) add_motion(y, shift, -1);
        y[time].slope = {};
        require_distance(y);
    }

    // Switches of the formulas that act, under the current signs.
    bool has_switches() const { return !form_.terms().active_switches().empty(); }
    // For each, the distance of its argument from the threshold on its present side, with the derivative at constant
    // time; infinite if it stays there.
    std::vector<Varied> distances(const std::vector<Varied>& y) const {
        std::vector<Varied> all = form_.switch_arguments(y.data());
        const std::vector<int>& active = form_.terms().active_switches();
        for (std::size_t k = 0; k < active.size(); ++k) {
            const double sign = form_.terms().sign(active[k]);
            all[k] = sign == 0 ? Varied(std::numeric_limits<double>::infinity())
                               : sign * (all[k] - form_.terms().switch_threshold(active[k]));
        }
        return all;
    }
    // Changes the sign of the k-th of them at the state y, at which its argument is at the threshold. Returns why the
    // motion or its derivative does not continue, or an empty string.
    std::string cross(std::size_t k, std::vector<Varied>& y) {
        const int which = form_.terms().active_switches()[k];
        const Varied distance = distances(y)[k];
        std::vector<double> values = values_of(y);
        const double approach = form_.terms().sign(which) * rounded_.switch_rate(which, values.data());
        const std::vector<double> before = rates_of(values);
        std::string fault = FormulaSwitches<FormulaTree<double>>(rounded_, 0).cross(which, values.data());
        copy_signs();
        if (!fault.empty()) return fault;
        if (approach == 0)
            return fmt::format("the argument of \"{}\" only touches its threshold", form_.terms().switch_text(which));
        const std::vector<double> after = rates_of(values);
        for (std::size_t c = 0; c < columns; ++c) {
            const double shift = -distance.slope[c] / approach;
            for (std::size_t i = 0; i < y.size(); ++i) y[i].slope[c] += (before[i] - after[i]) * shift;
        }
        return "";
    }

    // Projects y onto the closed loops.
    void project(std::vector<Varied>& y) const {
        if (!tree().has_loops()) return;
        std::vector<double> values = values_of(y);
        rounded_.tree().project(values.data());
        for (std::size_t i = 0; i < y.size(); ++i) y[i].value = values[i];
    }

  private:
    struct Side {
        ExactTree ahead, behind;
        double by;
    };

    ExactTree base_;
    FormulaTree<double> rounded_;
    FormulaTree<Varied> form_;
    std::vector<Side> sides_;
    std::string fault_;

    static std::vector<Varied> varied(const std::vector<Wide>& values) {
        std::vector<Varied> y;
        for (const Wide& value : values) y.emplace_back(static_cast<double>(value));
        return y;
    }

    template <class Values>
    void set_slopes(const TreeConstants<Varied>& constants, const Values& values) {
        set_slopes(constants.all(), values);
    }
    // Sets the slopes of `numbers`, of which values(tree) are the exact values in each tree.
    template <class Values>
    void set_slopes(const std::vector<Varied*>& numbers, const Values& values) {
        for (std::size_t c = 0; c < sides_.size(); ++c) {
            const std::vector<Wide> ahead = values(sides_[c].ahead), behind = values(sides_[c].behind);
            if (ahead.size() != numbers.size() || behind.size() != numbers.size()) {
                fault_ = "the number of loads changes with it";
                continue;
            }
            for (std::size_t i = 0; i < numbers.size(); ++i) {
                const double slope = static_cast<double>((ahead[i] - behind[i]) / Wide(sides_[c].by));
                // the axes of a link jump where an axis passes through a coordinate axis
                if (std::abs(slope) * sides_[c].by > 1e-3 * (1 + std::abs(numbers[i]->value)))
                    fault_ = "the axes of a joint's frame jump there";
                numbers[i]->slope[c] = slope;
            }
        }
    }

    static std::vector<double> values_of(const std::vector<Varied>& y) {
        std::vector<double> values;
        for (const Varied& number : y) values.push_back(number.value);
        return values;
    }
    std::vector<double> rates_of(const std::vector<double>& y) const {
        std::vector<double> dy(y.size());
        rounded_.derivative_by(y.data(), dy.data(), true);
        return dy;
    }
    // The derivatives of the time of an event.
    std::array<double, columns> shifts_of(std::size_t event) const {
        std::array<double, columns> all{};
        for (std::size_t c = 0; c < sides_.size(); ++c)
            all[c] = (sides_[c].ahead.times[event] - sides_[c].behind.times[event]) / sides_[c].by;
        return all;
    }
    // Adds `factor` times the present motion over the shifts of an event's time to the derivatives.
    void add_motion(std::vector<Varied>& y, const std::array<double, columns>& shift, double factor) const {
        const std::vector<double> rates = rates_of(values_of(y));
        for (std::size_t i = 0; i < y.size(); ++i)
            for (std::size_t c = 0; c < columns; ++c) y[i].slope[c] += factor * shift[c] * rates[i];
    }
    void set_loads(const Leg& leg) {
        rounded_.tree().convert_loads(base_.tree().loads_at(base_.scene, leg.begin));
        rounded_.terms().enter(leg.begin);
        form_.terms().enter(leg.begin);
        LinkLoads<Varied> loads = cast<Varied>(rounded_.tree().loads());
        TreeConstants<Varied> constants;
        constants.add(loads);
        set_slopes(constants, [&](const ExactTree& side) {
            return constants_of(side.tree().loads_at(side.scene, side.times[leg.index]));
        });
        form_.tree().convert_loads(loads);
    }
    void copy_signs() {
        const int count = static_cast<int>(form_.terms().set().expression.switches().size());
        for (int which = 0; which < count; ++which) form_.terms().set_sign(which, rounded_.terms().sign(which));
    }
    // A motion that stays at the threshold of a switch leaves it with a change of a number.
    void require_distance(const std::vector<Varied>& y) {
        const std::vector<Varied> arguments = form_.switch_arguments(y.data());
        const std::vector<int>& active = form_.terms().active_switches();
        for (std::size_t k = 0; k < active.size(); ++k) {
            if (form_.terms().sign(active[k]) != 0) continue;
            const Varied distance = arguments[k] - form_.terms().switch_threshold(active[k]);
            if (std::ranges::any_of(distance.slope, [](double slope) { return slope != 0; }))
                fault_ = fmt::format("the argument of \"{}\" stays at its threshold, where the derivative jumps",
                                     form_.terms().switch_text(active[k]));
        }
    }

    void apply_impulses(const Leg& leg, std::vector<Varied>& y) const {
        std::vector<Wide> values;
        for (const Varied& number : y) values.push_back(Wide(number.value));
        std::vector<Wide> after = values;
        if (!base_.tree().apply_impulses(base_.scene, leg.begin, after.data())) return;
        for (std::size_t i = 0; i < y.size(); ++i) y[i].value = static_cast<double>(after[i]);
        for (std::size_t c = 0; c < sides_.size(); ++c) {
            const Side& side = sides_[c];
            std::vector<Wide> ahead = values, behind = values;
            for (std::size_t i = 0; i < y.size(); ++i) {
                const Wide change = Wide(side.by) / 2 * Wide(y[i].slope[c]);
                ahead[i] += change, behind[i] -= change;
            }
            side.ahead.tree().apply_impulses(side.ahead.scene, side.ahead.times[leg.index], ahead.data());
            side.behind.tree().apply_impulses(side.behind.scene, side.behind.times[leg.index], behind.data());
            for (std::size_t i = 0; i < y.size(); ++i)
                y[i].slope[c] = static_cast<double>((ahead[i] - behind[i]) / Wide(side.by));
        }
    }
};

// The limits of all passes.
struct Limits {
    double end = 0;  // s, processor time
    long steps_left = 0;
};

// One pass over the run, for at most `columns` parameters.
class VariationalRun {
  public:
    VariationalRun(const Problem& problem, VariedTree& tree, double tolerance, Limits& limits)
        : scales_(scales_of(problem)), tree_(tree), tolerance_(tolerance), limits_(limits), y_(tree.initial()) {}

    void enter(const Leg& leg) {
        tree_.enter(leg, y_);
        t_ = leg.begin;
        if (h_ == 0) h_ = (leg.end - leg.begin) / 1000;
    }

    double time() const { return t_; }
    const std::vector<Varied>& state() const { return y_; }
    // Why the run ended early.
    const std::string& fault() const { return fault_; }

    // Integrates to `stop` (s). Returns whether that was possible.
    bool advance_to(double stop) {
        while (t_ < stop) {
            if (--limits_.steps_left < 0) return fail("the limit of steps was reached");
            if (Interruption::is_requested()) return fail("interrupted");
            if (processor_time() > limits_.end) return fail("the limit of time was reached");
            const double left = stop - t_;
            const bool last = h_ >= left * (1 - 1e-14);
            const double h = last ? left : h_;
            const double error = attempt(h);
            if (!std::isfinite(error)) {
                h_ = h / 10;
                if (t_ + h_ == t_) return fail("the motion or its derivative is not finite");
                continue;
            }
            const double next = h * std::clamp(0.9 * std::pow(std::max(error, 1e-12), -1.0 / 8), 0.3, 6.0);
            if (error > 1) {
                h_ = next;
                if (t_ + h_ == t_) return fail("the step size is below the spacing of numbers");
                continue;
            }
            h_ = last ? std::max(h_, next) : next;
            const std::optional<Crossing> crossing = find_crossing(h);
            t_ = crossing ? t_ + crossing->after : last ? stop : t_ + h;
            y_ = next_;
            tree_.project(y_);
            if (crossing && !cross(crossing->which)) return false;
        }
        return true;
    }

  private:
    using State = std::vector<Varied>;

    std::vector<double> scales_;
    VariedTree& tree_;
    double tolerance_;
    Limits& limits_;
    State y_, next_;
    std::array<State, dop853_stages> rates_;
    double t_ = 0, h_ = 0;  // s
    std::string fault_;

    // The end of a step at a switch.
    struct Crossing {
        std::size_t which = 0;
        double after = 0;  // s, from the start of the step
    };
    static constexpr long most_crossings = 100'000;
    long crossings_ = 0;

    // Finds the first switch whose argument is beyond its threshold at the end of the step h, and repeats the step up
    // to there. Two crossings of one switch within a step are not found.
    std::optional<Crossing> find_crossing(double h) {
        if (!tree_.has_switches()) return {};
        const std::vector<Varied> from = tree_.distances(y_), to = tree_.distances(next_);
        std::optional<Crossing> first;
        for (std::size_t k = 0; k < to.size(); ++k) {
            double high = h, at_high = to[k].value;
            if (first) {
                attempt(high = first->after);
                at_high = tree_.distances(next_)[k].value;
            }
            if (at_high < 0) first = Crossing{k, locate(k, from[k].value, high, at_high)};
        }
        if (first) attempt(first->after);
        return first;
    }
    // Locates the zero of a distance that is `at_high` < 0 at `high`, to the spacing of times, by false position with
    // halved weights (M. Dowell & P. Jarratt 1971, BIT 11, 168).
    double locate(std::size_t which, double at_low, double high, double at_high) {
        const auto distance = [&](double h) {
            attempt(h);
            return tree_.distances(next_)[which].value;
        };
        double low = 0;
        // after a crossing the step starts at the threshold
        constexpr int halvings = 60;
        for (int i = 0; i < halvings && !(at_low > 0); ++i) {
            const double middle = high / 2, value = distance(middle);
            if (value > 0)
                low = middle, at_low = value;
            else
                high = middle, at_high = value;
        }
        if (!(at_low > 0)) return high;
        const double spacing = 2 * std::numeric_limits<double>::epsilon() * std::max(t_, high);
        int side = 0;
        while (high - low > spacing) {
            double middle = (low * at_high - high * at_low) / (at_high - at_low);
            if (!(middle > low && middle < high)) middle = low + (high - low) / 2;
            if (!(middle > low && middle < high)) break;
            const double value = distance(middle);
            if (value > 0) {
                low = middle, at_low = value;
                if (side == 1) at_high /= 2;
                side = 1;
            } else {
                high = middle, at_high = value;
                if (side == -1) at_low /= 2;
                side = -1;
            }
            if (value == 0) break;
        }
        return high;
    }
    bool cross(std::size_t which) {
        if (++crossings_ > most_crossings) return fail("too many switches");
        const std::string fault = tree_.cross(which, y_);
        return fault.empty() || fail(fault);
    }

    // The scales of the tree's components, then of the time and of auxiliaries, which these equations do not use.
    static std::vector<double> scales_of(const Problem& problem) {
        if (has_formula_loads(problem.scene)) return formula_mechanism_of(problem).scales();
        std::vector<double> scales = mechanism_of(problem).scales();
        scales.push_back(problem.scene.duration);
        return scales;
    }
    bool fail(std::string why) {
        fault_ = fmt::format("{} at t = {:g} s", why, t_);
        return false;
    }

    Varied weighted(const double* weights, int count, std::size_t i) const {
        Varied sum;
        for (int j = 0; j < count; ++j) {
            if (weights[j] == 0) continue;
            const Varied& rate = rates_[static_cast<std::size_t>(j)][i];
            sum.value += weights[j] * rate.value;
            for (std::size_t c = 0; c < columns; ++c) sum.slope[c] += weights[j] * rate.slope[c];
        }
        return sum;
    }

    // The largest components of an error: of the motion in units of its scales, of each derivative in units of these
    // and of its own length.
    class Largest {
      public:
        Largest(const std::array<double, columns>& lengths) : lengths_(lengths) {}
        void include(const Varied& error, double scale) {
            take(std::abs(error.value) / scale);
            for (std::size_t c = 0; c < columns; ++c)
                if (lengths_[c] > 0) take(std::abs(error.slope[c]) / (scale * lengths_[c]));
        }
        double value() const { return largest_; }

      private:
        const std::array<double, columns>& lengths_;
        double largest_ = 0;
        void take(double size) { largest_ = size <= largest_ ? largest_ : size; }
    };

    // Computes next_ and returns the error estimate of dop853.f in units of the tolerance.
    double attempt(double h) {
        const std::size_t n = y_.size();
        next_.resize(n);
        for (int stage = 0; stage < dop853_stages; ++stage) {
            for (std::size_t i = 0; i < n; ++i) next_[i] = y_[i] + h * weighted(dop853.a[stage], stage, i);
            State& rate = rates_[static_cast<std::size_t>(stage)];
            rate.resize(n);
            tree_.derivative(next_.data(), rate.data());
        }
        std::array<double, columns> lengths{};
        for (std::size_t i = 0; i < n; ++i) {
            next_[i] = y_[i] + h * weighted(dop853.b, dop853_stages, i);
            for (std::size_t c = 0; c < columns; ++c)
                lengths[c] = std::max(lengths[c], std::abs(next_[i].slope[c]) / scales_[i]);
        }
        Largest fifth(lengths), third(lengths);
        for (std::size_t i = 0; i < n; ++i) {
            const Varied slope = weighted(dop853.b, dop853_stages, i);
            fifth.include(h * weighted(dop853.fifth_error, dop853_stages, i), scales_[i]);
            third.include(h * (slope - weighted(dop853.third, dop853_stages, i)), scales_[i]);
        }
        const double e5 = fifth.value() / tolerance_, e3 = third.value() / tolerance_;
        const double both = std::sqrt(e5 * e5 + 0.01 * e3 * e3);
        return both > 0 ? e5 * (e5 / both) : e5;
    }
};

// Appends the motion of all bodies, and its derivatives, for the columns from `first` on.
void record(Sensitivities& result, double t, std::size_t moment, std::size_t first, std::size_t count,
            const std::vector<BodyMotion<Varied>>& motions) {
    const std::size_t bodies = motions.size();
    for (std::size_t b = 0; b < bodies; ++b) {
        const BodyMotion<Varied>& m = motions[b];
        const Quaternion<double> q{m.q.w.value, m.q.x.value, m.q.y.value, m.q.z.value};
        const auto values = [](const Vector3<Varied>& v) {
            return Vector3<double>(v[0].value, v[1].value, v[2].value);
        };
        if (first == 0)
            result.samples.emplace_back(t, normalized(q), values(m.angular_velocity_B), values(m.position_W),
                                        values(m.velocity_W));
        const Vector3<Varied> w_W = rotate(normalized(m.q), m.angular_velocity_B);
        double* const out =
            result.derivatives.data() + (moment * bodies + b) * Sensitivities::quantities * result.parameters + first;
        for (std::size_t c = 0; c < count; ++c) {
            // the change dq = (0, turn) q / 2 of a unit quaternion; the change of its length does not contribute
            const Quaternion<double> dq{m.q.w.slope[c], m.q.x.slope[c], m.q.y.slope[c], m.q.z.slope[c]};
            const Vector3<double> turn = (2 / squared_norm(q)) * vector_part(dq * conjugate(q));
            for (std::size_t i = 0; i < 3; ++i) {
                const double numbers[] = {turn[i], w_W[i].slope[c], m.position_W[i].slope[c], m.velocity_W[i].slope[c]};
                for (std::size_t k = 0; k < 4; ++k) out[(3 * k + i) * result.parameters + c] = numbers[k];
            }
        }
    }
}

void require_times(const std::vector<double>& times, double duration) {
    if (times.empty()) throw std::invalid_argument("no times given");
    for (std::size_t i = 0; i < times.size(); ++i)
        if (!(times[i] >= 0 && times[i] <= duration) || (i > 0 && !(times[i] > times[i - 1])))
            throw std::invalid_argument("times must increase, from 0 or later to at most the scene's duration");
}

// Computes the columns from `first` on. Sets the status of `result`.
void run_pass(const Scene& scene, const Problem& problem, std::span<const SceneChange> changes, std::size_t first,
              const std::vector<double>& times, double tolerance, Limits& limits, Sensitivities& result) {
    VariedTree tree(scene, changes);
    VariationalRun run(problem, tree, tolerance, limits);
    SampleQueue samples(times);
    std::size_t moment = 0;
    const auto enter = [&](const Leg& leg) {
        if (samples.empty() || !tree.fault().empty()) return false;
        run.enter(leg);
        return tree.fault().empty();
    };
    const auto show = [&](double t) {
        record(result, t, moment++, first, changes.size(), tree.tree().motions(run.state().data()));
        return true;
    };
    const auto integrate = [&](const Leg& leg) {
        while (run.time() < leg.end && !samples.empty()) {
            if (!run.advance_to(std::min(leg.end, std::max(samples.front(), run.time())))) return false;
            for (; samples.due(leg, run.time()); samples.pop()) show(samples.front());
        }
        return true;
    };
    follow(itinerary(problem.scene), samples, enter, show, integrate);
    if (samples.empty()) return;
    result.status = tree.fault().empty() ? Status::failed : Status::unsupported;
    result.message = tree.fault().empty() ? run.fault() : tree.fault();
}

}  // namespace

std::string part_with_events(const Scene& scene) {
    if (!scene.planes.empty()) return "impacts on planes";
    if (!scene.contacts.empty()) return "contacts of spheres";
    for (const Joint& joint : scene.joints) {
        if (joint.friction != 0 || joint.limits.any()) return "friction and limits of joints";
        if (!joint.motion.empty()) return "prescribed motions of joints";
    }
    return "";
}

Sensitivities sensitivities(const Scene& scene, std::span<const SceneChange> changes, const std::vector<double>& times,
                            const SensitivitySettings& settings) {
    Sensitivities result;
    result.parameters = changes.size();
    result.message = unsupported_part(scene);
    if (!result.message.empty()) {
        result.status = Status::unsupported;
        return result;
    }
    require_times(times, scene.duration);
    const std::size_t events = event_times(scene).size();
    for (const SceneChange& change : changes)
        if (event_times(change.ahead).size() != events || event_times(change.behind).size() != events) {
            result.status = Status::unsupported;
            result.message = "the order of events changes with it";
            return result;
        }
    const Problem problem = pose(as_mechanism(scene));
    result.bodies = static_cast<int>(problem.scene.bodies.size());
    result.derivatives.assign(times.size() * problem.scene.bodies.size() * Sensitivities::quantities * changes.size(),
                              0);
    Limits limits{processor_time() + settings.seconds_limit, settings.max_steps};
    for (std::size_t first = 0; first < std::max<std::size_t>(1, changes.size()); first += columns) {
        const std::size_t count = std::min(columns, changes.size() - first);
        run_pass(scene, problem, changes.subspan(first, count), first, times, settings.tolerance, limits, result);
        if (result.status != Status::ok) break;
    }
    result.steps = settings.max_steps - limits.steps_left;
    return result;
}

}  // namespace polhode
