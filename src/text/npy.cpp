#include "text/npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <utility>

#include "text/message.h"

namespace polhode {
namespace {

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::size_t most_fields = 1000, widest_field = 4096;
constexpr const char* wanted = "give what numpy.save writes of a one-dimensional structured array";

// Parses the header's text: the subset of a Python dictionary that NumPy writes.
class HeaderReader {
  public:
    HeaderReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    void read(NpyHeader& header) {
        bool descr = false, order = false, shape = false;
        take('{');
        while (!found('}')) {
            const std::string key = string();
            take(':');
            if (key == "descr" && !std::exchange(descr, true))
                fields(header);
            else if (key == "fortran_order" && !std::exchange(order, true))
                fortran_order();
            else if (key == "shape" && !std::exchange(shape, true))
                header.rows = rows();
            else
                fail("has the key " + one_line(key, 60) + ", unknown or twice", wanted);
            if (found('}')) break;
            take(',');
        }
        blanks();
        if (!text_.empty()) fail("goes on behind its end", wanted);
        if (!descr || !order || !shape) fail("lacks descr, fortran_order or shape", wanted);
    }

  private:
    [[noreturn]] void fail(const std::string& fault, const std::string& remedy) const {
        throw InputError(file_, "header", fault, remedy);
    }
    void blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(" \t\n"), text_.size())); }
    // Consumes `c` if it comes next.
    bool found(char c) {
        blanks();
        if (!text_.starts_with(c)) return false;
        text_.remove_prefix(1);
        return true;
    }
    void take(char c) {
        if (!found(c)) fail(fmt::format("has no {} where one belongs", c), wanted);
    }
    bool found_word(std::string_view word) {
        blanks();
        if (!text_.starts_with(word)) return false;
        text_.remove_prefix(word.size());
        return true;
    }

    // A string in quotes of either kind, without escapes.
    std::string string() {
        blanks();
        const char quote = text_.empty() ? '\0' : text_[0];
        const std::size_t end = quote == '\'' || quote == '"' ? text_.find(quote, 1) : text_.npos;
        if (end == text_.npos) fail("has no text in quotes where one belongs", wanted);
        const std::string_view content = text_.substr(1, end - 1);
        if (content.find('\\') != content.npos) fail("has a name with a backslash", "give plain names");
        text_.remove_prefix(end + 1);
        return std::string(content);
    }

    void fortran_order() {
        if (found_word("True")) fail("says fortran_order", "give an array in C order");
        if (!found_word("False")) fail("has a fortran_order that is neither True nor False", wanted);
    }

    std::uint64_t rows() {
        take('(');
        blanks();
        std::uint64_t count = 0;
        const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), count);
        if (end == text_.data()) fail("has a shape of no dimension", "give a one-dimensional array, a record a body");
        if (error != std::errc()) fail("has a shape beyond 64 bits", wanted);
        text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
        take(',');
        if (!found(')')) fail("has a shape of several dimensions", "give a one-dimensional array, a record a body");
        return count;
    }

    void fields(NpyHeader& header) {
        if (!found('['))
            fail("has no named fields",
                 "give a structured array, say a = numpy.zeros(n, [('wx', '<f8'), ('wy', '<f8'), ('wz', '<f8')])");
        while (!found(']')) {
            take('(');
            NpyField field;
            blanks();
            if (text_.starts_with('(')) fail("has a field with a title", "give plain names");
            field.name = string();
            take(',');
            blanks();
            const std::string called = field.name.empty() ? "a field" : one_line(field.name, 60);
            if (text_.starts_with('['))
                fail(called + " has fields of its own", "give numbers, a field for each column");
            field.type = string();
            if (!found(')')) fail(called + " has a shape of its own", "give numbers, a field for each column");
            field.size = size_of(field, called);
            field.offset = header.record_size;
            header.record_size += field.size;
            const auto same = [&](const NpyField& other) { return !field.name.empty() && other.name == field.name; };
            if (std::ranges::any_of(header.fields, same)) fail("has two fields " + called, "give each once");
            header.fields.push_back(std::move(field));
            if (header.fields.size() > most_fields) fail("has more than 1000 fields", "give those that are columns");
            if (found(']')) break;
            take(',');
        }
        if (header.record_size == 0) fail("has records of no bytes", "give a field for each column");
    }

    std::size_t size_of(const NpyField& field, const std::string& called) const {
        const std::string_view type = field.type;
        if (type == "<f8" || type == "<i8") return 8;
        if (type == ">f8" || type == ">i8")
            fail(called + " is big-endian", "give little-endian numbers: a.astype(a.dtype.newbyteorder('<'))");
        // padding fields have no name and type V; named byte fields have type S
        const std::string_view letter = field.name.empty() ? "|V" : "|S";
        std::size_t size = 0;
        const char* const end = type.data() + type.size();
        if (type.starts_with(letter) && std::from_chars(type.data() + 2, end, size).ptr == end && size > 0 &&
            size <= widest_field)
            return size;
        fail(fmt::format("{} is of type {}", called, one_line(type, 60)),
             "give <f8 for numbers and S1 to S200 for ids");
    }

    std::string_view text_;
    const std::string& file_;
};

}  // namespace

NpyHeader parse_npy_header(std::string_view beginning, std::uint64_t file_size, const std::string& file) {
    const auto fail = [&](const std::string& fault, const std::string& remedy = wanted) {
        throw InputError(file, "", fault, remedy);
    };
    const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(beginning[i])); };
    if (!beginning.starts_with(magic)) fail("does not begin as an .npy file");
    const std::size_t start = beginning.size() > 6 && byte(6) == 1 ? 10 : 12;
    if (beginning.size() < start) fail("ends within its header");
    if (byte(6) < 1 || byte(6) > 3 || byte(7) != 0)
        fail(fmt::format("is of version {}.{} of the format", byte(6), byte(7)), "give one of 1.0, 2.0 or 3.0");
    std::size_t length = 0;
    for (std::size_t i = start; i-- > 8;) length = length << 8 | byte(i);
    if (length > longest_npy_header - start) fail("has a header of more than 64 KiB", "give fewer fields");
    if (beginning.size() < start + length) fail("ends within its header");
    NpyHeader header;
    HeaderReader(beginning.substr(start, length), file).read(header);
    header.data_offset = start + length;
    // by division: the number of rows is untrusted, and a product may overflow
    const std::uint64_t data = file_size - std::min<std::uint64_t>(file_size, header.data_offset);
    if (data / header.record_size != header.rows || data % header.record_size != 0)
        fail(fmt::format("has {} bytes behind its header, which announces {} records of {}", data, header.rows,
                         header.record_size),
             "give a file that was written to its end");
    return header;
}

std::string write_npy_header(const std::vector<NpyField>& fields, std::uint64_t rows) {
    std::string text = "{'descr': [";
    for (const NpyField& field : fields)
        text += fmt::format("{}('{}', '{}')", &field == &fields.front() ? "" : ", ", field.name, field.type);
    text += "], 'fortran_order': False, 'shape': (";
    const std::string count = std::to_string(rows);
    text += count + ",), }";
    // pad for any number of rows, then to a multiple of 64 bytes with a line end, as NumPy requires
    constexpr std::size_t most_digits = 20, start = 10;
    text.append(most_digits - count.size(), ' ');
    text.append(63 - (start + text.size()) % 64, ' ');
    text += '\n';
    if (text.size() > 65535) throw std::length_error("an .npy header of more than 64 KiB");
    std::string header(magic);
    header += {'\x01', '\x00', static_cast<char>(text.size() & 255), static_cast<char>(text.size() >> 8)};
    return header + text;
}

}  // namespace polhode
