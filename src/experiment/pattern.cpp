#include "experiment/pattern.h"

#include <regex.h>

#include <stdexcept>

namespace polhode {

struct Pattern::Compiled {
    regex_t expression{};
    ~Compiled() { regfree(&expression); }
};

Pattern::Pattern(const std::string& expression) {
    if (expression.empty()) return;
    regex_t compiled{};
    if (const int fault = regcomp(&compiled, expression.c_str(), REG_EXTENDED | REG_NOSUB)) {
        char reason[128];
        regerror(fault, &compiled, reason, sizeof reason);
        throw std::invalid_argument(reason);
    }
    const auto owned = std::make_shared<Compiled>();
    owned->expression = compiled;
    compiled_ = owned;
}

bool Pattern::matches(const std::string& text) const {
    return !compiled_ || regexec(&compiled_->expression, text.c_str(), 0, nullptr, 0) == 0;
}

}  // namespace polhode
