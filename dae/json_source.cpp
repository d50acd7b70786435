// SPDX-License-Identifier: GPL-3.0-or-later
/// JSON parser with locations, built on the event interface (SAX) of nlohmann::json; changes by --set;
/// output.
#include "dae/json_source.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>

namespace hilda::dae {

namespace {

// 2^53 - 1. The value 2^53 may result from rounding 2^53 + 1.
constexpr double largest_exact_integer = 9007199254740991;

/// Iterator that counts the bytes read by the parser. The events of nlohmann::json have no position.
class CountingIterator {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    CountingIterator(const char* at, std::size_t* consumed) : at(at), consumed(consumed) {}
    reference operator*() const { return *at; }
    CountingIterator& operator++()
    {
        ++at, ++*consumed;
        return *this;
    }
    bool operator==(const CountingIterator& other) const { return at == other.at; }
    bool operator!=(const CountingIterator& other) const { return at != other.at; }

private:
    const char* at;
    std::size_t* consumed;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_word(char c)
{
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '+' || c == '-';
}

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }  // UTF-8

/// The first characters of a text, at most 60 bytes
std::string excerpt(std::string_view s)
{
    constexpr std::size_t max_length = 60;
    if (s.size() <= max_length) return std::string(s);
    std::size_t end = max_length;
    while (end > 0 && continues_character(s[end])) --end;
    return std::string(s.substr(0, end)) + "...";
}

/// An excerpt in double quotes, with the escapes of JSON
std::string in_quotes(std::string_view s)
{
    return nlohmann::json(excerpt(s)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Builds the tree from the events of nlohmann::json, which have the order of the text.
class Builder {
public:
    Builder(std::string_view text, const JsonSource& source) : text(text), source(source)
    {
        // nlohmann::json skips a byte order mark.
        if (text.starts_with("\xEF\xBB\xBF")) token_end = 3;
    }

    Json parse()
    {
        if (text.size() > JsonSource::max_bytes)
            fail(0, "the text has " + std::to_string(text.size()) + " bytes; at most " +
                        std::to_string(JsonSource::max_bytes) + " are allowed");
        if (std::all_of(text.begin() + static_cast<std::ptrdiff_t>(token_end), text.end(), is_blank))
            fail(0, "the text is empty; a JSON object is expected");
        nlohmann::json::sax_parse(CountingIterator(text.data(), &consumed),
                                  CountingIterator(text.data() + text.size(), &consumed), this);
        return std::move(root);
    }

    // events

    bool null() { return add(nullptr); }
    bool boolean(bool b) { return add(b); }
    bool number_integer(std::int64_t) { return number(); }
    bool number_unsigned(std::uint64_t) { return number(); }
    bool number_float(double, const std::string&) { return number(); }
    bool string(std::string& s)
    {
        check_length(s);
        return add(std::move(s));
    }
    bool binary(std::vector<std::uint8_t>&) { return false; }
    bool start_array(std::size_t) { return open_container(Json::List()); }
    bool start_object(std::size_t) { return open_container(Json::Object()); }
    bool end_array() { return close_container(); }
    bool end_object()
    {
        check_duplicates(std::get<Json::Object>(open.back()->value));
        return close_container();
    }
    bool key(std::string& k)
    {
        check_length(k);
        std::get<Json::Object>(open.back()->value).push_back({std::move(k), token_start(), {}});
        token_end = consumed;
        return true;
    }

    [[noreturn]] bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e)
    {
        syntax_error(e.what());
    }

private:
    // locations

    /// Position of the first byte of the current token. Blanks and separators before it are skipped, because
    /// they cause no events.
    std::uint32_t token_start() const
    {
        std::size_t at = token_end;
        while (at < text.size() &&
               (is_blank(text[at]) || ((text[at] == ',' || text[at] == ':') && at + 1 < consumed)))
            ++at;
        return static_cast<std::uint32_t>(at);
    }

    /// JSON pointer of the value that is being read
    std::string pointer() const
    {
        std::string p;
        for (std::size_t depth = 0; depth < open.size(); ++depth) {
            const bool innermost = depth + 1 == open.size();
            if (const Json::List* list = open[depth]->list())
                p = pointer_to(p, std::to_string(innermost ? list->size() : list->size() - 1));
            else if (const Json::Object* object = open[depth]->object(); !object->empty())
                p = pointer_to(p, object->back().key);
        }
        return p;
    }

    [[noreturn]] void fail(std::size_t at, const std::string& what) const
    {
        throw PlacedError(source.place(at, pointer()) + ": " + what);
    }

    // values

    /// Inserts a value into the innermost open container and returns a reference to it.
    Json& put(Json&& v)
    {
        if (++values > JsonSource::max_values)
            fail(v.offset, "the text has more than " + std::to_string(JsonSource::max_values) + " values");
        if (open.empty()) return root = std::move(v);
        if (auto* list = std::get_if<Json::List>(&open.back()->value))
            return list->emplace_back(std::move(v));
        return std::get<Json::Object>(open.back()->value).back().value = std::move(v);
    }

    template <class T>
    bool add(T&& v)
    {
        put({.value = std::forward<T>(v), .offset = token_start()});
        token_end = consumed;
        return true;
    }

    bool number()
    {
        const std::uint32_t at = token_start();
        double x = 0;
        const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), x);
        const std::string_view digits(text.data() + at, static_cast<std::size_t>(end - (text.data() + at)));
        if (error != std::errc())
            fail(at, "the number is outside the range of double precision, got " + word(at));
        if (digits.find_first_of(".eE") == std::string_view::npos && std::abs(x) > largest_exact_integer)
            fail(at, "the integer is too large to be exact, got " + word(at) +
                         "; at most 2^53 - 1 is allowed, or write it with an exponent");
        return add(x);
    }

