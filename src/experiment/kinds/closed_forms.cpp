#include "experiment/kinds/closed_forms.h"

#include <algorithm>
#include <variant>

#include "experiment/kinds/closed_form_numbers.h"
#include "scene/body_hull.h"

namespace polhode {
namespace closed_forms {
namespace {

constexpr int printed_digits = 25;

std::string printed(const Exact& x) { return x == 0 ? "0" : x.str(printed_digits); }

Vector3<Exact> columns_from(const DecimalColumns& row, std::size_t first) {
    return {Exact(row[first]), Exact(row[first + 1]), Exact(row[first + 2])};
}

}  // namespace

Comparison::Comparison(const Scene& scene_, const truth::Truth& truth, std::string source)
    : scene(scene_), truth_(truth), source_(std::move(source)) {
    for (std::size_t b = 0; b < body_count(scene); ++b)
        bodies_.push_back(mass_properties<Exact>(scene_body(scene, b).body));
}

void Comparison::add(const std::string& quantity, const std::string& form, const Exact& expected,
                     const std::optional<Exact>& computed, const Exact& scale) {
    FormComparison row{quantity, form, source_, printed(expected), "", {}};
    if (computed) {
        row.computed = printed(*computed);
        const Exact size = std::max(Exact(abs(expected)), scale), off = abs(*computed - expected);
        row.difference = Exact(size > 0 ? Exact(off / size) : off).convert_to<double>();
    }
    all_.push_back(std::move(row));
}
void Comparison::add_constant(const std::string& quantity, const Exact& first, const Exact& last, const Exact& scale) {
    add(quantity, "constant", first, last, scale);
}

ExactMotion Comparison::at(std::size_t sample, std::size_t b) const {
    const DecimalColumns& row = truth_.decimals.at(sample * bodies() + b);
    return {{Exact(row[0]), Exact(row[1]), Exact(row[2]), Exact(row[3])},
            columns_from(row, 4),
            columns_from(row, 7),
            columns_from(row, 10)};
}
std::size_t Comparison::last_sample_before(const Exact& t) const {
    std::size_t sample = 0;
    while (sample < last_sample() && time(sample + 1) < t) ++sample;
    return sample;
}

const std::vector<DecimalContactEvent>& Comparison::events() const { return truth_.contact_events; }
const DecimalContactEvent* Comparison::find_event(std::string_view name, std::size_t n) const {
    for (const DecimalContactEvent& event : events())
        if (event.event == name && n-- == 0) return &event;
    return nullptr;
}
std::optional<Exact> Comparison::event(std::string_view name, std::size_t n) const {
    const DecimalContactEvent* found = find_event(name, n);
    return found ? std::optional(Exact(found->t)) : std::nullopt;
}
std::size_t Comparison::count(std::string_view name) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(events(), [&](const DecimalContactEvent& event) { return event.event == name; }));
}

Vector3<Exact> Comparison::gravity() const {
    return cast<Exact>(std::get<Gravity>(scene.loads.front()).acceleration_W);
}
Exact Comparison::radius(std::size_t b) const { return hull<Exact>(*scene_body(scene, b).body.source).front().radius; }
Exact Comparison::energy(std::size_t sample) const {
    Exact sum = 0;
    for (std::size_t b = 0; b < bodies(); ++b) {
        const ExactMotion motion = at(sample, b);
        const Vector3<Exact> w = rotate_back(motion.q, motion.angular_velocity_W);
        sum += body(b).mass * (dot(motion.velocity_W, motion.velocity_W) / 2 - dot(gravity(), motion.position_W)) +
               dot(w, body(b).inertia * w) / 2;
    }
    return sum;
}
Vector3<Exact> Comparison::angular_momentum_W(const ExactMotion& motion, std::size_t b) const {
    const Vector3<Exact> w = rotate_back(motion.q, motion.angular_velocity_W);
    return rotate(motion.q, body(b).inertia * w) + body(b).mass * cross(motion.position_W, motion.velocity_W);
}

}  // namespace closed_forms

std::vector<FormComparison> compare_closed_forms(const Scene& scene, const truth::Truth& truth) {
    using namespace closed_forms;
    if (!truth.reference.available) return {};
    for (const std::span<const SceneForms> forms : {contact_forms(), joint_forms()})
        for (const SceneForms& own : forms) {
            if (own.scene != scene.name) continue;
            Comparison comparison(scene, truth, std::string(own.source));
            own.compare(comparison);
            return comparison.take();
        }
    return {};
}

}  // namespace polhode
