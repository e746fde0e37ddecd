// The strict reader of trajectory files.
//
// Reader parses the header into columns and each line into a TrajectoryRow. With a column `body`, the rows of one
// time are stored in the order of the bodies: begin_moment() and end_moment() delimit them and check that each body
// has exactly one row.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>

#include "motion/foreign_columns.h"
#include "text/csv_lines.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t largest_file = std::size_t{1} << 30;

enum Block { block_t, block_q, block_w, block_p, block_o, block_v, block_bound, block_body, block_r, block_e, blocks };
constexpr std::size_t no_column = static_cast<std::size_t>(-1);

// The numbers of one line: t, q, w, p, v, a matrix row by row, Euler angles, and what is read past.
constexpr std::size_t slot_r = 14, slot_e = 23, slot_unused = 26;
using LineNumbers = std::array<double, slot_unused + 1>;

// Columns that stand together, and where their numbers are in LineNumbers.
constexpr struct {
    std::string_view names;
    std::size_t slot;
} block_columns[blocks] = {{"t", 0},
                           {"qw,qx,qy,qz", 1},
                           {"wx,wy,wz", 5},
                           {"px,py,pz", 8},
                           {"ox,oy,oz", 8},
                           {"vx,vy,vz", 11},
                           {"bound", slot_unused},
                           {"body", slot_unused},
                           {"r11,r12,r13,r21,r22,r23,r31,r32,r33", slot_r},
                           {"e1,e2,e3", slot_e}};

struct Column {
    std::string name;
    std::size_t slot;  // in LineNumbers
    Block block;
};

const std::vector<Column>& known_columns() {
    static const std::vector<Column> columns = [] {
        std::vector<Column> all;
        for (int block = 0; block < blocks; ++block) {
            std::string_view rest = block_columns[block].names;
            for (std::size_t slot = block_columns[block].slot; !rest.empty(); ++slot) {
                const std::size_t end = std::min(rest.find(','), rest.size());
                all.push_back({std::string(rest.substr(0, end)), slot, static_cast<Block>(block)});
                rest.remove_prefix(std::min(end + 1, rest.size()));
            }
        }
        return all;
    }();
    return columns;
}

bool is_nan(std::string_view cell) {
    if (cell.starts_with('-') || cell.starts_with('+')) cell.remove_prefix(1);
    return std::ranges::equal(cell, std::string_view("nan"), {}, [](char c) { return static_cast<char>(c | 0x20); });
}

// One file, line by line.
class Reader {
    struct FileColumn : Column {
        std::size_t place;  // in the file
        FileColumn(std::size_t in_file, const Column& column) : Column(column), place(in_file) {}
    };

  public:
    Reader(std::string_view text, const std::string& file, const ForeignColumns& foreign, QuaternionColumns quaternion,
           std::span<const std::string> bodies, std::vector<std::size_t>* gaps)
        : text_(text),
          lines_(text, file),
          file_(file),
          foreign_(foreign),
          quaternion_(quaternion),
          gaps_(gaps),
          bodies_known_(!bodies.empty()),
          bodies_(bodies.begin(), bodies.end()) {
        for (std::size_t i = 0; i < bodies_.size(); ++i) index_.emplace(bodies_[i], i);
    }

    TrajectoryFile read() {
        if (!lines_.next()) fail("", "is empty", "give a header line t,qw,qx,qy,qz,.. and one line per sample");
        header();
        if (gaps_ != nullptr) find_nan_times();
        while (lines_.next()) {
            if (has_nan()) continue;
            // as many as there are lines of this length
            if (result_.rows.empty()) result_.rows.reserve(lines_.rows_left());
            sample();
        }
        if (result_.rows.empty()) fail("", "has a header but no samples", "give one line per sample");
        if (body_place_ != no_column) end_moment(), remove_missing_bodies();
        result_.bodies = std::move(bodies_);
        result_.skipped_content = lines_.skipped_content();
        return std::move(result_);
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
        throw InputError(file_, place, fault, remedy);
    }
    std::string here() const { return fmt::format("line {}", lines_.number()); }
    std::string at(std::size_t place) const {
        return fmt::format("line {}, column {}", lines_.number(), one_line(names_[place], 60));
    }

