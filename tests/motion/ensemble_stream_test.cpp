#include "motion/ensemble_stream.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "motion/ensemble_npy.h"
#include "text/message.h"
#include "text/npy.h"

namespace polhode {
namespace {

constexpr std::size_t all = std::numeric_limits<std::size_t>::max();

// 1000 rows; every seventh is invalid (negative mass).
std::string csv() {
    std::string text = "id,mass,wx,wy,wz\n# masses\n";
    for (int i = 1; i <= 1000; ++i)
        text += "b" + std::to_string(i) + ',' + (i % 7 == 0 ? "-1" : std::to_string(i)) + ",0.5," + std::to_string(i) +
                ",1e-3\n";
    return text;
}

// The same table in NumPy's format.
std::string npy() {
    std::string content =
        write_npy_header({{"id", "|S6"}, {"mass", "<f8"}, {"wx", "<f8"}, {"wy", "<f8"}, {"wz", "<f8"}}, 1000);
    for (int i = 1; i <= 1000; ++i) {
        std::string id = "b" + std::to_string(i);
        id.resize(6);
        const double numbers[]{i % 7 == 0 ? -1.0 : i, 0.5, double(i), 1e-3};
        content += id;
        content.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
    }
    return content;
}

using Open = std::function<std::unique_ptr<EnsembleStream>(const Scene&)>;

void expect_pieces(const Open& open, const EnsembleTable& whole, const char* first_place) {
    Scene scene;
    for (const std::size_t most : {1u, 3u, 64u, 999u, 1000u, 5000u}) {
        const auto stream = open(scene);
        EXPECT_TRUE(stream->has_ids());
        EnsembleTable piece, together;
        while (stream->next(piece, most)) {
            EXPECT_LE(piece.bodies.size() + piece.refused.size(), most);
            together.bodies.insert(together.bodies.end(), piece.bodies.begin(), piece.bodies.end());
            together.ids.insert(together.ids.end(), piece.ids.begin(), piece.ids.end());
            together.refused.insert(together.refused.end(), piece.refused.begin(), piece.refused.end());
        }
        EXPECT_EQ(stream->rows_passed(), 1000u);
        EXPECT_NO_THROW(stream->require_rows());
        EXPECT_EQ(together.bodies, whole.bodies);
        EXPECT_EQ(together.ids, whole.ids);
        ASSERT_EQ(together.refused.size(), 142u);
        for (std::size_t i = 0; i < together.refused.size(); ++i) EXPECT_EQ(together.refused[i].row, 7 * (i + 1));
        EXPECT_NE(together.refused[0].fault.find(first_place), std::string::npos) << together.refused[0].fault;
    }
    // skipped rows are counted but not parsed
    const auto stream = open(scene);
    EnsembleTable piece;
    EXPECT_EQ(stream->skip(13), 13u);
    ASSERT_TRUE(stream->next(piece, 2));
    ASSERT_EQ(piece.refused.size(), 1u);
    EXPECT_EQ(piece.refused[0].row, 14u);
    EXPECT_EQ(piece.ids, std::vector<std::string>{"b15"});
    EXPECT_EQ(stream->skip(900), 900u);
    ASSERT_TRUE(stream->next(piece, 1));
    EXPECT_EQ(piece.ids, std::vector<std::string>{"b916"});
    EXPECT_EQ(stream->skip(all), 84u);
    EXPECT_FALSE(stream->next(piece, 1));
}

TEST(EnsembleStream, PiecesAreTheWhole) {
    const Scene scene;
    const EnsembleTable whole = parse_ensemble(csv(), "t.csv", scene, BadRows::pass_over);
    const std::string text = csv(), content = npy();
    expect_pieces([&](const Scene& s) { return ensemble_of_text(text, "t.csv", s); }, whole,
                  "t.csv: line 9, column mass");
    expect_pieces([&](const Scene& s) { return npy_ensemble_of(content, "t.npy", s); }, whole,
                  "t.npy: row 7, column mass");
}

TEST(EnsembleStream, FilesByTheirEnding) {
    std::string pattern = (std::filesystem::temp_directory_path() / "polhode_table_XXXXXX").string();
    const std::filesystem::path directory = mkdtemp(pattern.data());
    const Scene scene;
    const EnsembleTable whole = parse_ensemble(csv(), "t.csv", scene, BadRows::pass_over);
    for (const char* name : {"t.csv", "t.npy"}) {
        const std::string path = (directory / name).string();
        std::ofstream(path, std::ios::binary) << (path.ends_with("npy") ? npy() : csv());
        expect_pieces([&](const Scene& s) { return open_ensemble(path, s); }, whole, (path + ": ").c_str());
    }
    // a file that becomes shorter while it is being read
    const std::string path = (directory / "t.npy").string();
    const auto stream = open_ensemble(path, scene);
    std::filesystem::resize_file(path, 5000);
    EnsembleTable piece;
    EXPECT_THROW(stream->next(piece, all), InputError);
    EXPECT_THROW(open_ensemble(path, scene), InputError);
    EXPECT_THROW(open_ensemble((directory / "none.npy").string(), scene), InputError);
    std::filesystem::remove_all(directory);
}

TEST(EnsembleStream, WithoutABody) {
    const Scene scene;
    const auto message_of = [&](const std::string& text) -> std::string {
        const auto stream = ensemble_of_text(text, "t.csv", scene);
        EnsembleTable piece;
        while (stream->next(piece, 1)) continue;
        try {
            stream->require_rows();
        } catch (const InputError& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_EQ(message_of("mass\n"), "t.csv: has a header but no rows; give one line per body");
    EXPECT_EQ(message_of("mass\n-1\nx\n").find("t.csv: has no valid row; first error: t.csv: line 2"), 0u);
    EXPECT_EQ(message_of("mass\n-1\n1\n"), "none");
}

// One record with the mass and another field.
template <class T>
std::string one_record(const std::string& name, const std::string& type, const T& value) {
    return write_npy_header({{"mass", "<f8"}, {name, type}}, 1) + std::string("\0\0\0\0\0\0\xf0?", 8) +
           std::string(reinterpret_cast<const char*>(&value), sizeof value);
}

TEST(EnsembleStream, NpyIsAsStrictAsCsv) {
    const auto fault_of = [](const std::string& content) -> std::string {
        const Scene scene;
        try {
            EnsembleTable piece;
            npy_ensemble_of(content, "t.npy", scene)->next(piece, all);
            return piece.refused.empty() ? "none" : piece.refused[0].fault;
        } catch (const InputError& error) {
            return error.what();
        }
    };
    const auto expect = [&](const std::string& content, const std::string& fault) {
        EXPECT_NE(fault_of(content).find(fault), std::string::npos) << fault_of(content);
    };
    const char a[4] = {'a', 0, 0, 0}, comma[4] = {'a', ',', 'b', 0}, bell[4] = {'a', 7, 0, 0},
               inner[4] = {'a', 0, 'b', 0}, space[4] = {' ', 'a', 0, 0}, latin[4] = {'a', '\xe4', 0, 0};
    expect(one_record("id", "|S4", a), "none");
    expect(one_record("id", "|S4", comma), "t.npy: row 1, column id: contains a comma");
    expect(one_record("id", "|S4", space), "starts or ends with a space");
    expect(one_record("id", "|S4", bell), "control characters");
    expect(one_record("id", "|S4", inner), "control characters");
    expect(one_record("id", "|S4", latin), "is not UTF-8");
    expect(one_record("id", "<f8", 1.0), "header: declares id with type <f8; give a type from S1 to S200");
    expect(one_record("wx", "<f8", 1.0), "column wy is missing; give all of wx,wy,wz or none");
    expect(one_record("wx", "|S4", a), "declares wx with type |S4; give the type <f8");
    expect(one_record("Mass", "<f8", 1.0), "has the unknown field Mass; did you mean mass?");
    expect(write_npy_header({{"mass", "<f8"}}, 1) + std::string("\0\0\0\0\0\0\xf8\x7f", 8),
           "t.npy: row 1, column mass: nan is not finite");
    expect(write_npy_header({{"id", "|S4"}}, 1) + "abcd", "has no column but id");
}

}  // namespace
}  // namespace polhode
