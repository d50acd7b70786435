// SPDX-License-Identifier: GPL-3.0-or-later
/// Locations in a JSON text, and changes by --set.
#include "io/json_source.hpp"

#include "io/files.hpp"

#include <algorithm>
#include <charconv>

namespace hilda::io {

namespace {

/// Positions of the first bytes of the lines
std::vector<std::uint32_t> line_starts(std::string_view text)
{
    std::vector<std::uint32_t> starts = {
        static_cast<std::uint32_t>(text.size() - without_byte_order_mark(text).size())};
    for (std::size_t k = 0; k < std::min(text.size(), JsonSource::max_bytes); ++k)
        if (text[k] == '\n') starts.push_back(static_cast<std::uint32_t>(k + 1));
    return starts;
}

constexpr std::size_t block_size = 256;  // [bytes]

bool begins_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }

/// Number of UTF-8 characters before each block of the text, and before its end
std::vector<std::uint32_t> characters_before_blocks(std::string_view text)
{
    std::vector<std::uint32_t> counts = {0};
    std::uint32_t count = 0;
    for (std::size_t k = 0; k < std::min(text.size(), JsonSource::max_bytes); ++k) {
        count += begins_character(text[k]) ? 1 : 0;
        if ((k + 1) % block_size == 0) counts.push_back(count);
    }
    return counts;
}

bool is_utf8(std::string_view s)
{
    for (std::size_t n = 0; !s.empty(); s.remove_prefix(n))
        if ((n = utf8_length(s)) == 0) return false;
    return true;
}

/// The member or element `key` of a value, or nullptr
Json* child(Json& v, std::string_view key)
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

/// Removes the first part of a pointer such as /bodies/0 and returns it without the escapes of RFC 6901.
/// Throws InvalidInput for an invalid escape.
std::string take_key(std::string_view& pointer)
{
    const std::size_t end = std::min(pointer.find('/', 1), pointer.size());
    std::string key;
    for (std::size_t k = 1; k < end; ++k) {
        const bool escape = pointer[k] == '~';
        if (escape && (k + 1 == end || (pointer[k + 1] != '0' && pointer[k + 1] != '1')))
            throw InvalidInput("'~' is written ~0 in a pointer, and '/' in a key is ~1");
        key += !escape ? pointer[k] : pointer[++k] == '0' ? '~' : '/';
    }
    pointer.remove_prefix(end);
    return key;
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
        return JsonSource(text, "VALUE").root;
    } catch (const PlacedError&) {
        if (text.find_first_of("{[\"") == 0) throw;
        return text;
    }
}

/// The pointer with `from` for its first part replaced by `to`
std::string with_first_part(const std::string& pointer, const std::string& from, const std::string& to)
{
    const std::size_t end = std::min(pointer.find_first_of("/=", 1), pointer.size());
    return end > 0 && pointer.substr(1, end - 1) == from ? "/" + to + pointer.substr(end) : pointer;
}

}  // namespace

JsonSource::JsonSource(std::string t, std::string f, std::size_t longest_string)
    : text(std::move(t)), file(std::move(f)), line_start(line_starts(text)),
      characters_before_block(characters_before_blocks(text))
{
    if (text.size() > max_bytes)
        fail(root, "",
             "the text has " + std::to_string(text.size()) + " bytes; at most " + std::to_string(max_bytes) +
                 " are allowed");
    root = parse_json(text, *this, longest_string);
}

