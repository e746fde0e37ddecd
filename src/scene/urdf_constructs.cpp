// What the importer does with each element and attribute of URDF.
#include "scene/robot_schema.h"

namespace polhode {
namespace {

using enum RobotVerdict;

constexpr RobotConstruct constructs[] = {
    {"", "robot", "", modelled, "the root element"},
};

}  // namespace

std::span<const RobotConstruct> urdf_constructs() { return constructs; }

}  // namespace polhode
