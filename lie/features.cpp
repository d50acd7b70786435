// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/features.hpp"

#include "lie/system.hpp"

namespace hilda::lie {

const std::vector<FeatureText>& all_features()
{
    static const std::vector<FeatureText> all = {
        {Feature::algebraic, "contacts", "evolving contacts"},
        {Feature::regularised, "implicit_friction", "implicit friction"},
        {Feature::nonholonomic, "rolling", "rolling without slip"},
        {Feature::redundant, "redundant_rows", "redundant rows (\"redundant\": \"keep\" in the model file)"},
        {Feature::cones, "rigid_contacts", "rigid contacts (\"normal\": {\"type\": \"dvi\"})"},
        {Feature::history, "history", "loads with a history (friction, plasticity)"},
        {Feature::springs, "implicit_springs", "implicit springs (\"implicit\": true of a force)"}};
    return all;
}

std::vector<std::string> keys_of(Features features)
{
    std::vector<std::string> found;
    for (const FeatureText& f : all_features())
        if (features.contains(f.feature)) found.emplace_back(f.key);
    return found;
}

Features features_of(const System& system)
{
    const Rows& rows = system.pattern();
    Features found;
    if (!rows.algebraic.empty()) found.add(Feature::algebraic);
    if (!rows.regularised.empty()) found.add(Feature::regularised);
    if (rows.velocity_rows > 0) found.add(Feature::nonholonomic);
    if (system.keeps_redundant_rows()) found.add(Feature::redundant);
    if (system.has_cones()) found.add(Feature::cones);
    return found;
}

}  // namespace hilda::lie
