// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/contact_group.hpp"

#include "contact/compliant/contact_force.hpp"
#include "contact/compliant/manifold_force.hpp"
#include "contact/detection/near_pairs.hpp"
#include "dae/model.hpp"

#include <algorithm>

namespace hilda::contact {

std::unique_ptr<dae::Force> compliant_contact(const std::string& name, const dae::Model& model, int i,
                                              const Shape& shape_i, int j, const Shape& shape_j,
                                              std::shared_ptr<const NormalLaw> law,
                                              std::shared_ptr<const FrictionModel> friction)
{
    if (ManifoldForce::has_several_points(shape_i, shape_j))
        return std::make_unique<ManifoldForce>(name, model, i, shape_i, j, shape_j, std::move(law),
                                               std::move(friction));
    return std::make_unique<ContactForce>(name, model, i, shape_i, j, shape_j, std::move(law),
                                          std::move(friction));
}

ContactGroup::ContactGroup(std::string name, const dae::Model& model, ContactPairs pairs, Shape shape_i,
                           Shape shape_j, std::shared_ptr<const NormalLaw> law,
                           std::shared_ptr<const FrictionModel> friction)
    : name(std::move(name)), shape_i(std::move(shape_i)), shape_j(std::move(shape_j)), model(model),
      of(std::move(pairs)), law(std::move(law)), friction(std::move(friction))
{
    first_force = force(of.first_number());
}

bool ContactGroup::may_have(const NormalLaw& law)
{
    return !(law.force({.overlap = -1, .overlap_rate = 0, .curvature = 1, .m = 1}) > 0);
}

std::array<int, 2> ContactGroup::bodies(int number) const
{
    const auto [i, j] = of.pair(number);
    return {i, j};
}

std::unique_ptr<dae::Force> ContactGroup::force(int number) const
{
    const auto [i, j] = of.pair(number);
    return compliant_contact(of.name_of_pair(model, name, i, j), model, i, shape_i, j, shape_j, law,
                             friction);
}

double ContactGroup::reach(int body) const
{
    double smallest = -1;
    const auto add = [&](bool is_member, const Shape& shape) {
        if (!is_member) return;
        const double r = reach_about_centre(shape);
        smallest = smallest < 0 ? r : std::min(smallest, r);
    };
    add(of.place_in_first(body) >= 0, shape_i);
    add(of.place_in_second(body) >= 0, shape_j);
    return smallest;
}

void ContactGroup::find(const std::vector<Motion>& body, std::span<const double> motion,
                        std::vector<int>& numbers) const
{
    tests += find_near_pairs(of, shape_i, shape_j, body, motion, numbers);
}

}  // namespace hilda::contact
