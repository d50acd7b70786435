// SPDX-License-Identifier: GPL-3.0-or-later
/// Recursive descent parser of JSON (RFC 8259). The errors name the place, the text that was found there and
/// what is expected.
#include "io/files.hpp"
#include "io/formats/characters.hpp"
#include "io/json_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>

namespace hilda::io {

namespace {

// 2^53 - 1. The value 2^53 may result from rounding 2^53 + 1.
constexpr double largest_exact_integer = 9007199254740991;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_word(char c)
{
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '+' || c == '-';
}

/// Whether a character of a string stands for itself
bool is_plain(char c) { return c >= ' ' && c != '"' && c != '\\' && static_cast<unsigned char>(c) < 0x80; }

std::string utf8(unsigned code)
{
    const auto last = [code](int shift) { return static_cast<char>(0x80 | ((code >> shift) & 0x3F)); };
    if (code < 0x80) return {static_cast<char>(code)};
    if (code < 0x800) return {static_cast<char>(0xC0 | (code >> 6)), last(0)};
    if (code < 0x10000) return {static_cast<char>(0xE0 | (code >> 12)), last(6), last(0)};
    return {static_cast<char>(0xF0 | (code >> 18)), last(12), last(6), last(0)};
}

class JsonParser {
public:
    JsonParser(std::string_view text, const JsonSource& source, std::size_t longest_string)
        : text(text), source(source), longest_string(longest_string),
          at(text.size() - without_byte_order_mark(text).size())
    {}

    Json document()
    {
        skip_blanks();
        if (at == text.size()) fail(0, "the text is empty; a JSON object is expected");
        Json root = value();
        skip_blanks();
        if (at < text.size()) unexpected("the end of the text");
        return root;
    }

private:
    // characters

    char peek() const { return at < text.size() ? text[at] : '\0'; }
    bool take(char c)
    {
        if (peek() != c) return false;
        ++at;
        return true;
    }
    void skip_blanks()
    {
        while (at < text.size() && is_blank(text[at])) ++at;
    }

    // values

    Json value()
    {
        const auto start = static_cast<std::uint32_t>(at);
        if (++values > JsonSource::max_values)
            fail(start, "the text has more than " + std::to_string(JsonSource::max_values) + " values");
        const char c = peek();
        Json v = c == '{'                  ? object()
                 : c == '['                ? list()
                 : c == '"'                ? Json(string())
                 : is_digit(c) || c == '-' ? Json(number())
                                           : literal();
        v.offset = start;
        return v;
    }

    Json literal()
    {
        const std::string_view word = bare_word(at);
        if (word != "true" && word != "false" && word != "null") unexpected("a value");
        at += word.size();
        return word == "null" ? Json() : Json(word == "true");
    }

    double number()
    {
        const std::size_t start = at;
        const auto digits = [&](const char* after) {
            if (!is_digit(peek()))
                fail(start, std::string("not JSON: invalid number; expected digit after '") + after +
                                "', got " + found(start) + finite_hint(start));
            while (is_digit(peek())) ++at;
        };
        take('-');
        if (!take('0')) digits("-");
        bool integer = true;
        if (take('.')) integer = false, digits(".");
        if (take('e') || take('E')) {
            integer = false;
            if (!take('+')) take('-');
            digits("e");
        }
        double x = 0;
        if (std::from_chars(text.data() + start, text.data() + at, x).ec != std::errc())
            fail(start, "the number is outside the range of double precision, got " + found(start));
        if (integer && std::abs(x) > largest_exact_integer)
            fail(start, "the integer is too large to be exact, got " + found(start) +
                            "; at most 2^53 - 1 is allowed, or write it with an exponent");
        return x;
    }

