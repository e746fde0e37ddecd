#include "formula/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <utility>

#include "formula/language.h"
#include "formula/table_nodes.h"
#include "text/message.h"

namespace polhode::formula {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

struct Token {
    enum class Kind { number, name, quoted, symbol, end } kind = Kind::end;
    std::string_view text;  ///< without quotes
    double value = 0;
    std::size_t begin = 0, end = 0;  ///< offsets in the formula
};

std::string quote(std::string_view text) { return "\"" + one_line(text, 60) + "\""; }

std::vector<Token> split_into_tokens(std::string_view text) {
    std::vector<Token> tokens;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
            ++i;
            continue;
        }
        Token token;
        token.begin = i;
        if (is_digit(c) || (c == '.' && i + 1 < text.size() && is_digit(text[i + 1]))) {
            token.kind = Token::Kind::number;
            const auto [end, fault] = std::from_chars(text.data() + i, text.data() + text.size(), token.value);
            if (fault != std::errc() || !std::isfinite(token.value))
                throw FormulaError(i + 1, "number is beyond the range of binary64", "give a number below 1.8e308");
            i = static_cast<std::size_t>(end - text.data());
            if (i < text.size() && is_letter(text[i]))
                throw FormulaError(i + 1, fmt::format("\"{}\" follows a number", text[i]), "write products with \"*\"");
        } else if (is_letter(c)) {
            token.kind = Token::Kind::name;
            while (i < text.size() && (is_letter(text[i]) || is_digit(text[i]))) ++i;
        } else if (c == '"') {
            const std::size_t close = text.find('"', i + 1);
            if (close == text.npos) throw FormulaError(i + 1, "quoted name does not end", "add the closing quote");
            token.kind = Token::Kind::quoted;
            i = close + 1;
        } else {
            token.kind = Token::Kind::symbol;
            i += (c == '<' || c == '>') && i + 1 < text.size() && text[i + 1] == '=' ? 2 : 1;
            if (std::string_view("+-*/^()[],.<>").find(c) == std::string_view::npos)
                throw FormulaError(token.begin + 1,
                                   fmt::format("{} is not part of the language", quote(text.substr(token.begin, 1))),
                                   c == '=' ? "compare with <, <=, > or >=" : "remove it");
        }
        token.end = i;
        token.text = text.substr(token.begin, i - token.begin);
        if (token.kind == Token::Kind::quoted) token.text = token.text.substr(1, token.text.size() - 2);
        tokens.push_back(token);
    }
    Token end;
    end.begin = end.end = text.size();
    tokens.push_back(end);
    return tokens;
}

/// A condition: a test of a switch, or a combination of conditions.
struct Condition {
    enum class Kind { test, both, either, opposite } kind = Kind::test;
    int which_switch = 0;
    Test test = Test::positive;
    std::shared_ptr<const Condition> first, second;
};

/// A value or a condition, with its place in the formula.
struct Term {
    Value value;
    std::shared_ptr<const Condition> condition;  ///< null for a value
    std::size_t begin = 0, end = 0;
};

class Parser {
  public:
    Parser(std::string_view text, const Scope& scope, Expression& expression)
        : text_(text), scope_(scope), e_(expression), tokens_(split_into_tokens(text)) {}

    Value parse() {
        if (tokens_.size() == 1) throw FormulaError(1, "the formula is empty", "give an expression");
        const Term term = disjunction();
        if (next().kind != Token::Kind::end)
            fail(next(), fmt::format("expected an operator, not {}", quote(next().text)),
                 next().text == ")" || next().text == "]" ? "remove it, or open a bracket before it"
                                                          : "write products with \"*\"");
        return value_of(term);
    }

  private:
    std::string_view text_;
    const Scope& scope_;
    Expression& e_;
    std::vector<Token> tokens_;
    std::size_t at_ = 0;
    int depth_ = 0;

