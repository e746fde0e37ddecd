// What the importer does with each element and attribute of MJCF.
#include "scene/robot_schema.h"

namespace polhode {
namespace {

using enum RobotVerdict;

constexpr RobotConstruct mjcf_rows[] = {
    {"", "mujoco", "", modelled, "the root element"},
};

}  // namespace

std::span<const RobotConstruct> mjcf_constructs() { return mjcf_rows; }

}  // namespace polhode
