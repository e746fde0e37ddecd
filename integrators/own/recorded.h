// A system's right-hand side, recorded.
#pragma once

#include "motion/traced.h"

namespace polhode {

/// With the loads of the segment that it has entered. T: what constants are kept in.
template <class T, class SystemType>
Recording<T> recorded(const SystemType& system) {
    struct Form {
        const SystemType* system;
        void derivative(const Traced<T>* y, Traced<T>* dy) const { system->derivative(0, y, dy); }
    };
    return record<T>(Form{&system}, system.size());
}

}  // namespace polhode
