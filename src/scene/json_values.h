// Vectors, quaternions and other values of scene files.
#pragma once

#include <array>
#include <string>

#include "body/algebra.h"
#include "text/json_document.h"

namespace polhode {

/// Parses a number > 0; `what` names it in the message ("the mass").
double positive(const JsonNode& node, const char* what);

/// Parses [x, y, z].
inline Vector3<double> vector3(const JsonNode& node) {
    const auto& e = node.elements();
    if (e.size() != 3) node.fail(node.describe(), "give 3 numbers [x, y, z]");
    return {e[0]->number(), e[1]->number(), e[2]->number()};
}

/// Parses [w, x, y, z]. Does not check the norm.
inline Quaternion<double> quaternion(const JsonNode& node) {
    const auto& e = node.elements();
    if (e.size() != 4) node.fail(node.describe(), "give a quaternion of 4 numbers [w, x, y, z]");
    return {e[0]->number(), e[1]->number(), e[2]->number(), e[3]->number()};
}

/// Parses an array of two numbers.
inline std::array<double, 2> two_numbers(const JsonNode& node) {
    const auto& e = node.elements();
    if (e.size() != 2) node.fail(node.describe(), "give 2 numbers, one for each axis");
    return {e[0]->number(), e[1]->number()};
}

/// Canonical JSON: each number as the shortest decimal that reads back to the same binary64.
std::string write_json(const Vector3<double>& v);
std::string write_json(const Quaternion<double>& q);
std::string write_json(const std::array<double, 2>& pair);

}  // namespace polhode
