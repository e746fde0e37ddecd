// Lessons of the report page: a scene, an update, sliders and a short text, read from JSON files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/json_numbers.h"

namespace polhode {

/// The names of the built-in lessons, sorted: every experiments/lessons/NAME.json.
std::vector<std::string> builtin_lesson_names();

/// Reads a lesson: Lesson of src/report/page/source/data.ts. `file` is named in errors; a scene file that the lesson
/// names is relative to `directory` (empty: the working directory). Throws InputError, also if the page cannot compute
/// the scene: several bodies, planes, or loads other than gravity about a pivot.
Json parse_lesson(std::string_view text, const std::string& file, const std::string& directory = "");

/// The built-in lesson with this name, or else the lesson file at this path. Throws InputError.
Json find_lesson(const std::string& name_or_path);

/// All built-in lessons.
Json builtin_lessons_json();

}  // namespace polhode
