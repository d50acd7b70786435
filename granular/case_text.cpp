// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case_text.hpp"

#include "granular/text_place.hpp"
#include "io/error.hpp"

#include <algorithm>
#include <charconv>

namespace hilda::granular {

namespace {

using Json = Keys::Json;

constexpr int max_depth = 64;  // of nested objects and arrays; no case is deeper

/// Keys at the top level of a case that were renamed
struct RenamedKey {
    const char *old_name, *new_name;
};
constexpr RenamedKey renamed_keys[] = {
    {"every", "interval"}, {"frames_every", "frame_interval"}, {"checkpoint_every", "checkpoint_interval"}};

std::string rename_notice(const RenamedKey& key)
{
    return std::string(key.old_name) + " was renamed to " + key.new_name + "; the old name is still read";
}

struct SyntaxError : std::runtime_error {
    using std::runtime_error::runtime_error;
};
struct DuplicateKey : io::InvalidInput {
    DuplicateKey(const std::string& key, std::string place)
        : io::InvalidInput("the key " + key + " occurs twice in one object"), place(std::move(place))
    {}
    std::string place;
};

/// Input iterator over a text that counts the bytes that were read
struct CountingIterator {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    const char *at, *begin;
    std::size_t* count;

    reference operator*() const { return *at; }
    CountingIterator& operator++()
    {
        *count = static_cast<std::size_t>(++at - begin);
        return *this;
    }
    bool operator==(const CountingIterator& o) const { return at == o.at; }
};

/// Index of the opening quote of the string whose closing quote is at `end`
std::size_t opening_quote(const std::string& text, std::size_t end)
{
    std::size_t at = end;
    for (bool escaped = true; escaped;) {
        at = text.rfind('"', at - 1);
        const std::size_t before = at > 0 ? text.find_last_not_of('\\', at - 1) : std::string::npos;
        escaped = (at - 1 - before) % 2 == 1;  // by an odd number of backslashes
    }
    return at;
}

Json parse(const std::string& text)
{
    std::vector<std::set<std::string>> open;
    std::optional<DuplicateKey> duplicate;
    std::size_t count = 0;
    const auto callback = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (depth > max_depth)
            throw io::InvalidInput("must not be nested deeper than " + std::to_string(max_depth));
        if (event == Json::parse_event_t::object_start) open.emplace_back();
        if (event == Json::parse_event_t::object_end && !open.empty()) open.pop_back();
        if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second &&
            !duplicate)
            duplicate.emplace(parsed.dump(), text_place(text, opening_quote(text, count - 1)));
        return true;
    };
    try {
        const char* const end = text.data() + text.size();
        Json all = Json::parse(CountingIterator{text.data(), text.data(), &count},
                               CountingIterator{end, text.data(), &count}, callback);
        if (duplicate) throw DuplicateKey(*duplicate);
        return all;
    } catch (const Json::parse_error& e) {
        throw SyntaxError(text_place(text, std::max<std::size_t>(e.byte, 1) - 1) + ": is not valid JSON");
    } catch (const Json::exception& e) {  // for example a number out of range
        throw io::InvalidInput(e.what());
    }
}

Json value_of(const std::string& text)
{
    try {
        return parse(text);
    } catch (const SyntaxError&) {
        Json plain = text;
        try {
            plain.dump();
        } catch (const Json::exception&) {
            throw io::InvalidInput("the value is not UTF-8");
        }
        return plain;
    }
}

/// A part of a JSON pointer with the escape sequences ~0 and ~1 replaced (RFC 6901)
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
            throw io::InvalidInput("'~' is written ~0 in a pointer, and '/' in a key is ~1");
        key += next == '0' ? '~' : '/';
    }
    return key;
}

/// The member of an object or the element of an array; nullptr if it does not exist
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

CaseText::CaseText(std::string text, std::string name) : file_text(std::move(text)), file(std::move(name))
{
    try {
        all = parse(file_text);
    } catch (const SyntaxError& e) {
        throw io::InvalidInput(file + ':' + e.what());
    } catch (const DuplicateKey& e) {
        throw io::InvalidInput(file + ':' + e.place + ": " + e.what());
    } catch (const io::InvalidInput& e) {
        throw io::InvalidInput(file + ": " + e.what());
    }
    replace_old_names();
}

void CaseText::replace_old_names()
{
    if (!all.is_object()) return;
    for (const RenamedKey& key : renamed_keys) {
        if (!all.contains(key.old_name)) continue;
        const std::string pointer = std::string("/") + key.old_name;
        if (all.contains(key.new_name))
            throw io::InvalidInput(with_location(pointer + ": is the old name of " + key.new_name +
                                                 ", which is given as well; remove one of them"));
        Json with_new_name = Json::object();  // in the same order
        for (const auto& [name, value] : all.items())
            with_new_name[name == key.old_name ? key.new_name : name] = value;
        all = std::move(with_new_name);
        old_names[key.new_name] = key.old_name;
        renamed_notices.push_back(pointer + ": " + rename_notice(key));
    }
}

void CaseText::set(const Setting& requested)
{
    Setting setting = requested;
    for (const RenamedKey& key : renamed_keys) {
        if (setting.pointer != std::string("/") + key.old_name) continue;
        setting.pointer = std::string("/") + key.new_name;
        if (old_names.emplace(key.new_name, key.new_name).second)
            renamed_notices.push_back(setting.pointer + ": " + rename_notice(key));
    }
    Json* at = &all;
    std::string path;
    try {
        if (!setting.pointer.starts_with('/')) throw io::InvalidInput("must be /json/pointer=VALUE");
        for (std::size_t from = 1; from <= setting.pointer.size();) {
            const std::size_t to = std::min(setting.pointer.find('/', from), setting.pointer.size());
            const std::string key = unescaped(setting.pointer.substr(from, to - from));
            Json* next = child(*at, key);
            const bool last = to == setting.pointer.size();
            if (next == nullptr && last && at->is_object()) next = &(*at)[key];
            if (next == nullptr) throw io::InvalidInput("entry \"" + key + "\" does not exist");
            at = next;
            from = to + 1;
            path += '/' + key;
        }
        *at = value_of(setting.value);
    } catch (const io::InvalidInput& e) {
        throw io::InvalidInput(file + ':' + text_place(file_text, path) + " (" + (path.empty() ? "/" : path) +
                               "): " + setting.origin + ": " + e.what());
    }
    applied.push_back(setting);
}

std::string CaseText::text() const
{
    return applied.empty() && old_names.empty() ? file_text : all.dump(1) + '\n';
}

std::string CaseText::with_location(const std::string& what) const
{
    if (what[0] != '/' && what[0] != ':') return file + ": " + what;
    const std::string pointer = what.substr(0, what.find(": "));
    const std::size_t first_end = std::min(pointer.find('/', 1), pointer.size());
    const auto renamed = old_names.find(pointer.empty() ? "" : pointer.substr(1, first_end - 1));
    const std::string in_file =
        renamed == old_names.end() ? pointer : '/' + renamed->second + pointer.substr(first_end);
    std::string message = file + ':' + text_place(file_text, in_file) + " (" +
                          (in_file.empty() ? "/" : in_file) + ')' + what.substr(pointer.size());
    const auto by = std::find_if(applied.rbegin(), applied.rend(), [&](const Setting& c) {
        return (pointer + '/').starts_with(c.pointer + '/');
    });
    if (by != applied.rend()) message += " (from " + by->origin + ')';
    return message;
}

}  // namespace hilda::granular
