#include "scene/body_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "body/orientation.h"
#include "body/rigid_body.h"
#include "scene/contact_shape.h"
#include "text/decimal.h"

namespace polhode {

std::shared_ptr<const BodySource> body_source(BodyDefinition definition) {
    auto source = std::make_shared<BodySource>();
    source->definition = std::move(definition);
    source->wide = std::visit(MassPropertiesOf<Wide>{}, source->definition);
    return source;
}

Body body_of(std::shared_ptr<const BodySource> source) {
    // plain numbers are exact and need no source
    if (const auto* given = std::get_if<NumericBody>(&source->definition))
        return {given->mass, given->inertia, given->center_of_mass, nullptr};
    const auto [mass, center, inertia] = mass_properties<double>(*source);
    return {mass, inertia, center, std::move(source)};
}

std::string tensor_fault(const Matrix3<double>& J) {
    constexpr double tolerance = 1e-12;  // relative to the largest moment
    const Vector3<double> I = principal_frame(cast<Wide>(J)).moments;
    const double largest = std::max({std::abs(I[0]), std::abs(I[1]), std::abs(I[2])});
    if (!std::isfinite(largest)) return "is too large for binary64";
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < i; ++j)
            if (!(std::abs(J[i][j] - J[j][i]) <= tolerance * largest)) return "is not symmetric";
        if (I[i] < -tolerance * largest) return "has the principal moment " + shortest_decimal(I[i]);
        if (I[i] - I[(i + 1) % 3] - I[(i + 2) % 3] > tolerance * largest)
            return "has moments that violate the triangle inequality";
    }
    return "";
}

std::string norm_fault(const Quaternion<double>& q) {
    const double length = norm(q);
    return std::abs(length - 1) <= 1e-6 ? "" : "has norm " + shortest_decimal(length);
}

PartsBody with_contact_shape(NumericBody numbers, Shape shape) {
    PartsBody body;
    body.parts.push_back({body_source(numbers), {}, {}});
    body.parts.push_back({body_source(ShapedBody{std::move(shape), {0, false}}), {}, {}});
    return body;
}

const Shape* contact_shape(const PartsBody& body) {
    if (body.parts.size() != 2) return nullptr;
    const auto* hull = std::get_if<ShapedBody>(&body.parts[1].body->definition);
    return hull && hull->amount.value == 0 ? &hull->shape : nullptr;
}

const NumericBody& numbers_beside_contact_shape(const PartsBody& body) {
    return std::get<NumericBody>(body.parts.front().body->definition);
}

bool has_shape(const BodySource& source) {
    if (const auto* parts = std::get_if<PartsBody>(&source.definition))
        return contact_shape(*parts) || std::all_of(parts->parts.begin(), parts->parts.end(),
                                                    [](const PartsBody::Part& part) { return has_shape(*part.body); });
    return std::holds_alternative<ShapedBody>(source.definition) || std::holds_alternative<MeshBody>(source.definition);
}

}  // namespace polhode