    template <class Container>
    bool open_container(Container&& empty)
    {
        const std::uint32_t at = token_start();
        if (open.size() == JsonSource::max_depth)
            fail(at, "nested deeper than " + std::to_string(JsonSource::max_depth) + " levels");
        open.push_back(&put({.value = std::forward<Container>(empty), .offset = at}));
        token_end = consumed;
        return true;
    }

    bool close_container()
    {
        open.pop_back();
        token_end = consumed;
        return true;
    }

    void check_length(const std::string& s) const
    {
        if (s.size() > JsonSource::max_string)
            fail(token_start(), "a string of " + std::to_string(s.size()) + " bytes, got " + in_quotes(s) +
                                    "; at most " + std::to_string(JsonSource::max_string) + " are allowed");
    }

    void check_duplicates(const Json::Object& object)
    {
        std::vector<std::size_t> order(object.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return object[a].key < object[b].key; });
        for (std::size_t k = 1; k < order.size(); ++k) {
            const Json::Member &first = object[order[k - 1]], &second = object[order[k]];
            if (first.key != second.key) continue;
            open.pop_back();
            const std::string parent = open.empty() ? "" : pointer_in_parent();
            throw PlacedError(source.place(second.offset, pointer_to(parent, second.key)) + ": the key " +
                              in_quotes(second.key) + " is given twice; first at " +
                              source.place(first.offset, ""));
        }
    }

    /// JSON pointer of the object that was just removed from the stack. In contrast to pointer(), it is
    /// already an element of its list.
    std::string pointer_in_parent() const
    {
        std::string p = pointer();
        if (const Json::List* list = open.back()->list())
            p = p.substr(0, p.rfind('/') + 1) + std::to_string(list->size() - 1);
        return p;
    }

    // syntax

    /// The string, word or character at a position, for messages
    std::string word(std::size_t at) const
    {
        constexpr std::size_t max_length = 30;
        if (text[at] == '"')
            if (const std::size_t quote = text.find('"', at + 1); quote < at + max_length)
                return in_quotes(text.substr(at + 1, quote - at - 1));
        std::size_t end = at;
        while (end < text.size() && end - at < max_length && is_word(text[end])) ++end;
        if (end > at)
            return "'" + std::string(text.substr(at, end - at)) + (end - at == max_length ? "..." : "") + "'";
        const auto code = static_cast<unsigned char>(text[at]);
        if (code > ' ' && code < 127) return std::string("'") + text[at] + "'";
        return "byte " + std::to_string(code);
    }

