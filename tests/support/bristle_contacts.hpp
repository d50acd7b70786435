// SPDX-License-Identifier: GPL-3.0-or-later
/// A reader of the contacts of a model file, which makes bristles of them.

#pragma once

#include "dae/model_file_types.hpp"
#include "tests/support/bristle.hpp"

namespace hilda::tests {

/// Enrolled for as long as it lives; then the reader before it is back.
struct BristleContacts {
    const dae::ReadContact before = dae::contact_reader();

    BristleContacts() { dae::register_contact_reader(read); }
    ~BristleContacts() { dae::register_contact_reader(before); }
    BristleContacts(const BristleContacts&) = delete;
    BristleContacts& operator=(const BristleContacts&) = delete;

    /// Stiffness is by default as many N/m as body i has kg, and the length is a tenth of the distance at the
    /// start.
    static void read(dae::ObjectReader& o, const dae::ContactPair& pair)
    {
        const auto r = [&](int b) { return b == dae::ground ? lie::Vec3(0, 0, 0) : pair.start.body[b].r; };
        const double mass = pair.i == dae::ground ? 1 : pair.model.mass().m[pair.i];
        const double stiffness = o.positive("stiffness", mass);
        const double most = o.number("most", 0.1 * (r(pair.j) - r(pair.i)).norm());
        if (most > 10) lie::reject("bristle", "the length must be at most 10 m", most);
        auto bristle = std::make_unique<Bristle>(pair.i, pair.j, stiffness, most);
        bristle->name = pair.name;
        pair.model.load(std::move(bristle));
    }
};

}  // namespace hilda::tests