    // finds the columns that the file has
    void find_columns() {
        names_.assign(lines_.cells().begin(), lines_.cells().end());
        if (foreign_.places.empty()) {
            std::vector<std::string> known;
            for (const Column& column : known_columns())
                if (column.block <= block_body) known.push_back(column.name);
            for (const std::size_t column : lines_.header(known))
                columns_.push_back({columns_.size(), known_columns()[column]});
        }
        for (const auto& [name, place] : foreign_.places)
            columns_.push_back({place, *std::ranges::find(known_columns(), name, &Column::name)});
        std::ranges::stable_sort(columns_, {}, &FileColumn::place);
    }

    void header() {
        find_columns();
        int seen[blocks] = {};
        for (const FileColumn& column : columns_) {
            ++seen[column.block];
            if (column.block == block_body) body_place_ = column.place;
            if (column.block == block_t) time_place_ = column.place;
        }
        has_matrix_ = seen[block_r] > 0, has_angles_ = seen[block_e] > 0;
        const bool has_other_rotation = has_matrix_ || has_angles_;
        if ((seen[block_q] > 0) + has_matrix_ + has_angles_ > 1)
            fail(here(), "gives the rotation in two forms", "give only one of quaternion, matrix and Euler angles");
        for (const Column& known : known_columns()) {
            const bool is_required = known.block == block_t || (known.block == block_q && !has_other_rotation);
            const bool needed = is_required || (seen[known.block] > 0 && known.block < block_bound);
            if (needed && std::ranges::find(columns_, known.name, &FileColumn::name) == columns_.end())
                fail(here(), fmt::format("column {} is missing", known.name),
                     is_required ? "give at least t,qw,qx,qy,qz"
                                 : fmt::format("give all of {} or none", block_columns[known.block].names));
        }
        if (seen[block_p] > 0 && seen[block_o] > 0)
            fail(here(), "has both px,py,pz and ox,oy,oz",
                 "give the centre of mass (p) or the body's origin (o), not both");
        if (seen[block_body] == 0 && bodies_.size() > 1)
            fail(here(), "column body is missing",
                 "give t,body,qw,.. with one line at each time for each of " +
                     one_line(join_with_commas(bodies_), 200) + ", or for some of them");
        if (quaternion_ != QuaternionColumns::by_name) assign_quaternion_columns();
        result_.has_angular_velocity = seen[block_w] > 0;
        result_.has_position = seen[block_p] > 0;
        result_.has_origin = seen[block_o] > 0;
        result_.has_velocity = seen[block_v] > 0;
    }

    // assigns the quaternion's columns by their order
    void assign_quaternion_columns() {
        std::size_t next = quaternion_ == QuaternionColumns::scalar_first ? 0 : 1;  // of w, x, y, z
        for (FileColumn& column : columns_)
            if (column.block == block_q) column.slot = 1 + next++ % 4;
    }

    // the times, as they are written, at which a cell is NaN
    void find_nan_times() {
        CsvLines lines(text_, file_);
        lines.next();
        while (lines.next()) {
            const auto& cells = lines.cells();
            const auto has_nan = [&](const FileColumn& c) { return c.place < cells.size() && is_nan(cells[c.place]); };
            if (time_place_ < cells.size() && std::ranges::any_of(columns_, has_nan))
                nan_times_.emplace(cells[time_place_]);
        }
    }

    bool has_nan() {
        if (nan_times_.empty() || lines_.cells().size() <= time_place_) return false;
        const bool has_nan_time = nan_times_.contains(lines_.cells()[time_place_]);
        in_gap_ = in_gap_ || has_nan_time;
        return has_nan_time;
    }

    void count_time() {
        if (in_gap_ && times_ > 0) gaps_->push_back(times_);
        in_gap_ = false, ++times_;
    }

