// What a body is made of, as the scene file has it: data only, from which its mass properties follow exactly.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "body/mesh.h"
#include "body/shapes.h"

namespace polhode {

/// Either the mass (kg) or the density (kg/m^3; kg/m^2 of a disc or plate, kg/m of a rod), negative for a hole.
struct Amount {
    double value = 0;
    bool is_density = false;
};

struct BodySource;

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
/// The surface in a file beside the scene's.
struct MeshBody {
    std::string file;  ///< as the scene names it
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

struct BodySource {
    std::variant<GivenBody, ShapedBody, PointsBody, MeshBody, PartsBody> made_of;
};

/// The exact real function of the source's binary64 numbers, in the scalar S.
template <class S>
struct MassPropertiesOf {
    MassProperties<S> operator()(const GivenBody& given) const {
        MassProperties<S> body{S(given.mass), cast<S>(given.center_of_mass), cast<S>(given.inertia)};
        // asymmetry within the accepted 1e-12 is rounding of the input: the body has the mean of the two entries
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j)
                body.inertia[i][j] = body.inertia[j][i] = (body.inertia[i][j] + body.inertia[j][i]) / S(2);
        return body;
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
        if (body.amount.is_density) return of_mesh<S>(body.mesh, amount);
        MassProperties<S> whole = of_mesh<S>(body.mesh, S(1));
        const S density = amount / whole.mass;
        whole.mass = amount;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) whole.inertia[i][j] = density * whole.inertia[i][j];
        return whole;
    }
    MassProperties<S> operator()(const PartsBody& body) const {
        std::vector<MassProperties<S>> parts;
        for (const PartsBody::Part& part : body.parts) {
            Quaternion<S> q = cast<S>(part.orientation);
            const S norm = square_root(squared_norm(q));
            q = {q.w / norm, q.x / norm, q.y / norm, q.z / norm};
            parts.push_back(placed(std::visit(*this, part.body->made_of), cast<S>(part.position), q));
        }
        return composite(parts);
    }
};

template <class S>
MassProperties<S> mass_properties(const BodySource& source) {
    return std::visit(MassPropertiesOf<S>{}, source.made_of);
}

}  // namespace polhode
