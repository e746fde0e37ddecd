#include "motion/trajectory.h"

namespace polhode {

const char* name_of(Status status) {
    constexpr const char* names[] = {"ok", "unsupported", "diverged", "tolerance_not_met", "failed"};
    return names[static_cast<std::size_t>(status)];
}

Vector3<double> angular_velocity_W(const Sample& sample) {
    return (1 / squared_norm(sample.q)) * rotate(sample.q, sample.angular_velocity_B);
}

}  // namespace polhode
