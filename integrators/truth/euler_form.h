// First formulation of the reference: Euler's equations in body axes, with the full tensor, from the right-hand side in
// motion/equations.h that all methods share. State: w_B, q, and p, v if there is no pivot.
#pragma once

#include <vector>

#include "integrators/truth/motion.h"
#include "motion/body_equations.h"
#include "motion/exact_body_of.h"
#include "motion/problem.h"

namespace polhode::truth {

template <class P>
class EulerForm : public BodyState {
  public:
    static constexpr const char* name = "Euler form";

    explicit EulerForm(const Scene& scene)
        : scene_(&scene), body_(exact_body<P>(scene)), inertia_{body_.inertia_B, inverse(body_.inertia_B)} {}

    int dimension() const { return body_.pivoted ? BodyState::rotation : BodyState::motion; }
    const ExactBody<P>& body() const { return body_; }
    const Forcing<P>& forcing() const { return forcing_; }  ///< forcing of the piece entered last

    std::vector<truth::Block> blocks(const Scales& scales, const Vector3<double>&) const {
        const double size[] = {scales.angular_velocity, 1, scales.position, scales.velocity};
        std::vector<truth::Block> all;
        for (std::size_t b = 0; b < (body_.pivoted ? 2 : BodyState::blocks.size()); ++b)
            all.push_back({BodyState::blocks[b].first, BodyState::blocks[b].size, size[b]});
        return all;
    }

    void initial(P* y) const {
        set_rotation(y, body_.angular_velocity_B, body_.q);
        if (!body_.pivoted) set_translation(y, body_.position_W, body_.velocity_W);
    }

    /// Sets the loads that act from `begin` on, and applies the impulses at that time to y.
    void enter(double begin, P* y) {
        forcing_ = forcing_at<P>(*scene_, body_, begin, Quaternion<P>{});
        for (const PosedImpulse<P>& impulse : impulses_at<P>(*scene_, body_, begin, Quaternion<P>{})) {
            Vector3<P> w = angular_velocity(y), p, v;
            const Quaternion<P> q = attitude(y);
            if (!body_.pivoted) p = position(y), v = velocity(y);
            apply(impulse, inertia_, body_.mass, body_.pivoted, w, q, p, v);
            set_rotation(y, w, q);
            if (!body_.pivoted) set_translation(y, p, v);
        }
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        if (body_.pivoted)
            derivative_of<false>(y, dy);
        else
            derivative_of<true>(y, dy);
    }
    /// The derivative for known `translation`, which is true if there is no pivot.
    template <bool translation, class S>
    void derivative_of(const S* y, S* dy) const {
        LoadedEquations<P, FullInertia<P>, translation>{inertia_, &forcing_}.derivative(0, y, dy);
    }

    Motion<P> motion(const P* y) const {
        Motion<P> m;
        m.q = normalized(attitude(y));
        m.angular_velocity_B = angular_velocity(y);
        if (body_.pivoted)
            pivoted_center(m.q, m.angular_velocity_B, body_.arm, m.position_W, m.velocity_W);
        else
            m.position_W = position(y), m.velocity_W = velocity(y);
        return m;
    }

  private:
    const Scene* scene_;
    ExactBody<P> body_;
    FullInertia<P> inertia_;
    Forcing<P> forcing_;
};

}  // namespace polhode::truth
