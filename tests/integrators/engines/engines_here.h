// The engines installed beside the program that can be started. Missing engines are reported and skipped.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "integrators/engines/engine_methods.h"
#include "places.h"

namespace polhode {

inline const std::vector<EngineMethod>& engines_here() {
    static const std::vector<EngineMethod> all = [] {
        std::vector<EngineMethod> here;
        const auto list = std::filesystem::path(program_path()).parent_path() / "engines" / "engines.json";
        if (!std::filesystem::exists(list)) return here;
        for (EngineMethod& engine : read_engines(list.string())) {
            const EngineReport report = engine.inspect(nullptr);
            if (report.fault.empty())
                here.push_back(std::move(engine));
            else
                std::fprintf(stderr, "%s is not tested: %s\n", std::string(engine.method->name).c_str(),
                             report.fault.c_str());
        }
        return here;
    }();
    return all;
}

/// Whether damping and velocity limits are off, as in every setting except the default of some engines.
inline bool is_undamped(const EngineMethod& engine) {
    return engine.setting != "default" ||
           !(engine.engine == "jolt" || engine.engine == "physx" || engine.engine == "havok" ||
             engine.engine == "cannon_es" || engine.engine == "bullet_multibody");
}

}  // namespace polhode

#define SKIP_WITHOUT_ENGINES() \
    if (engines_here().empty()) GTEST_SKIP() << "no engine is here: build with POLHODE_ENGINES"
