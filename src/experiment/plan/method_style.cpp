#include "experiment/plan/method_style.h"

#include "integrators/engines/engine_methods.h"

namespace polhode {

const char* name_of(Family family) {
    switch (family) {
        case Family::unnamed:
            break;
        case Family::closed_form:
            return "closed_form";
        case Family::series:
            return "series";
        case Family::extrapolation:
            return "extrapolation";
        case Family::runge_kutta:
            return "runge_kutta";
        case Family::multistep:
            return "multistep";
        case Family::splitting:
            return "splitting";
        case Family::rotation_group:
            return "rotation_group";
        case Family::published_update:
            return "published_update";
        case Family::engine_update:
            return "engine_update";
        case Family::points:
            return "points";
        case Family::reference:
            return "reference";
        case Family::engine:
            return "engine";
    }
    return "others";
}

MethodStyle method_style(const Method& method) {
    MethodStyle style{static_cast<int>(method.family), 0};
    for (const Method* other : methods()) {
        if (other == &method) return style;
        if (other->family == method.family) ++style.mark;
    }
    if (method.family != Family::engine) return style;
    for (const EngineMethod& engine : engines()) {
        if (engine.method.get() == &method) break;
        ++style.mark;
    }
    return style;
}

}  // namespace polhode
