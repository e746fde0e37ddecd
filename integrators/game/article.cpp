// The update of the article on rotational dynamics for game programmers, as printed and corrected.
//
// A tick of length h, in the article's order:
//   1. apply_torque for every load:  r = point - x_com,  w += I_W^-1 (r x F) h;   also v += h F / m
//   2. update_body_orientation:      w += I_W^-1 (w x I_W w) h   (printed; Euler's equations have the other sign)
//                                    theta = rotation by |w| h about the new w,  q = theta q,
//                                    position rotated by theta about the centre of mass
//   3. position += h v
// The article has no step 3, no gravity and no pivot; these follow the usual semi-implicit update. q is not
// renormalised. ArticleStepper is the stepper; ArticleForm selects which errors of the printed code it contains.
#include <cmath>
#include <span>
#include <vector>

#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

enum class ArticleForm {
    as_written,         ///< x_com = position + center_of_mass, not rotated; the printed sign of w x I w
    offset_as_written,  ///< only the printed x_com
    sign_as_written,    ///< only the printed sign
    corrected,          ///< x_com rotated into the world; I dw/dt = tau - w x I w
    body_frame,         ///< the corrected update with w and the tensor in body axes, q = q theta
};

/// Rotation by `angle` (rad) about `axis`, which may have any nonzero length.
template <class S>
Quaternion<S> quaternion_angle_axis(S angle, const Vector3<S>& axis) {
    const S scale = std::sin(angle / 2) / std::sqrt(dot(axis, axis));
    return {std::cos(angle / 2), scale * axis[0], scale * axis[1], scale * axis[2]};
}

template <ArticleForm form, class S>
class ArticleStepper {
  public:
    explicit ArticleStepper(const Problem& problem) : problem_(&problem) {
        const ExactBody<double>& body = problem.body;
        pivoted_ = body.pivoted;
        mass_ = S(body.mass);
        inertia_B_ = cast<S>(body.inertia_B);
        inverse_inertia_B_ = cast<S>(inverse(body.inertia_B));
        mass_center_B_ = cast<S>(problem.scene.body.center_of_mass);
        // A held body rotates about its origin, with the inertia shifted there.
        rotation_center_B_ = pivoted_ ? Vector3<S>() : mass_center_B_;
        loads_.reserve(problem.scene.loads.size());
        restart();
    }

    void restart() {
        const ExactBody<double>& body = problem_->body;
        orientation_ = cast<S>(body.q);
        angular_velocity_ = cast<S>(in_body ? body.angular_velocity_B : rotate(body.q, body.angular_velocity_B));
        linear_velocity_ = pivoted_ ? Vector3<S>() : cast<S>(body.velocity_W);
        // The article's position is that of the body's origin.
        position_ =
            pivoted_ ? Vector3<S>() : cast<S>(body.position_W - rotate(body.q, problem_->scene.body.center_of_mass));
        steps_ = 0;
        rotate_inertia();
    }