    const Token& next() const { return tokens_[at_]; }
    Token take() { return tokens_[at_ + 1 < tokens_.size() ? at_++ : at_]; }
    bool is_symbol(std::string_view symbol) const {
        return next().kind == Token::Kind::symbol && next().text == symbol;
    }
    bool is_word(std::string_view word) const { return next().kind == Token::Kind::name && next().text == word; }
    bool take_symbol(std::string_view symbol) {
        if (!is_symbol(symbol)) return false;
        take();
        return true;
    }
    [[noreturn]] void fail(std::size_t offset, const std::string& fault, const std::string& remedy) const {
        throw FormulaError(offset + 1, fault, remedy);
    }
    [[noreturn]] void fail(const Token& token, const std::string& fault, const std::string& remedy) const {
        fail(token.begin, fault, remedy);
    }
    void require_symbol(const char* symbol, const char* remedy) {
        if (take_symbol(symbol)) return;
        fail(next(),
             next().kind == Token::Kind::end ? fmt::format("the formula ends where \"{}\" is expected", symbol)
                                             : fmt::format("expected \"{}\", not {}", symbol, quote(next().text)),
             remedy);
    }
    std::string text_of(std::size_t begin, std::size_t end) const {
        return one_line(text_.substr(begin, end - begin), 60);
    }

    // Nested brackets, signs and powers count towards the depth.
    class Nesting {
      public:
        explicit Nesting(Parser& parser) : parser_(parser) {
            if (++parser_.depth_ > most_formula_depth)
                parser_.fail(parser_.next(), fmt::format("the formula is nested deeper than {}", most_formula_depth),
                             "name parts of it in \"let\"");
        }
        Nesting(const Nesting&) = delete;
        Nesting& operator=(const Nesting&) = delete;
        ~Nesting() { --parser_.depth_; }

      private:
        Parser& parser_;
    };

    Value value_of(const Term& term) const {
        if (term.condition)
            fail(term.begin, fmt::format("the condition {} is not a number", quote(text_of(term.begin, term.end))),
                 "use it as if(condition, a, b)");
        return term.value;
    }
    Value typed(const Term& term, Type type, const std::string& where) const {
        const Value value = value_of(term);
        if (value.type != type)
            fail(term.begin,
                 fmt::format("{} is {}, but {} needs {}", quote(text_of(term.begin, term.end)), name_of(value.type),
                             where, name_of(type)),
                 type == Type::scalar && value.type == Type::vector ? "take a component such as .x, or norm(v)"
                 : type == Type::vector                             ? "give a vector such as [x, y, z]"
                 : type == Type::quaternion                         ? "give a quaternion [w, x, y, z]"
                                                                    : "give a scalar");
        return value;
    }
    int scalar(const Term& term, const std::string& where) const {
        return typed(term, Type::scalar, where).component[0];
    }
    Term scalar_term(int node, std::size_t begin) const { return {of(node), nullptr, begin, previous_end()}; }
    Term vector_term(int x, int y, int z, std::size_t begin) const {
        return {{Type::vector, {x, y, z, no_node}}, nullptr, begin, previous_end()};
    }
    static Value of(int node) { return {Type::scalar, {node, no_node, no_node, no_node}}; }
    std::size_t previous_end() const { return at_ == 0 ? 0 : tokens_[at_ - 1].end; }

