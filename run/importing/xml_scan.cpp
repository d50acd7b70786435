// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/importing/xml_scan.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>
#include <vector>

namespace hilda::run {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view blanks = " \t\r\n";
constexpr size_t most_bytes = size_t(64) << 20;
constexpr int most_levels = 200, most_links = 1000;
constexpr double most_of_composite = 10000;

class Scanner {
public:
    Scanner(std::string_view text, const std::function<void(const XmlElement&)>& take)
        : text(text), take(take)
    {}

    void scan()
    {
        while ((at = text.find('<', at)) != text.npos) {
            const std::string_view rest = text.substr(at);
            if (rest.starts_with("<!--"))
                skip_to("-->");
            else if (rest.starts_with("<![CDATA["))
                skip_to("]]>");
            else if (rest.starts_with("<?") || rest.starts_with("<!"))
                skip_to(">");
            else if (rest.starts_with("</"))
                depth = std::max(depth - 1, 0), skip_to(">");
            else
                ++at, element();
        }
    }

private:
    void skip_to(std::string_view end)
    {
        const size_t found = text.find(end, at);
        at = found == text.npos ? text.size() : found + end.size();
    }
    void skip_blanks() { at = std::min(text.find_first_not_of(blanks, at), text.size()); }
    std::string_view word(std::string_view ends)
    {
        const size_t begin = at;
        at = std::min(text.find_first_of(ends, at), text.size());
        return text.substr(begin, at - begin);
    }

    void element()
    {
        lines += std::count(text.begin() + static_cast<std::ptrdiff_t>(counted),
                            text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
        counted = at;
        XmlElement one{.name = word(" \t\r\n/>"), .attributes = {}, .depth = ++depth, .line = lines};
        bool is_empty = false;
        for (skip_blanks(); at < text.size() && text[at] != '>'; skip_blanks()) {
            is_empty = text[at] == '/';
            if (is_empty || text[at] == '=' || text[at] == '"' || text[at] == '\'') {
                ++at;
                continue;
            }
            const std::string_view key = word(" \t\r\n=/>");
            skip_blanks();
            if (at == text.size() || text[at] != '=') continue;
            ++at;
            skip_blanks();
            if (at == text.size() || (text[at] != '"' && text[at] != '\'')) continue;
            const char quote[] = {text[at++], '\0'};
            one.attributes.emplace(key, word(quote));
            ++at;
        }
        if (is_empty) --depth;
        take(one);
    }

    std::string_view text;
    const std::function<void(const XmlElement&)>& take;
    size_t at = 0, counted = 0;
    int depth = 0;
    long lines = 1;
};

/// The product of the numbers in a text such as "10 20 1"; 1 for a text without numbers
double product(std::string_view text)
{
    double all = 1;
    while (!(text = text.substr(std::min(text.find_first_not_of(blanks), text.size()))).empty()) {
        double factor = 1;
        const auto end = std::from_chars(text.data(), text.data() + text.size(), factor).ptr;
        if (end == text.data()) break;
        all *= factor;
        text.remove_prefix(static_cast<size_t>(end - text.data()));
    }
    return all;
}

class Check {
public:
    explicit Check(const std::string& file) : folder(fs::path(file).parent_path())
    {
        read(file);
        check_chains(file);
    }

private:
    /// The libraries follow the links of a chain by recursion.
    void check_chains(const std::string& file) const
    {
        std::map<std::string, int> links;  // from the root to a link
        for (const auto& [first, parent] : parents) {
            std::vector<std::string> chain;
            std::string link = first;
            for (; parents.contains(link) && !links.contains(link) && chain.size() <= parents.size();
                 link = parents.at(link))
                chain.push_back(link);
            int count = links.contains(link) ? links.at(link) : 1;
            for (; !chain.empty(); chain.pop_back()) links[chain.back()] = ++count;
            if (count > most_links)
                throw io::InvalidInput(
                    fmt::format("{}: the link {} is behind a chain of {} links, the limit is {}", file,
                                io::in_quotes(first), count - 1, most_links));
        }
    }

    void read(const std::string& file)
    {
        if (!read_already.insert(file).second) return;
        const std::string text = io::read_file(file, most_bytes);
        scan_xml(text, [&](const XmlElement& one) { check(file, one); });
    }

    void check(const std::string& file, const XmlElement& one)
    {
        const auto refuse = [&](const std::string& why) {
            throw io::InvalidInput(fmt::format("{}:{}: {}", file, one.line, why));
        };
        if (one.depth > most_levels)
            refuse(fmt::format("the element {} is at level {} of the nesting, the limit is {}",
                               io::in_quotes(one.name), one.depth, most_levels));
        if (one.name == "parent") parent = one.attribute("link");
        if (one.name == "child" && !one.attribute("link").empty())
            parents.emplace(std::string(one.attribute("link")), parent);
        if (one.name == "composite")
            if (const double bodies = product(one.attribute("count")); !(bodies <= most_of_composite))
                refuse(fmt::format("the composite has {:g} bodies, the limit is {:g}", bodies,
                                   most_of_composite));
        if (one.name == "compiler")
            for (const char* key : {"meshdir", "texturedir", "assetdir"})
                if (!one.attribute(key).empty()) folders.emplace_back(folder / one.attribute(key));
        for (const char* key : {"file", "filename"}) {
            const std::string_view name = one.attribute(key);
            if (name.empty() || name.find("://") != name.npos) continue;
            std::error_code error;
            std::vector<fs::path> places = folders;
            places.push_back(folder);
            places.push_back(fs::path(file).parent_path());
            for (const fs::path& place : places) {
                const fs::file_status status = fs::status(place / name, error);
                if (!fs::exists(status)) continue;
                if (!fs::is_regular_file(status))
                    refuse(fmt::format("{} is not a regular file", io::in_quotes(name)));
                if (one.name == "include") read((place / name).string());
                break;
            }
        }
    }

    const fs::path folder;
    std::vector<fs::path> folders;  ///< of meshes and textures
    std::set<std::string> read_already;
    std::string parent;                          ///< of the present joint
    std::map<std::string, std::string> parents;  ///< of the links of URDF
};

}  // namespace

std::string_view XmlElement::attribute(std::string_view key) const
{
    const auto found = attributes.find(key);
    return found == attributes.end() ? std::string_view() : found->second;
}

void scan_xml(std::string_view text, const std::function<void(const XmlElement&)>& take)
{
    Scanner(text, take).scan();
}

void check_robot_file(const std::string& file) { Check check(file); }

}  // namespace hilda::run
