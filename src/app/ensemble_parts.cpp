// Writes and merges parts of an ensemble. Each part has a .json file that identifies the table, scene, options and
// program and has the size and hash of the part. The merge verifies these and concatenates the parts after one header.
#include "app/ensemble_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>

#include "app/commands.h"
#include "motion/ensemble_stream.h"
#include "text/atomic_stream.h"
#include "text/content_hash.h"
#include "text/folder_names.h"
#include "text/input_file.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/npy.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_parts = 1'000'000, block = std::size_t{1} << 20, largest_json = std::size_t{1} << 16;
constexpr const char* kind = "part of an ensemble";

// Calls `use` with all bytes from the current position of `input`, at most one block at a time.
void for_each_block(InputFile& input, const std::function<void(std::string_view)>& use) {
    std::vector<char> bytes(block);
    while (const std::size_t count = input.read(bytes.data(), bytes.size())) use({bytes.data(), count});
}

// A part's file and its .json file.
struct FoundPart {
    EnsemblePart part;
    std::string json, path;
};

bool is_part_json(const std::string& name) {
    return name.ends_with(".json") && name.find(".part-") != name.npos && name.find("-of-") != name.npos;
}

std::vector<FoundPart> parts_in(const std::vector<std::string>& dirs) {
    std::vector<FoundPart> found;
    for (const std::string& dir : dirs) {
        std::vector<std::string> names;
        std::error_code error;
        for (const std::string& name : names_in(dir, error))
            if (is_part_json(name)) names.push_back(name);
        if (error) throw InputError(dir, "", "cannot be read: " + error.message(), "give the directories of the parts");
        for (const std::string& name : names) {
            FoundPart part;
            part.json = (fs::path(dir) / name).string();
            part.path = part.json.substr(0, part.json.size() - std::string_view(".json").size());
            part.part = parse_part(read_text(part.json, largest_json, "the .json file of a part"), part.json);
            found.push_back(std::move(part));
        }
    }
    return found;
}

// Keeps the parts of one ensemble: the one with the given output name, or the only one.
void choose(std::vector<FoundPart>& found, const std::string& dir, const std::string& name) {
    std::vector<std::string> names;
    for (const FoundPart& part : found)
        if (std::ranges::find(names, part.part.output) == names.end()) names.push_back(part.part.output);
    if (names.empty())
        throw InputError(dir, "", "contains no part of an ensemble", "give the directories of the parts");
    if (names.size() == 1) return;
    if (std::ranges::find(names, name) == names.end())
        throw InputError(dir, "", "contains parts of " + one_line(join_with_commas(names), 300),
                         "give one of these as --output");
    std::erase_if(found, [&](const FoundPart& part) { return part.part.output != name; });
}

// Throws InputError unless both are parts of the same ensemble.
void require_same(const FoundPart& a, const FoundPart& b) {
    const auto differ = [&](const char* what, const std::string& x, const std::string& y) {
        if (x == y) return;
        throw InputError(
            a.json, "",
            fmt::format("has {} {}, and {} has {}", what, one_line(x, 200), one_line(b.json, 300), one_line(y, 200)),
            "remove the parts that do not belong, or solve them again");
    };
    const EnsemblePart &p = a.part, &q = b.part;
    differ("number of parts", std::to_string(p.shard.parts), std::to_string(q.shard.parts));
    differ("table hash", p.table.hash, q.table.hash);
    differ("table rows", std::to_string(p.table.rows), std::to_string(q.table.rows));
    differ("scene hash", p.scene, q.scene);
    differ("options", p.options, q.options);
    differ("program key", p.program, q.program);
}

// Reads a part after its header, block by block, and verifies its size and hash against its .json file.
class PartReader {
  public:
    PartReader(const FoundPart& found, bool npy)
        : found_(found), input_(found.path, found.path, "a part of an ensemble", FileKinds::regular) {
        if (npy) {
            std::string beginning = take(std::min(*input_.size(), longest_npy_header));
            npy_ = parse_npy_header(beginning, *input_.size(), found.path);
            input_.seek(npy_.data_offset);
            header_size_ = npy_.data_offset;
        } else {
            const std::string beginning = take(std::min<std::size_t>(*input_.size(), 1024));
            header_ = beginning.substr(0, std::min(beginning.find('\n'), beginning.size() - 1) + 1);
            input_.seek(header_.size());
            header_size_ = header_.size();
        }
        if (*input_.size() != header_size_ + found.part.bytes) damaged();
    }

    const NpyHeader& npy() const { return npy_; }
    // The first line of a CSV file.
    const std::string& header() const { return header_; }

    void read(const std::function<void(std::string_view)>& use) {
        ContentHash hash;
        for_each_block(input_, [&](std::string_view bytes) {
            hash.add(bytes);
            use(bytes);
        });
        if (hash.text() != found_.part.hash) damaged();
    }

