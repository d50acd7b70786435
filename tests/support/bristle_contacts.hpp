// SPDX-License-Identifier: GPL-3.0-or-later
/// A reader for the contacts of a model file that creates a Bristle for each contact.

#pragma once

#include "contact/contact_list.hpp"
#include "dae/model.hpp"
#include "dae/model_types.hpp"
#include "tests/support/bristle.hpp"

namespace hilda::tests {

/// Registers the reader in the constructor and restores the previous reader in the destructor.
struct BristleContacts {
    const dae::ReadContacts previous = dae::contact_reader();

    BristleContacts()
    {
        dae::register_contact_reader([](dae::ObjectReader& model, const dae::PartialModel& to) {
            contact::read_contacts(model, to, read);
        });
    }
    ~BristleContacts() { dae::register_contact_reader(previous); }
    BristleContacts(const BristleContacts&) = delete;
    BristleContacts& operator=(const BristleContacts&) = delete;

    /// Default of `stiffness` [N/m]: the mass of body i in kg times 1 N/(m kg). Default of `most` [m]: a
    /// tenth of the distance of the bodies at the start.
    static bool read(dae::ObjectReader& o, const contact::ContactPair& pair)
    {
        const auto r = [&](int b) { return b == dae::ground ? lie::Vec3(0, 0, 0) : pair.start.body[b].r; };
        const double mass = pair.i == dae::ground ? 1 : pair.model.mass().m[pair.i];
        const double stiffness = o.positive("stiffness", {}, mass);
        const double max_stretch = o.number("most", {}, 0.1 * (r(pair.j) - r(pair.i)).norm());
        if (max_stretch > 10) lie::reject("bristle", "the length must be at most 10 m", max_stretch);
        auto bristle = std::make_unique<Bristle>(pair.i, pair.j, stiffness, max_stretch);
        bristle->name = pair.name;
        pair.model.load(std::move(bristle));
        return false;
    }
};

}  // namespace hilda::tests
