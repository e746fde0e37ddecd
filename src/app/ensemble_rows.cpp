#include "app/ensemble_rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>

#include "motion/mechanism_motion.h"
#include "motion/trajectory_columns.h"
#include "text/message.h"
#include "text/npy.h"

namespace polhode {
namespace {

// Appends a comma and the number, or only the comma if the number is not finite.
void append_number(std::string& text, double value) {
    text += ',';
    if (!std::isfinite(value)) return;
    char buffer[32];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

class CsvFormat : public EnsembleFormat {
  public:
    CsvFormat(bool has_ids, bool has_bodies) : has_ids_(has_ids), has_bodies_(has_bodies) {}

    std::string header(std::uint64_t) const override {
        std::string text = has_ids_ ? "row,id,status" : "row,status";
        for (const std::string_view name : motion_columns) {
            text.append(",").append(name);
            if (has_bodies_ && name == "t") text += ",body";
        }
        return text + ",message\n";
    }
    bool counts_records() const override { return false; }

    void append(std::string& text, const EnsembleRecord& record) const override {
        text += std::to_string(record.row);
        if (has_ids_) text += ',';
        if (record.id) text += *record.id;
        text.append(",").append(name_of(record.status));
        if (record.sample)
            append_motion(text, record);
        else
            text.append(std::size(motion_columns) + (has_bodies_ ? 1 : 0), ',');
        text += ',';
        if (!record.message.empty()) append_quoted(text, record.message);
        text += '\n';
    }

  private:
    void append_motion(std::string& text, const EnsembleRecord& record) const {
        const auto numbers = motion_numbers(*record.sample);
        append_number(text, numbers[0]);
        if (has_bodies_) text.append(",").append(record.body);
        for (std::size_t i = 1; i < numbers.size(); ++i) append_number(text, numbers[i]);
    }
    static void append_quoted(std::string& text, const std::string& message) {
        text += '"';
        for (const char c : one_line(message, 500)) text.append(c == '"' ? 2 : 1, c);
        text += '"';
    }

    bool has_ids_, has_bodies_;
};

// Records: row, status, the numbers, then the body's name and the id, both padded with zeros.
class NpyFormat : public EnsembleFormat {
  public:
    NpyFormat(std::size_t id_width, std::size_t body_width) : id_width_(id_width), body_width_(body_width) {}

    std::string header(std::uint64_t bytes) const override {
        std::vector<NpyField> fields{{"row", "<i8"}, {"status", "<i8"}};
        for (const std::string_view name : motion_columns) fields.push_back({std::string(name), "<f8"});
        if (body_width_ > 0) fields.push_back({"body", "|S" + std::to_string(body_width_)});
        if (id_width_ > 0) fields.push_back({"id", "|S" + std::to_string(id_width_)});
        return write_npy_header(fields, bytes / (sizeof(Numbers) + body_width_ + id_width_));
    }
    bool counts_records() const override { return true; }

    void append(std::string& text, const EnsembleRecord& record) const override {
        Numbers numbers{static_cast<std::int64_t>(record.row), static_cast<std::int64_t>(record.status), {}};
        if (record.sample)
            numbers.motion = motion_numbers(*record.sample);
        else
            numbers.motion.fill(std::numeric_limits<double>::quiet_NaN());
        text.append(reinterpret_cast<const char*>(&numbers), sizeof numbers);
        append_padded(text, record.body, body_width_);
        append_padded(text, record.id ? *record.id : std::string_view(), id_width_);
    }

  private:
    struct Numbers {
        std::int64_t row, status;
        std::array<double, std::size(motion_columns)> motion;
    };
    static_assert(sizeof(Numbers) == 128);

    static void append_padded(std::string& text, std::string_view word, std::size_t width) {
        text.append(word).append(width - word.size(), '\0');
    }

    std::size_t id_width_, body_width_;
};

// Appends all records of a row of a piece.
void append_row(std::string& text, const SolvedPiece& piece, std::size_t i, std::size_t number, const Scene& scene,
                const EnsembleFormat& format) {
    static const std::string nothing;
    const std::string* const id = piece.table.ids.empty() ? nullptr : &piece.table.ids[i];
    for (const std::vector<EnsembleRow>& at : piece.at)
        format.append(text, {number, id, at[i].status, at[i].moved ? &at[i].end : nullptr, "", at[i].message});
    if (piece.mechanisms.empty()) return;
    const MechanismRow& row = piece.mechanisms[i];
    for (std::size_t k = 0; k < row.samples.size(); ++k)
        format.append(text,
                      {number, id, Status::ok, &row.samples[k], scene.bodies[k % scene.bodies.size()].name, nothing});
    if (row.status != Status::ok) format.append(text, {number, id, row.status, nullptr, "", row.message});
}

}  // namespace

std::unique_ptr<EnsembleFormat> make_format(const std::string& path, const Scene& scene, const EnsembleStream& table,
                                            const std::string& file) {
    const std::vector<std::string> bodies = body_names(scene);
    if (!path.ends_with(".npy")) return std::make_unique<CsvFormat>(table.has_ids(), !bodies.empty());
    if (table.has_ids() && table.id_width() == 0)
        throw InputError(file, "column id", "has ids of variable length, which .npy output does not support",
                         "remove the column (rows are numbered), give an .npy table, or write CSV");
    std::size_t longest_name = 0;
    for (const std::string& name : bodies) longest_name = std::max(longest_name, name.size());
    return std::make_unique<NpyFormat>(table.id_width(), longest_name);
}

std::string format_rows(const SolvedPiece& piece, const Scene& scene, const EnsembleFormat& format) {
    const EnsembleTable& table = piece.table;
    const std::vector<std::size_t> numbers = table.row_numbers(piece.first_row);
    std::string text;
    auto refused = table.refused.begin();
    // refused rows are written before the next solved row; the remaining ones at the end
    const auto refuse_before = [&](std::size_t number) {
        for (; refused != table.refused.end() && refused->row < number; ++refused)
            format.append(text, {refused->row, nullptr, Status::failed, nullptr, "", refused->fault});
    };
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        refuse_before(numbers[i]);
        append_row(text, piece, i, numbers[i], scene, format);
        if (i == 0) text.reserve((text.size() + text.size() / 16) * numbers.size());
    }
    refuse_before(std::numeric_limits<std::size_t>::max());
    return text;
}

}  // namespace polhode
