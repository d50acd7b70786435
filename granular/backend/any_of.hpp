// SPDX-License-Identifier: GPL-3.0-or-later
/// Tagged union of force laws, selected when a case is read. It is used instead of virtual functions, which a
/// GPU kernel cannot call through pointers of the host.

#pragma once

#include "granular/backend/real.hpp"

#include <cstring>
#include <string>
#include <type_traits>

namespace hilda::granular {

/// One of the given laws, which are trivially copyable and at most 32 bytes long. The default is the first
/// law with all parameters zero.
template <class... Laws>
class AnyOf {
public:
    AnyOf() = default;
    template <class Law>
    requires(std::is_same_v<Law, Laws> || ...) AnyOf(const Law& law)
    {
        static_assert(std::is_trivially_copyable_v<Law>, "a force law has plain numbers as members only");
        static_assert(sizeof(Law) <= sizeof bytes, "the parameters of a force law take at most 32 bytes");
        int k = 0;
        ((std::is_same_v<Law, Laws> ? void(index = k++) : void(k++)), ...);
        std::memcpy(bytes, &law, sizeof law);
    }

    /// Calls f with the stored law.
    template <class F>
    HILDA_HD void visit(const F& f) const
    {
        int k = 0;
        ((index == k++ ? f(*reinterpret_cast<const Laws*>(bytes)) : void()), ...);
    }
    /// Whether the stored law is of type Law
    template <class Law>
    bool is() const
    {
        bool result = false;
        visit([&]<class Found>(const Found&) { result = std::is_same_v<Law, Found>; });
        return result;
    }

    /// Whether both have the same law, with any parameters
    bool is_same_law(const AnyOf& other) const { return index == other.index; }

    /// Reads the law with this name from its keys; false if no law has the name.
    template <class Keys>
    bool read(const std::string& name, Keys& keys)
    {
        bool found = false;
        ((name == Laws::name ? void((*this = Laws::read(keys), found = true)) : void()), ...);
        return found;
    }
    /// Calls f with a value of each law, in the order of the list.
    template <class F>
    static void for_each(const F& f)
    {
        (f(Laws{}), ...);
    }

private:
    int index = 0;
    alignas(8) unsigned char bytes[32] = {};
};

}  // namespace hilda::granular
