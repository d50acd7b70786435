// SPDX-License-Identifier: GPL-3.0-or-later
/// Several lists as one message.

#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace hilda::granular {

/// Lists of plain data, one after the other, as one message
class Lists {
public:
    Lists() = default;
    explicit Lists(std::string bytes) : all(std::move(bytes)) {}
    const std::string& bytes() const { return all; }

    template <class T>
    void add(const std::vector<T>& list)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::uint64_t count = list.size();
        all.append(reinterpret_cast<const char*>(&count), sizeof count);
        all.append(reinterpret_cast<const char*>(list.data()), count * sizeof(T));
    }
    template <class T>
    std::vector<T> next()
    {
        std::uint64_t count = 0;
        std::memcpy(&count, all.data() + at, sizeof count);
        at += sizeof count;
        std::vector<T> list(count);
        if (count > 0) std::memcpy(static_cast<void*>(list.data()), all.data() + at, count * sizeof(T));
        at += count * sizeof(T);
        return list;
    }

private:
    std::string all;
    std::size_t at = 0;
};

}  // namespace hilda::granular
