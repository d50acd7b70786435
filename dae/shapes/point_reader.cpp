// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/shapes/point_reader.hpp"

#include "io/formats/mesh_file.hpp"

namespace hilda::dae {

void note_mesh_keys(ObjectReader& o, std::string_view about_file)
{
    o.note("file", "file",
           {about_file, R"("stone.stl")", R"("minLength": 5, "pattern": "[.]([oO][bB][jJ]|[sS][tT][lL])$")"});
    o.note("scale", R"("type": "number", "exclusiveMinimum": 0, "default": 1)",
           {"Factor of the coordinates of the file [-], for example 0.001 for a file in mm.", "0.001"});
}

MeshKeys read_mesh_keys(ObjectReader& o, std::string_view about_file)
{
    if (!about_file.empty()) note_mesh_keys(o, about_file);
    MeshKeys keys;
    keys.path = o.file("file");
    if (const Json* v = o.find("scale"); v != nullptr) {
        keys.scale = o.number_at(*v, o.pointer("scale"), "scale");
        if (!(keys.scale > 0)) o.fail("scale", "scale must be positive, got " + shortest(keys.scale));
    }
    return keys;
}

std::vector<Vec3> read_mesh_points(const MeshKeys& keys)
{
    std::vector<Vec3> points;
    for (const auto& [x, y, z] :
         io::read_mesh_file(keys.path, MeshKeys::max_bytes, MeshKeys::max_triangles).vertices)
        points.push_back(keys.scale * Vec3(x, y, z));
    return points;
}

Eigen::MatrixXd read_rows(ObjectReader& o, std::string_view key, std::optional<std::size_t> width,
                          const io::About& about)
{
    const Json::List& rows = o.list(key, true, about);
    if (rows.empty()) o.fail(key, std::string(key) + " must not be empty");
    const auto named = [&](std::size_t i) { return std::string(key) + "[" + std::to_string(i) + "]"; };
    if (!width) width = rows[0].list() != nullptr ? rows[0].list()->size() : 1;
    Eigen::MatrixXd all(rows.size(), *width);
    Json::List recorded = rows;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Json::List* row = rows[i].list();
        if (row == nullptr || row->size() != *width)
            o.fail(key, named(i) + " must be a list of " + std::to_string(*width) + " numbers, got " +
                            described(rows[i]));
        for (std::size_t j = 0; j < *width; ++j) {
            double x = 0;
            if (const double* literal = (*row)[j].number(); literal != nullptr) {
                x = *literal;
            } else {
                const std::string at = pointer_to(o.pointer(key), std::to_string(i));
                x = o.number_at((*row)[j], pointer_to(at, std::to_string(j)),
                                named(i) + "[" + std::to_string(j) + "]");
                std::get<Json::List>(recorded[i].value)[j].value = x;
            }
            all(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = x;
        }
    }
    o.record(key, std::move(recorded));
    return all;
}

}  // namespace hilda::dae
