// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case_text.hpp"

#include "granular/text_place.hpp"

#include <algorithm>
#include <charconv>

namespace hilda::granular {

namespace {

using Json = Keys::Json;

/// Nothing deeper than this is a case, and a key that stands twice is a mistake.
constexpr int deepest = 64;

struct NoJson : std::runtime_error {
    using std::runtime_error::runtime_error;
};
struct Twice : InvalidCase {
    Twice(const std::string& key, std::string place)
        : InvalidCase("the key " + key + " stands twice in one object"), place(std::move(place))
    {}
    std::string place;
};

/// Bytes of a text, and how many of them were read
struct Reader {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    const char *at, *begin;
    std::size_t* count;

    reference operator*() const { return *at; }
    Reader& operator++()
    {
        *count = static_cast<std::size_t>(++at - begin);
        return *this;
    }
    bool operator==(const Reader& o) const { return at == o.at; }
};

/// Of the string whose closing quote is at `end`
std::size_t opening_quote(const std::string& text, std::size_t end)
{
    std::size_t at = end;
    for (bool escaped = true; escaped;) {
        at = text.rfind('"', at - 1);
        const std::size_t before = at > 0 ? text.find_last_not_of('\\', at - 1) : std::string::npos;
        escaped = (at - 1 - before) % 2 == 1;  // by so many backslashes
    }
    return at;
}

Json parse(const std::string& text)
{
    std::vector<std::set<std::string>> open;
    std::optional<Twice> twice;
    std::size_t count = 0;
    const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (depth > deepest) throw InvalidCase("is nested deeper than " + std::to_string(deepest));
        if (event == Json::parse_event_t::object_start) open.emplace_back();
        if (event == Json::parse_event_t::object_end && !open.empty()) open.pop_back();
        if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second &&
            !twice)
            twice.emplace(parsed.dump(), text_place(text, opening_quote(text, count - 1)));
        return true;
    };
    try {
        const char* const end = text.data() + text.size();
        Json all =
            Json::parse(Reader{text.data(), text.data(), &count}, Reader{end, text.data(), &count}, watch);
        if (twice) throw Twice(*twice);
        return all;
    } catch (const Json::parse_error& e) {
        throw NoJson(text_place(text, std::max<std::size_t>(e.byte, 1) - 1) + ": is no JSON");
    } catch (const Json::exception& e) {  // a number beyond all numbers, say
        throw InvalidCase(e.what());
    }
}

Json value_of(const std::string& text)
{
    try {
        return parse(text);
    } catch (const NoJson&) {
        Json plain = text;
        try {
            plain.dump();
        } catch (const Json::exception&) {
            throw InvalidCase("the value is not UTF-8");
        }
        return plain;
    }
}

/// A part of a pointer with its escapes undone
std::string unescaped(const std::string& part)
{
    std::string key;
    for (std::size_t k = 0; k < part.size(); ++k) {
        if (part[k] != '~') {
            key += part[k];
            continue;
        }
        const char next = k + 1 < part.size() ? part[++k] : ' ';
        if (next != '0' && next != '1')
            throw InvalidCase("'~' is written ~0 in a pointer, and '/' in a key is ~1");
        key += next == '0' ? '~' : '/';
    }
    return key;
}

/// The member of an object or a list, or nothing
Json* child(Json& of, const std::string& key)
{
    if (of.is_object()) {
        const auto found = of.find(key);
        return found == of.end() ? nullptr : &*found;
    }
    std::size_t number = 0;
    const char* end = key.data() + key.size();
    if (!of.is_array() || key.empty() || std::from_chars(key.data(), end, number).ptr != end ||
        number >= of.size())
        return nullptr;
    return &of[number];
}

}  // namespace

CaseText::CaseText(std::string text, std::string name) : of_file(std::move(text)), file(std::move(name))
{
    try {
        all = parse(of_file);
    } catch (const NoJson& e) {
        throw InvalidCase(file + ':' + e.what());
    } catch (const Twice& e) {
        throw InvalidCase(file + ':' + e.place + ": " + e.what());
    } catch (const InvalidCase& e) {
        throw InvalidCase(file + ": " + e.what());
    }
}

void CaseText::set(const Setting& setting)
{
    Json* at = &all;
    std::string way;
    try {
        if (!setting.pointer.starts_with('/')) throw InvalidCase("must be /json/pointer=VALUE");
        for (std::size_t from = 1; from <= setting.pointer.size();) {
            const std::size_t to = std::min(setting.pointer.find('/', from), setting.pointer.size());
            const std::string key = unescaped(setting.pointer.substr(from, to - from));
            Json* next = child(*at, key);
            const bool last = to == setting.pointer.size();
            if (next == nullptr && last && at->is_object()) next = &(*at)[key];
            if (next == nullptr) throw InvalidCase("there is no \"" + key + "\"");
            at = next;
            from = to + 1;
            way += '/' + key;
        }
        *at = value_of(setting.value);
    } catch (const InvalidCase& e) {
        throw InvalidCase(file + ':' + text_place(of_file, way) + " (" + (way.empty() ? "/" : way) +
                          "): " + setting.asked + ": " + e.what());
    }
    made.push_back(setting);
}

std::string CaseText::text() const { return made.empty() ? of_file : all.dump(1) + '\n'; }

std::string CaseText::placed(const std::string& what) const
{
    if (what[0] != '/' && what[0] != ':') return file + ": " + what;
    const std::string pointer = what.substr(0, what.find(": "));
    std::string told = file + ':' + text_place(of_file, pointer) + " (" + (pointer.empty() ? "/" : pointer) +
                       ')' + what.substr(pointer.size());
    const auto by = std::find_if(made.rbegin(), made.rend(), [&](const Setting& c) {
        return (pointer + '/').starts_with(c.pointer + '/');
    });
    if (by != made.rend()) told += " (from " + by->asked + ')';
    return told;
}

}  // namespace hilda::granular
