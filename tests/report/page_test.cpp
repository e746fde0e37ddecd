// Tests the insertion of a document into the page.
#include "report/page.h"

#include <gtest/gtest.h>

#include <random>

#include "report/document_text.h"

namespace polhode {
namespace {

TEST(Page, ContainsTheExactDocument) {
    std::mt19937 random(1);
    for (const std::size_t size : {0u, 1u, 2u, 3u, 100u, 1'000'000u}) {
        std::string document;
        for (std::size_t i = 0; i < size; ++i) document += static_cast<char>(random() % 256);
        EXPECT_EQ(document_text(fill_page(page_template, "folder", document)), document) << size;
    }
}

TEST(Page, IsTheSameForTheSameDocument) {
    EXPECT_EQ(fill_page(page_template, "a", "{}"), fill_page(page_template, "a", "{}"));
}

TEST(Page, ShowsATitleLiterally) {
    const std::string page = fill_page(page_template, "</title><script>alert(1)</script>&\"\n", "{}");
    EXPECT_NE(page.find("<title>&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot; </title>"),
              std::string::npos)
        << page;
}

TEST(Page, EscapesPlaceholdersInTheTitle) {
    const std::string page = fill_page(page_template, "<!--polhode:data-->", "{}");
    EXPECT_EQ(document_text(page), "{}");
    EXPECT_EQ(page.find("<!--"), std::string::npos);
}

TEST(Page, RefusesAFrontEndWithoutItsPlaces) {
    EXPECT_THROW(fill_page("<title><!--polhode:title--></title>", "a", "{}"), std::runtime_error);
    EXPECT_THROW(fill_page("<!--polhode:title--><!--polhode:data--><!--polhode:data-->", "a", "{}"),
                 std::runtime_error);
}

}  // namespace
}  // namespace polhode
