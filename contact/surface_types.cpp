// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface_types.hpp"

#include "contact/tangent_basis.hpp"

namespace hilda::contact {

namespace {

Mat3 read_axes(dae::ObjectReader& o, const std::string& z)
{
    if (z.empty() || o.find(z) == nullptr) return dae::read_orientation(o);
    for (const char* other : {"A", "p", "axis_angle", "euler_angles"})
        if (o.has(other)) o.fail(other, "the orientation must be given once, got " + z + " and " + other);
    const Vec3 n = o.direction(z).normalized();
    Mat3 axes;
    axes << tangent_basis(n), n;
    return axes + Mat3::Zero();  // turns -0 into 0 for the canonical text
}

}  // namespace

Shape read_shape(dae::ObjectReader& parent, std::string_view key)
{
    io::Json canonical;
    Shape shape = read_shape(parent, key, canonical);
    parent.record(key, std::move(canonical));
    return shape;
}

Shape read_shape(dae::ObjectReader& parent, std::string_view key, io::Json& canonical)
{
    dae::ObjectReader o = parent.object(key);
    using Types = io::Registry<SurfaceType>;
    const SurfaceType& type = *Types::find(o.one_of("type", Types::names()));
    Shape shape;
    shape.surface = type.read(o);
    shape.position = o.vec3("position", Vec3::Zero());
    shape.orientation = read_axes(o, type.z);
    o.record("A", dae::json(shape.orientation));

    canonical = o.finish();
    std::erase_if(std::get<dae::Json::Object>(canonical.value), [&](const dae::Json::Member& k) {
        return k.key == "p" || k.key == "axis_angle" || k.key == "euler_angles" ||
               (k.key == type.z && !type.z.empty());
    });
    return shape;
}

Vec3 read_semi_axes(dae::ObjectReader& o)
{
    Vec3 semi_axes = o.vec3("semi_axes");
    if (!(semi_axes.minCoeff() > 0))
        o.fail("semi_axes", "semi_axes must be positive, got " + dae::described(*o.find("semi_axes")));
    return semi_axes;
}

Eigen::MatrixXd read_rows(dae::ObjectReader& o, std::string_view key, std::optional<std::size_t> width)
{
    const dae::Json::List& rows = o.list(key, true);
    if (rows.empty()) o.fail(key, std::string(key) + " must not be empty");
    const auto named = [&](std::size_t i) { return std::string(key) + "[" + std::to_string(i) + "]"; };
    if (!width) width = rows[0].list() != nullptr ? rows[0].list()->size() : 1;
    Eigen::MatrixXd all(rows.size(), *width);
    dae::Json::List recorded = rows;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const dae::Json::List* row = rows[i].list();
        if (row == nullptr || row->size() != *width)
            o.fail(key, named(i) + " must be a list of " + std::to_string(*width) + " numbers, got " +
                            dae::described(rows[i]));
        for (std::size_t j = 0; j < *width; ++j) {
            double x = 0;
            if (const double* literal = (*row)[j].number(); literal != nullptr) {
                x = *literal;
            } else {
                const std::string at = dae::pointer_to(o.pointer(key), std::to_string(i));
                x = o.number_at((*row)[j], dae::pointer_to(at, std::to_string(j)),
                                named(i) + "[" + std::to_string(j) + "]");
                std::get<dae::Json::List>(recorded[i].value)[j].value = x;
            }
            all(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = x;
        }
    }
    o.record(key, std::move(recorded));
    return all;
}

}  // namespace hilda::contact

template class hilda::io::Registry<hilda::contact::SurfaceType>;
