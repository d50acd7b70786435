// SPDX-License-Identifier: GPL-3.0-or-later
/// Copies of arrays between the host and the memory of a back end.

#pragma once

#include "granular/backend/engine.hpp"

#include <span>
#include <type_traits>
#include <vector>

namespace hilda::granular::detail {

/// The elements of an array in the memory of the host
template <class Backend, class T>
std::span<const T> to_host(const Backend& on, const par::Array<Backend, T>& from, std::vector<T>& copy)
{
    if constexpr (std::is_same_v<Backend, par::Cpu>) return {from.data(), from.size()};
    copy.resize(from.size());
    par::copy_to_host(on, copy.data(), from.data(), from.size() * sizeof(T));
    return copy;
}

/// The sum of the elements of an array; `copy`: memory of the host
template <class Backend, class Sum>
Sum total(const Backend& on, const par::Array<Backend, Sum>& blocks, std::vector<Sum>& copy)
{
    Sum sum;
    for (const Sum& block : to_host(on, blocks, copy)) sum += block;
    return sum;
}

/// Copies a list to the memory of the back end.
template <class Backend, class T>
void send(const Backend& on, par::Array<Backend, T>& to, const std::vector<T>& from)
{
    to.resize(from.size());
    par::copy_to_device(on, to.data(), from.data(), from.size() * sizeof(T));
}

/// Copies all arrays of a world between the host and the device.
template <class Backend, class To, class From>
void copy(const Backend& on, Arrays<To>& to, Arrays<From>& from)
{
    const auto one = [&](auto& a, auto& b) {
        using T = std::remove_reference_t<decltype(*b.data())>;
        a.resize(b.size());
        if constexpr (std::is_same_v<To, par::Cpu>)
            par::copy_to_host(on, a.data(), b.data(), b.size() * sizeof(T));
        else
            par::copy_to_device(on, a.data(), b.data(), b.size() * sizeof(T));
    };
    auto& p = to.particle;
    auto& q = to.pairs;
    auto& pf = from.particle;
    auto& qf = from.pairs;
    one(p.position, pf.position), one(p.velocity, pf.velocity), one(p.omega, pf.omega);
    one(p.compensation, pf.compensation), one(p.species, pf.species), one(p.id, pf.id), one(p.acc, pf.acc),
        one(p.alpha, pf.alpha);
    one(p.orientation, pf.orientation), one(p.orientation_compensation, pf.orientation_compensation);
    one(p.position_at_build, pf.position_at_build);
    // The host does not use the loads.
    one(q.start, qf.start), one(q.i, qf.i), one(q.j, qf.j), one(q.law, qf.law);
    one(q.in_contact, qf.in_contact), one(q.image, qf.image), one(q.history, qf.history);
    one(q.rotation_history, qf.rotation_history), one(q.internal, qf.internal);
    p.count = pf.count, q.count = qf.count;
    one(to.clump, from.clump);
}

}  // namespace hilda::granular::detail