  private:
    [[noreturn]] void damaged() const {
        const Shard& shard = found_.part.shard;
        throw InputError(found_.path, "", "does not match its .json file",
                         fmt::format("solve it again: --shard {}/{}", shard.part, shard.parts));
    }
    std::string take(std::size_t count) {
        std::string bytes(count, '\0');
        bytes.resize(input_.read_fully(bytes.data(), count));
        return bytes;
    }

    const FoundPart& found_;
    InputFile input_;
    NpyHeader npy_;
    std::string header_;
    std::size_t header_size_ = 0;
};

// Returns the parts in order, without copies. Throws InputError if a part is missing or differs from its copy.
std::vector<const FoundPart*> in_order(const std::vector<FoundPart>& found, bool npy) {
    const std::size_t parts = found.front().part.shard.parts;
    std::map<std::size_t, const FoundPart*> first;
    for (const FoundPart& part : found) {
        require_same(part, found.front());
        const auto [known, is_new] = first.emplace(part.part.shard.part, &part);
        if (is_new) continue;
        if (known->second->part.hash != part.part.hash || known->second->part.bytes != part.part.bytes)
            throw InputError(part.path, "", "differs from " + one_line(known->second->path, 300),
                             "remove the one that does not belong, or solve it again");
        PartReader(part, npy).read([](std::string_view) {});
    }
    std::vector<const FoundPart*> order;
    std::vector<std::string> missing;
    std::size_t count_missing = 0;
    for (std::size_t i = 1; i <= parts; ++i) {
        const auto part = first.find(i);
        if (part != first.end()) {
            order.push_back(part->second);
        } else if (++count_missing <= 10) {
            missing.push_back(std::to_string(i));
        }
    }
    if (count_missing > 0)
        throw InputError(
            found.front().part.output, "",
            fmt::format("is missing part{} {}{} of {}", count_missing == 1 ? "" : "s", join_with_commas(missing),
                        count_missing > 10 ? fmt::format(" and {} more", count_missing - 10) : "", parts),
            fmt::format("solve it: --shard {}/{}", missing.front(), parts));
    return order;
}

}  // namespace

Shard parse_shard(const std::string& text) {
    Shard shard;
    const char* const end = text.data() + text.size();
    const auto part = std::from_chars(text.data(), end, shard.part);
    if (part.ec == std::errc() && part.ptr != end && *part.ptr == '/') {
        const auto parts = std::from_chars(part.ptr + 1, end, shard.parts);
        if (parts.ec == std::errc() && parts.ptr == end && shard.part >= 1 && shard.part <= shard.parts &&
            shard.parts <= most_parts)
            return shard;
    }
    throw UsageError(fmt::format("--shard is {}; give I/N with 1 <= I <= N <= 1000000", one_line(text, 60)));
}

std::pair<std::size_t, std::size_t> shard_rows(std::size_t rows, const Shard& shard) {
    // the first (rows % parts) parts have one more row; no product can overflow
    const std::size_t least = rows / shard.parts, longer = rows % shard.parts;
    const auto first_row = [&](std::size_t i) { return i * least + std::min(i, longer); };
    return {first_row(shard.part - 1), first_row(shard.part)};
}

std::string part_path(const std::string& output, const Shard& shard) {
    const fs::path path(output);
    const std::size_t digits = std::max<std::size_t>(4, std::to_string(shard.parts).size());
    const std::string name = fmt::format("{}.part-{:0{}}-of-{:0{}}{}", path.stem().string(), shard.part, digits,
                                         shard.parts, digits, path.extension().string());
    return (path.parent_path() / name).string();
}

TableIdentity compute_identity(const std::string& path, const Scene& scene) {
    TableIdentity identity;
    ContentHash hash;
    InputFile input(path, path, "a table that is a regular file, because --shard reads it several times",
                    FileKinds::regular);
    identity.bytes = *input.size();
    // Rows of an .npy file are found without reading earlier rows. Reading the whole file would take longer than
    // solving the rows of a part. The sampled blocks are at the same places in all files of this length and include
    // both ends.
    constexpr std::size_t sampled_from = std::size_t{64} << 20, samples = 1024, length = 4096;
    if (path.ends_with(".npy") && identity.bytes > sampled_from) {
        const std::size_t stride = (identity.bytes - length) / (samples - 1);
        std::string bytes(length, '\0');
        for (std::size_t k = 0; k < samples; ++k) {
            input.seek(k + 1 < samples ? k * stride : identity.bytes - length);
            if (input.read_fully(bytes.data(), length) < length) input.refuse("changed while it was read");
            hash.add(bytes);
        }
    } else {
        std::uint64_t read = 0;
        for_each_block(input, [&](std::string_view bytes) {
            hash.add(bytes);
            read += bytes.size();
        });
        if (read != identity.bytes) input.refuse("changed while it was read");
    }
    identity.hash = hash.text();
    const std::unique_ptr<EnsembleStream> rows = open_ensemble(path, scene);
    identity.rows = rows->skip(std::numeric_limits<std::size_t>::max());
    if (identity.rows == 0) rows->require_rows();
    return identity;
}