    Term disjunction() {
        const Nesting nesting(*this);
        Term left = conjunction();
        while (is_word("or")) left = combine(left, Condition::Kind::either, &Parser::conjunction);
        return left;
    }
    Term conjunction() {
        Term left = negation();
        while (is_word("and")) left = combine(left, Condition::Kind::both, &Parser::negation);
        return left;
    }
    Term combine(const Term& left, Condition::Kind kind, Term (Parser::*operand)()) {
        const Token word = take();
        const Term right = (this->*operand)();
        for (const Term* side : {&left, &right})
            if (!side->condition)
                fail(side->begin,
                     fmt::format("{} is a number, but \"{}\" needs a condition", quote(text_of(side->begin, side->end)),
                                 word.text),
                     "compare it: x > 0");
        auto both = std::make_shared<Condition>();
        both->kind = kind, both->first = left.condition, both->second = right.condition;
        return {{}, both, left.begin, right.end};
    }
    Term negation() {
        if (!is_word("not")) return comparison();
        const Nesting nesting(*this);
        const Token word = take();
        const Term inner = negation();
        if (!inner.condition)
            fail(inner.begin,
                 fmt::format("{} is a number, but \"not\" needs a condition", quote(text_of(inner.begin, inner.end))),
                 "compare it: not x > 0");
        auto opposite = std::make_shared<Condition>();
        opposite->kind = Condition::Kind::opposite, opposite->first = inner.condition;
        return {{}, opposite, word.begin, inner.end};
    }
    Term comparison() {
        const Term left = sum();
        for (const auto& [symbol, test] : {std::pair{"<", Test::negative}, std::pair{"<=", Test::not_positive},
                                           std::pair{">", Test::positive}, std::pair{">=", Test::not_negative}}) {
            if (!is_symbol(symbol)) continue;
            take();
            const Term right = sum();
            auto condition = std::make_shared<Condition>();
            condition->test = test;
            condition->which_switch =
                e_.compare(scalar(left, "a comparison"), scalar(right, "a comparison"), text_of(left.begin, right.end));
            if (is_symbol("<") || is_symbol("<=") || is_symbol(">") || is_symbol(">="))
                fail(next(), "comparisons do not chain", "join two comparisons with \"and\"");
            return {{}, condition, left.begin, right.end};
        }
        return left;
    }
    Term sum() {
        Term left = product();
        while (is_symbol("+") || is_symbol("-")) {
            const Token sign = take();
            const Term right = product();
            const Value a = value_of(left), b = value_of(right);
            if (a.type != b.type || a.type == Type::quaternion)
                fail(sign, fmt::format("{} and {} cannot be added or subtracted", name_of(a.type), name_of(b.type)),
                     "give two scalars or two vectors");
            left = {componentwise(a, b, sign.text == "+" ? &Expression::add : &Expression::subtract), nullptr,
                    left.begin, right.end};
        }
        return left;
    }
    Value componentwise(const Value& a, const Value& b, int (Expression::*operation)(int, int)) {
        Value result{a.type, {}};
        for (std::size_t i = 0; i < 4; ++i)
            result.component[i] = a.component[i] == no_node ? no_node : (e_.*operation)(a.component[i], b.component[i]);
        return result;
    }
    Term product() {
        Term left = signed_factor();
        while (is_symbol("*") || is_symbol("/")) {
            const Token symbol = take();
            const Term right = signed_factor();
            left = {multiplied(symbol, value_of(left), value_of(right)), nullptr, left.begin, right.end};
        }
        return left;
    }
    Value multiplied(const Token& symbol, const Value& a, const Value& b) {
        const bool divides = symbol.text == "/";
        if (a.type == Type::quaternion || b.type == Type::quaternion)
            fail(symbol, fmt::format("{} and {} cannot be multiplied or divided", name_of(a.type), name_of(b.type)),
                 "use q only as an argument of a function");
        if (b.type == Type::scalar) {
            Value result{a.type, a.component};
            for (int& component : result.component)
                if (component != no_node)
                    component = divides ? e_.divide(component, b.component[0]) : e_.multiply(component, b.component[0]);
            return result;
        }
        if (divides) fail(symbol, "division by a vector", "divide by a scalar, for example norm(v)");
        if (a.type == Type::vector)
            fail(symbol, "a vector and a vector cannot be multiplied", "use dot(a, b) or cross(a, b)");
        Value result{b.type, b.component};
        for (int& component : result.component)
            if (component != no_node) component = e_.multiply(a.component[0], component);
        return result;
    }
    Term signed_factor() {
        if (!is_symbol("-") && !is_symbol("+")) return power();
        const Nesting nesting(*this);
        const Token sign = take();
        Term inner = signed_factor();
        Value value = value_of(inner);
        if (value.type == Type::quaternion) fail(sign, "a quaternion has no sign", "use q only as an argument");
        if (sign.text == "-")
            for (int& component : value.component)
                if (component != no_node) component = e_.negate(component);
        return {value, nullptr, sign.begin, inner.end};
    }
    Term power() {
        const Term base = postfix();
        if (!is_symbol("^")) return base;
        const Nesting nesting(*this);
        take();
        const Term exponent = is_symbol("-") || is_symbol("+") ? signed_factor() : power();
        const int a = scalar(base, "the base of \"^\""), b = scalar(exponent, "the exponent of \"^\"");
        return {of(e_.power(a, b)), nullptr, base.begin, exponent.end};
    }
    Term postfix() {
        Term term = primary();
        while (is_symbol(".")) {
            take();
            const Token member = take();
            constexpr std::string_view axes = "xyz";
            const std::size_t axis = member.text.size() == 1 ? axes.find(member.text) : axes.npos;
            if (member.kind != Token::Kind::name || axis == axes.npos)
                fail(member, fmt::format("{} is not a component", quote(member.text)), "use .x, .y or .z");
            const Value v = typed(term, Type::vector, "a component");
            term = {of(v.component[axis]), nullptr, term.begin, member.end};
        }
        if (is_symbol("[")) fail(next(), "components are not numbered", "use .x, .y or .z");
        return term;
    }
    Term primary() {
        const Token token = take();
        switch (token.kind) {
            case Token::Kind::number:
                return scalar_term(e_.number(token.value), token.begin);
            case Token::Kind::name:
                if (is_symbol("(")) return call(token);
                return named(token);
            case Token::Kind::quoted:
                return named(token);
            case Token::Kind::symbol:
                if (token.text == "(") {
                    Term inner = disjunction();
                    require_symbol(")", "close the bracket");
                    inner.begin = token.begin, inner.end = previous_end();
                    return inner;
                }
                if (token.text == "[") return list(token);
                fail(token, fmt::format("expected a value, not {}", quote(token.text)),
                     "give a number, a name or \"(\"");
            case Token::Kind::end:
                break;
        }
        fail(token, "the formula ends where a value is expected", "complete the formula");
    }
    Term list(const Token& open) {
        std::vector<int> parts;
        do parts.push_back(scalar(disjunction(), "a list"));
        while (take_symbol(","));
        require_symbol("]", "close the list");
        if (parts.size() != 3 && parts.size() != 4)
            fail(open, fmt::format("the list has {} elements", parts.size()),
                 "give a vector [x, y, z] or a quaternion [w, x, y, z]");
        Value value{parts.size() == 3 ? Type::vector : Type::quaternion, {}};
        value.component.fill(no_node);
        std::copy(parts.begin(), parts.end(), value.component.begin());
        return {value, nullptr, open.begin, previous_end()};
    }
    // A name, or a name and a member that the scope defines together ("arm.angle").
    Term named(const Token& token) {
        if (is_symbol(".") && at_ + 1 < tokens_.size() && tokens_[at_ + 1].kind == Token::Kind::name) {
            const std::string both = fmt::format("{}.{}", token.text, tokens_[at_ + 1].text);
            if (const auto found = scope_.names.find(both); found != scope_.names.end()) {
                take(), take();
                return {found->second, nullptr, token.begin, previous_end()};
            }
        }
        if (is_symbol(".") && at_ + 1 < tokens_.size()) fail_unknown_member(token);
        if (token.text == "pi") return scalar_term(e_.pi(), token.begin);
        if (const auto found = scope_.names.find(token.text); found != scope_.names.end())
            return {found->second, nullptr, token.begin, token.end};
        fail_unknown(token);
    }
    // Fails if the scope knows members of the name, but not this one.
    void fail_unknown_member(const Token& token) const {
        const std::string prefix = fmt::format("{}.", token.text);
        std::vector<std::string> members;
        for (auto name = scope_.names.lower_bound(prefix); name != scope_.names.end(); ++name) {
            if (!name->first.starts_with(prefix)) break;
            members.push_back(name->first.substr(prefix.size()));
        }
        if (members.empty() || scope_.names.contains(token.text)) return;
        fail(tokens_[at_ + 1], fmt::format("{} has no quantity {}", quote(token.text), quote(tokens_[at_ + 1].text)),
             "give one of " + join_with_commas(members));
    }
    [[noreturn]] void fail_unknown(const Token& token) const {
        for (const FunctionEntry& function : formula_functions())
            if (function.name == token.text)
                fail(token, fmt::format("the function \"{}\" has no arguments", token.text),
                     fmt::format("write {}({})", function.name, function.arguments));
        std::vector<std::string> candidates{"pi"};
        for (const auto& [name, value] : scope_.names) candidates.push_back(name);
        const std::string meant = did_you_mean(token.text, candidates);
        fail(token, fmt::format("unknown name {}", quote(token.text)),
             meant.empty() ? "known names: " + one_line(join_with_commas(candidates), 300) : meant);
    }

