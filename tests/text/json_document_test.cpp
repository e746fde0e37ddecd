#include "text/json_document.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>

namespace polhode {
namespace {

std::string fault_of(std::string_view text) {
    try {
        const JsonDocument document(text, "f");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

template <class Call>
std::string thrown(Call&& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(JsonDocument, KnowsKindsPointersAndKeys) {
    const JsonDocument document(R"({"a/b": [1, {"m~n": true}], "c": null, "d": "x"})", "f");
    const JsonNode& root = document.root();
    EXPECT_EQ(root.pointer(), "");
    const JsonNode& list = root.require_member("a/b", "a list");
    EXPECT_EQ(list.pointer(), "/a~1b");
    EXPECT_EQ(list.key(), "a/b");
    ASSERT_EQ(list.elements().size(), 2u);
    EXPECT_EQ(list.elements()[0]->whole_number(), 1);
    EXPECT_EQ(list.elements()[1]->find("m~n")->pointer(), "/a~1b/1/m~0n");
    EXPECT_TRUE(list.elements()[1]->find("m~n")->boolean());
    EXPECT_EQ(root.find("c")->kind(), JsonKind::null);
    EXPECT_EQ(root.find("d")->string(), "x");
    EXPECT_EQ(root.find("e"), nullptr);
}

TEST(JsonDocument, StaysWhereItIsWhenMoved) {
    JsonDocument first(R"({"a": [1]})", "f");
    const JsonNode* node = first.root().find("a");
    const JsonDocument second(std::move(first));
    EXPECT_EQ(second.root().find("a"), node);
    EXPECT_EQ(thrown([&] { node->number(); }), "f: /a: is an array of length 1; give a number");
}

TEST(JsonDocument, GettersSayWhatIsThere) {
    const JsonDocument document(R"({"n": 1.5, "s": "a\nb", "t": false, "o": {}, "z": null})", "f");
    const auto at = [&](const char* key) -> const JsonNode& { return *document.root().find(key); };
    EXPECT_EQ(thrown([&] { at("n").whole_number(); }), "f: /n: is 1.5; give a whole number");
    EXPECT_EQ(thrown([&] { at("n").string(); }), "f: /n: is 1.5; give a string");
    EXPECT_EQ(thrown([&] { at("s").number(); }), "f: /s: is the string \"a\\\\nb\"; give a number");
    EXPECT_EQ(thrown([&] { at("t").elements(); }), "f: /t: is false; give an array");
    EXPECT_EQ(thrown([&] { at("o").boolean(); }), "f: /o: is an object; give true or false");
    EXPECT_EQ(thrown([&] { at("z").members(); }), "f: /z: is null; give an object");
    EXPECT_EQ(thrown([&] { at("o").require_member("k", "a key"); }), "f: /o/k: is missing; give a key");
    EXPECT_EQ(thrown([&] {
                  document.root().require_known_keys({"n", "s", "t", "o"});
              }),
              "f: /z: is an unknown key; known keys: n, s, t, o");
}

TEST(JsonDocument, DepthOf64IsAllowedAnd65IsNot) {
    const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    EXPECT_EQ(fault_of(nested(64)), "");
    EXPECT_NE(fault_of(nested(65)).find("more than 64 levels deep"), std::string::npos);
    EXPECT_NE(fault_of(std::string(10'000'000, '[')).find("more than 64 levels deep"), std::string::npos);
}

TEST(JsonDocument, SyntaxErrorsGiveLineColumnAndPointer) {
    EXPECT_EQ(fault_of("{\n  \"a\": [1,\n    oops]}").find("f: line 3, column 5, in /a/1: "), 0u)
        << fault_of("{\n  \"a\": [1,\n    oops]}");
    EXPECT_EQ(fault_of("{\"a\": {\"b\": -Infinity}}"),
              "f: /a/b: is -Infinity, which is not a number in JSON; give a finite number");
    EXPECT_EQ(fault_of("[1, 2, 1e400]"), "f: /2: is too large for binary64; give a finite number");
}

TEST(JsonDocument, RefusesGuards) {
    EXPECT_NE(fault_of(std::string((16u << 20) + 1, ' ')).find("16 MiB"), std::string::npos);
    std::string many = "[";
    for (int i = 0; i < 1'000'001; ++i) many += "0,";
    EXPECT_NE(fault_of(many + "0]").find("more than 1000000 values"), std::string::npos);
    EXPECT_NE(fault_of(std::string_view("[1]\0[2]", 7)).find("zero byte"), std::string::npos);
}

TEST(ReadText, AFifoIsRefusedAtOnce) {
    std::string directory = (std::filesystem::temp_directory_path() / "polhode_fifo_XXXXXX").string();
    ASSERT_NE(::mkdtemp(directory.data()), nullptr);
    const std::string path = directory + "/pipe";
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    EXPECT_NE(thrown([&] { read_text(path); }).find("is a FIFO, not a regular file"), std::string::npos);
    std::filesystem::remove_all(directory);
}

// the reader recovers what json_string() writes
RC_GTEST_PROP(JsonString, ReadsBack, ()) {
    const std::string text = *rc::gen::container<std::string>(rc::gen::inRange<char>(0, 127));
    const std::string document = json_string(text);
    RC_ASSERT(JsonDocument(document, "f").root().string() == text);
}

}  // namespace
}  // namespace polhode