    Quaternion<double> rotation_in(const LineNumbers& x) const {
        if (has_angles_) {
            const double unit = foreign_.degrees ? std::numbers::pi / 180 : 1;
            return quaternion_from_euler(foreign_.sequence,
                                         {x[slot_e] * unit, x[slot_e + 1] * unit, x[slot_e + 2] * unit});
        }
        Matrix3<double> A;
        for (std::size_t i = 0; i < 9; ++i) A[i / 3][i % 3] = x[slot_r + i];
        try {
            require_rotation(A, 1e-3);
        } catch (const std::invalid_argument& error) {
            fail(here(), error.what(), "give a rotation matrix row by row");
        }
        return quaternion_from_rotation(A);
    }

    TrajectoryRow row_of(const LineNumbers& x) const {
        return {x[0],
                has_matrix_ || has_angles_ ? rotation_in(x) : Quaternion<double>{x[1], x[2], x[3], x[4]},
                {x[5], x[6], x[7]},
                {x[8], x[9], x[10]},
                {x[11], x[12], x[13]}};
    }

    void sample() {
        const auto& cells = lines_.cells();
        if (cells.size() != names_.size())
            fail(here(), fmt::format("has {} cells under {} columns", cells.size(), names_.size()),
                 "give one number per column");
        LineNumbers numbers{};
        for (const FileColumn& column : columns_) {
            if (column.block == block_body) continue;
            const std::string_view cell = cells[column.place];
            const std::optional<double> value = parse_decimal(cell);
            if (!value)
                fail(at(column.place), cell.empty() ? "is empty" : one_line(cell, 60) + " is not a number",
                     "give a decimal number such as -1.5e-3");
            if (!std::isfinite(*value))
                fail(at(column.place), one_line(cell, 60) + " is not finite", "give a finite number");
            numbers[column.slot] = *value;
        }
        const TrajectoryRow row = row_of(numbers);
        if (row.t < 0)
            fail(at(time_place_), shortest_decimal(row.t) + " s is before the start of the scene", "give times >= 0");
        const bool same_moment = body_place_ != no_column && !result_.rows.empty() && row.t == result_.rows.back().t;
        if (!same_moment && !result_.rows.empty() && !(row.t > result_.rows.back().t))
            fail(at(time_place_),
                 fmt::format("{} s is not after the {} s of the previous sample", shortest_decimal(row.t),
                             shortest_decimal(result_.rows.back().t)),
                 "give each time once, in ascending order");
        if (!same_moment) count_time();
        const double length = norm(row.q);
        if (!(length >= 1e-100 && length <= 1e100))
            fail(fmt::format("line {}, columns qw,qx,qy,qz", lines_.number()),
                 fmt::format("have length {}, which does not define an attitude", shortest_decimal(length)),
                 "give a quaternion w, x, y, z of length about 1");
        if (body_place_ == no_column)
            result_.rows.push_back(row);
        else
            sample_of_body(row, same_moment, cells[body_place_]);
    }

