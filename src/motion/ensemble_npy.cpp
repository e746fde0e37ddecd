#include "motion/ensemble_npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "text/decimal.h"
#include "text/input_file.h"
#include "text/message.h"
#include "text/npy.h"

namespace polhode {
namespace {

constexpr std::size_t block = std::size_t{1} << 20;  // bytes read at once, or one record

// A file's bytes from an offset on: as many as were asked for, fewer only at its end.
using Bytes = std::function<std::size_t(std::size_t offset, char* bytes, std::size_t count)>;

class NpyEnsemble : public EnsembleStream {
  public:
    NpyEnsemble(Bytes bytes, std::size_t size, std::string file, const Scene& scene)
        : EnsembleStream(std::move(file), scene), bytes_(std::move(bytes)) {
        std::string beginning(std::min(size, longest_npy_header), '\0');
        beginning.resize(bytes_(0, beginning.data(), beginning.size()));
        header_ = parse_npy_header(beginning, size, file_);
        const std::vector<std::string>& names = columns().names();
        std::vector<std::size_t> places;
        for (const NpyField& field : header_.fields) {
            if (field.name.empty()) continue;
            const auto known = std::ranges::find(names, field.name);
            if (known == names.end()) {
                const std::string meant = did_you_mean(field.name, names);
                fail("header", "has the unknown field " + one_line(field.name, 60),
                     fmt::format("{}{}known columns: {}", meant, meant.empty() ? "" : " ", fmt::join(names, ", ")));
            }
            const bool is_id = &*known == &names.back();
            if (is_id != field.type.starts_with("|S") || (!is_id && field.type != "<f8"))
                fail("header", fmt::format("declares {} with type {}", field.name, field.type),
                     is_id ? "give a type from S1 to S200" : "give the type <f8");
            if (is_id) id_width_ = field.size;
            places.push_back(static_cast<std::size_t>(known - names.begin()));
            fields_.push_back({&*known, field.offset, is_id});
        }
        select(places, "header");
        const std::size_t most = std::max<std::size_t>(1, block / header_.record_size);
        held_.resize(std::min<std::size_t>(most, header_.rows) * header_.record_size);
    }

  protected:
    bool advance() override { return advance_by(1) == 1; }

    std::size_t advance_by(std::size_t rows) override {
        const std::uint64_t left = header_.rows - passed_;
        const std::size_t passed = static_cast<std::size_t>(std::min<std::uint64_t>(rows, left));
        passed_ += passed;
        if (passed == rows && rows > 0 && passed_ > held_end_) hold();
        return passed;
    }

    void read_cells() override {
        const char* const record = held_.data() + (passed_ - 1 - held_begin_) * header_.record_size;
        auto number = numbers_.begin();
        for (const Field& field : fields_) {
            if (field.is_id) {
                read_id({record + field.offset, id_width_});
                continue;
            }
            std::memcpy(&*number, record + field.offset, sizeof *number);
            if (!std::isfinite(*number))
                refuse({*field.name, shortest_decimal(*number) + " is not finite", "give a finite number"});
            ++number;
        }
    }

    std::size_t rows_left() const override { return static_cast<std::size_t>(header_.rows - passed_ + 1); }
    std::string here() const override { return fmt::format("row {}", passed_); }

  private:
    struct Field {
        const std::string* name;
        std::size_t offset;
        bool is_id;
    };

    void read_id(std::string_view id) {
        id_ = id.substr(0, id.find_last_not_of('\0') + 1);
        if (id_.find(',') != id_.npos || id_.starts_with(' ') || id_.ends_with(' '))
            refuse({"id", "contains a comma, or starts or ends with a space", "remove them"});
        if (const auto fault = columns().fault_of_id(id_)) refuse(*fault);
    }

    // Reads records, starting at the current one.
    void hold() {
        held_begin_ = passed_ - 1;
        const std::uint64_t rows =
            std::min<std::uint64_t>(held_.size() / header_.record_size, header_.rows - held_begin_);
        held_end_ = held_begin_ + rows;
        const std::size_t count = static_cast<std::size_t>(rows) * header_.record_size;
        const std::size_t offset = header_.data_offset + static_cast<std::size_t>(held_begin_) * header_.record_size;
        // it was long enough when it was opened
        if (bytes_(offset, held_.data(), count) < count)
            fail(here(), "is missing: the file was truncated while it was read",
                 "do not modify the file during the run");
    }

    Bytes bytes_;
    NpyHeader header_;
    std::vector<Field> fields_;
    std::uint64_t passed_ = 0;                     // the row at hand, counted from 1
    std::uint64_t held_begin_ = 0, held_end_ = 0;  // the rows that are held, counted from 0
    std::vector<char> held_;
};

}  // namespace

std::unique_ptr<EnsembleStream> open_npy_ensemble(const std::string& path, const Scene& scene) {
    const auto input = std::make_shared<InputFile>(path, path, "a readable .npy file", FileKinds::regular);
    const Bytes bytes = [input](std::size_t offset, char* to, std::size_t count) {
        input->seek(offset);
        return input->read_fully(to, count);
    };
    return std::make_unique<NpyEnsemble>(bytes, *input->size(), path, scene);
}

std::unique_ptr<EnsembleStream> npy_ensemble_of(std::string_view content, const std::string& file, const Scene& scene) {
    const Bytes bytes = [content](std::size_t offset, char* to, std::size_t count) {
        const std::string_view part = content.substr(std::min(offset, content.size()), count);
        std::copy(part.begin(), part.end(), to);
        return part.size();
    };
    return std::make_unique<NpyEnsemble>(bytes, content.size(), file, scene);
}

}  // namespace polhode
