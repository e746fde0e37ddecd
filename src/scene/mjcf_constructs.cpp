// What the importer does with each element and attribute of MJCF.
#include "scene/robot_schema.h"

namespace polhode {
namespace {

using enum RobotVerdict;

constexpr RobotConstruct constructs[] = {
    {"", "mujoco", "", modelled, "the root element"},
};

}  // namespace

std::span<const RobotConstruct> mjcf_constructs() { return constructs; }

}  // namespace polhode