    // ---- functions ----

    struct Call {
        Token name;
        std::vector<Term> arguments;
        std::string in;  ///< "norm(v)", for messages
    };
    Term call(const Token& name) {
        const auto functions = formula_functions();
        const auto entry = std::ranges::find(functions, name.text, &FunctionEntry::name);
        if (entry == functions.end()) fail_unknown_function(name);
        take();
        Call call{name, {}, fmt::format("{}({})", entry->name, entry->arguments)};
        std::string first;  // a name as the first argument
        if (name.text == "table") first = table_name(call);
        if (name.text == "at" || name.text == "velocity_at") first = body_name(call);
        if (!is_symbol(")")) do
                call.arguments.push_back(disjunction());
            while (take_symbol(","));
        require_symbol(")", "close the bracket");
        const std::size_t expected =
            static_cast<std::size_t>(std::ranges::count(entry->arguments, ',')) + (first.empty() ? 1 : 0);
        if (call.arguments.size() != expected)
            fail(name,
                 fmt::format("\"{}\" has {} argument{}", name.text, call.arguments.size() + (first.empty() ? 0 : 1),
                             call.arguments.size() + (first.empty() ? 0 : 1) == 1 ? "" : "s"),
                 "write " + call.in);
        if (name.text == "table") {
            const int x = scalar(call.arguments[0], call.in);
            return scalar_term(
                table_nodes(e_, scope_.tables.find(first)->second, x, text_of(name.begin, previous_end())), name.begin);
        }
        if (!first.empty()) {
            const Value point = typed(call.arguments[0], Type::vector, call.in);
            return {point_function(call, scope_.bodies.find(first)->second, point), nullptr, name.begin,
                    previous_end()};
        }
        Term result = apply(call);
        result.begin = name.begin, result.end = previous_end();
        return result;
    }
    [[noreturn]] void fail_unknown_function(const Token& name) const {
        if (scope_.names.contains(name.text))
            fail(name, fmt::format("{} is a value, not a function", quote(name.text)), "write products with \"*\"");
        std::vector<std::string> candidates;
        for (const FunctionEntry& function : formula_functions()) candidates.emplace_back(function.name);
        const std::string meant = did_you_mean(name.text, candidates);
        fail(name, fmt::format("unknown function {}", quote(name.text)),
             meant.empty() ? "functions: " + join_with_commas(candidates) : meant);
    }
    std::string table_name(const Call& call) {
        const Token token = take();
        if (token.kind != Token::Kind::name && token.kind != Token::Kind::quoted)
            fail(token, "table needs the name of a table", "write " + call.in);
        if (scope_.tables.find(token.text) == scope_.tables.end()) {
            std::vector<std::string> candidates;
            for (const auto& [name, table] : scope_.tables) candidates.push_back(name);
            const std::string meant = did_you_mean(token.text, candidates);
            fail(token, fmt::format("unknown table {}", quote(token.text)),
                 !meant.empty()       ? meant
                 : candidates.empty() ? "define it in \"tables\""
                                      : "tables: " + one_line(join_with_commas(candidates), 300));
        }
        require_symbol(",", "write table(name, x)");
        return std::string(token.text);
    }
    std::string body_name(const Call& call) {
        const Token token = take();
        if (token.kind != Token::Kind::name && token.kind != Token::Kind::quoted)
            fail(token, fmt::format("{} needs the name of a body", call.name.text), "write " + call.in);
        if (scope_.bodies.empty())
            fail(call.name, fmt::format("{} is available in scenes of several bodies only", quote(call.name.text)),
                 "use p, v and to_world");
        if (scope_.bodies.find(token.text) == scope_.bodies.end()) {
            std::vector<std::string> candidates;
            for (const auto& [name, body] : scope_.bodies) candidates.push_back(name);
            const std::string meant = did_you_mean(token.text, candidates);
            fail(token, fmt::format("unknown body {}", quote(token.text)),
                 !meant.empty() ? meant : "give the name of a body");
        }
        require_symbol(",", ("write " + call.in).c_str());
        return std::string(token.text);
    }
    // The position p + R (x - c), or the velocity v + R (w x (x - c)), of the point x of a body with centre of mass c.
    Value point_function(const Call& call, const BodyScope& body, const Value& point) {
        const bool is_position = call.name.text == "at";
        const Value arm = componentwise(point, body.center, &Expression::subtract);
        const Value& start = is_position ? body.position : body.velocity;
        const Value in_body = is_position ? arm : cross_product(e_, body.angular_velocity, arm);
        return componentwise(start, multiply_matrix(e_, body.axes, in_body, false), &Expression::add);
    }
    Term apply(const Call& call) {
        const std::string_view name = call.name.text;
        if (name == "if") return conditional(call);
        constexpr std::pair<std::string_view, Operation> direct[] = {
            {"sqrt", Operation::square_root},
            {"cbrt", Operation::cube_root},
            {"exp", Operation::exponential},
            {"log", Operation::logarithm},
            {"sin", Operation::sine},
            {"cos", Operation::cosine},
            {"asin", Operation::arcsine},
            {"acos", Operation::arccosine},
            {"sinh", Operation::hyperbolic_sine},
            {"tanh", Operation::hyperbolic_tangent},
        };
        for (const auto& [known, operation] : direct)
            if (name == known) return {of(e_.apply(operation, scalar(call.arguments[0], call.in))), nullptr, 0, 0};
        if (name == "hold") return held(call);
        if (name == "dot" || name == "cross" || name == "norm" || name == "unit") return vector_function(call);
        if (name.starts_with("to_") || name == "inertia" || name.starts_with("rotation_")) return body_function(call);
        std::vector<int> x;
        for (const Term& argument : call.arguments) x.push_back(scalar(argument, call.in));
        return {of(scalar_function(name, x, text_of(call.name.begin, previous_end()))), nullptr, 0, 0};
    }
    int scalar_function(std::string_view name, const std::vector<int>& x, const std::string& text) {
        const int zero = e_.number(0), one = e_.number(1);
        if (name == "tan") return e_.divide(e_.apply(Operation::sine, x[0]), e_.apply(Operation::cosine, x[0]));
        if (name == "atan") return e_.arctangent(x[0], one);
        if (name == "atan2") return e_.arctangent(x[0], x[1]);
        if (name == "cosh") {
            const int s = e_.apply(Operation::hyperbolic_sine, x[0]);
            return e_.square_root(e_.add(one, e_.multiply(s, s)));
        }
        if (name == "hypot") return e_.square_root(e_.add(e_.multiply(x[0], x[0]), e_.multiply(x[1], x[1])));
        if (name == "abs") return e_.choose(e_.compare(x[0], zero, text), Test::not_negative, x[0], e_.negate(x[0]));
        if (name == "sign") {
            const int which = e_.compare(x[0], zero, text);
            return e_.choose(which, Test::positive, one, e_.choose(which, Test::negative, e_.number(-1), zero));
        }
        if (name == "min") return e_.choose(e_.compare(x[0], x[1], text), Test::not_positive, x[0], x[1]);
        if (name == "max") return e_.choose(e_.compare(x[0], x[1], text), Test::not_negative, x[0], x[1]);
        if (name == "clamp") {
            const int above = e_.choose(e_.compare(x[0], x[2], text), Test::positive, x[2], x[0]);
            return e_.choose(e_.compare(x[0], x[1], text), Test::negative, x[1], above);
        }
        return e_.choose(e_.compare(x[0], zero, text), Test::not_negative, one, zero);  // step
    }
    int chosen(const Condition& condition, int if_true, int otherwise) {
        switch (condition.kind) {
            case Condition::Kind::test:
                return e_.choose(condition.which_switch, condition.test, if_true, otherwise);
            case Condition::Kind::both:
                return chosen(*condition.first, chosen(*condition.second, if_true, otherwise), otherwise);
            case Condition::Kind::either:
                return chosen(*condition.first, if_true, chosen(*condition.second, if_true, otherwise));
            case Condition::Kind::opposite:
                break;
        }
        return chosen(*condition.first, otherwise, if_true);
    }
    Term conditional(const Call& call) {
        const Term& condition = call.arguments[0];
        if (!condition.condition)
            fail(condition.begin,
                 fmt::format("{} is a number, but \"if\" needs a condition",
                             quote(text_of(condition.begin, condition.end))),
                 "compare it: if(x > 0, a, b)");
        const Value a = value_of(call.arguments[1]), b = value_of(call.arguments[2]);
        if (a.type != b.type)
            fail(call.name, fmt::format("\"if\" chooses between {} and {}", name_of(a.type), name_of(b.type)),
                 "give two values of the same type");
        Value result{a.type, {}};
        for (std::size_t i = 0; i < 4; ++i)
            result.component[i] =
                a.component[i] == no_node ? no_node : chosen(*condition.condition, a.component[i], b.component[i]);
        return {result, nullptr, 0, 0};
    }
    Term held(const Call& call) {
        if (!e_.allows_holds()) fail(call.name, "\"hold\" is not available here", "use it in a load");
        Value value = value_of(call.arguments[0]);
        if (value.type == Type::quaternion)
            fail(call.arguments[0].begin, "a quaternion cannot be held", "give a scalar or a vector");
        const int period = scalar(call.arguments[1], call.in);
        if (!e_.is_uniform(period))
            fail(call.arguments[1].begin, "the period depends on time or state", "give a number or a parameter");
        for (int& component : value.component)
            if (component != no_node) component = e_.hold(component, period);
        return {value, nullptr, 0, 0};
    }
    int dot(const Value& a, const Value& b) {
        int sum = e_.number(0);
        for (std::size_t i = 0; i < 3; ++i) sum = e_.add(sum, e_.multiply(a.component[i], b.component[i]));
        return sum;
    }
    Term vector_function(const Call& call) {
        std::vector<Value> v;
        for (const Term& argument : call.arguments) v.push_back(typed(argument, Type::vector, call.in));
        if (call.name.text == "dot") return {of(dot(v[0], v[1])), nullptr, 0, 0};
        if (call.name.text == "cross") return {cross_product(e_, v[0], v[1]), nullptr, 0, 0};
        const int length = e_.square_root(dot(v[0], v[0]));
        if (call.name.text == "norm") return {of(length), nullptr, 0, 0};
        Value unit = v[0];
        for (std::size_t i = 0; i < 3; ++i) unit.component[i] = e_.divide(unit.component[i], length);
        return {unit, nullptr, 0, 0};
    }
    Term body_function(const Call& call) {
        const std::string_view name = call.name.text;
        if (name == "inertia" ? scope_.inertia.empty() : scope_.attitude.empty())
            fail(call.name, fmt::format("\"{}\" is not available here", name), "use it in a load on a body");
        if (name.starts_with("rotation_")) return rotation_function(call);
        const Value v = typed(call.arguments[0], Type::vector, call.in);
        if (name == "inertia") {
            std::array<int, 9> tensor{};
            std::copy(scope_.inertia.begin(), scope_.inertia.end(), tensor.begin());
            return {multiply_matrix(e_, tensor, v, false), nullptr, 0, 0};
        }
        return {multiply_matrix(e_, rotation_matrix_nodes(e_, scope_.attitude), v, name == "to_body"), nullptr, 0, 0};
    }
    // r = q0* q, with q0 normalised
    Term rotation_function(const Call& call) {
        const Value q0 = typed(call.arguments[0], Type::quaternion, call.in);
        int squares = e_.number(0);
        for (const int component : q0.component) squares = e_.add(squares, e_.multiply(component, component));
        const int length = e_.square_root(squares);
        std::array<int, 4> a{};
        for (std::size_t i = 0; i < 4; ++i) a[i] = e_.divide(q0.component[i], length);
        const std::vector<int>& q = scope_.attitude;
        // rows of the matrix of q -> q0* q
        const std::array<std::array<int, 4>, 4> rows{{{a[0], a[1], a[2], a[3]},
                                                      {e_.negate(a[1]), a[0], a[3], e_.negate(a[2])},
                                                      {e_.negate(a[2]), e_.negate(a[3]), a[0], a[1]},
                                                      {e_.negate(a[3]), a[2], e_.negate(a[1]), a[0]}}};
        std::array<int, 4> r{};
        for (std::size_t i = 0; i < 4; ++i) {
            r[i] = e_.number(0);
            for (std::size_t j = 0; j < 4; ++j) r[i] = e_.add(r[i], e_.multiply(rows[i][j], q[j]));
        }
        const int which = e_.compare(r[0], e_.number(0), text_of(call.name.begin, previous_end()));
        const auto with_sign = [&](int node) { return e_.choose(which, Test::not_negative, node, e_.negate(node)); };
        Value result{Type::vector, {}};
        result.component.fill(no_node);
        int factor = e_.number(2);
        if (call.name.text == "rotation_vector") {
            const Value axis{Type::vector, {r[1], r[2], r[3], no_node}};
            const int sine = e_.square_root(dot(axis, axis));
            factor = e_.divide(e_.multiply(e_.number(2), e_.arctangent(sine, with_sign(r[0]))), sine);
        }
        for (std::size_t i = 0; i < 3; ++i) result.component[i] = e_.multiply(factor, with_sign(r[i + 1]));
        return {result, nullptr, 0, 0};
    }
};

}  // namespace

