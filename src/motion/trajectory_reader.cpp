// The strict reader of trajectory files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "body/orientation.h"
#include "motion/trajectory_csv.h"
#include "text/csv_lines.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t largest_file = std::size_t{1} << 30;

struct Column {
    const char* name;
    double* (*place)(TrajectoryRow&);  // nullptr: read past
    int block;                         // columns of one block stand together
};

enum Block { block_t, block_q, block_w, block_p, block_o, block_v, block_bound, block_body, blocks };
constexpr const char* block_names[blocks] = {"t",        "qw,qx,qy,qz", "wx,wy,wz", "px,py,pz",
                                             "ox,oy,oz", "vx,vy,vz",    "",         ""};
constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

const std::vector<Column>& known_columns() {
    using Row = TrajectoryRow;
    static const std::vector<Column> columns{
        {"t", [](Row& r) { return &r.t; }, block_t},
        {"qw", [](Row& r) { return &r.q.w; }, block_q},
        {"qx", [](Row& r) { return &r.q.x; }, block_q},
        {"qy", [](Row& r) { return &r.q.y; }, block_q},
        {"qz", [](Row& r) { return &r.q.z; }, block_q},
        {"wx", [](Row& r) { return &r.angular_velocity_W[0]; }, block_w},
        {"wy", [](Row& r) { return &r.angular_velocity_W[1]; }, block_w},
        {"wz", [](Row& r) { return &r.angular_velocity_W[2]; }, block_w},
        {"px", [](Row& r) { return &r.position_W[0]; }, block_p},
        {"py", [](Row& r) { return &r.position_W[1]; }, block_p},
        {"pz", [](Row& r) { return &r.position_W[2]; }, block_p},
        {"ox", [](Row& r) { return &r.position_W[0]; }, block_o},
        {"oy", [](Row& r) { return &r.position_W[1]; }, block_o},
        {"oz", [](Row& r) { return &r.position_W[2]; }, block_o},
        {"vx", [](Row& r) { return &r.velocity_W[0]; }, block_v},
        {"vy", [](Row& r) { return &r.velocity_W[1]; }, block_v},
        {"vz", [](Row& r) { return &r.velocity_W[2]; }, block_v},
        {"bound", nullptr, block_bound},
        {"body", nullptr, block_body},
    };
    return columns;
}

// One file, line by line.
class Reader {
  public:
    Reader(std::string_view text, const std::string& file, QuaternionColumns quaternion,
           std::span<const std::string> bodies)
        : lines_(text, file),
          file_(file),
          quaternion_(quaternion),
          bodies_known_(!bodies.empty()),
          bodies_(bodies.begin(), bodies.end()) {
        for (std::size_t i = 0; i < bodies_.size(); ++i) index_.emplace(bodies_[i], i);
    }

    TrajectoryFile read() {
        if (!lines_.next()) fail("", "is empty", "give a header line t,qw,qx,qy,qz,.. and one line per sample");
        header();
        while (lines_.next()) {
            // as many as there are lines of this length
            if (result_.rows.empty()) result_.rows.reserve(lines_.rows_left());
            sample();
        }
        if (result_.rows.empty()) fail("", "has a header but no samples", "give one line per sample");
        if (body_column_ != nowhere) end_moment(), leave_out_missing();
        result_.bodies = std::move(bodies_);
        result_.read_past = lines_.read_past();
        return std::move(result_);
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
        throw InputError(file_, place, fault, remedy);
    }
    std::string here() const { return fmt::format("line {}", lines_.number()); }
    std::string at(std::size_t column) const {
        return fmt::format("line {}, column {}", lines_.number(), columns_[column]->name);
    }

