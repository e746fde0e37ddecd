// Strict reader and writer of the header of NumPy's binary format (.npy): records of named numbers and short texts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// A field of a record.
struct NpyField {
    std::string name;        ///< empty for padding
    std::string type;        ///< NumPy's code: "<f8" (binary64), "<i8", "|S12" (bytes, padded with zeros), "|V4"
    std::size_t size = 0;    ///< bytes
    std::size_t offset = 0;  ///< bytes from the start of the record
};

/// The contents of a file's header.
struct NpyHeader {
    std::vector<NpyField> fields;  ///< in file order
    std::size_t record_size = 0;   ///< bytes
    std::uint64_t rows = 0;        ///< records
    std::size_t data_offset = 0;   ///< bytes before the first record

    /// The size in bytes of a file with this header.
    std::uint64_t file_size() const { return data_offset + rows * record_size; }
};

/// Size limit of a header in bytes. parse_npy_header() needs at most this many bytes of a file.
constexpr std::size_t longest_npy_header = std::size_t{64} << 10;

/// Parses the header from the first bytes of a file: a one-dimensional array of records of the field types named
/// above, format versions 1 to 3. `file_size` is the size of the whole file in bytes and must match the header
/// exactly. Throws InputError that names the file as `file`.
NpyHeader parse_npy_header(std::string_view beginning, std::uint64_t file_size, const std::string& file);

/// A header for packed records of these fields (their offsets are ignored), with ASCII names without quotes. Its
/// length does not depend on the number of rows.
std::string write_npy_header(const std::vector<NpyField>& fields, std::uint64_t rows);

}  // namespace polhode
