// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/json.hpp"

#include "io/formats/characters.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace hilda::io {

namespace {

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }  // UTF-8

/// Appends a string in double quotes with the escapes of JSON. Ill-formed bytes are replaced by U+FFFD.
void append_quoted(std::string& out, std::string_view s)
{
    static constexpr std::string_view codes = "\"\\\b\f\n\r\t", names = "\"\\bfnrt";
    out += '"';
    for (std::size_t k = 0; k < s.size();) {
        const std::size_t n = utf8_length(s.substr(k));
        const auto code = static_cast<unsigned char>(s[k]);
        if (const std::size_t escape = codes.find(s[k]); escape != std::string_view::npos)
            (out += '\\') += names[escape];
        else if (code < ' ')
            (out += code < 16 ? "\\u000" : "\\u001") += "0123456789abcdef"[code % 16];
        else
            out += n == 0 ? "\xEF\xBF\xBD" : s.substr(k, n);
        k += std::max<std::size_t>(n, 1);
    }
    out += '"';
}

/// A number in the style of JavaScript libraries: 1.0, 0.001, 1e-05, 1e+22. From 1e-4 to 1e15 without
/// exponent.
std::string with_decimal_point(double x)
{
    if (!std::isfinite(x)) return "null";
    const bool fixed = x == 0 || (std::abs(x) >= 1e-4 && std::abs(x) < 1e15);
    char digits[32];
    std::string text(digits, std::to_chars(digits, digits + sizeof digits, x,
                                           fixed ? std::chars_format::fixed : std::chars_format::scientific)
                                 .ptr);
    return fixed && text.find('.') == std::string::npos ? text + ".0" : text;
}

bool has_object(const Json& v)
{
    if (const Json::List* list = v.list()) return std::any_of(list->begin(), list->end(), has_object);
    return v.members() != nullptr;
}

enum class Style { canonical, output };

void write(const Json& v, Style style, const std::string& indent, std::string& out)
{
    const std::string deeper = indent + "  ";
    const auto each = [&](const auto& elements, bool one_line, char open, char close, const auto& element) {
        out += open;
        for (std::size_t k = 0; k < elements.size(); ++k) {
            if (k > 0) out += one_line ? ", " : ",";
            if (!one_line) (out += '\n') += deeper;
            element(elements[k]);
        }
        if (!one_line && !elements.empty()) (out += '\n') += indent;
        out += close;
    };
    const auto visit = [&]<class Is>(const Is& is) {
        if constexpr (std::is_same_v<Is, Json::List>) {
            each(is, style == Style::canonical && !has_object(v), '[', ']',
                 [&](const Json& element) { write(element, style, deeper, out); });
        } else if constexpr (std::is_same_v<Is, Json::Object>) {
            each(is, false, '{', '}', [&](const Json::Member& member) {
                append_quoted(out, member.key);
                out += ": ";
                write(member.value, style, deeper, out);
            });
        } else if constexpr (std::is_same_v<Is, std::string>) {
            append_quoted(out, is);
        } else if constexpr (std::is_same_v<Is, double>) {
            out += style == Style::canonical ? shortest(is) : with_decimal_point(is);
        } else if constexpr (std::is_same_v<Is, bool>) {
            out += is ? "true" : "false";
        } else if constexpr (std::is_same_v<Is, std::nullptr_t>) {
            out += "null";
        } else {
            out += std::to_string(is);
        }
    };
    std::visit(visit, v.value);
}

template <class Container>
Container& container(Json& v, const char* error)
{
    if (v.value.index() == 0) v.value = Container();
    auto* found = std::get_if<Container>(&v.value);
    if (found == nullptr) throw std::logic_error(error);
    return *found;
}

}  // namespace

Json::Json(std::initializer_list<Json> elements)
{
    const auto is_member = [](const Json& element) {
        return element.list() != nullptr && element.size() == 2 && element.at(0).string() != nullptr;
    };
    if (!std::all_of(elements.begin(), elements.end(), is_member)) {
        value = List(elements);
        return;
    }
    value = Object();
    for (const Json& element : elements) (*this)[*element.at(0).string()] = element.at(1);
}

const Json::Member* Json::member(std::string_view key) const
{
    if (members() != nullptr)
        for (const Member& m : *members())
            if (m.key == key) return &m;
    return nullptr;
}

Json& Json::operator[](const std::string& key)
{
    Object& all = container<Object>(*this, "Json: not an object");
    for (Member& m : all)
        if (m.key == key) return m.value;
    return all.emplace_back(Member{key, 0, {}}).value;
}

void Json::push_back(Json element)
{
    container<List>(*this, "Json: not an array").push_back(std::move(element));
}

void Json::update(const Json& other)
{
    if (other.members() == nullptr) throw std::logic_error("Json: not an object");
    for (const Member& m : *other.members()) (*this)[m.key] = m.value;
}

const Json& Json::at(size_t element) const
{
    if (list() == nullptr) throw std::out_of_range("Json: not an array");
    return list()->at(element);
}

size_t Json::size() const
{
    return list() != nullptr ? list()->size() : members() != nullptr ? members()->size() : 0;
}

std::string Json::text() const
{
    std::string out;
    write(*this, Style::output, "", out);
    return out + '\n';
}

std::string written(const Json& v)
{
    std::string out;
    write(v, Style::canonical, "", out);
    return out;
}

std::string described(const Json& v)
{
    if (v.string() != nullptr) return in_quotes(*v.string());
    if (v.members() != nullptr)
        return "an object of " + std::to_string(v.size()) + (v.size() == 1 ? " key" : " keys");
    if (v.list() == nullptr) return written(v);
    const auto is_number = [](const Json& e) { return e.number() != nullptr; };
    if (v.size() <= 4 && std::all_of(v.list()->begin(), v.list()->end(), is_number)) return written(v);
    return "a list of " + std::to_string(v.size());
}

std::string shortest(double x)
{
    if (std::isnan(x)) return "nan";
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, x).ptr};
}

std::string excerpt(std::string_view s)
{
    constexpr std::size_t max_length = 60;
    if (s.size() <= max_length) return std::string(s);
    std::size_t end = max_length;
    while (end > 0 && continues_character(s[end])) --end;
    return std::string(s.substr(0, end)) + "...";
}

std::string in_quotes(std::string_view s)
{
    std::string out;
    append_quoted(out, excerpt(s));
    return printable(out);
}

std::size_t utf8_length(std::string_view s)
{
    const auto byte = [&](std::size_t k) { return k < s.size() ? static_cast<unsigned char>(s[k]) : 0u; };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t n = first >= 0xC2 && first < 0xE0   ? 2
                          : first >= 0xE0 && first < 0xF0 ? 3
                          : first >= 0xF0 && first < 0xF5 ? 4
                                                          : 0;
    // The second byte excludes overlong forms (E0, F0), surrogates (ED) and codes above U+10FFFF (F4).
    const unsigned least = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
    const unsigned most = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
    if (byte(1) < least || byte(1) > most) return 0;
    for (std::size_t k = 2; k < n; ++k)
        if ((byte(k) & 0xC0) != 0x80) return 0;
    return n;
}

std::string pointer_to(const std::string& parent, std::string_view key)
{
    std::string pointer;
    const std::string shown = excerpt(key);
    pointer.reserve(parent.size() + shown.size() + 1);
    (pointer += parent) += '/';
    for (const char c : shown)
        if (c == '~' || c == '/')
            pointer += c == '~' ? "~0" : "~1";
        else
            pointer += c;
    return pointer;
}

}  // namespace hilda::io
