// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_rows.hpp"

#include "lie/state.hpp"

#include <algorithm>

namespace hilda::lie {

double ConeRows::Cone::normal_velocity(const State& x) const
{
    double u_n = 0;
    const auto add = [&](int b, const Mat36& C) {
        if (b < 0) return;
        const Motion& body = x.body[static_cast<std::size_t>(b)];
        u_n += C.block<1, 3>(0, 0).dot(body.rdot) + C.block<1, 3>(0, 3).dot(body.omega_bar);
    };
    add(i, C_i);
    add(j, C_j);
    return u_n;
}

bool ConeRows::has(std::uint64_t key) const
{
    const auto found = std::lower_bound(cone.begin(), cone.end(), key,
                                        [](const Cone& c, std::uint64_t k) { return c.key < k; });
    return found != cone.end() && found->key == key;
}

void ConeRows::add_unlisted(const ConeRows& other)
{
    const auto by_key = [](const Cone& c, const Cone& d) { return c.key < d.key; };
    for (const Cone& c : other.cone)
        if (!has(c.key)) cone.insert(std::upper_bound(cone.begin(), cone.end(), c, by_key), c);
}

}  // namespace hilda::lie
