#include "check/engine_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "body/orientation.h"
#include "motion/formula_terms.h"

namespace polhode {
namespace {

using Vector = Vector3<double>;

constexpr UpdateRule rules[] = {
    {"accurate steps", RateUpdate::accurate},
    {"semi-implicit Euler with an explicit gyroscopic term", RateUpdate::after_loads},
    {"semi-implicit Euler with an implicit gyroscopic term", RateUpdate::implicit_newton},
    {"semi-implicit Euler with a gyroscopic term that conserves |L|", RateUpdate::rescaled_momentum},
    {"semi-implicit Euler", RateUpdate::together},
    {"semi-implicit Euler of the angular momentum", RateUpdate::momentum},
    {"the explicit midpoint rule", RateUpdate::midpoint},
    {"explicit Euler", RateUpdate::together, false},
    {"explicit Euler, the gyroscopic term after the loads", RateUpdate::after_loads, false},
    {"explicit Euler of the angular momentum", RateUpdate::momentum, false},
    {"semi-implicit Euler with an explicit gyroscopic term and a first-order quaternion", RateUpdate::after_loads, true,
     true},
    {"semi-implicit Euler with an implicit gyroscopic term and a first-order quaternion", RateUpdate::implicit_newton,
     true, true},
    {"semi-implicit Euler with a gyroscopic term that conserves |L| and a first-order quaternion",
     RateUpdate::rescaled_momentum, true, true},
    {"semi-implicit Euler with a first-order quaternion", RateUpdate::together, true, true},
    {"semi-implicit Euler of the angular momentum with a first-order quaternion", RateUpdate::momentum, true, true},
    {"explicit Euler with a first-order quaternion", RateUpdate::together, false, true},
    {"explicit Euler of the angular momentum with a first-order quaternion", RateUpdate::momentum, false, true},
};

// largest rotation in an accurate step, rad; the error of each step is (h w)^5 / 120 = 3e-9 rad
constexpr double max_rotation = 0.05;
constexpr int max_small_steps = 200;
// formulas can change faster than the attitude
constexpr int least_steps_with_formulas = 10;

// The scene with a torque of zero in place of each formula, so that its times remain.
Scene replace_formulas(Scene scene) {
    for (Load& load : scene.loads)
        if (const auto* formula = std::get_if<FormulaLoad>(&load)) {
            const Window window = formula->window;
            load = Torque{{}, Frame::body, window};
        }
    scene.let.clear();
    return scene;
}

}  // namespace

std::span<const UpdateRule> update_rules() { return rules; }

EngineModel::EngineModel(const Cause& cause)
    : fault_(cause.engine),
      problem_(pose(replace_formulas(cause.scene), Formulation::full)),
      inertia_{problem_.body.full_inertia.tensor, problem_.body.full_inertia.inverse},
      center_(cause.scene.body.center_of_mass) {
    for (const Load& load : cause.scene.loads) {
        if (const auto* torque = std::get_if<Torque>(&load)) pushes_.push_back(torque->window);
        if (const auto* force = std::get_if<Force>(&load)) pushes_.push_back(force->window);
        if (const auto* formula = std::get_if<FormulaLoad>(&load)) pushes_.push_back(formula->window);
    }
    if (!has_formula_loads(cause.scene)) return;
    const FormulaTerms<double> terms(compile_formulas(cause.scene, cause.scene.name), cause.scene, problem_.body,
                                     cause.scene.body.inertia_B);
    auto by_segment = std::make_shared<std::vector<FormulaTerms<double>>>(problem_.segments.size(), terms);
    for (std::size_t i = 0; i < by_segment->size(); ++i) (*by_segment)[i].enter(problem_.segments[i].begin);
    formulas_ = by_segment;
}

void EngineModel::enter(std::size_t segment, EngineLoads& loads) const {
    loads.enter(problem_.segments[segment]);
    loads.formulas = formulas_ ? &(*formulas_)[segment] : nullptr;
}

// Formulas that are held over a row keep their components in the axes of their loads.
void EngineModel::add_formulas(const EngineLoads& loads, double t, const ModelState& s, Action& action) const {
    const auto inputs = [](double time, const ModelState& at) {
        return FormulaState<double>(time, at.angular_velocity_B, at.q, at.position_W, at.velocity_W);
    };
    const FormulaState<double> now = inputs(t, s);
    const FormulaState<double> used = fault_.formulas_held ? inputs(loads.row_start, loads.at_row_start) : now;
    const FormulaWrench<double> wrench =
        loads.formulas->wrench(now, loads.formulas->evaluate<double>(used, static_cast<const double*>(nullptr)));
    action.torque_B = action.torque_B + wrench.torque_B;
    if (!problem_.body.pivoted)
        action.acceleration_W = action.acceleration_W + (1 / problem_.body.mass) * wrench.force_W;
}

BodyInertia<double> EngineModel::inertia(const Quaternion<double>& q) const {
    if (fault_.tensor == WorldTensor::turned) return inertia_;
    const Matrix3<double> R = rotation_matrix(q), back = transposed(R);
    const auto in_body = [&](const Matrix3<double>& world) { return back * world * R; };
    const auto diagonal_of = [](const Matrix3<double>& m) { return diagonal(Vector(m[0][0], m[1][1], m[2][2])); };
    switch (fault_.tensor) {
        case WorldTensor::turned:
            break;
        case WorldTensor::fixed:
            return {in_body(inertia_.tensor), in_body(inertia_.inverse)};
        case WorldTensor::turned_back:
            return {in_body(back * inertia_.tensor * R), in_body(back * inertia_.inverse * R)};
        case WorldTensor::diagonal: {
            const Matrix3<double> world = diagonal_of(R * inertia_.tensor * back);
            return {in_body(world), in_body(polhode::inverse(world))};
        }
        case WorldTensor::inverse_diagonal:
            return {inertia_.tensor, in_body(diagonal_of(R * inertia_.inverse * back))};
    }
    return inertia_;
}

bool EngineModel::is_coasting(double t) const {
    return std::none_of(pushes_.begin(), pushes_.end(),
                        [&](const Window& window) { return window.from <= t && t < window.until; });
}

// Returns w after a time h with the engine's damping only.
Vector EngineModel::apply_damping(const Vector& w, double t, double h) const {
    if (fault_.coasting_only && !is_coasting(t)) return w;
    Vector left;
    for (int i = 0; i < 3; ++i)
        left[i] = std::max(0.0, 1 - (fault_.angular_damping + fault_.axis_damping_B[i]) * h) * w[i];
    return left;
}

ModelState EngineModel::start() const {
    const ExactBody<double>& b = problem_.body;
    ModelState s{{b.q, b.angular_velocity_B, b.position_W, b.velocity_W}, {}};
    apply_impulses(s, problem_.segments.front());
    place_at_pivot(s);
    return s;
}

bool EngineModel::supports(const UpdateRule& rule, int steps) const {
    if (uses_row_rate() && (steps < 2 || rule.rate == RateUpdate::accurate || !rule.by_new_rate)) return false;
    if (fault_.in_place != InPlace::none && !rule.first_order) return false;
    // these rules make no difference between damping before and after the rotation
    if (fault_.damping_last && (!rule.by_new_rate || rule.rate == RateUpdate::accurate ||
                                rule.rate == RateUpdate::midpoint || rule.rate == RateUpdate::momentum))
        return false;
    // with a tensor fixed in the world, constant L means constant w: an engine without a gyroscopic term
    if (fault_.tensor == WorldTensor::fixed && rule.rate == RateUpdate::momentum) return false;
    // a rate computed from L is not integrated in body axes
    return rule.rate != RateUpdate::momentum ||
           (fault_.gyroscopic == 1 && (fault_.rotation_rate == AttitudeRate::own_rate ||
                                       fault_.rotation_rate == AttitudeRate::first_rate_of_row_w_in_world));
}

bool EngineModel::has_event(double t, double dt) const {
    return std::any_of(problem_.segments.begin() + 1, problem_.segments.end(),
                       [&](const Segment& segment) { return t < segment.begin && segment.begin <= t + dt; });
}

// Error of the torque (world axes) by torques and arms in wrong axes.
Vector EngineModel::torque_error(const EngineLoads& loads, double t, const ModelState& s,
                                 const Matrix3<double>& A) const {
    Vector more;
    if (fault_.drag_in_world && loads.forcing().has_damping) {
        const Vector& w_B = s.angular_velocity_B;
        more = more + A * (loads.forcing().damping * w_B) - loads.forcing().damping * (A * w_B);
    }
    if (fault_.spring != TorqueAxes::own)
        for (const SpringTorque<double>& spring : loads.forcing().springs) {
            const Quaternion<double> r = conjugate(spring.rest) * s.q;
            const Vector in_body = (-2 * spring.stiffness * r.w) * vector_part(r), in_world = A * in_body;
            more = more + (fault_.spring == TorqueAxes::body_in_world ? in_body : A * in_world) - in_world;
        }
    if (fault_.arm_not_rotated)
        for (const Load& load : problem_.scene.loads) {
            const auto* force = std::get_if<Force>(&load);
            if (!force || force->point_frame != Frame::body || !acts(force->window, t)) continue;
            const Vector arm = force->point - problem_.scene.pivot.value_or(center_);
            const Vector force_W = force->frame == Frame::body ? A * force->vector : force->vector;
            more = more + cross(arm - A * arm, force_W);
        }
    return more;
}

EngineModel::Action EngineModel::action(const EngineLoads& loads, double t, const ModelState& s) const {
    const Matrix3<double> A = rotation_matrix(s.q);
    const Vector torque = loads.torque_W(
        t, A, [&] { return s.q; }, A * s.angular_velocity_B, s.position_W, s.velocity_W);
    Action a{transposed(A) * (torque + torque_error(loads, t, s, A)), {}};
    if (!problem_.body.pivoted) a.acceleration_W = loads.acceleration_W(A, s.velocity_W);
    if (loads.formulas) add_formulas(loads, t, s, a);
    return a;
}

void EngineModel::limit(ModelState& s, double t) const {
    const double most = fault_.speed_limit;
    if (!std::isfinite(most) || (fault_.coasting_only && !is_coasting(t))) return;
    const auto clamped = [&](const Vector& w) {
        return Vector(std::clamp(w[0], -most, most), std::clamp(w[1], -most, most), std::clamp(w[2], -most, most));
    };
    Vector& w = s.angular_velocity_B;
    switch (fault_.limited_quantity) {
        case LimitedQuantity::length:
            if (const double speed = length(w); speed > most) w = (most / speed) * w;
            break;
        case LimitedQuantity::body_axes:
            w = clamped(w);
            break;
        case LimitedQuantity::world_axes:
            w = rotate_back(s.q, clamped(rotate(s.q, w)));
            break;
    }
}

void EngineModel::place_at_pivot(ModelState& s) const {
    if (problem_.body.pivoted) pivoted_center(s.q, s.angular_velocity_B, problem_.body.arm, s.position_W, s.velocity_W);
}

void EngineModel::apply_impulses(ModelState& s, const Segment& segment) const {
    if (segment.impulses.empty()) return;
    const Matrix3<double> A = rotation_matrix(s.q);
    Vector kick;
    WorldLoads<double>::apply_impulses(problem_, segment, A, s.position_W, kick, s.velocity_W);
    s.angular_velocity_B = s.angular_velocity_B + inertia(s.q).inverse * (transposed(A) * kick);
    place_at_pivot(s);
}

// Returns w after a time h with the gyroscopic term only. A factor of the term is a factor of the time.
Vector EngineModel::apply_gyroscopic_term(const BodyInertia<double>& inertia, const Vector& w, double h,
                                          const UpdateRule& rule) const {
    const double time = fault_.gyroscopic * h;
    if (time == 0) return w;
    switch (rule.rate) {
        case RateUpdate::implicit_newton:
            return inertia.apply_gyroscopic_term<GyroscopicTerm::one_newton_step>(w, time);
        case RateUpdate::rescaled_momentum:
            return inertia.apply_gyroscopic_term<GyroscopicTerm::rescaled_momentum>(w, time);
        default:
            return inertia.apply_gyroscopic_term<GyroscopicTerm::explicit_euler>(w, time);
    }
}

// Rotates the attitude by a rate in body axes, with the engine's faults.
void EngineModel::rotate_attitude(ModelState& s, const Vector& rate_B, double h, bool first_order) const {
    if (fault_.no_rotation) return;
    const Vector by = (fault_.rotation_factor * h) * rate_B;
    if (fault_.in_place != InPlace::none) {
        // half the rotation in the axes of the update, applied component by component
        const bool world = fault_.in_place == InPlace::world_rate;
        const Vector half = 0.5 * (world ? rotate(s.q, by) : by);
        const double side = world ? -1 : 1;
        Quaternion<double>& q = s.q;
        q.w -= q.x * half[0] + q.y * half[1] + q.z * half[2];
        q.x += q.w * half[0] + side * (q.y * half[2] - q.z * half[1]);
        q.y += q.w * half[1] + side * (q.z * half[0] - q.x * half[2]);
        q.z += q.w * half[2] + side * (q.x * half[1] - q.y * half[0]);
        q = normalized(q);
        return;
    }
    const auto factor = [&](const Vector& angle) {
        if (!first_order) return quaternion_from_rotation_vector(angle);
        return normalized(Quaternion<double>{1, angle[0] / 2, angle[1] / 2, angle[2] / 2});
    };
    switch (fault_.rotation_rate) {
        case AttitudeRate::own_rate:
            s.q = normalized(s.q * factor(by));
            break;
        case AttitudeRate::body_rate_in_world:
            s.q = normalized(factor(by) * s.q);
            break;
        case AttitudeRate::world_rate_in_body: {
            // this engine integrates the rate in world axes
            const Vector w_W = rotate(s.q, s.angular_velocity_B);
            s.q = normalized(s.q * factor(rotate(s.q, by)));
            s.angular_velocity_B = rotate_back(s.q, w_W);
            break;
        }
        case AttitudeRate::world_rate_in_body_w_in_body:
            s.q = normalized(s.q * factor(rotate(s.q, by)));
            break;
        case AttitudeRate::first_rate_of_row_w_in_world: {
            const Vector w_W = rotate(s.q, s.angular_velocity_B);
            s.q = normalized(factor((fault_.rotation_factor * h) * s.row_rate_W) * s.q);
            s.angular_velocity_B = rotate_back(s.q, w_W);
            break;
        }
        case AttitudeRate::first_rate_of_row_w_in_body:
            s.q = normalized(factor((fault_.rotation_factor * h) * s.row_rate_W) * s.q);
            break;
    }
}

// Error of the acceleration of the centre of mass (world axes) in an engine that integrates the motion of the origin:
// a term missing in a_origin = a_center - dw/dt x r - w x (w x r) is added to a_center.
Vector EngineModel::origin_error(const ModelState& s, const Vector& w_B, const Vector& dw_B) const {
    Vector error_B;
    if (!fault_.origin.has_centripetal) error_B = error_B + cross(w_B, cross(w_B, center_));
    if (!fault_.origin.has_euler) error_B = error_B + cross(dw_B, center_);
    return rotate(s.q, error_B);
}

// Advances the translation in a semi-implicit step, after w and the attitude. Returns the difference between the
// positions by the new and the old velocity.
Vector EngineModel::translate(ModelState& s, const ModelState& old, const Vector& acceleration_W, double h) const {
    const double velocity_factor = std::max(0.0, 1 - fault_.linear_damping * h);
    if (!fault_.origin.is_integrated) {
        s.velocity_W = velocity_factor * (old.velocity_W + h * acceleration_W);
        if (fault_.no_translation) return {};
        s.position_W = old.position_W + h * s.velocity_W;
        return h * (s.velocity_W - old.velocity_W);
    }
    const Vector w = rotate(old.q, old.angular_velocity_B), r = rotate(old.q, center_),
                 new_w = rotate(s.q, s.angular_velocity_B), new_r = rotate(s.q, center_);
    Vector a = acceleration_W;
    if (fault_.origin.has_centripetal) a = a - cross(w, cross(w, r));
    if (fault_.origin.has_euler) a = a - cross((1 / h) * (new_w - w), r);
    const Vector v = old.velocity_W - cross(w, r), new_v = velocity_factor * (v + h * a);
    s.velocity_W = new_v + cross(new_w, new_r);
    if (fault_.no_translation) return {};
    s.position_W = old.position_W - r + h * new_v + new_r;
    return h * (new_v - v);
}

// Half a step with the rates at the start, then the whole step with the rates at its middle.
Vector EngineModel::midpoint_step(ModelState& s, const EngineLoads& loads, double t, double h) const {
    const ModelState old = s;
    const auto go = [&](double at, const ModelState& from, double dt) {
        const Action a = action(loads, at, from);
        const Vector& w = from.angular_velocity_B;
        const BodyInertia<double> I = inertia(from.q);
        const Vector dw = I.inverse * (a.torque_B + fault_.gyroscopic * cross(I.tensor * w, w));
        const Vector v = from.velocity_W;
        ModelState next = old;
        rotate_attitude(
            next, fault_.rotation_rate == AttitudeRate::world_rate_in_body ? rotate_back(old.q, rotate(from.q, w)) : w,
            dt, false);
        // an engine with its tensor in world axes also integrates the rate there
        if (fault_.tensor == WorldTensor::turned && fault_.rotation_rate != AttitudeRate::first_rate_of_row_w_in_world)
            next.angular_velocity_B = next.angular_velocity_B + dt * dw;
        else
            next.angular_velocity_B =
                rotate_back(next.q, rotate(old.q, old.angular_velocity_B) + dt * rotate(from.q, dw));
        const Vector error = fault_.origin.is_integrated ? origin_error(from, w, dw) : Vector();
        next.velocity_W = old.velocity_W + dt * (a.acceleration_W + error);
        if (!fault_.no_translation) next.position_W = old.position_W + dt * v;
        place_at_pivot(next);
        return next;
    };
    s = go(t + h / 2, go(t, old, h / 2), h);
    s.angular_velocity_B = apply_damping(s.angular_velocity_B, t, h);
    s.velocity_W = std::max(0.0, 1 - fault_.linear_damping * h) * s.velocity_W;
    limit(s, t);
    place_at_pivot(s);
    return {};
}

Vector EngineModel::step(ModelState& s, const EngineLoads& loads, double t, double h, const UpdateRule& rule) const {
    if (rule.rate == RateUpdate::midpoint) return midpoint_step(s, loads, t, h);
    const Action a = action(loads, t, s);
    const ModelState old = s;
    const Vector& old_w = old.angular_velocity_B;
    const BodyInertia<double> I = inertia(s.q);
    const Vector by_loads = h * (I.inverse * a.torque_B);
    Vector w = old_w, momentum_W;
    switch (rule.rate) {
        case RateUpdate::together:
            w = old_w + by_loads + (apply_gyroscopic_term(I, old_w, h, rule) - old_w);
            break;
        case RateUpdate::momentum:
            // an engine that integrates L computes w by its inverse tensor only
            momentum_W = rotate(
                s.q, (fault_.tensor == WorldTensor::inverse_diagonal ? polhode::inverse(I.inverse) : I.tensor) * old_w +
                         h * a.torque_B);
            w = old_w + by_loads;
            break;
        default:
            w = apply_gyroscopic_term(I, old_w + by_loads, h, rule);
    }
    s.angular_velocity_B = fault_.damping_last ? w : apply_damping(w, t, h);
    if (!fault_.damping_last) limit(s, t);
    rotate_attitude(s, rule.by_new_rate ? s.angular_velocity_B : old_w, h, rule.first_order);
    if (rule.rate == RateUpdate::momentum) {
        s.angular_velocity_B = apply_damping(inertia(s.q).inverse * rotate_back(s.q, momentum_W), t, h);
        limit(s, t);
    } else if (fault_.tensor != WorldTensor::turned && !rule.by_new_rate) {
        // the rate is integrated in world axes
        s.angular_velocity_B = rotate_back(s.q, rotate(old.q, s.angular_velocity_B));
    }
    if (fault_.damping_last) {
        s.angular_velocity_B = apply_damping(s.angular_velocity_B, t, h);
        limit(s, t);
    }
    const Vector position_difference = translate(s, old, a.acceleration_W, h);
    place_at_pivot(s);
    return position_difference;
}

// Advances (q, w, p, v) by the classical Runge-Kutta method.
void EngineModel::small_step(ModelState& s, const EngineLoads& loads, double t, double h) const {
    struct Rate {
        Quaternion<double> q;
        Vector w, p, v;
    };
    const auto rate = [&](double at, const ModelState& y) {
        ModelState unit = y;
        unit.q = normalized(y.q);
        place_at_pivot(unit);
        const Action a = action(loads, at, unit);
        const Vector& w = y.angular_velocity_B;
        Rate r;
        const BodyInertia<double> I = inertia(unit.q);
        r.w = I.inverse * (a.torque_B + fault_.gyroscopic * cross(I.tensor * w, w));
        if (!fault_.coasting_only || is_coasting(t))
            for (int i = 0; i < 3; ++i) r.w[i] -= (fault_.angular_damping + fault_.axis_damping_B[i]) * w[i];
        const Vector error = fault_.origin.is_integrated ? origin_error(unit, w, r.w) : Vector();
        Vector turning = fault_.rotation_factor * w;
        if (fault_.rotation_rate == AttitudeRate::body_rate_in_world) turning = rotate_back(unit.q, turning);
        if (fault_.rotation_rate == AttitudeRate::world_rate_in_body) {
            turning = rotate(unit.q, turning);
            // only torques change w_W
            r.w = r.w - cross(turning, w);
        }
        if (fault_.rotation_rate == AttitudeRate::world_rate_in_body_w_in_body) turning = rotate(unit.q, turning);
        if (fault_.no_rotation) turning = {};
        r.q = attitude_rate(0.5, y.q, turning);
        r.p = fault_.no_translation ? Vector() : y.velocity_W;
        r.v = a.acceleration_W + error - fault_.linear_damping * y.velocity_W;
        return r;
    };
    const auto advanced = [&](const Rate& r, double by) {
        ModelState y = s;
        y.q = {s.q.w + by * r.q.w, s.q.x + by * r.q.x, s.q.y + by * r.q.y, s.q.z + by * r.q.z};
        y.angular_velocity_B = s.angular_velocity_B + by * r.w;
        y.position_W = s.position_W + by * r.p, y.velocity_W = s.velocity_W + by * r.v;
        return y;
    };
    const Rate a = rate(t, s), b = rate(t + h / 2, advanced(a, h / 2)), c = rate(t + h / 2, advanced(b, h / 2)),
               d = rate(t + h, advanced(c, h));
    const auto mean = [](const auto& k1, const auto& k2, const auto& k3, const auto& k4) {
        return (1.0 / 6) * (k1 + 2.0 * (k2 + k3) + k4);
    };
    const Quaternion<double> q{(a.q.w + 2 * (b.q.w + c.q.w) + d.q.w) / 6, (a.q.x + 2 * (b.q.x + c.q.x) + d.q.x) / 6,
                               (a.q.y + 2 * (b.q.y + c.q.y) + d.q.y) / 6, (a.q.z + 2 * (b.q.z + c.q.z) + d.q.z) / 6};
    s = advanced({q, mean(a.w, b.w, c.w, d.w), mean(a.p, b.p, c.p, d.p), mean(a.v, b.v, c.v, d.v)}, h);
    s.q = normalized(s.q);
    limit(s, t);
    place_at_pivot(s);
}

void EngineModel::advance_segment(ModelState& s, const EngineLoads& loads, double t, double dt, const UpdateRule& rule,
                                  int steps, Vector& position_difference) const {
    if (!(dt > 0)) return;
    if (rule.rate == RateUpdate::accurate) {
        const double rotation =
            dt * fault_.time * std::max(length(s.angular_velocity_B), problem_.scales.angular_velocity);
        // a state that is not finite takes the largest number of steps
        const double wanted = std::ceil(rotation / max_rotation);
        const int least = loads.formulas ? least_steps_with_formulas : 2;
        steps = wanted < max_small_steps ? std::max(least, static_cast<int>(wanted)) : max_small_steps;
    }
    const double part = dt / steps, h = part * fault_.time;
    for (int i = 0; i < steps; ++i) {
        if (rule.rate == RateUpdate::accurate)
            small_step(s, loads, t + i * part, h);
        else
            position_difference = position_difference + step(s, loads, t + i * part, h, rule);
    }
}

Vector EngineModel::advance(ModelState& s, double t, double dt, const UpdateRule& rule, int steps) const {
    EngineLoads loads(problem_);
    loads.row_start = t, loads.at_row_start = s;
    if (uses_row_rate()) s.row_rate_W = rotate(s.q, s.angular_velocity_B);
    const std::size_t first = segment_at(problem_, t);
    enter(first, loads);
    Vector position_difference;
    const double end = t + dt;
    for (std::size_t k = first + 1; k < problem_.segments.size() && problem_.segments[k].begin <= end; ++k) {
        const Segment& next = problem_.segments[k];
        advance_segment(s, loads, t, next.begin - t, rule, steps, position_difference);
        t = std::max(t, next.begin);
        enter(k, loads);
        apply_impulses(s, next);
    }
    advance_segment(s, loads, t, end - t, rule, steps, position_difference);
    return position_difference;
}

}  // namespace polhode