    void enter(const Segment& segment) {
        rotate_inertia();
        loads_.clear();
        for (const Load& load : problem_->scene.loads) {
            const auto* impulse = std::get_if<Impulse>(&load);
            if (impulse && impulse->at == segment.begin) {
                const Vector3<S> J = to_world(cast<S>(impulse->vector), impulse->frame);
                apply_force(J, point_to_world(cast<S>(impulse->point), impulse->point_frame), 1);
            } else if (!impulse && acts(window_of(load), segment.begin)) {
                loads_.push_back(&load);
            }
        }
    }

    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step);
        rotate_inertia();
        for (const Load* load : loads_) std::visit([&](const auto& l) { apply(l, t, h); }, *load);
        update_body_orientation(h);
        if (!pivoted_) position_ = position_ + h * linear_velocity_;
        ++steps_;
    }

    Sample sample(double t) const {
        Sample s;
        s.t = t, s.q = cast<double>(orientation_);
        s.angular_velocity_B = cast<double>(angular_velocity_);
        if (!in_body) s.angular_velocity_B = (1 / squared_norm(s.q)) * rotate_back(s.q, s.angular_velocity_B);
        const Vector3<double>& mass_center_B = problem_->scene.body.center_of_mass;
        s.position_W = cast<double>(position_) + rotate(s.q, mass_center_B);
        s.velocity_W = cast<double>(linear_velocity_);
        if (pivoted_) pivoted_center(s.q, s.angular_velocity_B, mass_center_B, s.position_W, s.velocity_W);
        return s;
    }

    bool finite() const {
        return all_finite(angular_velocity_, linear_velocity_, position_) && all_finite(orientation_);
    }
    long rhs_evaluations() const { return steps_; }

  private:
    static constexpr bool in_body = form == ArticleForm::body_frame;
    static constexpr bool printed_offset = form == ArticleForm::as_written || form == ArticleForm::offset_as_written;
    static constexpr bool printed_sign = form == ArticleForm::as_written || form == ArticleForm::sign_as_written;

    // R I R^-1 and its inverse, by the general matrix inverse as in the article.
    void rotate_inertia() {
        if constexpr (in_body) return;
        const Matrix3<S> orientation_matrix = rotation_matrix(orientation_);
        world_inertia_ = orientation_matrix * inertia_B_ * inverse(orientation_matrix);
        inverse_world_inertia_ = inverse(world_inertia_);
    }

    Vector3<S> to_world(const Vector3<S>& v, Frame frame) const {
        return frame == Frame::world ? v : rotate(orientation_, v);
    }
    Vector3<S> point_to_world(const Vector3<S>& point, Frame frame) const {
        return frame == Frame::world ? point : position_ + rotate(orientation_, point);
    }
    Vector3<S> angular_velocity_in_body() const {
        return in_body ? angular_velocity_ : rotate_back(orientation_, angular_velocity_);
    }
    Vector3<S> mass_center_velocity_W() const {
        if (!pivoted_) return linear_velocity_;
        return rotate(orientation_, cross(angular_velocity_in_body(), mass_center_B_));
    }

    // J = (I^-1 torque) h.
    void apply_torque(const Vector3<S>& torque_W, S h) {
        if constexpr (in_body)
            angular_velocity_ = angular_velocity_ + h * (inverse_inertia_B_ * rotate_back(orientation_, torque_W));
        else
            angular_velocity_ = angular_velocity_ + h * (inverse_world_inertia_ * torque_W);
    }
    void apply_force(const Vector3<S>& force_W, const Vector3<S>& point_W, S h) {
        const Vector3<S> offset = printed_offset ? rotation_center_B_ : rotate(orientation_, rotation_center_B_);
        const Vector3<S> world_com = position_ + offset;
        const Vector3<S> r = point_W - world_com;
        apply_torque(cross(r, force_W), h);
        accelerate(force_W, h);
    }
    void accelerate(const Vector3<S>& force_W, S h) {
        if (!pivoted_) linear_velocity_ = linear_velocity_ + (h / mass_) * force_W;
    }
    // A force at the centre of mass rotates the body only if it is held at another point.
    void apply_at_mass_center(const Vector3<S>& force_W, S h) {
        if (pivoted_)
            apply_force(force_W, point_to_world(mass_center_B_, Frame::body), h);
        else
            accelerate(force_W, h);
    }

    void apply(const Gravity& load, double, S h) { apply_at_mass_center(mass_ * cast<S>(load.acceleration_W), h); }
    void apply(const Torque& load, double, S h) { apply_torque(to_world(cast<S>(load.vector), load.frame), h); }
    void apply(const Force& load, double, S h) {
        apply_force(to_world(cast<S>(load.vector), load.frame), point_to_world(cast<S>(load.point), load.point_frame),
                    h);
    }
    void apply(const Drag& load, double, S h) {
        const Vector3<S> w = angular_velocity_in_body(), c = cast<S>(load.rotational);
        apply_torque(rotate(orientation_, Vector3<S>(-c[0] * w[0], -c[1] * w[1], -c[2] * w[2])), h);
        if (load.translational != 0) apply_at_mass_center(S(-load.translational) * mass_center_velocity_W(), h);
    }
    void apply(const Spring& load, double, S h) {
        const Quaternion<S> r = cast<S>(conjugate(normalized(load.rest_orientation))) * orientation_;
        apply_torque(rotate(orientation_, (-2 * S(load.stiffness) * r.w) * vector_part(r)), h);
    }
    void apply(const UserTorque& load, double t, S h) {
        const LoadState state{t, cast<double>(orientation_), cast<double>(angular_velocity_in_body()),
                              cast<double>(position_ + rotate(orientation_, mass_center_B_)),
                              cast<double>(mass_center_velocity_W())};
        apply_torque(rotate(orientation_, cast<S>(load.torque_B(state))), h);
    }
    void apply(const Impulse&, double, double) {}
    // Loads of scenes with several bodies.
    void apply(const Motor&, double, double) {}
    void apply(const FormulaLoad&, double, double) {}
    void apply(const PointSpring&, double, double) {}

    void update_body_orientation(S h) {
        Vector3<S>& w = angular_velocity_;
        if constexpr (printed_sign)
            w = w + h * (inverse_world_inertia_ * cross(w, world_inertia_ * w));
        else if constexpr (!in_body)
            w = w + h * (inverse_world_inertia_ * cross(world_inertia_ * w, w));
        else
            w = w + h * (inverse_inertia_B_ * cross(inertia_B_ * w, w));
        const Vector3<S> world_com = position_ + rotate(orientation_, rotation_center_B_);
        const Vector3<S> com_to_position = position_ - world_com;
        // Without rotation there is no axis.
        const S rate = std::sqrt(dot(w, w));
        if (rate == 0) return;
        const Quaternion<S> theta = quaternion_angle_axis(rate * h, w);
        if constexpr (in_body) {
            orientation_ = orientation_ * theta;
            position_ = world_com - rotate(orientation_, rotation_center_B_);
        } else {
            orientation_ = theta * orientation_;
            position_ = world_com + rotate(theta, com_to_position);
        }
    }

    const Problem* problem_;
    bool pivoted_ = false;
    S mass_ = 1;
    Matrix3<S> inertia_B_, inverse_inertia_B_, world_inertia_, inverse_world_inertia_;
    Vector3<S> mass_center_B_, rotation_center_B_;  ///< from the body's origin
    std::vector<const Load*> loads_;                ///< loads that act on this segment, in file order

    Quaternion<S> orientation_;
    Vector3<S> angular_velocity_;  ///< world axes; body axes in the body-frame form
    Vector3<S> linear_velocity_;   ///< velocity of the centre of mass
    Vector3<S> position_;          ///< position of the body's origin
    long steps_ = 0;
};

