// Contacts of several free spheres with each other and with planes: reader, writer, checks, and lists of contacts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene/scene_check.h"
#include "text/json_document.h"

namespace polhode {

/// Whether the scene has several bodies that touch planes or each other.
inline bool has_sphere_contacts(const Scene& scene) {
    return is_mechanism(scene) && (!scene.planes.empty() || !scene.contacts.empty());
}

/// Two spheres that collide.
struct SpherePair {
    std::size_t first = 0, second = 0;  ///< indices of the bodies
    double restitution = 1, friction = 0;
};

/// The pairs of spheres that collide, in the order in which simultaneous impacts are resolved: that of the entries,
/// and within an entry for all pairs that of the bodies. The scene must be valid.
std::vector<SpherePair> sphere_pairs(const Scene& scene);

/// The scene of one of several spheres alone: its loads and all planes. A scene of one body is returned as it is.
Scene scene_of_sphere(const Scene& scene, std::size_t body);

/// Number of an event's contact: planes + bodies for each body. For one body it is the index of the plane.
inline std::size_t contact_with_plane(const Scene& scene, std::size_t body, std::size_t plane) {
    return body * (scene.planes.size() + scene.bodies.size()) + plane;
}
/// Number of the contact of a body with another one.
inline std::size_t contact_with_body(const Scene& scene, std::size_t body, std::size_t other) {
    return contact_with_plane(scene, body, scene.planes.size() + other);
}
/// Names of the body ("body" in a scene of one body) and of the plane or other body of a contact.
struct ContactNames {
    std::string body, other;
};
ContactNames contact_names(const Scene& scene, std::size_t contact);

/// Parses one element of "contacts". Throws InputError.
SphereContact parse_sphere_contact(const JsonNode& node);

/// The entry as canonical JSON.
std::string write_sphere_contact(const SphereContact& contact);

/// Checks planes and contacts of a scene of several bodies. Throws InputError.
void check_sphere_contacts(const SceneCheck& check, const Scene& scene);

}  // namespace polhode
