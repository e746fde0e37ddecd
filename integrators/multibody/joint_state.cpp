#include "integrators/multibody/joint_state.h"

#include "body/orientation.h"

namespace polhode::multibody {

JointState::JointState(const Problem& problem)
    : initial_model_(std::shared_ptr<const MechanismModel>(problem.model(), &mechanism_of(problem))),
      y_(static_cast<std::size_t>(initial_model_->dimension())),
      dy_(y_.size()) {
    JointState::restart();
}

void JointState::restart() {
    model_ = initial_model_;
    model_->initial(y_.data());
    steps_ = 0;
}

void JointState::enter(const Segment& segment) {
    auto next = std::make_shared<MechanismModel>(*model_);
    next->enter(segment.begin, y_.data());
    model_ = std::move(next);
}

std::vector<Sample> JointState::sample(double t) const {
    std::vector<Sample> samples = model_->motion(y_.data());
    for (Sample& sample : samples) sample.t = t;
    return samples;
}

void JointState::advance_coordinates(double h, std::vector<double>& y) const {
    for (const Link<double>& link : tree().links().links) {
        double* const x = y.data() + link.coordinate;
        const double* const rate = y.data() + link.rate;
        if (link.coordinates() == 1) {
            x[0] += h * rate[0];
            continue;
        }
        const Vector3<double> turn(h * rate[0], h * rate[1], h * rate[2]);
        const Quaternion<double> q =
            normalized(Quaternion<double>{x[0], x[1], x[2], x[3]} * quaternion_from_rotation_vector(turn));
        x[0] = q.w, x[1] = q.x, x[2] = q.y, x[3] = q.z;
        if (link.kind == LinkJoint::free)
            for (int k = 0; k < 3; ++k) x[4 + k] += h * rate[3 + k];
    }
}

}  // namespace polhode::multibody
