// The HTML page: a front-end built in advance, with a document inserted.
#pragma once

#include <string>
#include <string_view>

namespace polhode {

/// Path of the built front-end: $POLHODE_REPORT_PAGE if set, else report/page.html beside the program, else
/// ../share/polhode/report/page.html relative to the program's directory. Throws std::runtime_error with the remedy if
/// it does not exist.
std::string page_template_path();

/// Inserts a title and a document, as gzip in base64, into the front-end. Throws std::runtime_error if the template
/// does not contain each placeholder exactly once.
std::string fill_page(std::string_view page_template, std::string_view title, std::string_view document);

}  // namespace polhode
