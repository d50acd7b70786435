// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/settings.hpp"

#include "granular/case/case_file.hpp"
#include "granular/case/continued_case.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

/// Sets the seeds of the fills, then those of the insertions.
void set_seeds(io::JsonSource& source, std::uint64_t seed)
{
    std::size_t set = 0;
    for (const std::string key : {"fill", "insert"}) {
        const io::Json::Member* entries = source.root.member(key);
        const std::size_t number = entries != nullptr ? entries->value.size() : 0;
        for (std::size_t k = 0; k < number; ++k, ++set) {
            const io::Json& one = entries->value.list() != nullptr ? entries->value.at(k) : entries->value;
            if (one.members() != nullptr && one.member("file") == nullptr)
                source.set('/' + key + '/' + std::to_string(k) + "/seed=" + std::to_string(seed + set),
                           "--seed " + std::to_string(seed));
        }
    }
    if (set == 0) source.notices.emplace_back("--seed has no effect: the case has no fill");
}

}  // namespace

std::string with_numbers(const io::Json& root, const std::string& pointer)
{
    for (const std::string list : {"boundaries", "insert"}) {
        const std::string start = '/' + list + '/';
        const io::Json::Member* entries = root.member(list);
        if (!pointer.starts_with(start) || entries == nullptr || entries->value.list() == nullptr) continue;
        const std::size_t end = std::min(pointer.find_first_of("/=", start.size()), pointer.size());
        const std::string key = pointer.substr(start.size(), end - start.size());
        if (key.find_first_not_of("0123456789") == std::string::npos) continue;  // a number
        for (std::size_t k = 0; k < entries->value.size(); ++k) {
            const io::Json::Member* found = entries->value.at(k).member("name");
            if (found != nullptr && found->value.string() != nullptr &&
                io::pointer_to("", *found->value.string()) == '/' + key)
                return start + std::to_string(k) + pointer.substr(end);
        }
    }
    return pointer;
}

io::JsonSource changed_source(const std::string& text, const std::string& file,
                              const Environment& environment)
{
    io::JsonSource source(text, file);
    source.within = environment.folder, source.base = environment.base;
    for (const auto& [old_name, name] : renamed_keys) source.rename(old_name, name);
    for (const Setting& setting : environment.settings)
        source.set(with_numbers(source.root, setting.change),
                   setting.origin.empty() ? "--set " + io::in_quotes(setting.change) : setting.origin);
    if (environment.seed) set_seeds(source, *environment.seed);
    if (environment.continues != nullptr) keep_intervals(source, *environment.continues);
    return source;
}

}  // namespace hilda::granular
