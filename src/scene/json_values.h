// Vectors, quaternions and the like, as scene files have them.
#pragma once

#include "body/algebra.h"
#include "text/json_document.h"

namespace polhode {

/// A number > 0; `what` names it in the message: "the mass".
double positive(const JsonNode& node, const char* what);

inline Vector3<double> vector3(const JsonNode& node) {
    const auto& e = node.elements();
    if (e.size() != 3) node.fail(node.described(), "give 3 numbers [x, y, z]");
    return {e[0]->number(), e[1]->number(), e[2]->number()};
}

inline Quaternion<double> quaternion(const JsonNode& node) {
    const auto& e = node.elements();
    if (e.size() != 4) node.fail(node.described(), "give a quaternion of 4 numbers [w, x, y, z]");
    return {e[0]->number(), e[1]->number(), e[2]->number(), e[3]->number()};
}

}  // namespace polhode
