// How a body is described in a scene file, as data from which its mass properties follow exactly.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "body/mesh.h"
#include "body/shapes.h"
#include "scene/scene.h"

namespace polhode {

/// Either the mass (kg) or the density (kg/m^3; kg/m^2 for a disc or plate, kg/m for a rod). Negative for a hole.
struct Amount {
    double value = 0;
    bool is_density = false;
};

/// Mass (kg), tensor about the centre of mass (kg m^2) and centre of mass (m), given as numbers.
struct NumericBody {
    double mass = 1;
    Matrix3<double> inertia;
    Vector3<double> center_of_mass;
};
/// A uniform body with a shape.
struct ShapedBody {
    Shape shape;
    Amount amount;
};
/// A body of point masses.
struct PointsBody {
    std::vector<PointMass<double>> points;
};
/// A closed surface from a file.
struct MeshBody {
    std::string file;  ///< as written in the scene
    std::string hash;  ///< hash of the file's bytes
    Mesh mesh;
    Amount amount;
};
/// Bodies placed by their own origins: rotated by the normalised orientation, then translated.
struct PartsBody {
    struct Part {
        std::shared_ptr<const BodySource> body;
        Vector3<double> position;
        Quaternion<double> orientation;
    };
    std::vector<Part> parts;
};

/// Three successive rotations about coordinate axes, each by an angle in rad or degrees.
struct EulerRotation {
    std::array<int, 3> axes{0, 1, 2};
    Vector3<double> angles;
    bool in_degrees = false;
    bool intrinsic = false;  ///< intrinsic: each axis follows the previous rotations; else fixed axes
};
/// The inertial of a robot description. Its frame is relative to the link; the tensor is about the centre of mass in
/// the axes of the inertial's frame.
struct ImportedBody {
    std::string file, link;  ///< as written in the scene
    std::string hash;        ///< hash of the file's bytes
    double mass = 0;
    Matrix3<double> inertia;
    Vector3<double> center_of_mass;
    std::variant<Quaternion<double>, EulerRotation> orientation;
};

using BodyDefinition = std::variant<NumericBody, ShapedBody, PointsBody, MeshBody, PartsBody, ImportedBody>;

/// The former name of NumericBody.
using GivenBody [[deprecated("renamed to NumericBody")]] = NumericBody;
/// The former name of EulerRotation.
using EulerTurn [[deprecated("renamed to EulerRotation")]] = EulerRotation;
/// The former name of BodyDefinition.
using MadeOf [[deprecated("renamed to BodyDefinition")]] = BodyDefinition;

/// The description of a body and its mass properties.
struct BodySource {
    BodyDefinition definition;
    MassProperties<Wide> wide;  ///< the resulting mass properties, to 113 bits
};

/// The orientation as a unit quaternion in the scalar S.
template <class S>
Quaternion<S> unit_quaternion(const std::variant<Quaternion<double>, EulerRotation>& orientation) {
    if (const auto* q = std::get_if<Quaternion<double>>(&orientation)) return normalized(cast<S>(*q));
    const EulerRotation& turn = std::get<EulerRotation>(orientation);
    Quaternion<S> q;
    for (int i = 0; i < 3; ++i) {
        if (turn.angles[i] == 0) continue;
        S angle(turn.angles[i]);
        if (turn.in_degrees) angle = angle * Elementary<S>::pi() / S(180);
        Vector3<S> axis;
        Quaternion<S> one;
        Elementary<S>::sine_cosine(S(angle / S(2)), axis[turn.axes[i]], one.w);
        one = {one.w, axis[0], axis[1], axis[2]};
        q = turn.intrinsic ? q * one : one * q;
    }
    return q;
}

/// Computes the exact real function of the source's binary64 numbers, in the scalar S.
template <class S>
struct MassPropertiesOf {
    MassProperties<S> operator()(const NumericBody& given) const {
        return {S(given.mass), cast<S>(given.center_of_mass), symmetric(given.inertia)};
    }
    MassProperties<S> operator()(const ShapedBody& shaped) const {
        const S amount(shaped.amount.value);
        return shaped.amount.is_density ? body_from_density<S>(shaped.shape, amount)
                                        : body_from_mass<S>(shaped.shape, amount);
    }
    MassProperties<S> operator()(const PointsBody& body) const {
        std::vector<PointMass<S>> points;
        points.reserve(body.points.size());
        for (const PointMass<double>& point : body.points) points.push_back({S(point.mass), cast<S>(point.position)});
        return body_from_points(points);
    }
    MassProperties<S> operator()(const MeshBody& body) const {
        const S amount(body.amount.value);
        const Extent<S> e = mesh_extent<S>(body.mesh);
        return uniform_body(e, body.amount.is_density ? S(amount * e.size) : amount);
    }
    MassProperties<S> operator()(const PartsBody& body) const;
    MassProperties<S> operator()(const ImportedBody& body) const {
        return {S(body.mass), cast<S>(body.center_of_mass),
                rotated(symmetric(body.inertia), unit_quaternion<S>(body.orientation))};
    }

    // an asymmetry within the accepted 1e-12 is input rounding: use the mean of the two entries
    static Matrix3<S> symmetric(const Matrix3<double>& inertia) {
        Matrix3<S> m = cast<S>(inertia);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) m[i][j] = m[j][i] = (m[i][j] + m[j][i]) / S(2);
        return m;
    }
};

/// The mass properties of a source, in the scalar S.
template <class S>
MassProperties<S> mass_properties(const BodySource& source) {
    if constexpr (std::is_same_v<S, Wide>) {
        return source.wide;
    } else if constexpr (std::is_same_v<S, double>) {
        return {double(source.wide.mass), cast<double>(source.wide.center), cast<double>(source.wide.inertia)};
    } else {
        return std::visit(MassPropertiesOf<S>{}, source.definition);
    }
}

template <class S>
MassProperties<S> MassPropertiesOf<S>::operator()(const PartsBody& body) const {
    std::vector<MassProperties<S>> parts;
    for (const PartsBody::Part& part : body.parts)
        parts.push_back(
            placed(mass_properties<S>(*part.body), cast<S>(part.position), normalized(cast<S>(part.orientation))));
    return composite(parts);
}

/// The mass properties of a scene's body: the exact function of its binary64 numbers, in the scalar S.
template <class S>
MassProperties<S> mass_properties(const Body& body) {
    if (body.source) return mass_properties<S>(*body.source);
    return MassPropertiesOf<S>{}(NumericBody{body.mass, body.inertia_B, body.center_of_mass});
}

/// Creates a source with its mass properties.
std::shared_ptr<const BodySource> body_source(BodyDefinition definition);

/// The scene body of this source, with each number rounded once. Does not check that the numbers are physical: see
/// validate().
Body body_of(std::shared_ptr<const BodySource> source);

/// Why no mass distribution can have this tensor (kg m^2, about its centre of mass), in a few words; empty if one
/// can. Checks symmetry, sign and the triangle inequality within 1e-12 of the largest moment. Moments may be 0.
std::string tensor_fault(const Matrix3<double>& inertia);

/// "has norm .." if the quaternion's length differs from 1 by more than 1e-6, else an empty text. norm_remedy is the
/// matching remedy.
std::string norm_fault(const Quaternion<double>& q);
inline constexpr const char* norm_remedy = "give a unit quaternion [w, x, y, z] with norm 1 within 1e-6";

/// Whether the body was described with its shape: by a shape, a mesh, or parts of these.
bool has_shape(const BodySource& source);

}  // namespace polhode
