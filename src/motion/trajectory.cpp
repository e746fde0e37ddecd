#include "motion/trajectory.h"

namespace polhode {

const char* name_of(Status status) {
    switch (status) {
        case Status::ok:
            return "ok";
        case Status::unsupported:
            return "unsupported";
        case Status::diverged:
            return "diverged";
        case Status::tolerance_not_met:
            return "tolerance_not_met";
        case Status::failed:
            break;
    }
    return "failed";
}

Vector3<double> angular_velocity_W(const Sample& sample) {
    return (1 / squared_norm(sample.q)) * rotate(sample.q, sample.angular_velocity_B);
}

}  // namespace polhode
