// The first formulation of the truth: Euler's equations in body axes, from the one right-hand side of
// motion/equations.h, with the full tensor. State: w_B, q, and p, v where there is no pivot.
#pragma once

#include <vector>

#include "integrators/truth/motion.h"
#include "motion/body_equations.h"
#include "motion/exact_body_of.h"
#include "motion/problem.h"

namespace polhode::truth {

template <class P>
class EulerForm {
  public:
    static constexpr const char* name = "Euler form";

    explicit EulerForm(const Scene& scene)
        : scene_(&scene), body_(exact_body<P>(scene)), inertia_{body_.inertia_B, inverse(body_.inertia_B)} {}

    int dimension() const { return body_.pivoted ? 7 : 13; }
    const ExactBody<P>& body() const { return body_; }
    const Forcing<P>& forcing() const { return forcing_; }  ///< of the piece last entered

    std::vector<Block> blocks(const Scales& scales, const Vector3<double>&) const {
        std::vector<Block> blocks{{0, 3, scales.angular_velocity}, {3, 4, 1}};
        if (!body_.pivoted) blocks.insert(blocks.end(), {{7, 3, scales.position}, {10, 3, scales.velocity}});
        return blocks;
    }

    void initial(P* y) const {
        put(y, 0, body_.angular_velocity_B);
        put(y, 3, body_.q);
        if (body_.pivoted) return;
        put(y, 7, body_.position_W);
        put(y, 10, body_.velocity_W);
    }

    /// Takes up the loads that act from `begin` on, and applies the impulses at that time to y.
    void enter(double begin, P* y) {
        forcing_ = forcing_at<P>(*scene_, body_, begin, Quaternion<P>{});
        for (const PosedImpulse<P>& impulse : impulses_at<P>(*scene_, body_, begin, Quaternion<P>{})) {
            Vector3<P> w = vector_at(y, 0), p, v;
            if (!body_.pivoted) p = vector_at(y, 7), v = vector_at(y, 10);
            apply(impulse, inertia_, body_.mass, body_.pivoted, w, quaternion_at(y, 3), p, v);
            put(y, 0, w);
            if (!body_.pivoted) put(y, 10, v);
        }
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        if (body_.pivoted)
            derivative_of<false>(y, dy);
        else
            derivative_of<true>(y, dy);
    }
    /// The same where it is known whether there is translation, which is where there is no pivot.
    template <bool translation, class S>
    void derivative_of(const S* y, S* dy) const {
        LoadedEquations<P, FullInertia<P>, translation>{inertia_, &forcing_}.derivative(0, y, dy);
    }

    Motion<P> motion(const P* y) const {
        Motion<P> m;
        m.q = normalized(quaternion_at(y, 3));
        m.angular_velocity_B = vector_at(y, 0);
        if (body_.pivoted)
            pivoted_center(m.q, m.angular_velocity_B, body_.arm, m.position_W, m.velocity_W);
        else
            m.position_W = vector_at(y, 7), m.velocity_W = vector_at(y, 10);
        return m;
    }

  private:
    const Scene* scene_;
    ExactBody<P> body_;
    FullInertia<P> inertia_;
    Forcing<P> forcing_;
};

}  // namespace polhode::truth