    void header() {
        std::vector<std::string> names;
        for (const Column& known : known_columns()) names.emplace_back(known.name);
        int seen[blocks] = {};
        for (const std::size_t place : lines_.header(names)) {
            columns_.push_back(&known_columns()[place]);
            ++seen[columns_.back()->block];
        }
        for (const Column& known : known_columns()) {
            const bool needed = known.block <= block_q || (seen[known.block] > 0 && known.block < block_bound);
            if (needed && std::find(columns_.begin(), columns_.end(), &known) == columns_.end())
                fail(here(), fmt::format("column {} is missing", known.name),
                     known.block <= block_q ? "give at least t,qw,qx,qy,qz"
                                            : fmt::format("give all of {} or none", block_names[known.block]));
        }
        if (seen[block_p] > 0 && seen[block_o] > 0)
            fail(here(), "has both px,py,pz and ox,oy,oz",
                 "give the centre of mass (p) or the body's origin (o), not both");
        if (seen[block_body] == 0 && bodies_.size() > 1)
            fail(here(), "column body is missing",
                 "give t,body,qw,.. with one line at each time for each of " + one_line(listed(bodies_), 200) +
                     ", or for some of them");
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            places_.push_back(columns_[i]->place);
            if (columns_[i]->block == block_body) body_column_ = i;
        }
        if (quaternion_ != QuaternionColumns::by_name) take_quaternion_in_order();
        result_.has_angular_velocity = seen[block_w] > 0;
        result_.has_position = seen[block_p] > 0;
        result_.has_origin = seen[block_o] > 0;
        result_.has_velocity = seen[block_v] > 0;
    }

    // the quaternion's columns as they stand
    void take_quaternion_in_order() {
        std::size_t next = quaternion_ == QuaternionColumns::scalar_first ? 0 : 1;  // of w, x, y, z
        for (std::size_t i = 0; i < columns_.size(); ++i)
            if (columns_[i]->block == block_q) places_[i] = known_columns()[1 + next++ % 4].place;
    }

    void sample() {
        const auto& cells = lines_.cells();
        if (cells.size() != columns_.size())
            fail(here(), fmt::format("has {} cells under {} columns", cells.size(), columns_.size()),
                 "give one number per column");
        TrajectoryRow row;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (i == body_column_) continue;
            const std::optional<double> value = parse_decimal(cells[i]);
            if (!value)
                fail(at(i), cells[i].empty() ? "is empty" : one_line(cells[i], 60) + " is not a number",
                     "give a decimal number such as -1.5e-3");
            if (!std::isfinite(*value)) fail(at(i), one_line(cells[i], 60) + " is not finite", "give a finite number");
            if (places_[i] != nullptr) *places_[i](row) = *value;
        }
        const std::string time = fmt::format("line {}, column t", lines_.number());
        if (row.t < 0) fail(time, shortest_decimal(row.t) + " s is before the start of the scene", "give times >= 0");
        const bool same_moment = body_column_ != nowhere && !result_.rows.empty() && row.t == result_.rows.back().t;
        if (!same_moment && !result_.rows.empty() && !(row.t > result_.rows.back().t))
            fail(time,
                 fmt::format("{} s is not after the {} s of the previous sample", shortest_decimal(row.t),
                             shortest_decimal(result_.rows.back().t)),
                 "give each time once, in ascending order");
        const double length = norm(row.q);
        if (!(length >= 1e-100 && length <= 1e100))
            fail(fmt::format("line {}, columns qw,qx,qy,qz", lines_.number()),
                 fmt::format("have length {}, which does not define an attitude", shortest_decimal(length)),
                 "give a quaternion w, x, y, z of length about 1");
        if (body_column_ == nowhere)
            result_.rows.push_back(row);
        else
            sample_of_body(row, same_moment, cells[body_column_]);
    }

    // Into the place of its body at its time.
    void sample_of_body(const TrajectoryRow& row, bool same_moment, std::string_view name) {
        if (!same_moment) begin_moment();
        const auto known = index_.find(name);
        const std::size_t body = known == index_.end() ? bodies_.size() : known->second;
        if (body == bodies_.size()) {
            if (name.empty()) fail(at(body_column_), "is empty", "give the body's name");
            if (bodies_known_) {
                const std::string meant = did_you_mean(name, bodies_);
                fail(at(body_column_), fmt::format("\"{}\" is not a body of the scene", one_line(name, 60)),
                     meant.empty() ? "give one of " + one_line(listed(bodies_), 200) : meant);
            }
            if (moment_ > 0)
                fail(at(body_column_), fmt::format("body \"{}\" has no line at the first time", one_line(name, 60)),
                     "give one line per body at each time");
            bodies_.emplace_back(name);
            index_.emplace(name, body);
        }
        if (moment_ > 0 && in_file_[body] == 0)
            fail(at(body_column_), fmt::format("body \"{}\" has no line at the first time", one_line(name, 60)),
                 "give one line per body at each time");
        if (body < there_.size() && there_[body] != 0)
            fail(at(body_column_),
                 fmt::format("body \"{}\" has two lines at {} s", one_line(name, 60), shortest_decimal(row.t)),
                 "give one line per body at each time");
        there_.resize(bodies_.size()), there_[body] = 1;
        last_line_ = lines_.number();
        // the rows of a moment that are still to come have its time already
        TrajectoryRow to_come;
        to_come.t = row.t;
        result_.rows.resize(moment_ + bodies_.size(), to_come);
        result_.rows[moment_ + body] = row;
    }
    void begin_moment() {
        if (!result_.rows.empty()) end_moment();
        moment_ = result_.rows.size();
        there_.assign(bodies_.size(), 0);
    }
    // The bodies at the first time are those of the file.
    void end_moment() {
        if (moment_ == 0) in_file_ = there_;
        for (std::size_t body = 0; body < bodies_.size(); ++body)
            if (there_[body] == 0 && in_file_[body] != 0)
                fail(fmt::format("line {}, column body", last_line_),
                     fmt::format("body \"{}\" has no line at {} s", one_line(bodies_[body], 60),
                                 shortest_decimal(result_.rows.back().t)),
                     "give one line per body at each time");
    }
    // Takes out the places of bodies that the file does not have.
    void leave_out_missing() {
        const std::size_t count = bodies_.size();
        if (std::ranges::find(in_file_, 0) == in_file_.end()) return;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < result_.rows.size(); ++i)
            if (in_file_[i % count] != 0) result_.rows[kept++] = result_.rows[i];
        result_.rows.resize(kept);
        std::vector<std::string> names;
        for (std::size_t body = 0; body < count; ++body)
            if (in_file_[body] != 0) names.push_back(std::move(bodies_[body]));
        bodies_ = std::move(names);
    }

    CsvLines lines_;
    const std::string& file_;
    QuaternionColumns quaternion_;
    std::vector<const Column*> columns_;               // in the file's order
    std::vector<double* (*)(TrajectoryRow&)> places_;  // of each column
    std::size_t body_column_ = nowhere;
    bool bodies_known_;                                      // to the caller
    std::vector<std::string> bodies_;                        // names, in the order of the rows of a moment
    std::map<std::string, std::size_t, std::less<>> index_;  // of a name
    std::size_t moment_ = 0;                                 // the first row of the moment at hand
    std::vector<char> there_;                                // which of the bodies have a row in it
    std::vector<char> in_file_;                              // which have a row at the first time
    long last_line_ = 0;                                     // of a body's row
    TrajectoryFile result_;
};

}  // namespace

TrajectoryFile parse_trajectory(std::string_view text, const std::string& file, QuaternionColumns quaternion,
                                std::span<const std::string> bodies) {
    return Reader(text, file, quaternion, bodies).read();
}

TrajectoryFile read_trajectory(const std::string& path, QuaternionColumns quaternion,
                               std::span<const std::string> bodies) {
    return parse_trajectory(read_text(path, largest_file, "a readable CSV file"), path, quaternion, bodies);
}

}  // namespace polhode
