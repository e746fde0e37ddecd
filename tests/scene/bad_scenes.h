// The catalogue of bad scene files: tests/scene/bad/NAME.json, each with one fault of its own.
#pragma once

#include <fstream>
#include <string>
#include <vector>

namespace polhode {

struct BadScene {
    std::string path, place;  ///< `place`: what the message must name
};

inline std::vector<BadScene> bad_scenes() {
    std::vector<BadScene> all;
    std::ifstream table(POLHODE_SOURCE_DIR "/tests/scene/bad_places.tsv");
    for (std::string line; std::getline(table, line);) {
        if (line.starts_with('#')) continue;
        const std::size_t tab = line.find('\t');
        all.push_back({POLHODE_SOURCE_DIR "/tests/scene/bad/" + line.substr(0, tab) + ".json", line.substr(tab + 1)});
    }
    return all;
}

}  // namespace polhode
