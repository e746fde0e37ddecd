// Base of steppers in maximal coordinates (integrators/run/march.h) with scalar S: everything except step().
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/multibody/active_loads.h"
#include "integrators/run/march.h"
#include "motion/mechanism.h"

namespace polhode::multibody {

template <class S>
class MaximalState {
  public:
    explicit MaximalState(const Problem& problem) {
        auto shared = std::make_shared<Shared>(Shared{maximal::Mechanism<double>(problem.scene), {}, {}, {}});
        const std::vector<BodyMotion<double>> start = mechanism_initial_motions(problem.scene);
        for (std::size_t b = 0; b <= start.size(); ++b) {
            MovingBody<S> body;
            body.R = diagonal(Vector3<S>(1, 1, 1));
            if (b < start.size()) {
                const maximal::MaximalBody<double>& source = shared->mechanism.bodies[b];
                body.movable = source.movable;
                body.mass = S(source.mass);
                if (source.movable) {
                    body.inverse_mass = S(1 / source.mass);
                    body.inertia = {cast<S>(source.inertia), cast<S>(source.inverse_inertia)};
                }
                body.q = cast<S>(start[b].q), body.x = cast<S>(start[b].position_W);
                body.v = cast<S>(start[b].velocity_W);
                body.w = cast<S>(rotate(start[b].q, start[b].angular_velocity_B));
                body.update_rotation();
            }
            shared->start.push_back(body);
        }
        const auto& links = shared->mechanism.links;
        for (std::size_t k = 0; k < links.size(); ++k) {
            if (!shared->mechanism.movable(links[k].from.body) && !shared->mechanism.movable(links[k].to.body))
                continue;
            shared->pairs.push_back(make_joint_pair<S>(links[k], k));
        }
        // initial joint coordinates, including those of joints that the reader has moved
        for (const JointPair<S>& pair : shared->pairs) {
            std::array<S, 2> coordinate{S(links[pair.link].coordinate[0]), S(links[pair.link].coordinate[1])};
            if (pair.has_spring)
                update_coordinates(PairView<S>{pair, shared->start[pair.from], shared->start[pair.to]}, coordinate);
            shared->coordinates.push_back(coordinate);
        }
        shared_ = std::move(shared);
        restart();
    }

    void restart() {
        bodies_ = shared_->start, coordinates_ = shared_->coordinates;
        active_loads_ = {}, steps_ = 0;
    }
    /// An impulse changes only the velocity of the body that it acts on; the next step transmits it to the others.
    void enter(const Segment& segment) {
        active_loads_ = ActiveLoads<S>(shared_->mechanism, segment.begin);
        std::vector<WorldWrench<S>> impulses(bodies_.size());
        if (!ActiveLoads<S>::add_impulses(shared_->mechanism, segment.begin, bodies_, impulses)) return;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            bodies_[b].v = bodies_[b].v + bodies_[b].inverse_mass * impulses[b].force;
            bodies_[b].w = bodies_[b].w + bodies_[b].inverse_I_W * impulses[b].torque;
        }
    }
    std::vector<Sample> sample(double t) const {
        std::vector<Sample> samples;
        for (std::size_t b = 0; b + 1 < bodies_.size(); ++b) {
            const MovingBody<S>& body = bodies_[b];
            samples.push_back({t, cast<double>(body.q), cast<double>(transposed(body.R) * body.w), cast<double>(body.x),
                               cast<double>(body.v)});
        }
        return samples;
    }
    bool finite() const {
        for (const MovingBody<S>& body : bodies_)
            if (!all_finite(body.x, body.v, body.w) || !all_finite(body.q)) return false;
        return true;
    }
    long rhs_evaluations() const { return steps_; }

  protected:
    const std::vector<JointPair<S>>& pairs() const { return shared_->pairs; }
    PairView<S> view(const JointPair<S>& pair) const { return {pair, bodies_[pair.from], bodies_[pair.to]}; }

    /// v += h F / m, w += h I^-1 tau for all loads at the current state, and the `gyroscopic` term of w.
    template <GyroscopicTerm gyroscopic>
    void accelerate(S h) {
        wrenches_.assign(bodies_.size(), {});
        active_loads_.add_wrenches(bodies_, wrenches_);
        for (std::size_t k = 0; k < pairs().size(); ++k) {
            const JointPair<S>& pair = pairs()[k];
            const S motor = active_loads_.motor(pair.link);
            if (!pair.has_spring && !pair.has_damper && motor == S(0)) continue;
            if (pair.has_spring) update_coordinates(view(pair), coordinates_[k]);
            add_joint_forces(view(pair), motor, coordinates_[k], wrenches_[pair.from], wrenches_[pair.to]);
        }
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            MovingBody<S>& body = bodies_[b];
            if (!body.movable) continue;
            body.v = body.v + (h * body.inverse_mass) * wrenches_[b].force;
            if constexpr (gyroscopic != GyroscopicTerm::none)
                body.w =
                    body.R * body.inertia.template apply_gyroscopic_term<gyroscopic>(transposed(body.R) * body.w, h);
            body.w = body.w + h * (body.inverse_I_W * wrenches_[b].torque);
        }
    }

    /// x += h v, q = exp(h w) q.
    static void move(MovingBody<S>& body, S h, const Vector3<S>& v, const Vector3<S>& w) {
        if (!body.movable) return;
        body.x = body.x + h * v;
        body.rotate_by(h * w);
        body.update_rotation();
    }

    std::vector<MovingBody<S>> bodies_;  ///< in the scene's order, then the world
    /// One entry per pair; updated for joints with a spring, and by the method for others.
    std::vector<std::array<S, 2>> coordinates_;
    long steps_ = 0;

  private:
    struct Shared {
        maximal::Mechanism<double> mechanism;
        std::vector<MovingBody<S>> start;
        std::vector<JointPair<S>> pairs;
        std::vector<std::array<S, 2>> coordinates;  // one entry per pair
    };
    std::shared_ptr<const Shared> shared_;
    ActiveLoads<S> active_loads_;
    std::vector<WorldWrench<S>> wrenches_;
};

}  // namespace polhode::multibody
