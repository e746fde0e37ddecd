#include "experiment/plan/pattern.h"

#include <fmt/format.h>
#include <regex.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <vector>

#include "experiment/plan/plan_limits.h"

namespace polhode {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument(why); }

// Counts the characters of an expression with its repetitions expanded. regcomp() expands all repetitions but * and ?.
// These make their operand optional, and its time and memory grow quadratically with such operands. Each of *, ? and +
// is therefore counted as doubling what it repeats.
class ExpandedSize {
  public:
    void character() { add(1); }
    void open() {
        groups_.push_back(0);
        if (groups_.size() > static_cast<std::size_t>(deepest_parentheses) + 1)
            refuse(fmt::format("parentheses are nested more than {} deep", deepest_parentheses));
        last_ = 0;
    }
    void close() {
        // an unmatched parenthesis is an ordinary character
        if (groups_.size() == 1) return character();
        const long inner = groups_.back();
        groups_.pop_back();
        add(std::max(inner, 1L));
    }
    void repeat(long times) {
        // without an operand, the operator may be an ordinary character that later operators repeat
        const long before = std::max(last_, 1L);
        groups_.back() -= last_;
        add(std::min(before * std::max(times, 1L), 100'000L));
    }

  private:
    void add(long characters) {
        last_ = characters;
        groups_.back() += characters;
        if (groups_.back() > most_unrolled)
            refuse(fmt::format("it has more than {} characters with its repetitions expanded", most_unrolled));
    }

    std::vector<long> groups_{0};  // characters of the open groups, outermost first
    long last_ = 0;                // characters of the operand of a following repetition
};

// Index of the last character of the bracket expression that starts at `i`.
std::size_t find_bracket_end(const std::string& expression, std::size_t i) {
    ++i;
    if (i < expression.size() && expression[i] == '^') ++i;
    const std::size_t first = i;
    for (; i < expression.size() && (i == first || expression[i] != ']'); ++i) {
        if (expression[i] != '[' || i + 1 >= expression.size()) continue;
        if (expression[i + 1] == '.' || expression[i + 1] == '=') refuse("collating elements are not supported");
        if (expression[i + 1] == ':') i = std::min(expression.find(":]", i + 2), expression.size() - 2) + 1;
    }
    return std::min(i, expression.size() - 1);
}

// The largest number in the braces that start at `i`. Moves `i` to the closing brace, or to the last character before
// the end of the digits and commas if there is none.
long largest_count(const std::string& expression, std::size_t& i) {
    long largest = 1, count = 0;
    for (++i; i < expression.size(); ++i) {
        const bool is_digit = std::isdigit(static_cast<unsigned char>(expression[i])) != 0;
        if (!is_digit && expression[i] != ',') break;
        count = is_digit ? std::min(10 * count + (expression[i] - '0'), 100'000L) : 0;
        largest = std::max(largest, count);
    }
    if (i == expression.size() || expression[i] != '}') --i;
    return largest;
}

// Refuses expressions that regcomp() and regexec() do not handle safely: deep nesting overflows the stack, and back
// references take exponential time.
void require_safe(const std::string& expression) {
    if (expression.size() > longest_expression)
        refuse(fmt::format("it has more than {} characters", longest_expression));
    if (expression.find('\0') != std::string::npos) refuse("it contains a zero byte");
    ExpandedSize size;
    for (std::size_t i = 0; i < expression.size(); ++i) switch (expression[i]) {
            case '\\':
                ++i;
                if (i < expression.size() && std::isdigit(static_cast<unsigned char>(expression[i])) != 0)
                    refuse("back references are not supported");
                size.character();
                break;
            case '(':
                size.open();
                break;
            case ')':
                size.close();
                break;
            case '[':
                i = find_bracket_end(expression, i);
                size.character();
                break;
            case '{':
                size.repeat(largest_count(expression, i));
                break;
            case '*':
            case '?':
            case '+':
                size.repeat(2);
                break;
            default:
                size.character();
        }
}

}  // namespace

struct Pattern::Compiled {
    regex_t expression{};
    ~Compiled() { regfree(&expression); }
};

Pattern::Pattern(const std::string& expression) {
    if (expression.empty()) return;
    require_safe(expression);
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
