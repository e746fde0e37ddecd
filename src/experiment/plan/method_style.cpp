#include "experiment/plan/method_style.h"

#include "integrators/engines/engine_methods.h"

namespace polhode {

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
