#include "app/submit_scripts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <stdexcept>

#include "scene/builtin.h"
#include "text/json_document.h"

namespace polhode {

// the files src/app/submit/*, embedded by polhode_embed()
std::span<const BuiltinText> submit_templates();

namespace {

// replaces each @name@ by its value, in one pass, because values may contain such words
std::string fill(std::string_view text, const std::map<std::string_view, std::string>& values) {
    std::string filled;
    for (std::size_t end = 0; !text.empty(); text.remove_prefix(std::min(end, text.size()))) {
        const std::size_t begin = text.find('@');
        filled += text.substr(0, begin);
        if (begin == std::string_view::npos) break;
        end = text.find('@', begin + 1);
        const auto value = values.find(text.substr(begin + 1, end == std::string_view::npos ? end : end - begin - 1));
        if (value == values.end())
            filled += '@', end = begin + 1;
        else
            filled += value->second, ++end;
    }
    return filled;
}

std::string shell_words(const std::vector<std::string>& texts) {
    std::string line;
    for (const std::string& text : texts) line += " " + shell_word(text);
    return line;
}

// JSON strings are valid Python strings: json_string() does not escape characters beyond 16 bits
std::string python_strings(const std::vector<std::string>& texts) {
    std::vector<std::string> strings;
    for (const std::string& text : texts) strings.push_back(json_string(text));
    return fmt::format("{}", fmt::join(strings, ", "));
}

std::string template_name(const std::string& engine) { return engine == "snakemake" ? "Snakefile" : engine + ".sh"; }

}  // namespace

std::string shell_word(const std::string& text) {
    const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 ||
               std::string_view("_-./=:,+").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (plain) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

std::string slurm_time(long seconds) {
    const long minutes = std::max(1L, (seconds + 59) / 60);
    return fmt::format("{}-{:02}:{:02}:00", minutes / 1440, minutes / 60 % 24, minutes % 60);
}

std::string script_name(const std::string& engine, const Submission& s) { return s.name + "." + template_name(engine); }

std::string submit_script(const std::string& engine, const Submission& s) {
    const auto templates = submit_templates();
    const auto found = std::ranges::find(templates, template_name(engine), &BuiltinText::name);
    if (found == templates.end()) throw std::invalid_argument("no script for the engine " + engine);
    const bool python = engine == "snakemake";
    const auto word = python ? [](const std::string& text) { return json_string(text); } : shell_word;
    const auto words = python ? python_strings : shell_words;
    return fill(found->text, {{"name", s.name},
                              {"program", word(s.program)},
                              {"experiment", word(s.experiment)},
                              {"output", word(s.output)},
                              {"plan", word(s.plan)},
                              {"shards", std::to_string(s.shards)},
                              {"jobs", std::to_string(s.jobs)},
                              {"time", slurm_time(s.seconds)},
                              {"minutes", std::to_string((s.seconds + 59) / 60)},
                              {"options", words(s.options)},
                              {"merge_options", words(s.merge_options)}});
}

}  // namespace polhode