template <ArticleForm form, class S = double>
Trajectory solve_article(const Problem& problem, const Settings& settings) {
    return march<ArticleStepper<form, S>>(problem, settings);
}

std::string article_refusal(const Problem& problem) {
    return problem.scene.pivot && !(*problem.scene.pivot == Vector3<double>())
               ? "the article rotates a body about its origin; a pivot elsewhere is not supported"
               : "";
}

constexpr std::string_view article_source =
    "an article on rotational dynamics for game programmers (apply_torque, "
    "update_body_orientation); corrected by Euler's equations";

constexpr Method article_variants[] = {
    {.name = "article_as_written",
     .documentation =
         "The article's update as printed. Its internal torque has the wrong sign, w += h I^-1 (w x Iw), so it "
         "converges, with order 1, to I dw/dt = tau + w x Iw, which is a different motion. Where forces are "
         "applied, the offset of the centre of mass is not rotated into world axes.",
     .origin = "article: apply_torque and update_body_orientation, as printed",
     .solve = solve_article<ArticleForm::as_written>},
    {.name = "article_offset_as_written",
     .documentation =
         "The article's `apply_torque` as printed, x_com = position + center_of_mass with the offset in body axes, "
         "in the corrected update: only the first of the article's two errors. It matters if a force acts on a "
         "rotated body whose centre of mass is not its origin. Otherwise the result equals that of "
         "`article_mended`, bit for bit.",
     .origin = "article: apply_torque's centre of mass as printed, sign corrected",
     .solve = solve_article<ArticleForm::offset_as_written>},
    {.name = "article_sign_as_written",
     .documentation = "The article's `update_body_orientation` as printed, w += h I^-1 (w x Iw), with the corrected "
                      "`apply_torque`: only the second error. It converges, with order 1, to I dw/dt = tau + w x Iw.",
     .origin = "article: update_body_orientation's sign as printed, centre of mass corrected",
     .solve = solve_article<ArticleForm::sign_as_written>},
    {.name = "article_mended",
     .documentation =
         "The article's update with the sign of Euler's equations, w -= h I^-1 (w x Iw), and the offset of the centre "
         "of mass rotated into world axes. The tensor is rotated and inverted again at every step. Order 1.",
     .origin = "article: sign and centre of mass corrected",
     .solve = solve_article<ArticleForm::corrected>},
    {.name = "article_body_frame",
     .documentation =
         "The corrected update in body axes, the article's other suggestion. It does not rotate the tensor. The "
         "motion equals that of `article_mended` except for rounding, at lower cost.",
     .origin = "article: \"put the body in its local coordinates\"",
     .solve = solve_article<ArticleForm::body_frame>},
};

constexpr auto article_binary64_family =
    apply_defaults({.source = article_source,
                    .conserves = "|q| to round-off",
                    .control = Control::fixed_step,
                    .order = 1,
                    .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
                    .family = Family::published_update,
                    .refusal = article_refusal},
                   article_variants);

constexpr auto article_family =
    with_binary32<article_binary64_family, binary32_refusal, solve_article<ArticleForm::as_written, float>,
                  solve_article<ArticleForm::offset_as_written, float>,
                  solve_article<ArticleForm::sign_as_written, float>, solve_article<ArticleForm::corrected, float>,
                  solve_article<ArticleForm::body_frame, float>>();

}  // namespace

extern const std::span<const Method> article_methods{article_family};

}  // namespace polhode
