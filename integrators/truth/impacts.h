// The reference's two formulations, with impacts on planes.
#pragma once

#include <algorithm>
#include <vector>

#include "integrators/truth/euler_form.h"
#include "integrators/truth/momentum_form.h"
#include "motion/contact.h"

namespace polhode::truth {

/// Euler form; impulses are computed by motion/impact.h.
template <class P>
class EulerFormWithPlanes : public EulerForm<P> {
  public:
    explicit EulerFormWithPlanes(const Scene& scene)
        : EulerForm<P>(scene),
          inverse_inertia_(inverse(this->body().inertia_B)),
          geometry_(contact_geometry(scene, this->body().center, Quaternion<P>{})) {}

    const ContactGeometry<P>& geometry() const { return geometry_; }
    Placement<P> placement(const P* y) const {
        const Quaternion<P> q = normalized(this->attitude(y));
        return {q, this->position(y), this->velocity(y), rotate(q, this->angular_velocity(y))};
    }
    P max_speed(const P& w, const P& v) const { return v + geometry_.reach * w; }
    ImpactOutcome apply_impact(const P& tolerance, P* y) const {
        const Placement<P> at = placement(y);
        ImpactBody<P> body{P(1) / this->body().mass, rotated(inverse_inertia_, at.q), at.position_W, at.velocity_W,
                           at.angular_velocity_W};
        const ImpactOutcome outcome = resolve_impact(body, geometry_.contacts(at, tolerance));
        const Vector3<P> jump_W = body.angular_velocity_W - at.angular_velocity_W;
        this->set_rotation(y, Vector3<P>(this->angular_velocity(y) + rotate_back(at.q, jump_W)), this->attitude(y));
        this->set_translation(y, this->position(y), body.velocity_W);
        return outcome;
    }

  private:
    Matrix3<P> inverse_inertia_;
    ContactGeometry<P> geometry_;
};

/// Momentum form. The impulse of a single contact is computed from the change that a unit impulse on P and L makes to
/// the speed of the contact point, independently of motion/impact.h. Several simultaneous contacts use motion/impact.h.
template <class P>
class MomentumFormWithPlanes : public MomentumForm<P> {
  public:
    explicit MomentumFormWithPlanes(const Scene& scene)
        : MomentumForm<P>(scene),
          body_(mass_properties<P>(scene.body)),
          inverse_inertia_(inverse(body_.inertia)),
          geometry_(contact_geometry(scene, body_.center, Quaternion<P>{})) {
        for (const Vector3<P>& row : inverse_inertia_.row) inverse_size_ += dot(row, row);
        inverse_size_ = square_root(inverse_size_);
    }

    const ContactGeometry<P>& geometry() const { return geometry_; }
    Placement<P> placement(const P* y) const {
        const Motion<P> m = this->motion(y);
        return {m.q, m.position_W, m.velocity_W, rotate(m.q, m.angular_velocity_B)};
    }
    P max_speed(const P& L, const P& momentum) const {
        return momentum / body_.mass + geometry_.reach * (inverse_size_ * L);
    }
    ImpactOutcome apply_impact(const P& tolerance, P* y) const {
        const Placement<P> at = placement(y);
        const std::vector<Contact<P>> touching = geometry_.contacts(at, tolerance);
        if (touching.size() == 1) {
            const Contact<P>& contact = touching.front();
            const Vector3<P>& n = contact.normal_W;
            const Vector3<P> r = contact.point_W - at.position_W;
            const P before = speed(y, r, n);
            if (!(before < P(0))) return {};
            std::vector<P> pushed(y, y + this->dimension());
            push(pushed.data(), r, n, P(1));
            const P response = speed(pushed.data(), r, n) - before;
            push(y, r, n, -(P(1) + contact.restitution) * before / response);
            return {true, true, speed(y, r, n).template convert_to<double>()};
        }
        ImpactBody<P> body{P(1) / body_.mass, rotated(inverse_inertia_, at.q), at.position_W, at.velocity_W,
                           at.angular_velocity_W};
        const ImpactOutcome outcome = resolve_impact(body, touching);
        const Vector3<P> w_B = rotate_back(at.q, body.angular_velocity_W);
        this->set_momenta(y, rotate(at.q, Vector3<P>(body_.inertia * w_B)), Vector3<P>(body_.mass * body.velocity_W));
        return outcome;
    }

  private:
    void push(P* y, const Vector3<P>& r, const Vector3<P>& n, const P& j) const {
        this->set_momenta(y, Vector3<P>(this->angular_momentum(y) + j * cross(r, n)),
                          Vector3<P>(this->linear_momentum(y) + j * n));
    }
    // speed along n of the body's point at r from the centre of mass, world axes
    P speed(const P* y, const Vector3<P>& r, const Vector3<P>& n) const {
        const Placement<P> at = placement(y);
        return dot(n, at.velocity_W) + dot(at.angular_velocity_W, cross(r, n));
    }

    MassProperties<P> body_;
    Matrix3<P> inverse_inertia_;
    ContactGeometry<P> geometry_;
    P inverse_size_ = P(0);  // upper bound of the factor by which I^-1 lengthens a vector
};

}  // namespace polhode::truth