    std::string string()
    {
        const std::size_t start = at++;
        std::string s;
        while (!take('"')) {
            if (at == text.size())
                fail(start, "not JSON: invalid string: missing closing quote, got " +
                                in_quotes(text.substr(start + 1)));
            const char c = text[at];
            if (c == '\n' || c == '\r')
                fail(start, "not JSON: a string must be closed on its line, got " +
                                in_quotes(text.substr(start + 1, at - start - 1)));
            if (c == '\\') {
                ++at;
                s += escape();
                continue;
            }
            if (static_cast<unsigned char>(c) < ' ') invalid("a control character must be escaped");
            std::size_t n = 0;
            while (at + n < text.size() && is_plain(text[at + n])) ++n;
            if (n == 0 && (n = utf8_length(text.substr(at))) == 0) invalid("ill-formed UTF-8");
            s += text.substr(at, n);
            at += n;
        }
        if (s.size() > longest_string)
            fail(start, "a string of " + std::to_string(s.size()) + " bytes, got " + in_quotes(s) +
                            "; at most " + std::to_string(longest_string) + " are allowed");
        return s;
    }

    /// The character that an escape sequence stands for, without its backslash
    std::string escape()
    {
        static constexpr std::string_view names = "\"\\/bfnrt", codes = "\"\\/\b\f\n\r\t";
        if (at < text.size())
            if (const std::size_t k = names.find(text[at]); k != std::string_view::npos)
                return ++at, std::string(1, codes[k]);
        if (!take('u')) invalid("forbidden character after backslash");
        constexpr unsigned high = 0xD800, low = 0xDC00, end = 0xE000;  // surrogates
        const unsigned code = hex();
        if (code < high || code >= end) return utf8(code);
        const auto lone = [&] { invalid("surrogate U+D800..U+DBFF must be followed by U+DC00..U+DFFF"); };
        if (code >= low || !take('\\') || !take('u')) lone();
        const unsigned second = hex();
        if (second < low || second >= end) lone();
        return utf8(0x10000 + ((code - high) << 10) + (second - low));
    }

    unsigned hex()
    {
        unsigned code = 0;
        for (int k = 0; k < 4; ++k, ++at) {
            if (std::isxdigit(static_cast<unsigned char>(peek())) == 0)
                invalid("'\\u' must be followed by 4 hex digits");
            code =
                16 * code + static_cast<unsigned>(is_digit(peek()) ? peek() - '0' : (peek() | 32) - 'a' + 10);
        }
        return code;
    }

    Json list()
    {
        Json::List all;
        all.reserve(expected_size[path.size()]);
        open({&all, nullptr});
        if (!take(']')) {
            do {
                skip_blanks();
                all.push_back(value());
                skip_blanks();
            } while (take(','));
            if (!take(']')) unexpected("']' or ','");
        }
        close(all.size());
        return Json(std::move(all));
    }

    Json object()
    {
        Json::Object all;
        all.reserve(expected_size[path.size()]);
        open({nullptr, &all});
        if (!take('}')) {
            do {
                skip_blanks();
                if (peek() != '"') unexpected("a key in double quotes");
                const auto start = static_cast<std::uint32_t>(at);
                all.push_back({string(), start, {}});
                skip_blanks();
                if (!take(':')) unexpected("':'");
                skip_blanks();
                all.back().value = value();
                skip_blanks();
            } while (take(','));
            if (!take('}')) unexpected("'}' or ','");
        }
        close(all.size());
        check_duplicates(all);
        return Json(std::move(all));
    }

    void check_duplicates(const Json::Object& object) const
    {
        constexpr std::size_t few = 16;
        if (object.size() <= few) {  // most objects: without the memory of a sorted list
            bool twice = false;
            for (std::size_t a = 0; a < object.size(); ++a)
                for (std::size_t b = 0; b < a; ++b) twice = twice || object[a].key == object[b].key;
            if (!twice) return;
        }
        std::vector<std::size_t> order(object.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return object[a].key < object[b].key; });
        for (std::size_t k = 1; k < order.size(); ++k) {
            const Json::Member &first = object[order[k - 1]], &second = object[order[k]];
            if (first.key == second.key) {
                const std::string at = pointer_to(pointer(), second.key);
                throw PlacedError(source.place(second.offset, at), at,
                                  "the key " + in_quotes(second.key) + " is given twice; first at " +
                                      source.place(first.offset, ""));
            }
        }
    }

    // locations

    /// A container that is being read: one of the two
    struct Open {
        const Json::List* list;
        const Json::Object* object;
    };

