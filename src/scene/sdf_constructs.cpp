// What the importer does with each element and attribute of SDFormat.
#include "scene/robot_schema.h"

namespace polhode {
namespace {

using enum RobotVerdict;

constexpr RobotConstruct sdf_rows[] = {
    {"", "sdf", "", modelled, "the root element"},
};

}  // namespace

std::span<const RobotConstruct> sdf_constructs() { return sdf_rows; }

}  // namespace polhode
