// Any bytes are either a valid scene, which then survives being written and read, or one InputError of one line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "motion/problem.h"
#include "scene/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace polhode;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    Scene scene;
    try {
        scene = parse_scene(text, "fuzz");
    } catch (const InputError& error) {
        const std::string_view message = error.what();
        if (message.size() > 1300 || !message.starts_with("fuzz: ") || message.find("; ") == message.npos) std::abort();
        for (const char c : message)
            if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) std::abort();
        return 0;
    }
    const std::string written = write_scene(scene);
    if (write_scene(parse_scene(written, "written")) != written) std::abort();
    pose(scene);
    return 0;
}
