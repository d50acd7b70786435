// SPDX-License-Identifier: GPL-3.0-or-later
/// Lists of named entries that files of the program register: integrators, joints, forces, surfaces, laws,
/// studies.

#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hilda::io {

/// The registered entries of one type, sorted by name. Entry has a member `name`.
///
/// A file registers an entry by a constant with static initialisation:
///
///     const bool registered = io::Registry<JointType>::add({.name = "screw", .read = read_screw});
///
/// The order in which files are initialised has no effect on the list.
///
/// An entry that many files register is declared in its header by `extern template class
/// io::Registry<Entry>;` and instantiated in one .cpp file, so that add() is compiled once.
template <class Entry>
class Registry {
public:
    /// Adds an entry and returns true. Throws std::logic_error if an entry with this name exists.
    static bool add(Entry entry);

    static const std::vector<Entry>& all() { return entries(); }

    /// The entry with this name, or nullptr
    static const Entry* find(std::string_view name)
    {
        for (const Entry& entry : entries())
            if (entry.name == name) return &entry;
        return nullptr;
    }

    static std::vector<std::string> names()
    {
        std::vector<std::string> all_names;
        all_names.reserve(entries().size());
        for (const Entry& entry : entries()) all_names.emplace_back(entry.name);
        return all_names;
    }

private:
    // A function-local static: entries are added before main(), in an unspecified order of the files.
    static std::vector<Entry>& entries()
    {
        static std::vector<Entry> list;
        return list;
    }
};

template <class Entry>
bool Registry<Entry>::add(Entry entry)
{
    std::vector<Entry>& list = entries();
    const auto at = std::lower_bound(list.begin(), list.end(), entry,
                                     [](const Entry& a, const Entry& b) { return a.name < b.name; });
    if (at != list.end() && at->name == entry.name)
        throw std::logic_error("two entries of a list are registered under the name " +
                               std::string(entry.name));
    list.insert(at, std::move(entry));
    return true;
}

}  // namespace hilda::io
