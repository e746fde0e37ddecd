// Joints of robot files that a scene expresses by several joints.
#pragma once

#include "scene/robot_tree.h"

namespace polhode {

/// Replaces joints by revolute and prismatic joints with massless links between them: NAME of type screw by
/// NAME_translation and NAME, which are coupled; planar by NAME_first, NAME_second and NAME_rotation; universal with
/// parallel axes, or `with_laws` if an axis has limits or friction, by NAME_1 and NAME_2. With `with_laws` a joint
/// whose limits are equal becomes fixed.
void expand_robot_joints(Robot& robot, bool with_laws);

}  // namespace polhode
