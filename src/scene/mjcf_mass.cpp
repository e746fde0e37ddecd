// Masses of MJCF bodies by the rules of <compiler>.
#include "scene/mjcf_mass.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/inertia_repair.h"
#include "text/message.h"

namespace polhode {
namespace {

bool is_zero(const Matrix3<Wide>& m) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(m[i][j] == Wide(0))) return false;
    return true;
}

}  // namespace

std::optional<MassProperties<Wide>> MjcfMasses::of(const Body& body) {
    const MjcfInertia rule = body.model->compiler.inertia;
    std::optional<MassProperties<Wide>> mass;
    if (rule == MjcfInertia::from_geoms || (rule == MjcfInertia::either && !body.inertial)) mass = of_geoms(body);
    // if no geom has mass, <inertial> applies even with inertiafromgeom="true"
    if (!mass && body.inertial) {
        const MjcfPlaced& inertial = *body.inertial;
        mass = placed(mjcf_inertial(xml_, *inertial.at, inertial.model->compiler), inertial.pose.position,
                      inertial.pose.turn);
    }
    if (mass && mass->mass == Wide(0) && is_zero(mass->inertia)) mass.reset();
    apply_bounds(body, mass);
    return mass;
}

std::optional<ImportedBody> MjcfMasses::given(const Body& body) {
    const MjcfCompiler& compiler = body.model->compiler;
    const bool changes = compiler.least_mass > 0 || compiler.least_moment > 0 || compiler.balances;
    if (changes || !body.inertial) return {};
    const RobotPose& pose = body.inertial->pose;
    if (!(pose.position == Vector3<Wide>()) || !(pose.turn == Quaternion<Wide>())) return {};
    if (compiler.inertia == MjcfInertia::from_geoms && of_geoms(body)) return {};
    return mjcf_given_inertial(xml_, *body.inertial->at, body.inertial->model->compiler);
}

std::optional<MassProperties<Wide>> MjcfMasses::of_geoms(const Body& body) {
    std::vector<MassProperties<Wide>> parts;
    for (const MjcfPlaced& geom : body.geoms)
        if (const std::optional<MassProperties<Wide>> part = of_geom(body, geom)) parts.push_back(*part);
    if (parts.empty()) return {};
    return composite(parts);
}

// Applies boundmass, boundinertia and balanceinertia to the principal moments.
void MjcfMasses::apply_bounds(const Body& body, std::optional<MassProperties<Wide>>& mass) {
    const MjcfCompiler& compiler = body.model->compiler;
    const bool bounded = compiler.least_mass > 0 || compiler.least_moment > 0;
    if (!mass && bounded) {
        // MuJoCo puts the centre of a massless body at the value of the body's pos, interpreted in the body's frame
        mass.emplace();
        if (body.at->Attribute("pos")) mass->center = cast<Wide>(three_of(xml_.attribute(*body.at, "pos", 3)));
    }
    if (!mass || !(bounded || compiler.balances)) return;
    const WidePrincipalFrame frame = wide_principal_frame(mass->inertia);
    Vector3<Wide> moments = frame.moments;
    bool raised = mass->mass < Wide(compiler.least_mass), balanced = false;
    mass->mass = std::max(mass->mass, Wide(compiler.least_mass));
    for (int i = 0; i < 3; ++i) {
        raised = raised || moments[i] < Wide(compiler.least_moment);
        moments[i] = std::max(moments[i], Wide(compiler.least_moment));
    }
    const Wide sum = moments[0] + moments[1] + moments[2];
    for (int i = 0; i < 3; ++i) balanced = balanced || sum - moments[i] < moments[i] * (Wide(1) - Wide(1e-14));
    if (balanced && compiler.balances) moments = {sum / Wide(3), sum / Wide(3), sum / Wide(3)};
    if (raised) note("bodies raised to boundmass or boundinertia", body.name);
    if (balanced && compiler.balances) note("inertia tensors balanced by balanceinertia", body.name);
    if (raised || (balanced && compiler.balances)) mass->inertia = rotated(diagonal(moments), frame.q_BP);
}

}  // namespace polhode
