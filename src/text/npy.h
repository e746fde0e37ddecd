// NumPy's binary format of one table (.npy), read strictly: records of named numbers and short texts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// A field of a record.
struct NpyField {
    std::string name;        ///< empty of what pads records
    std::string type;        ///< as NumPy writes it: "<f8" (binary64), "<i8", "|S12" (bytes, zeros behind), "|V4"
    std::size_t size = 0;    ///< bytes
    std::size_t offset = 0;  ///< from the record's beginning
};

/// What a file's header says.
struct NpyHeader {
    std::vector<NpyField> fields;  ///< in the file's order
    std::size_t record_size = 0;   ///< bytes
    std::uint64_t rows = 0;        ///< records
    std::size_t data_offset = 0;   ///< where the first record begins

    /// How long a file is that this header is of.
    std::uint64_t file_size() const { return data_offset + rows * record_size; }
};

/// The longest header that is read: that many bytes of a file are enough for parse_npy_header().
constexpr std::size_t longest_npy_header = std::size_t{64} << 10;

/// Reads the header of a file by its first bytes: a one-dimensional array of records with the fields' types named
/// above, in versions 1 to 3 of the format. `file_size` is that of the whole file, and is exactly what the header asks
/// for. Throws InputError, in which the file is called `file`.
NpyHeader parse_npy_header(std::string_view beginning, std::uint64_t file_size, const std::string& file);

/// A header for records of these fields one after the other (offsets are not looked at), of names in ASCII without
/// quotes; as long for any number of rows.
std::string write_npy_header(const std::vector<NpyField>& fields, std::uint64_t rows);

}  // namespace polhode
