// Adds binary32 variants to a family of methods for mechanisms.
#pragma once

#include "integrators/multibody/refusals.h"
#include "integrators/run/binary32.h"

namespace polhode::multibody {

/// with_binary32() for scenes of several bodies.
template <const auto& methods, auto... solves>
constexpr auto with_binary32_variants() {
    auto all = with_binary32<methods, mechanism_binary32_refusal, solves...>();
    // a mechanism is posed as a system other than one body
    for (Method& method : all) method.general_systems = true;
    return all;
}

}  // namespace polhode::multibody
