#include "motion/ensemble_columns.h"

#include <fmt/format.h>

#include <algorithm>

#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t longest_id = 200;

enum Block { block_q, block_w, block_p, block_v, block_moments, block_products, block_mass, block_id, blocks };
constexpr const char* block_names[blocks] = {"qw,qx,qy,qz", "wx,wy,wz",    "px,py,pz", "vx,vy,vz",
                                             "ixx,iyy,izz", "ixy,ixz,iyz", "mass",     "id"};

}  // namespace

const std::vector<EnsembleColumn>& ensemble_columns() {
    using B = EnsembleBody;
    static const std::vector<EnsembleColumn> columns{
        {"qw", [](B& b, double x) { b.orientation.w = x; }, block_q},
        {"qx", [](B& b, double x) { b.orientation.x = x; }, block_q},
        {"qy", [](B& b, double x) { b.orientation.y = x; }, block_q},
        {"qz", [](B& b, double x) { b.orientation.z = x; }, block_q},
        {"wx", [](B& b, double x) { b.angular_velocity[0] = x; }, block_w},
        {"wy", [](B& b, double x) { b.angular_velocity[1] = x; }, block_w},
        {"wz", [](B& b, double x) { b.angular_velocity[2] = x; }, block_w},
        {"px", [](B& b, double x) { b.position_W[0] = x; }, block_p},
        {"py", [](B& b, double x) { b.position_W[1] = x; }, block_p},
        {"pz", [](B& b, double x) { b.position_W[2] = x; }, block_p},
        {"vx", [](B& b, double x) { b.velocity_W[0] = x; }, block_v},
        {"vy", [](B& b, double x) { b.velocity_W[1] = x; }, block_v},
        {"vz", [](B& b, double x) { b.velocity_W[2] = x; }, block_v},
        {"ixx", [](B& b, double x) { b.inertia_B[0][0] = x; }, block_moments},
        {"iyy", [](B& b, double x) { b.inertia_B[1][1] = x; }, block_moments},
        {"izz", [](B& b, double x) { b.inertia_B[2][2] = x; }, block_moments},
        {"ixy", [](B& b, double x) { b.inertia_B[0][1] = b.inertia_B[1][0] = x; }, block_products},
        {"ixz", [](B& b, double x) { b.inertia_B[0][2] = b.inertia_B[2][0] = x; }, block_products},
        {"iyz", [](B& b, double x) { b.inertia_B[1][2] = b.inertia_B[2][1] = x; }, block_products},
        {"mass", [](B& b, double x) { b.mass = x; }, block_mass},
        {"id", nullptr, block_id},
    };
    return columns;
}

EnsembleBody start_under(const std::vector<const EnsembleColumn*>& columns, const Scene& scene, const std::string& file,
                         const std::string& place) {
    const auto fail = [&](const std::string& fault, const std::string& remedy) {
        throw InputError(file, place, fault, remedy);
    };
    int seen[blocks] = {};
    for (const EnsembleColumn* column : columns) ++seen[column->block];
    for (const EnsembleColumn& known : ensemble_columns()) {
        if (seen[known.block] == 0 || std::ranges::find(columns, &known) != columns.end()) continue;
        fail(fmt::format("column {} is missing", known.name),
             fmt::format("give all of {} or none", block_names[known.block]));
    }
    if (seen[block_id] > 0 && columns.size() == 1)
        fail("has no column but id", "give at least one of qw,qx,qy,qz, wx,wy,wz, ixx,iyy,izz, mass, ..");
    if (seen[block_products] > 0 && seen[block_moments] == 0)
        fail("has products of inertia without moments", "give ixx,iyy,izz together with ixy,ixz,iyz");
    if (scene.pivot && (seen[block_p] > 0 || seen[block_v] > 0))
        fail(fmt::format("has the columns {}, but the scene has a pivot",
                         block_names[seen[block_p] ? block_p : block_v]),
             "remove them: the pivot and the attitude determine the centre of mass");
    EnsembleBody start = ensemble_body(scene);
    // moments without products: about the body's own axes
    if (seen[block_moments] > 0) start.inertia_B = {};
    return start;
}

std::optional<BodyFault> fault_of_id(std::string_view id) {
    if (id.size() > longest_id) return BodyFault{"id", "is longer than 200 bytes", "use shorter ids"};
    if (first_invalid_utf8(id) != std::string_view::npos) return BodyFault{"id", "is not UTF-8", "encode it as UTF-8"};
    if (one_line(id, id.size()) != id || id.find('"') != id.npos)
        return BodyFault{"id", one_line(id, 60) + " contains quotes or control characters",
                         "use printable text without quotes and commas"};
    return {};
}

std::string place_of(const BodyFault& fault) {
    return fmt::format("{} {}", fault.columns.find(',') == std::string::npos ? "column" : "columns", fault.columns);
}

}  // namespace polhode
