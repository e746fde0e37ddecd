// What the importer does with each element and attribute of SDFormat.
#include "scene/robot_schema.h"

namespace polhode {
namespace {

using enum RobotVerdict;

constexpr RobotConstruct constructs[] = {
    {"", "sdf", "", modelled, "the root element"},
};

}  // namespace

std::span<const RobotConstruct> sdf_constructs() { return constructs; }

}  // namespace polhode
