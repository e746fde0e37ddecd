#include "scene/robot_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "scene/robot_xml.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr RobotFormat formats[] = {
    {"URDF", "robot", urdf_constructs}, {"MJCF", "mujoco", mjcf_constructs}, {"SDFormat", "sdf", sdf_constructs}};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Whether every word of the text equals `value`; numbers are compared by value.
bool all_words_equal(std::string_view text, std::string_view value) {
    const std::optional<double> number = parse_decimal(value);
    bool any = false;
    for (std::size_t i = 0; i < text.size();) {
        if (is_blank(text[i])) {
            ++i;
            continue;
        }
        std::size_t end = i;
        while (end < text.size() && !is_blank(text[end])) ++end;
        const std::string_view word = text.substr(i, end - i);
        const std::optional<double> one = number ? parse_decimal(word) : std::nullopt;
        if (one ? *one != *number : word != value) return false;
        any = true, i = end;
    }
    return any || value.empty();
}

bool is_neutral(std::string_view text, std::string_view neutral) {
    while (!neutral.empty()) {
        const std::size_t end = std::min(neutral.find('|'), neutral.size());
        if (all_words_equal(text, neutral.substr(0, end))) return true;
        neutral.remove_prefix(std::min(end + 1, neutral.size()));
    }
    return false;
}

class Survey {
  public:
    Survey(const RobotXml& xml, std::span<const RobotConstruct> constructs, RobotNotes& omitted)
        : xml_(xml), omitted_(omitted) {
        for (const RobotConstruct& one : constructs) rows_.emplace(Key{one.parent, one.element, one.attribute}, &one);
    }

    void walk(const XMLElement& at, std::string_view parent) {
        const RobotConstruct* row = find(parent, at.Name(), "");
        if (!row) return note(fmt::format("unknown element <{}>", one_line(at.Name(), 40)), at);
        if (row->verdict == RobotVerdict::irrelevant) return;
        if (is_noted(row->verdict)) {
            const bool acts =
                row->has_effect ? row->has_effect(at) : !is_neutral(at.GetText() ? at.GetText() : "", row->neutral);
            if (acts) note(std::string(row->note), at);
            return;
        }
        for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next()) walk_attribute(at, parent, *a);
        for (const XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement())
            walk(*one, at.Name());
    }

  private:
    static bool is_noted(RobotVerdict verdict) {
        return verdict == RobotVerdict::omitted || verdict == RobotVerdict::partial;
    }

    using Key = std::tuple<std::string_view, std::string_view, std::string_view>;

    // the row for this parent, or else for any parent
    const RobotConstruct* find(std::string_view parent, std::string_view element, std::string_view attribute) const {
        for (const std::string_view over : {parent, std::string_view("*")})
            if (const auto found = rows_.find(Key{over, element, attribute}); found != rows_.end())
                return found->second;
        return nullptr;
    }

    void walk_attribute(const XMLElement& at, std::string_view parent, const tinyxml2::XMLAttribute& attribute) {
        const std::string_view name = attribute.Name();
        if (name.starts_with("xmlns")) return;  // a namespace declaration
        const RobotConstruct* row = find(parent, at.Name(), name);
        if (!row)
            return note(fmt::format("unknown attribute {} of <{}>", one_line(name, 40), one_line(at.Name(), 40)), at);
        if (!is_noted(row->verdict)) return;
        const bool acts = row->has_effect ? row->has_effect(at) : !is_neutral(attribute.Value(), row->neutral);
        if (acts) note(std::string(row->note), at);
    }

    void note(const std::string& what, const XMLElement& at) { omitted_[what].push_back(robot_note_name(xml_, at)); }

    const RobotXml& xml_;
    RobotNotes& omitted_;
    std::map<Key, const RobotConstruct*> rows_;
};

}  // namespace

std::span<const RobotFormat> robot_formats() { return formats; }

void survey_robot(const RobotXml& xml, const XMLElement& root, std::span<const RobotConstruct> constructs,
                  RobotNotes& omitted) {
    Survey(xml, constructs, omitted).walk(root, "");
}

std::string robot_note_name(const RobotXml& xml, const XMLElement& at) {
    for (const tinyxml2::XMLNode* node = &at; node; node = node->Parent())
        if (const XMLElement* element = node->ToElement())
            if (const char* name = element->Attribute("name"); name && *name && node->Parent()->ToElement())
                return one_line(name, 60);
    return fmt::format("<{}> at {}", one_line(at.Name(), 40), xml.place_of(at));
}

}  // namespace polhode
