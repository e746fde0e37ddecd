#include "text/npy.h"

#include <gtest/gtest.h>

#include "text/message.h"

namespace polhode {
namespace {

// The bytes that numpy.save writes (format version 1.0) with this dictionary.
std::string file_with(const std::string& dictionary, std::size_t data = 0) {
    const std::string text = dictionary + std::string(63 - (10 + dictionary.size()) % 64, ' ') + '\n';
    return "\x93NUMPY" + std::string("\1\0", 2) + static_cast<char>(text.size() & 255) +
           static_cast<char>(text.size() >> 8) + text + std::string(data, '\0');
}

NpyHeader header_of(const std::string& file) { return parse_npy_header(file, file.size(), "t.npy"); }

std::string message_of(const std::string& file) {
    try {
        header_of(file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

const std::string rest = ", 'fortran_order': False, 'shape': (2,), }";

TEST(Npy, FieldsInTheirPlaces) {
    // as written by numpy 1.24 for numpy.dtype([('id', 'S3'), ('wx', 'f8'), ('n', 'i8')], align=True)
    const NpyHeader header =
        header_of(file_with("{'descr': [('id', '|S3'), ('', '|V5'), ('wx', '<f8'), ('n', '<i8')]" + rest, 48));
    EXPECT_EQ(header.rows, 2u);
    EXPECT_EQ(header.record_size, 24u);
    EXPECT_EQ(header.data_offset % 64, 0u);
    ASSERT_EQ(header.fields.size(), 4u);
    EXPECT_EQ(header.fields[0].size, 3u);
    EXPECT_EQ(header.fields[2].name, "wx");
    EXPECT_EQ(header.fields[2].offset, 8u);
    EXPECT_EQ(header.fields[3].offset, 16u);
}

TEST(Npy, AHeaderIsAsLongForAnyNumberOfRows) {
    const std::vector<NpyField> fields{{"row", "<i8"}, {"t", "<f8"}, {"id", "|S7"}};
    const std::string none = write_npy_header(fields, 0);
    for (const std::uint64_t rows : {1ull, 99'999ull, 1'000'000'000'000ull, 18'446'744'073'709'551'615ull / 24}) {
        const std::string header = write_npy_header(fields, rows);
        EXPECT_EQ(header.size(), none.size());
        EXPECT_EQ(header.size() % 64, 0u);
        const NpyHeader read = parse_npy_header(header, header.size() + 23 * rows, "t.npy");
        EXPECT_EQ(read.rows, rows);
        EXPECT_EQ(read.record_size, 23u);
        EXPECT_EQ(read.fields[2].offset, 16u);
    }
}

TEST(Npy, ReportsFaults) {
    const std::string mass = "{'descr': [('mass', '<f8')]";
    EXPECT_EQ(message_of(file_with(mass + rest, 16)), "none");
    const std::pair<std::string, const char*> faults[]{
        {"", "does not start with the magic string of an .npy file"},
        {"mass\n1\n", "does not start with the magic string of an .npy file"},
        {"\x93NUMPY", "ends within its header"},
        {file_with(mass + rest).substr(0, 60), "ends within its header"},
        {"\x93NUMPY" + std::string("\4\0\1\0\0\0\n", 7), "has format version 4.0"},
        {"\x93NUMPY" + std::string("\2\0\0\0\0\1", 6), "has a header larger than 64 KiB"},
        {file_with(mass + rest, 15), "has 15 bytes of data where its header declares 2 records of 8 bytes"},
        {file_with(mass + rest, 24), "has 24 bytes of data"},
        {file_with("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", 48), "has no named fields"},
        {file_with(mass + ", 'fortran_order': True, 'shape': (2,), }", 16), "has fortran_order True"},
        {file_with(mass + ", 'fortran_order': False, 'shape': (2, 1), }", 16), "has a shape with several dimensions"},
        {file_with(mass + ", 'fortran_order': False, 'shape': (), }", 8), "has a shape without dimensions"},
        {file_with(mass + ", 'fortran_order': False, 'shape': (99999999999999999999,), }", 8), "beyond 64 bits"},
        {file_with(mass + ", 'fortran_order': False, 'shape': (2305843009213693953,), }", 8), "declares 230584"},
        {file_with(mass + ", 'fortran_order': False}", 8), "lacks descr"},
        {file_with(mass + ", 'shape': (1,), 'shape': (1,)}", 8), "has the key shape, which is unknown or repeated"},
        {file_with(mass + rest + "}", 16), "continues after its closing brace"},
        {file_with("{'descr': [('mass', '>f8')]" + rest, 16), "mass is big-endian"},
        {file_with("{'descr': [('mass', '<f4')]" + rest, 8), "mass has type <f4"},
        {file_with("{'descr': [('mass', '|O')]" + rest, 16), "mass has type |O"},
        {file_with("{'descr': [('mass', '|S0')]" + rest, 16), "mass has type |S0"},
        {file_with("{'descr': [('mass', '|V8')]" + rest, 16), "mass has type |V8"},
        {file_with("{'descr': [('q', '<f8', (4,))]" + rest, 64), "q is an array"},
        {file_with("{'descr': [('q', [('w', '<f8')])]" + rest, 16), "q has subfields"},
        {file_with("{'descr': [(('title', 'q'), '<f8')]" + rest, 16), "has a field with a title"},
        {file_with("{'descr': [('m', '<f8'), ('m', '<f8')]" + rest, 32), "has two fields m"},
        {file_with("{'descr': []" + rest, 0), "has empty records"},
        {file_with("{'descr': [('\\x6d', '<f8')]" + rest, 16), "has a name with a backslash"},
    };
    for (const auto& [file, fault] : faults) {
        const std::string message = message_of(file);
        EXPECT_NE(message.find(fault), std::string::npos) << fault << "\n" << message;
        EXPECT_EQ(message.find("t.npy: "), 0u) << message;
        EXPECT_NE(message.find("; give "), std::string::npos) << message;
    }
}

}  // namespace
}  // namespace polhode
