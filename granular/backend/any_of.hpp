// SPDX-License-Identifier: GPL-3.0-or-later
/// One of several laws, chosen when a case is read: a tagged union that a GPU can take apart too.

#pragma once

#include "granular/backend/real.hpp"

#include <cstring>
#include <string>
#include <type_traits>

namespace hilda::granular {

template <class... Laws>
class AnyOf {
public:
    AnyOf() = default;
    template <class Law>
    requires(std::is_same_v<Law, Laws> || ...) AnyOf(const Law& law)
    {
        static_assert(std::is_trivially_copyable_v<Law> && sizeof(Law) <= sizeof bytes);
        int k = 0;
        ((std::is_same_v<Law, Laws> ? void(kind = k++) : void(k++)), ...);
        std::memcpy(bytes, &law, sizeof law);
    }

    /// Calls f with the law that this is.
    template <class F>
    HILDA_HD void visit(const F& f) const
    {
        int k = 0;
        ((kind == k++ ? f(*reinterpret_cast<const Laws*>(bytes)) : void()), ...);
    }
    template <class Law>
    bool is() const
    {
        bool yes = false;
        visit([&]<class Found>(const Found&) { yes = std::is_same_v<Law, Found>; });
        return yes;
    }

    /// Makes a law of this name out of its keys; false where no law has it.
    template <class Keys>
    bool read(const std::string& name, Keys& keys)
    {
        bool found = false;
        ((name == Laws::name ? void((*this = Laws::read(keys), found = true)) : void()), ...);
        return found;
    }
    static std::string names()
    {
        std::string all;
        ((all += (all.empty() ? "" : ", ") + std::string(Laws::name)), ...);
        return all;
    }

private:
    int kind = 0;
    alignas(8) unsigned char bytes[32] = {};
};

}  // namespace hilda::granular