const char* name_of(Type type) {
    constexpr const char* names[] = {"a scalar", "a vector", "a quaternion"};
    return names[static_cast<std::size_t>(type)];
}

std::array<int, 9> rotation_matrix_nodes(Expression& e, const std::vector<int>& q) {
    const auto product = [&](std::size_t i, std::size_t j) { return e.multiply(q[i], q[j]); };
    const auto twice = [&](int node) { return e.add(node, node); };
    const int ww = product(0, 0), xx = product(1, 1), yy = product(2, 2), zz = product(3, 3);
    const int xy = product(1, 2), xz = product(1, 3), yz = product(2, 3);
    const int wx = product(0, 1), wy = product(0, 2), wz = product(0, 3);
    return {e.subtract(e.subtract(e.add(ww, xx), yy), zz),
            twice(e.subtract(xy, wz)),
            twice(e.add(xz, wy)),
            twice(e.add(xy, wz)),
            e.subtract(e.add(e.subtract(ww, xx), yy), zz),
            twice(e.subtract(yz, wx)),
            twice(e.subtract(xz, wy)),
            twice(e.add(yz, wx)),
            e.add(e.subtract(e.subtract(ww, xx), yy), zz)};
}

Value multiply_matrix(Expression& e, const std::array<int, 9>& matrix, const Value& v, bool transposed) {
    Value result{Type::vector, {}};
    result.component.fill(no_node);
    for (std::size_t i = 0; i < 3; ++i) {
        int sum = e.number(0);
        for (std::size_t j = 0; j < 3; ++j)
            sum = e.add(sum, e.multiply(matrix[transposed ? 3 * j + i : 3 * i + j], v.component[j]));
        result.component[i] = sum;
    }
    return result;
}