    /// Converts a message of nlohmann::json such as "[...] parse error at line 1, column 5: syntax error
    /// while parsing value - invalid literal; last read: 'nan'; expected ...". The reason and the expected
    /// token are used.
    [[noreturn]] void syntax_error(const std::string& what) const
    {
        std::size_t at = token_start();
        const std::size_t dash = what.find(" - "), read = what.find("; last read: '", dash),
                          expected = what.rfind("; expected ");
        std::string reason =
            dash == std::string::npos ? "" : what.substr(dash + 3, std::min(read, expected) - dash - 3);
        std::string allowed = expected == std::string::npos || expected < dash ? "" : what.substr(expected);
        if (what.find("number overflow") != std::string::npos)
            fail(at, "the number is outside the range of double precision, got " + word(at));
        if (at >= text.size()) fail(text.size(), "not JSON: unexpected end of the text" + allowed);

        const char last = text[consumed - 1];
        if (reason.starts_with("invalid string") && (last == '\n' || last == '\r'))
            fail(at, "not JSON: a string must be closed on its line, got " +
                         in_quotes(text.substr(at + 1, consumed - at - 2)));
        if (reason.starts_with("invalid string") && reason.find("missing closing quote") == std::string::npos)
            at = consumed - 1;  // the invalid character in the string
        std::size_t before = at;
        while (before > 0 && is_blank(text[before - 1])) --before;
        const std::string got = word(at);
        if ((text[at] == '}' || text[at] == ']') && before > 0 && text[before - 1] == ',')
            fail(before - 1, "not JSON: a comma without a following value, before " + got);
        if (text[at] == '/' || text[at] == '#') allowed = "; JSON has no comments; use the key \"note\"";
        if (text[at] == '\'') allowed = "; strings must be in double quotes";
        if (got.find("nan") == 1 || got.find("NaN") == 1 || got.find("inf") < 3 || got.find("Inf") < 3)
            allowed = "; numbers must be finite";
        if (reason.empty()) reason = "syntax error";
        fail(at,
             "not JSON: " + reason + (reason.find(got) == std::string::npos ? ", got " + got : "") + allowed);
    }

    std::string_view text;
    const JsonSource& source;
    std::size_t consumed = 0;   // bytes read by the parser; one more after a number (look-ahead)
    std::size_t token_end = 0;  // value of `consumed` at the end of the preceding token
    std::size_t values = 0;
    Json root;
    std::vector<Json*> open;  // open containers; only the innermost one changes
};

/// Positions of the first bytes of the lines
std::vector<std::uint32_t> line_starts(std::string_view text)
{
    std::vector<std::uint32_t> starts = {0};
    for (std::size_t k = 0; k < std::min(text.size(), JsonSource::max_bytes); ++k)
        if (text[k] == '\n') starts.push_back(static_cast<std::uint32_t>(k + 1));
    return starts;
}

/// The member or element `key` of a value, or nullptr
Json* child(Json& v, const std::string& key)
{
    if (auto* object = std::get_if<Json::Object>(&v.value)) {
        for (Json::Member& m : *object)
            if (m.key == key) return &m.value;
    } else if (auto* list = std::get_if<Json::List>(&v.value)) {
        std::size_t index = 0;
        const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
        if (error == std::errc() && end == key.data() + key.size() && index < list->size())
            return &(*list)[index];
    }
    return nullptr;
}

/// Gives a value from --set, and all its elements, the location of the value that it replaces.
void set_location(Json& v, std::uint32_t offset, std::int32_t change)
{
    v.offset = offset;
    v.change = change;
    if (auto* list = std::get_if<Json::List>(&v.value))
        for (Json& element : *list) set_location(element, offset, change);
    if (auto* object = std::get_if<Json::Object>(&v.value))
        for (Json::Member& m : *object) m.offset = offset, set_location(m.value, offset, change);
}

Json value_of_change(const std::string& text)
{
    try {
        return JsonSource(text, "--set").root;
    } catch (const PlacedError&) {
        return {.value = text};
    }
}

bool has_object(const Json& v)
{
    if (const Json::List* list = v.list()) return std::any_of(list->begin(), list->end(), has_object);
    return v.object() != nullptr;
}

void write(const Json& v, const std::string& indent, std::string& out)
{
    const std::string deeper = indent + "  ";
    if (const Json::List* list = v.list()) {
        const bool one_line = !has_object(v);
        out += '[';
        for (std::size_t k = 0; k < list->size(); ++k) {
            out += one_line ? (k > 0 ? ", " : "") : (k > 0 ? ",\n" : "\n") + deeper;
            write((*list)[k], deeper, out);
        }
        out += one_line ? "]" : "\n" + indent + "]";
    } else if (const Json::Object* object = v.object()) {
        out += '{';
        for (std::size_t k = 0; k < object->size(); ++k) {
            out += (k > 0 ? ",\n" : "\n") + deeper + nlohmann::json((*object)[k].key).dump() + ": ";
            write((*object)[k].value, deeper, out);
        }
        out += object->empty() ? "}" : "\n" + indent + "}";
    } else if (const std::string* s = v.string()) {
        out += nlohmann::json(*s).dump();
    } else if (const double* x = v.number()) {
        out += shortest(*x);
    } else if (const bool* b = std::get_if<bool>(&v.value)) {
        out += *b ? "true" : "false";
    } else {
        out += "null";
    }
}

}  // namespace

