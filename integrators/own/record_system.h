// Records a system's right-hand side.
#pragma once

#include "motion/traced.h"

namespace polhode {

/// Records it with the loads of the segment that the system has entered. T: type of the constants.
template <class T, class SystemType>
Recording<T> record_system(const SystemType& system) {
    struct Form {
        const SystemType* system;
        void derivative(const Traced<T>* y, Traced<T>* dy) const { system->derivative(0, y, dy); }
    };
    return record<T>(Form{&system}, system.size());
}

}  // namespace polhode