    void open(Open container)
    {
        if (path.size() == JsonSource::max_depth)
            fail(at, "nested deeper than " + std::to_string(JsonSource::max_depth) + " levels");
        path.push_back(container);
        ++at;
        skip_blanks();
    }
    void close(std::size_t size)
    {
        path.pop_back();
        expected_size[path.size()] = static_cast<std::uint8_t>(std::min(size, largest_expected));
    }

    /// JSON pointer of the value that is being read. It is not yet an element of its list.
    std::string pointer() const
    {
        std::string p;
        for (const Open& in : path)
            if (in.list != nullptr)
                p = pointer_to(p, std::to_string(in.list->size()));
            else if (!in.object->empty())
                p = pointer_to(p, in.object->back().key);
        return p;
    }

    [[noreturn]] void fail(std::size_t where, const std::string& what) const
    {
        throw PlacedError(source.place(where, pointer()), pointer(), what);
    }

    // syntax errors

    std::string_view bare_word(std::size_t from) const
    {
        std::size_t end = from;
        while (end < text.size() && is_word(text[end])) ++end;
        return text.substr(from, end - from);
    }

    /// The string, word or character at a position, for messages
    std::string found(std::size_t where) const
    {
        constexpr std::size_t max_length = 30;
        if (where >= text.size()) return "the end of the text";
        if (text[where] == '"')
            if (const std::size_t quote = text.find('"', where + 1); quote < where + max_length)
                return in_quotes(text.substr(where + 1, quote - where - 1));
        if (const std::string_view word = bare_word(where); !word.empty())
            return "'" + std::string(word.substr(0, max_length)) + (word.size() > max_length ? "..." : "") +
                   "'";
        const auto code = static_cast<unsigned char>(text[where]);
        if (code > ' ' && code < 127) return std::string("'") + text[where] + "'";
        return "byte " + std::to_string(code);
    }

    /// "; numbers must be finite" for nan, inf, -Infinity, ...
    const char* finite_hint(std::size_t where) const
    {
        std::string word(bare_word(where).substr(0, 4));
        for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        const std::string name = word.substr(word.find_first_not_of("+-") == 1 ? 1 : 0, 3);
        return name == "nan" || name == "inf" ? "; numbers must be finite" : "";
    }

    [[noreturn]] void invalid(const std::string& rule) const
    {
        fail(at, "not JSON: invalid string: " + rule + ", got " + found(at));
    }

    /// Reports the token at the current position.
    [[noreturn]] void unexpected(const std::string& expected) const
    {
        if (at == text.size()) fail(at, "not JSON: unexpected end of the text; expected " + expected);
        const std::string got = found(at);
        const char c = text[at];
        std::size_t before = at;
        while (before > 0 && is_blank(text[before - 1])) --before;
        if ((c == '}' || c == ']') && before > 0 && text[before - 1] == ',')
            fail(before - 1, "not JSON: a comma without a following value, before " + got);
        std::string hint = finite_hint(at);
        if (c == '/' || c == '#') hint = "; JSON has no comments; use the key \"note\"";
        if (c == '\'') hint = "; strings must be in double quotes";
        const bool punctuation = std::string_view("{}[]:,").find(c) != std::string_view::npos;
        const std::string what = punctuation               ? "unexpected " + got
                                 : c == '"'                ? "unexpected string literal, got " + got
                                 : is_digit(c) || c == '-' ? "unexpected number literal, got " + got
                                                           : "invalid literal, got " + got;
        fail(at, "not JSON: " + what + (hint.empty() ? "; expected " + expected : hint));
    }

    std::string_view text;
    const JsonSource& source;
    const std::size_t longest_string;
    std::size_t at = 0, values = 0;
    std::vector<Open> path;
    /// Sizes of the last lists and objects of each depth, for which memory is reserved
    static constexpr std::size_t largest_expected = 16;
    std::array<std::uint8_t, JsonSource::max_depth + 1> expected_size = {};
};

}  // namespace

Json parse_json(std::string_view text, const JsonSource& source, std::size_t longest_string)
{
    return JsonParser(text, source, longest_string).document();
}

}  // namespace hilda::io