const Json::Member* Json::member(std::string_view key) const
{
    if (const Object* members = object())
        for (const Member& m : *members)
            if (m.key == key) return &m;
    return nullptr;
}

JsonSource::JsonSource(std::string_view text, std::string file)
    : text(text), file(std::move(file)), line_start(line_starts(text))
{
    root = Builder(text, *this).parse();
}

void JsonSource::set(const std::string& change)
{
    const std::size_t equals = change.find('=');
    const std::string prefix = "--set " + in_quotes(change) + ": ";
    if (equals == std::string::npos || equals == 0 || change[0] != '/')
        fail(root, "", prefix + "must be /json/pointer=VALUE");
    const auto number = static_cast<std::int32_t>(changes.size());
    changes.push_back(change);

    Json* at = &root;
    std::string pointer;
    for (std::size_t from = 1; from <= equals;) {
        const std::size_t to = std::min(change.find('/', from), equals);
        std::string key;  // without the escapes of RFC 6901
        for (std::size_t k = from; k < to; ++k) {
            const bool escape = change[k] == '~';
            if (escape && (k + 1 == to || (change[k + 1] != '0' && change[k + 1] != '1')))
                fail(*at, pointer, prefix + "'~' is written ~0 in a pointer, and '/' in a key is ~1");
            key += !escape ? change[k] : change[++k] == '0' ? '~' : '/';
        }
        from = to + 1;
        Json* next = child(*at, key);
        if (next == nullptr) {
            auto* object = std::get_if<Json::Object>(&at->value);
            if (object == nullptr || to != equals)
                fail(*at, pointer, prefix + "there is no " + in_quotes(key) + " in " + described(*at));
            object->push_back({key, at->offset, {.value = nullptr, .offset = at->offset}});
            next = &object->back().value;
        }
        at = next;
        pointer = pointer_to(pointer, key);
    }
    const std::uint32_t offset = at->offset;
    *at = value_of_change(change.substr(equals + 1));
    set_location(*at, offset, number);
}

std::string JsonSource::place(std::size_t offset, const std::string& pointer) const
{
    const auto after = std::upper_bound(line_start.begin(), line_start.end(), offset);
    const std::size_t start = *(after - 1);
    std::size_t column = 1;
    for (std::size_t k = start; k < offset; ++k)
        if (!continues_character(text[k])) ++column;
    std::string place = file + ":" + std::to_string(after - line_start.begin()) + ":" +
                        std::to_string(column) + " (" + (pointer.empty() ? "/" : pointer) + ")";
    std::replace_if(
        place.begin(), place.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; },
        '?');
    return place;
}

void JsonSource::fail(const Json& at, const std::string& pointer, const std::string& what) const
{
    const std::string from =
        at.change < 0 ? "" : " (from --set " + in_quotes(changes[static_cast<std::size_t>(at.change)]) + ")";
    throw PlacedError(place(at.offset, pointer) + ": " + what + from);
}

std::string pointer_to(const std::string& parent, std::string_view key)
{
    std::string pointer = parent + "/";
    for (const char c : excerpt(key)) pointer += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return pointer;
}

std::string shortest(double x)
{
    if (std::isnan(x)) return "nan";
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, x).ptr};
}

std::string described(const Json& v)
{
    if (const double* x = v.number()) return shortest(*x);
    if (const std::string* s = v.string()) return in_quotes(*s);
    if (const bool* b = std::get_if<bool>(&v.value)) return *b ? "true" : "false";
    if (const Json::Object* object = v.object())
        return "an object of " + std::to_string(object->size()) + (object->size() == 1 ? " key" : " keys");
    if (v.list() == nullptr) return "null";
    if (v.list()->size() <= 4 &&
        std::all_of(v.list()->begin(), v.list()->end(), [](const Json& e) { return e.number(); }))
        return written(v);
    return "a list of " + std::to_string(v.list()->size());
}

std::string written(const Json& v)
{
    std::string out;
    write(v, "", out);
    return out;
}

}  // namespace hilda::dae
