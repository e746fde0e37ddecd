// The page itself: its front-end, built beforehand, and a document put into it.
#pragma once

#include <string>
#include <string_view>

namespace polhode {

/// The file of the built front-end: build/report/page.html beside the program of a build tree, else
/// ../share/polhode/report/page.html from where the program is installed, unless $POLHODE_REPORT_PAGE names another.
/// Throws std::runtime_error, with what would bring it, where there is none.
std::string page_template_path();

/// The front-end with a title and a document in its places: the document compressed (gzip) and in base64. Throws
/// std::runtime_error where the template has no such places, or each more than once.
std::string filled_page(std::string_view page_template, std::string_view title, std::string_view document);

}  // namespace polhode