std::string write_part(const EnsemblePart& p) {
    return fmt::format(
        "{{\"kind\": {}, \"part\": {}, \"parts\": {}, \"output\": {},\n"
        " \"table\": {{\"rows\": {}, \"bytes\": {}, \"hash\": {}}},\n"
        " \"scene\": {}, \"program\": {}, \"options\": {},\n"
        " \"rows\": {}, \"ok\": {}, \"refused\": {}, \"bytes\": {}, \"hash\": {}}}\n",
        json_string(kind), p.shard.part, p.shard.parts, json_string(p.output), p.table.rows, p.table.bytes,
        json_string(p.table.hash), json_string(p.scene), json_string(p.program), json_string(p.options), p.rows, p.ok,
        p.refused, p.bytes, json_string(p.hash));
}

EnsemblePart parse_part(const std::string& text, const std::string& file) {
    const JsonDocument document(text, file);
    const JsonNode& root = document.root();
    const auto field = [](const JsonNode& node, const char* key) -> const JsonNode& {
        return node.require_member(key, "the value that --shard wrote");
    };
    const auto count = [&](const JsonNode& node, const char* key) {
        const long number = field(node, key).whole_number();
        if (number < 0) field(node, key).fail(fmt::format("is {}", number), "give a count");
        return static_cast<std::size_t>(number);
    };
    if (field(root, "kind").string() != kind)
        field(root, "kind").fail("is a different kind", fmt::format("give \"{}\"", kind));
    root.require_known_keys({"kind", "part", "parts", "output", "table", "scene", "program", "options", "rows", "ok",
                             "refused", "bytes", "hash"});
    EnsemblePart p;
    p.shard = {count(root, "part"), count(root, "parts")};
    if (p.shard.part < 1 || p.shard.part > p.shard.parts || p.shard.parts > most_parts)
        field(root, "part").fail("is out of range", "give a number from 1 to parts, at most 1000000");
    p.output = field(root, "output").string();
    const JsonNode& table = field(root, "table");
    table.require_known_keys({"rows", "bytes", "hash"});
    p.table = {count(table, "rows"), count(table, "bytes"), field(table, "hash").string()};
    p.scene = field(root, "scene").string(), p.program = field(root, "program").string();
    p.options = field(root, "options").string();
    p.rows = count(root, "rows"), p.ok = count(root, "ok"), p.refused = count(root, "refused");
    p.bytes = count(root, "bytes"), p.hash = field(root, "hash").string();
    const auto [first, last] = shard_rows(p.table.rows, p.shard);
    if (p.rows != last - first)
        field(root, "rows").fail(fmt::format("is {}", p.rows), fmt::format("give {}", last - first));
    return p;
}

bool has_ensemble_parts(const std::string& dir) {
    std::error_code error;
    const std::vector<std::string> names = names_in(dir, error);
    return std::any_of(names.begin(), names.end(), is_part_json);
}

MergedEnsemble merge_ensemble_parts(const std::vector<std::string>& dirs, const std::string& output) {
    std::vector<FoundPart> found = parts_in(dirs);
    const bool into_folder = fs::is_directory(output);
    choose(found, dirs.empty() ? output : dirs.front(), into_folder ? "" : fs::path(output).filename().string());
    const std::string name = found.front().part.output;
    if (name.empty() || fs::path(name).filename() != name)
        throw InputError(found.front().json, "/output", "is not a file name", "give a name without a directory");
    const bool npy = name.ends_with(".npy");
    MergedEnsemble merged;
    merged.output = into_folder ? (fs::path(output) / name).string() : output;
    if (npy != merged.output.ends_with(".npy"))
        throw InputError(merged.output, "", "differs in format from the parts of " + one_line(name, 200),
                         "give a name with the same ending");
    const std::vector<const FoundPart*> order = in_order(found, npy);
    for (const FoundPart* part : order) {
        merged.rows += part->part.rows, merged.ok += part->part.ok, merged.refused += part->part.refused;
    }
    merged.parts = order.size();
    if (merged.rows == merged.refused) throw InputError(name, "", "has no solved row", "correct the rows of the table");
    AtomicStream stream(merged.output);
    std::string header;
    NpyHeader npy_header;
    std::uint64_t npy_rows = 0;
    for (const FoundPart* part : order) {
        PartReader reader(*part, npy);
        if (npy && part == order.front())
            npy_header = reader.npy(), header = write_npy_header(npy_header.fields, 0);
        else if (part == order.front())
            header = reader.header();
        const bool same_header = npy ? write_npy_header(reader.npy().fields, 0) == header : reader.header() == header;
        if (!same_header)
            throw InputError(part->path, "header", "differs from that of " + one_line(order.front()->path, 300),
                             "solve it again");
        if (part == order.front()) stream.write(header);
        npy_rows += reader.npy().rows;
        reader.read([&](std::string_view bytes) { stream.write(bytes); });
    }
    if (npy) stream.write_over_beginning(write_npy_header(npy_header.fields, npy_rows));
    stream.commit();
    return merged;
}

}  // namespace polhode
