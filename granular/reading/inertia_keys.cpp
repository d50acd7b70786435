// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/reading/inertia_keys.hpp"

#include "granular/core/rigid_body.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

/// A matrix of three rows, row by row
std::array<double, 9> matrix(ObjectReader& o, const std::string& key)
{
    std::array<double, 9> M{};
    const io::Json::List& rows = o.list(key, true);
    const auto fail = [&] {
        o.fail(key, key + " must be one number, three numbers or three rows of three numbers, got " +
                        io::described(*o.find(key)));
    };
    if (rows.size() != 3) fail();
    for (std::size_t i = 0; i < 3; ++i) {
        if (rows[i].list() == nullptr || rows[i].size() != 3) fail();
        const std::string at = o.pointer(key) + '/' + std::to_string(i) + '/';
        for (std::size_t j = 0; j < 3; ++j)
            M[3 * i + j] = o.number_at((*rows[i].list())[j], at + std::to_string(j), key);
    }
    o.record(key, *o.find(key));
    return M;
}

}  // namespace

Inertia read_inertia(ObjectReader& o)
{
    const io::Json* v = o.find("inertia");
    if (v->list() == nullptr) return o.not_negative("inertia");
    Inertia J;
    if (v->size() == 0 || v->list()->front().list() == nullptr) {
        const Vec3 principal = o.vec3("inertia");
        J.xx = principal.x, J.yy = principal.y, J.zz = principal.z;
    } else {
        const auto M = matrix(o, "inertia");
        // Programs that compute the matrix leave rounding errors of its largest entries in all of them.
        const double rounding = 1e-12 * (std::abs(M[0]) + std::abs(M[4]) + std::abs(M[8]));
        for (const auto& [i, j] : {std::pair{0u, 1u}, {1u, 2u}, {2u, 0u}})
            if (!(std::abs(M[3 * i + j] - M[3 * j + i]) <= rounding))
                o.fail("inertia", "inertia must be symmetric, got " + io::shortest(M[3 * i + j]) + " and " +
                                      io::shortest(M[3 * j + i]));
        const auto mean = [&](std::size_t i, std::size_t j) { return M[i] + (M[j] - M[i]) / 2; };
        J = Inertia(std::array{M[0], M[4], M[8], mean(1, 3), mean(5, 7), mean(6, 2)});
    }
    if (!is_inertia(J))
        o.fail(
            "inertia",
            "the principal moments of inertia must be positive, and none larger than the sum of the others, "
            "got " +
                io::described(*v));
    return J;
}

}  // namespace hilda::granular
