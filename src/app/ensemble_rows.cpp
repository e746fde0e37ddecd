#include "app/ensemble_rows.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "text/message.h"
#include "text/npy.h"

namespace polhode {
namespace {

void append_vector(std::string& text, const Vector3<double>& v) {
    for (int i = 0; i < 3; ++i) append_number(text, v[i]);
}

class CsvFormat : public EnsembleFormat {
  public:
    explicit CsvFormat(bool has_ids) : has_ids_(has_ids) {}

    std::string header(std::uint64_t) const override {
        return std::string(has_ids_ ? "row,id,status" : "row,status") +
               ",t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,message\n";
    }
    bool counts_rows() const override { return false; }

    void append_row(std::string& text, std::size_t number, const std::string* id,
                    const EnsembleRow& row) const override {
        text += std::to_string(number);
        if (has_ids_) text += ',';
        if (id) text += *id;
        text.append(",").append(name_of(row.status));
        if (row.moved) {
            append_number(text, row.end.t);
            append_numbers(text, row.end);
        } else {
            text.append(14, ',');
        }
        append_message(text, row.message);
        text += '\n';
    }

  private:
    bool has_ids_;
};

class NpyFormat : public EnsembleFormat {
  public:
    explicit NpyFormat(std::size_t id_width) : id_width_(id_width) {}

    std::string header(std::uint64_t rows) const override {
        std::vector<NpyField> fields{{"row", "<i8"}, {"status", "<i8"}};
        for (const char* name : {"t", "qw", "qx", "qy", "qz", "wx", "wy", "wz", "px", "py", "pz", "vx", "vy", "vz"})
            fields.push_back({name, "<f8"});
        if (id_width_ > 0) fields.push_back({"id", "|S" + std::to_string(id_width_)});
        return write_npy_header(fields, rows);
    }
    bool counts_rows() const override { return true; }

    void append_row(std::string& text, std::size_t number, const std::string* id,
                    const EnsembleRow& row) const override {
        struct {
            std::int64_t row, status;
            double numbers[14];
        } record{};
        static_assert(sizeof record == 128);
        record.row = static_cast<std::int64_t>(number), record.status = static_cast<std::int64_t>(row.status);
        const Sample& s = row.end;
        double* next = record.numbers;
        if (row.moved) {
            for (const double value : {s.t, s.q.w, s.q.x, s.q.y, s.q.z}) *next++ = value;
            for (const Vector3<double>& v : {angular_velocity_W(s), s.position_W, s.velocity_W})
                for (int i = 0; i < 3; ++i) *next++ = v[i];
        } else {
            std::ranges::fill(record.numbers, std::numeric_limits<double>::quiet_NaN());
        }
        text.append(reinterpret_cast<const char*>(&record), sizeof record);
        if (id_width_ == 0) return;
        if (id) text += *id;
        text.append(id_width_ - (id ? id->size() : 0), '\0');
    }

  private:
    std::size_t id_width_;
};

}  // namespace

void append_number(std::string& text, double value) {
    text += ',';
    if (!std::isfinite(value)) return;
    char buffer[32];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

void append_numbers(std::string& text, const Sample& s) {
    for (const double value : {s.q.w, s.q.x, s.q.y, s.q.z}) append_number(text, value);
    append_vector(text, angular_velocity_W(s));
    append_vector(text, s.position_W);
    append_vector(text, s.velocity_W);
}

void append_message(std::string& text, const std::string& message) {
    text += ',';
    if (message.empty()) return;
    text += '"';
    for (const char c : one_line(message, 500)) text.append(c == '"' ? 2 : 1, c);
    text += '"';
}

std::vector<std::size_t> SolvedPiece::numbers() const {
    std::vector<std::size_t> numbers;
    numbers.reserve(table.bodies.size());
    auto refused = table.refused.begin();
    for (std::size_t number = first_row; numbers.size() < table.bodies.size(); ++number)
        if (refused != table.refused.end() && refused->row == number)
            ++refused;
        else
            numbers.push_back(number);
    return numbers;
}

std::unique_ptr<EnsembleFormat> format_of(const std::string& path, const EnsembleStream& table,
                                          const std::string& file) {
    if (!path.ends_with(".npy")) return std::make_unique<CsvFormat>(table.has_ids());
    if (table.has_ids() && table.id_width() == 0)
        throw InputError(file, "column id", "has ids of any length, and an .npy file has none for them",
                         "leave the column out (rows are numbered), give an .npy table, or write CSV");
    return std::make_unique<NpyFormat>(table.id_width());
}

std::string rows_of(const SolvedPiece& piece, const EnsembleFormat& format) {
    const EnsembleTable& table = piece.table;
    const std::vector<std::size_t> numbers = piece.numbers();
    std::string text;
    auto refused = table.refused.begin();
    // a refused row stands in front of the next body; the last ones have none behind them
    const auto refuse_before = [&](std::size_t number) {
        for (; refused != table.refused.end() && refused->row < number; ++refused)
            format.append_row(text, refused->row, nullptr, {Status::failed, false, {}, refused->fault});
    };
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        refuse_before(numbers[i]);
        for (const std::vector<EnsembleRow>& at : piece.at) {
            format.append_row(text, numbers[i], table.ids.empty() ? nullptr : &table.ids[i], at[i]);
            if (i == 0 && &at == &piece.at.front()) text.reserve((text.size() + 16) * numbers.size() * piece.at.size());
        }
    }
    refuse_before(std::numeric_limits<std::size_t>::max());
    return text;
}

}  // namespace polhode
