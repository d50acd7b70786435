// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kinematics/prescribed_motion.hpp"

#include "io/error.hpp"
#include "io/formats/csv_table.hpp"
#include "io/json.hpp"
#include "io/json_source.hpp"
#include "io/nearest.hpp"
#include "lie/so3.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hilda::run {

namespace {

constexpr const char* time_column = "t";

io::Json samples(const std::vector<double>& t, const std::vector<double>& f, double offset = 0)
{
    io::Json::List values;
    for (const double x : f) values.emplace_back(x + offset);
    io::Json motion = io::Json::object();
    motion["t"] = io::Json::List(t.begin(), t.end());
    motion["f"] = std::move(values);
    return motion;
}

std::string text_of(const io::Json& object, const char* key)
{
    const io::Json::Member* member = object.member(key);
    const std::string* text = member == nullptr ? nullptr : member->value.string();
    return text == nullptr ? "" : *text;
}

lie::Vec3 vector_of(const io::Json& object, const char* key)
{
    lie::Vec3 v = lie::Vec3::Zero();
    if (const io::Json::Member* member = object.member(key); member != nullptr && member->value.list())
        for (int k = 0; k < 3; ++k) v[k] = *(*member->value.list())[static_cast<std::size_t>(k)].number();
    return v;
}

lie::Motion motion_of(const dae::Description& d, const std::string& body)
{
    for (int b = 0; b < d.model->bodies(); ++b)
        if (d.model->body_name(b) == body) return d.x.body[static_cast<std::size_t>(b)];
    return {};  // the ground
}

/// The driver of a revolute or translational joint, from the canonical form of the joint
io::Json drive_of(const dae::Description& d, const io::Json& joint, const std::vector<double>& t,
                  const std::vector<double>& f)
{
    const bool rotates = text_of(joint, "type") == "revolute";
    io::Json drive = {{"name", text_of(joint, "name") + " drive"},
                      {"type", rotates ? "hinge-driver" : "DP2"},
                      {"body_i", text_of(joint, "body_i")},
                      {"body_j", text_of(joint, "body_j")}};
    if (rotates) {
        drive["axis_bar_i"] = joint.member("axis_bar_i")->value;
        drive["axis_bar_j"] = joint.member("axis_bar_j")->value;
        drive["angle"] = samples(t, f);
        return drive;
    }
    const lie::Motion i = motion_of(d, text_of(joint, "body_i")), j = motion_of(d, text_of(joint, "body_j"));
    const lie::Vec3 axis = vector_of(joint, "axis_bar_i").normalized();
    const double now =
        (i.A * axis)
            .dot(j.r + j.A * vector_of(joint, "s_bar_q_j") - i.r - i.A * vector_of(joint, "s_bar_p_i"));
    drive["a_bar_i"] = {axis[0], axis[1], axis[2]};
    for (const char* key : {"s_bar_p_i", "s_bar_q_j"})
        if (joint.member(key) != nullptr) drive[key] = joint.member(key)->value;
    drive["f"] = samples(t, f, now - f.front());
    return drive;
}

/// A column of numbers. Throws io::InvalidInput for an empty field.
std::vector<double> finite_values(const io::CsvTable& table, const std::string& column)
{
    std::vector<double> all = table.values(column);
    for (std::size_t k = 0; k < all.size(); ++k)
        if (!std::isfinite(all[k]))
            throw io::InvalidInput(fmt::format("{}: row {}: {} must be a finite number, got {}", table.file,
                                               k + 1, column, all[k]));
    return all;
}

}  // namespace

dae::Description with_motion(const dae::Description& d, const std::string& file)
{
    const io::CsvTable table = io::read_csv_table(file);
    const std::vector<double> t = finite_values(table, time_column);
    if (table.columns.size() < 2)
        throw io::InvalidInput(file + ": there must be a column for a joint or a driver, besides t");
    io::Json root = io::JsonSource(d.text, d.name).root;
    std::vector<std::string> known;
    auto& constraints = std::get<io::Json::List>(root["constraints"].value);
    for (const io::Json& c : constraints) known.push_back(text_of(c, "name"));
    for (const std::string& name : table.columns) {
        if (name == time_column) continue;
        const auto at = std::find(known.begin(), known.end(), name);
        if (at == known.end())
            throw io::InvalidInput(file + ": the model has no joint or driver" +
                                   io::with_nearest(name, known));
        io::Json& constraint = constraints[static_cast<std::size_t>(at - known.begin())];
        const std::string type = text_of(constraint, "type");
        const std::vector<double> f = finite_values(table, name);
        const bool is_driver = constraint.member("f") != nullptr || constraint.member("angle") != nullptr;
        if (is_driver)
            constraint[constraint.member("f") != nullptr ? "f" : "angle"] = samples(t, f);
        else if (type == "revolute" || type == "translational")
            constraints.push_back(drive_of(d, io::Json(constraint), t, f));
        else
            throw io::InvalidInput(file + ": column " + name +
                                   ": a motion can be that of a driver, a revolute "
                                   "or a translational joint, and the type of '" +
                                   name + "' is " + type);
    }
    root["end"] = t.back();
    return dae::read_model(io::written(root), d.name + " with the motion of " + file);
}

}  // namespace hilda::run