void JsonSource::set(const std::string& requested, const std::string& option)
{
    const std::string origin = option.empty() ? "--set " + in_quotes(requested) : option;
    std::string change = requested;
    for (const Renamed& key : renamed)
        if (change = with_first_part(requested, key.old_name, key.new_name); change != requested) {
            if (!key.in_text) {
                notice("/" + key.new_name, key);
                notices.back() += " (from " + origin + ")";
            }
            break;
        }
    const std::size_t equals = change.find('=');
    Json* at = &root;
    std::string pointer;
    try {
        if (equals == std::string::npos || !change.starts_with('/'))
            throw InvalidInput("must be /json/pointer=VALUE");
        if (!is_utf8(change)) throw InvalidInput("must be UTF-8");
        for (std::string_view rest(change.data(), equals); !rest.empty();) {
            const std::string key = take_key(rest);
            Json* next = child(*at, key);
            if (next == nullptr) {
                auto* object = std::get_if<Json::Object>(&at->value);
                if (object == nullptr || !rest.empty())
                    throw InvalidInput("there is no " + in_quotes(key) + " in " + described(*at));
                const std::uint32_t offset = at->offset;
                next = &object->emplace_back(Json::Member{key, offset, {}}).value;
                next->offset = offset;
            }
            at = next;
            pointer = pointer_to(pointer, key);
        }
        const std::uint32_t offset = at->offset;
        *at = value_of_change(change.substr(equals + 1));
        set_location(*at, offset, static_cast<std::int32_t>(origins.size()));
    } catch (const InvalidInput& e) {
        throw PlacedError(place(at->offset, pointer) + ": " + origin, pointer, e.what(), from(*at));
    }
    changes.push_back(change);
    origins.push_back(origin);
    changed = true;
}

void JsonSource::rename(const std::string& old_name, const std::string& new_name)
{
    Json* value = child(root, old_name);
    renamed.push_back({old_name, new_name, false});
    if (root.members() == nullptr || value == nullptr) return;
    if (root.member(new_name) != nullptr)
        fail(*value, "/" + old_name,
             old_name + " is the old name of " + new_name + ", which is given as well; remove one of them");
    for (Json::Member& m : std::get<Json::Object>(root.value))
        if (m.key == old_name) m.key = new_name;
    renamed.back().in_text = changed = true;
    notice("/" + new_name, renamed.back());
}

void JsonSource::remove(const std::string& key)
{
    if (root.members() != nullptr && std::erase_if(std::get<Json::Object>(root.value),
                                                   [&](const Json::Member& m) { return m.key == key; }) > 0)
        changed = true;
}

void JsonSource::notice(const std::string& pointer, const Renamed& key)
{
    notices.push_back(place(pointer) + ": " + key.old_name + " was renamed to " + key.new_name +
                      "; the old name is still read");
}

const Json& JsonSource::find(const std::string& pointer) const
{
    const Json* at = &root;
    for (std::string_view rest = pointer; !rest.empty();) {
        const Json* next = child(const_cast<Json&>(*at), take_key(rest));
        if (next == nullptr) break;
        at = next;
    }
    return *at;
}

std::string JsonSource::place(const std::string& pointer) const
{
    return place(find(pointer).offset, pointer);
}

std::size_t JsonSource::characters_before(std::size_t offset) const
{
    const std::size_t block = offset / block_size;
    std::size_t count = characters_before_block[block];
    for (std::size_t k = block * block_size; k < offset; ++k) count += begins_character(text[k]) ? 1 : 0;
    return count;
}

std::string JsonSource::place(std::size_t offset, const std::string& pointer) const
{
    const auto after = std::upper_bound(line_start.begin() + 1, line_start.end(), offset);
    const std::size_t start = std::min<std::size_t>(*(after - 1), offset);
    const std::size_t column = 1 + characters_before(offset) - characters_before(start);
    std::string in_text = pointer.empty() ? "/" : pointer;
    for (const Renamed& key : renamed)
        if (key.in_text) in_text = with_first_part(in_text, key.new_name, key.old_name);
    std::string place = file + ":" + std::to_string(after - line_start.begin()) + ":" +
                        std::to_string(column) + " (" + in_text + ")";
    std::replace_if(
        place.begin(), place.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; },
        '?');
    return place;
}

void JsonSource::fail(const Json& at, const std::string& pointer, const std::string& what) const
{
    throw PlacedError(place(at.offset, pointer), pointer, what, from(at));
}

/// " (from ORIGIN)" of a value that a change has given, otherwise ""
std::string JsonSource::from(const Json& at) const
{
    return at.change < 0 ? "" : " (from " + origins[static_cast<std::size_t>(at.change)] + ")";
}

void JsonSource::fail(const std::string& pointer, const std::string& what) const
{
    fail(find(pointer), pointer, what);
}

}  // namespace hilda::io
