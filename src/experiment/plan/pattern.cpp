#include "experiment/plan/pattern.h"

#include <fmt/format.h>
#include <regex.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "experiment/plan/plan_limits.h"

namespace polhode {
namespace {

// The system's regcomp overflows the stack on deep nesting and unrolls every repetition but * and ?; back references
// take exponential time.
void require_harmless(const std::string& expression) {
    const auto refuse = [](const std::string& why) { throw std::invalid_argument(why); };
    if (expression.size() > longest_expression)
        refuse(fmt::format("it has more than {} characters", longest_expression));
    if (expression.find('\0') != std::string::npos) refuse("it holds a zero byte");
    long depth = 0, unrolled = 1;
    const auto repeat = [&](long times) {
        unrolled = std::min(unrolled * times, 100'000L);
        if (unrolled > most_unrolled) refuse(fmt::format("its repetitions multiply to more than {}", most_unrolled));
    };
    for (std::size_t i = 0; i < expression.size(); ++i) {
        const auto digit = [&](std::size_t at) {
            return at < expression.size() && std::isdigit(static_cast<unsigned char>(expression[at])) != 0;
        };
        if (expression[i] == '\\') {
            if (digit(i + 1)) refuse("back references are not available");
            ++i;
        } else if (expression[i] == '(') {
            if (++depth > deepest_parentheses)
                refuse(fmt::format("its parentheses are nested deeper than {}", deepest_parentheses));
        } else if (expression[i] == ')') {
            --depth;
        } else if (expression[i] == '{') {
            long largest = 1;
            for (++i; digit(i) || (i < expression.size() && expression[i] == ',');) {
                long count = 0;
                for (; digit(i); ++i) count = std::min(10 * count + (expression[i] - '0'), 100'000L);
                largest = std::max(largest, count);
                if (i < expression.size() && expression[i] == ',') ++i;
            }
            repeat(largest);
            --i;
        } else if (expression[i] == '+') {
            repeat(2);  // a+ becomes aa*
        }
    }
}

}  // namespace

struct Pattern::Compiled {
    regex_t expression{};
    ~Compiled() { regfree(&expression); }
};

Pattern::Pattern(const std::string& expression) {
    if (expression.empty()) return;
    require_harmless(expression);
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
