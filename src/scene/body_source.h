// What a body is made of, as the scene file has it: data only, from which its mass properties follow exactly.
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

/// Either the mass (kg) or the density (kg/m^3; kg/m^2 of a disc or plate, kg/m of a rod), negative for a hole.
struct Amount {
    double value = 0;
    bool is_density = false;
};

/// Mass (kg), tensor about the centre of mass (kg m^2) and centre of mass (m), given as numbers.
struct GivenBody {
    double mass = 1;
    Matrix3<double> inertia;
    Vector3<double> center_of_mass;
};
struct ShapedBody {
    Shape shape;
    Amount amount;
};
struct PointsBody {
    std::vector<PointMass<double>> points;
};
/// A closed surface, from a file.
struct MeshBody {
    std::string file;  ///< as the scene names it
    std::string hash;  ///< of the file's bytes
    Mesh mesh;
    Amount amount;
};
/// Bodies placed by their own origins: turned by the orientation, which stands for its normalised value, then moved.
struct PartsBody {
    struct Part {
        std::shared_ptr<const BodySource> body;
        Vector3<double> position;
        Quaternion<double> orientation;
    };
    std::vector<Part> parts;
};

/// Three turns about axes of the frame, each an angle in rad or degrees.
struct EulerTurn {
    std::array<int, 3> axes{0, 1, 2};
    Vector3<double> angles;
    bool in_degrees = false;
    bool about_turned_axes = false;  ///< each about the axes as the ones before left them; else about fixed axes
};
/// The inertial of a robot description. Its frame stands in the link's; the tensor is about the centre of mass in the
/// axes of that frame.
struct ImportedBody {
    std::string file, link;  ///< as the scene names them
    std::string hash;        ///< of the file's bytes
    double mass = 0;
    Matrix3<double> inertia;
    Vector3<double> center_of_mass;
    std::variant<Quaternion<double>, EulerTurn> orientation;
};

using MadeOf = std::variant<GivenBody, ShapedBody, PointsBody, MeshBody, PartsBody, ImportedBody>;

struct BodySource {
    MadeOf made_of;
    MassProperties<Wide> wide;  ///< what follows from it, to 113 bits
};

/// The orientation in the scalar S, of unit length.
template <class S>
Quaternion<S> unit_quaternion(const std::variant<Quaternion<double>, EulerTurn>& orientation) {
    if (const auto* q = std::get_if<Quaternion<double>>(&orientation)) return normalized(cast<S>(*q));
    const EulerTurn& turn = std::get<EulerTurn>(orientation);
    Quaternion<S> q;
    for (int i = 0; i < 3; ++i) {
        if (turn.angles[i] == 0) continue;
        S angle(turn.angles[i]);
        if (turn.in_degrees) angle = angle * Elementary<S>::pi() / S(180);
        Vector3<S> axis;
        Quaternion<S> one;
        Elementary<S>::sine_cosine(S(angle / S(2)), axis[turn.axes[i]], one.w);
        one = {one.w, axis[0], axis[1], axis[2]};
        q = turn.about_turned_axes ? q * one : one * q;
    }
    return q;
}

/// The exact real function of the source's binary64 numbers, in the scalar S.
template <class S>
struct MassPropertiesOf {
    MassProperties<S> operator()(const GivenBody& given) const {
        return {S(given.mass), cast<S>(given.center_of_mass), symmetric(given.inertia)};
    }
    MassProperties<S> operator()(const ShapedBody& shaped) const {
        const S amount(shaped.amount.value);
        return shaped.amount.is_density ? of_density<S>(shaped.shape, amount) : of_mass<S>(shaped.shape, amount);
    }
    MassProperties<S> operator()(const PointsBody& body) const {
        std::vector<PointMass<S>> points;
        points.reserve(body.points.size());
        for (const PointMass<double>& point : body.points) points.push_back({S(point.mass), cast<S>(point.position)});
        return of_points(points);
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

    // asymmetry within the accepted 1e-12 is rounding of the input: the body has the mean of the two entries
    static Matrix3<S> symmetric(const Matrix3<double>& inertia) {
        Matrix3<S> m = cast<S>(inertia);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) m[i][j] = m[j][i] = (m[i][j] + m[j][i]) / S(2);
        return m;
    }
};

template <class S>
MassProperties<S> mass_properties(const BodySource& source) {
    if constexpr (std::is_same_v<S, Wide>) {
        return source.wide;
    } else if constexpr (std::is_same_v<S, double>) {
        return {double(source.wide.mass), cast<double>(source.wide.center), cast<double>(source.wide.inertia)};
    } else {
        return std::visit(MassPropertiesOf<S>{}, source.made_of);
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

/// The mass properties of a scene's body, the exact function of its binary64 numbers.
template <class S>
MassProperties<S> mass_properties(const Body& body) {
    if (body.source) return mass_properties<S>(*body.source);
    return MassPropertiesOf<S>{}(GivenBody{body.mass, body.inertia_B, body.center_of_mass});
}

/// A source made of these, with the mass properties that follow.
std::shared_ptr<const BodySource> body_source(MadeOf made_of);

/// A scene's body of this source, each of its numbers rounded once. Says nothing about whether they are those of a
/// body: see validate().
Body body_of(std::shared_ptr<const BodySource> source);

/// Why the tensor about a centre of mass is that of no distribution of mass, in a few words, or empty: symmetry, sign
/// and triangle inequality within 1e-12 of the largest moment. Moments may be 0.
std::string tensor_fault(const Matrix3<double>& inertia);

/// What is wrong with a quaternion that is not of length 1 within 1e-6, "has norm ..", or an empty text; norm_remedy is
/// what to give instead.
std::string norm_fault(const Quaternion<double>& q);
inline constexpr const char* norm_remedy = "give a unit quaternion [w, x, y, z] with norm 1 within 1e-6";

/// Whether the body was read with its shape: it is a shape, a mesh, or parts of such.
bool has_shape(const BodySource& source);

}  // namespace polhode