    // Stores a row at the index of its body at this time.
    void sample_of_body(const TrajectoryRow& row, bool same_moment, std::string_view name) {
        if (!same_moment) begin_moment();
        const auto known = index_.find(name);
        const std::size_t body = known == index_.end() ? bodies_.size() : known->second;
        if (body == bodies_.size()) {
            if (name.empty()) fail(at(body_place_), "is empty", "give the body's name");
            if (bodies_known_) {
                const std::string meant = did_you_mean(name, bodies_);
                fail(at(body_place_), fmt::format("\"{}\" is not a body of the scene", one_line(name, 60)),
                     meant.empty() ? "give one of " + one_line(join_with_commas(bodies_), 200) : meant);
            }
            if (moment_ > 0)
                fail(at(body_place_), fmt::format("body \"{}\" has no line at the first time", one_line(name, 60)),
                     "give one line per body at each time");
            bodies_.emplace_back(name);
            index_.emplace(name, body);
        }
        if (moment_ > 0 && in_file_[body] == 0)
            fail(at(body_place_), fmt::format("body \"{}\" has no line at the first time", one_line(name, 60)),
                 "give one line per body at each time");
        if (body < has_row_.size() && has_row_[body] != 0)
            fail(at(body_place_),
                 fmt::format("body \"{}\" has two lines at {} s", one_line(name, 60), shortest_decimal(row.t)),
                 "give one line per body at each time");
        has_row_.resize(bodies_.size()), has_row_[body] = 1;
        last_line_ = lines_.number();
        // rows of this time that are not read yet get its time now
        TrajectoryRow empty_row;
        empty_row.t = row.t;
        result_.rows.resize(moment_ + bodies_.size(), empty_row);
        result_.rows[moment_ + body] = row;
    }
    void begin_moment() {
        if (!result_.rows.empty()) end_moment();
        moment_ = result_.rows.size();
        has_row_.assign(bodies_.size(), 0);
    }
    // The bodies at the first time define the file's bodies.
    void end_moment() {
        if (moment_ == 0) in_file_ = has_row_;
        for (std::size_t body = 0; body < bodies_.size(); ++body)
            if (has_row_[body] == 0 && in_file_[body] != 0)
                fail(fmt::format("line {}, column body", last_line_),
                     fmt::format("body \"{}\" has no line at {} s", one_line(bodies_[body], 60),
                                 shortest_decimal(result_.rows.back().t)),
                     "give one line per body at each time");
    }
    // Removes the rows of bodies that the file does not have.
    void remove_missing_bodies() {
        const std::size_t count = bodies_.size();
        if (std::ranges::find(in_file_, 0) == in_file_.end()) return;
        std::size_t remaining = 0;
        for (std::size_t i = 0; i < result_.rows.size(); ++i)
            if (in_file_[i % count] != 0) result_.rows[remaining++] = result_.rows[i];
        result_.rows.resize(remaining);
        std::vector<std::string> names;
        for (std::size_t body = 0; body < count; ++body)
            if (in_file_[body] != 0) names.push_back(std::move(bodies_[body]));
        bodies_ = std::move(names);
    }

    std::string_view text_;
    CsvLines lines_;
    const std::string& file_;
    const ForeignColumns& foreign_;
    QuaternionColumns quaternion_;
    std::vector<std::size_t>* gaps_;                // if null, NaN is refused
    std::set<std::string, std::less<>> nan_times_;  // times at which a cell is NaN
    bool in_gap_ = false;                           // whether the last line was at one of these times
    std::size_t times_ = 0;                         // number of times read so far
    std::vector<std::string> names_;                // names of the file's columns
    std::vector<FileColumn> columns_;               // the columns that are read, in the file's order
    bool has_matrix_ = false, has_angles_ = false;  // read instead of the quaternion
    std::size_t time_place_ = no_column;
    std::size_t body_place_ = no_column;
    bool bodies_known_;                                      // whether the caller gave the bodies
    std::vector<std::string> bodies_;                        // names, in the order of the rows at one time
    std::map<std::string, std::size_t, std::less<>> index_;  // index of each name
    std::size_t moment_ = 0;                                 // first row at the current time
    std::vector<char> has_row_;                              // whether each body has a row at the current time
    std::vector<char> in_file_;                              // whether each body has a row at the first time
    long last_line_ = 0;                                     // line of the last row of a body
    TrajectoryFile result_;
};

}  // namespace

TrajectoryFile parse_trajectory(std::string_view text, const std::string& file, QuaternionColumns quaternion,
                                std::span<const std::string> bodies) {
    return parse_foreign_trajectory(text, file, {}, quaternion, bodies);
}

TrajectoryFile parse_foreign_trajectory(std::string_view text, const std::string& file, const ForeignColumns& columns,
                                        QuaternionColumns quaternion, std::span<const std::string> bodies,
                                        std::vector<std::size_t>* gaps) {
    return Reader(text, file, columns, quaternion, bodies, gaps).read();
}

TrajectoryFile read_trajectory(const std::string& path, QuaternionColumns quaternion,
                               std::span<const std::string> bodies) {
    return parse_trajectory(read_text(path, largest_file, "a readable CSV file"), path, quaternion, bodies);
}

}  // namespace polhode
