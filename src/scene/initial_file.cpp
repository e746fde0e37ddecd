#include "scene/initial_file.h"

#include <fmt/format.h>

#include "scene/json_values.h"
#include "scene/scene_keys.h"

namespace polhode {

Frame parse_frame(const JsonNode& node) {
    if (node.string() == "body") return Frame::body;
    if (node.string() == "world") return Frame::world;
    node.fail(node.describe(), "give \"body\" or \"world\"");
}

std::string write_frame(Frame frame) { return frame == Frame::body ? "\"body\"" : "\"world\""; }

Initial parse_initial(const JsonNode& node, bool pivoted, Initial start) {
    node.require_known_keys(keys_of(scene_keys(), "initial"));
    if (const JsonNode* q = node.find("orientation")) start.orientation = quaternion(*q);
    if (const JsonNode* w = node.find("angular_velocity")) start.angular_velocity = vector3(*w);
    if (const JsonNode* f = node.find("angular_velocity_frame")) start.angular_velocity_frame = parse_frame(*f);
    for (const char* key : {"position", "velocity"}) {
        const JsonNode* given = node.find(key);
        if (!given) continue;
        if (pivoted)
            given->fail("is given, but the scene has a pivot",
                        "remove it: the pivot and the attitude determine the centre of mass");
        (key[0] == 'p' ? start.position_W : start.velocity_W) = vector3(*given);
    }
    return start;
}

std::string write_initial(const Initial& initial, bool pivoted, const char* separator) {
    std::string text = fmt::format("\"orientation\": {},{}\"angular_velocity\": {},{}\"angular_velocity_frame\": {}",
                                   write_json(initial.orientation), separator, write_json(initial.angular_velocity),
                                   separator, write_frame(initial.angular_velocity_frame));
    if (!pivoted)
        text += fmt::format(",{}\"position\": {},{}\"velocity\": {}", separator, write_json(initial.position_W),
                            separator, write_json(initial.velocity_W));
    return text;
}

}  // namespace polhode