Value cross_product(Expression& e, const Value& a, const Value& b) {
    Value result{Type::vector, {}};
    result.component.fill(no_node);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        result.component[i] =
            e.subtract(e.multiply(a.component[j], b.component[k]), e.multiply(a.component[k], b.component[j]));
    }
    return result;
}

Value parse_formula(std::string_view text, const Scope& scope, Expression& expression) {
    if (text.size() > most_formula_characters)
        throw FormulaError(most_formula_characters + 1,
                           fmt::format("the formula has more than {} characters", most_formula_characters),
                           "name parts of it in \"let\"");
    try {
        return Parser(text, scope, expression).parse();
    } catch (const LimitError& error) {
        throw FormulaError(1, error.what(), "simplify the formulas, or use tables with fewer points");
    }
}

bool is_identifier(std::string_view text) {
    return !text.empty() && is_letter(text[0]) &&
           std::ranges::all_of(text, [](char c) { return is_letter(c) || is_digit(c); });
}

bool is_reserved(std::string_view name) {
    for (const FunctionEntry& function : formula_functions())
        if (function.name == name) return true;
    for (const QuantityEntry& quantity : formula_quantities())
        if (quantity.name == name) return true;
    return name == "and" || name == "or" || name == "not" || name == "at" || name == "velocity_at" || name == "world";
}

}  // namespace polhode::formula
