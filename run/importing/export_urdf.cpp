// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/importing/export_urdf.hpp"

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "run/named_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <queue>
#include <set>

namespace hilda::run {

namespace {

using io::Json;
using lie::Mat3;
using lie::Vec3;

std::string numbers(const Vec3& v) { return fmt::format("{} {} {}", v.x() + 0., v.y() + 0., v.z() + 0.); }

/// Roll, pitch and yaw of A = R_z(yaw) R_y(pitch) R_x(roll). Any roll is right at a pitch of ± 90 degrees;
/// the yaw is that of A R_x(-roll).
Vec3 roll_pitch_yaw(const Mat3& A)
{
    const double roll = std::atan2(A(2, 1), A(2, 2)), s = std::sin(roll), c = std::cos(roll);
    return {roll, std::atan2(-A(2, 0), std::hypot(A(2, 1), A(2, 2))),
            std::atan2(s * A(0, 2) - c * A(0, 1), c * A(1, 1) - s * A(1, 2))};
}

std::string origin(const Vec3& p, const Mat3& A)
{
    return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>", numbers(p), numbers(roll_pitch_yaw(A)));
}

std::string quoted(const std::string& text)
{
    std::string all;
    for (const char c : text)
        all += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
    return all;
}

/// 0 if it is no number
double number(const Json& of)
{
    const double* const value = of.number();
    return value == nullptr ? 0 : *value;
}

Vec3 vector(const Json& of)
{
    Vec3 v;
    for (int c = 0; c < 3; ++c) v[c] = number(of.at(static_cast<size_t>(c)));
    return v;
}

struct Joint {
    std::string name, type;
    int i = -1, j = -1;
    Vec3 P = Vec3::Zero(), Q = Vec3::Zero();  ///< on bodies i and j, relative to their centres of mass
    Vec3 axis_i = Vec3::UnitX(), axis_j = Vec3::UnitX();
    double damping = 0;
};

class Writer {
public:
    Writer(const dae::Description& d, std::vector<std::string>& left_out)
        : d(d), body(d.model->all_bodies()), left_out(left_out), source(d.text, d.name, d.text.size() + 1)
    {}

    std::string text()
    {
        read();
        find_parents();
        for (const dae::Body& of : body) link_names.insert(of.name);
        for (const Joint& of : joint) joint_names.insert(of.name);
        root = unused("world", link_names);
        std::string all = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"{}\"/>\n",
                                      quoted(d.name), root);
        for (size_t n = 0; n < body.size(); ++n) all += link(static_cast<int>(n));
        for (size_t n = 0; n < body.size(); ++n) all += joint_of(static_cast<int>(n));
        return all + "</robot>\n";
    }

private:
    [[noreturn]] void refuse(const std::string& why) const { throw io::InvalidInput(d.name + ": " + why); }

    const Json& at(const Json& of, const char* key) const
    {
        const Json::Member* member = of.member(key);
        static const Json none;
        return member == nullptr ? none : member->value;
    }
    std::string word(const Json& of, const char* key) const
    {
        const std::string* text = at(of, key).string();
        return text == nullptr ? "" : *text;
    }
    int number_of(const std::string& name) const
    {
        for (size_t n = 0; n < body.size(); ++n)
            if (body[n].name == name) return static_cast<int>(n);
        return -1;
    }

    void read()
    {
        const Json &constraints = at(source.root, "constraints"), &forces = at(source.root, "forces");
        for (size_t k = 0; k < constraints.size(); ++k) {
            const Json& of = constraints.at(k);
            Joint one{.name = word(of, "name"), .type = word(of, "type")};
            if (one.type != "revolute" && one.type != "translational" && one.type != "fixed")
                refuse(
                    fmt::format("constraint '{}': {} has no counterpart in URDF; allowed are revolute, "
                                "translational and fixed",
                                one.name, one.type));
            one.i = number_of(word(of, "body_i"));
            one.j = number_of(word(of, "body_j"));
            if (at(of, "s_bar_p_i").size() == 3) one.P = vector(at(of, "s_bar_p_i"));
            if (at(of, "s_bar_q_j").size() == 3) one.Q = vector(at(of, "s_bar_q_j"));
            if (at(of, "axis_bar_i").size() == 3) one.axis_i = vector(at(of, "axis_bar_i"));
            if (at(of, "axis_bar_j").size() == 3) one.axis_j = vector(at(of, "axis_bar_j"));
            joint.push_back(one);
        }
        for (size_t k = 0; k < forces.size(); ++k) add_force(forces.at(k));
        if (at(source.root, "contacts").size() > 0) left_out.emplace_back("contacts");
        const Vec3 g =
            at(source.root, "gravity").size() == 3 ? vector(at(source.root, "gravity")) : Vec3::Zero();
        if (g != Vec3(0, 0, -9.81))
            left_out.push_back(
                fmt::format("gravity ({}), which a program that reads the file sets", numbers(g)));
        for (const lie::Motion& b : d.x.body)
            if (b.rdot.norm() + b.omega_bar.norm() > 0) {
                left_out.emplace_back("initial velocities");
                break;
            }
    }

    void add_force(const Json& of)
    {
        const int i = number_of(word(of, "body_i")), j = number_of(word(of, "body_j"));
        const double damping = number(at(of, "damping"));
        for (Joint& one : joint) {
            const bool same_pair = (one.i == i && one.j == j) || (one.i == j && one.j == i);
            if (word(of, "type") != "torsion-spring" || !same_pair || one.type != "revolute") continue;
            one.damping += damping;
            if (number(at(of, "stiffness")) == 0) return;
        }
        left_out.push_back("force '" + word(of, "name") + "'");
    }

    /// Follows the joints from the ground, and from bodies that no joint connects with it.
    void find_parents()
    {
        parent_joint.assign(body.size(), -1);
        std::vector<bool> found(body.size(), false), used(joint.size(), false);
        const auto follow = [&](int root) {
            std::queue<int> next;
            for (next.push(root); !next.empty(); next.pop()) {
                const int n = next.front();
                for (size_t k = 0; k < joint.size(); ++k) {
                    if (used[k] || (joint[k].i != n && joint[k].j != n)) continue;
                    used[k] = true;
                    const int other = joint[k].i == n ? joint[k].j : joint[k].i;
                    if (other < 0 || found[other])
                        refuse("constraint '" + joint[k].name + "' closes a loop; URDF files are trees");
                    found[other] = true;
                    parent_joint[other] = static_cast<int>(k);
                    next.push(other);
                }
            }
        };
        follow(-1);
        for (size_t n = 0; n < body.size(); ++n)
            if (!found[n]) found[n] = true, follow(static_cast<int>(n));
    }

    /// The joint of a body with its parent is seen from the body.
    bool is_reversed(int n) const { return joint[parent_joint[n]].i == n; }
    /// Origin of the frame of the link of a body, relative to its centre of mass, in its frame
    Vec3 frame_at(int n) const
    {
        if (n < 0 || parent_joint[n] < 0) return Vec3::Zero();
        const Joint& of = joint[parent_joint[n]];
        return is_reversed(n) ? of.P : of.Q;
    }

    std::string link(int n) const
    {
        const dae::Body& of = body[n];
        const Mat3& J = of.J_bar;
        return fmt::format(
            "  <link name=\"{}\">\n    <inertial>\n      {}\n      <mass value=\"{}\"/>\n"
            "      <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n"
            "    </inertial>\n  </link>\n",
            quoted(of.name), origin(-frame_at(n), Mat3::Identity()), of.m, J(0, 0), J(0, 1), J(0, 2), J(1, 1),
            J(1, 2), J(2, 2));
    }

    /// The name, with a number if it is one of these, to which it is added
    static std::string unused(const std::string& name, std::set<std::string>& names)
    {
        std::string own = name;
        for (int k = 2; !names.insert(own).second; ++k) own = fmt::format("{}_{}", name, k);
        return own;
    }

    std::string joint_of(int n)
    {
        const lie::Motion& own = d.x.body[n];
        const Vec3 at = own.r + own.A * frame_at(n);
        if (parent_joint[n] < 0)
            return fmt::format(
                "  <joint name=\"{}\" type=\"floating\"><parent link=\"{}\"/>"
                "<child link=\"{}\"/>{}</joint>\n",
                quoted(unused(body[n].name + "_free", joint_names)), root, quoted(body[n].name),
                origin(at, own.A));
        const Joint& of = joint[parent_joint[n]];
        const int p = is_reversed(n) ? of.j : of.i;
        lie::Motion parent;
        if (p >= 0) parent = d.x.body[p];
        const Vec3 from = parent.r + parent.A * frame_at(p);
        const bool is_revolute = of.type == "revolute", is_fixed = of.type == "fixed";
        const char* const type = is_fixed ? "fixed" : is_revolute ? "continuous" : "prismatic";
        std::string all = fmt::format(
            "  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{}\"/><child link=\"{}\"/>\n    {}\n",
            quoted(of.name), type, p < 0 ? root : quoted(body[p].name), quoted(body[n].name),
            origin(parent.A.transpose() * (at - from), parent.A.transpose() * own.A));
        if (!is_fixed) {
            const Vec3 axis = (is_reversed(n) ? of.axis_i : of.axis_j).normalized();
            all += fmt::format("    <axis xyz=\"{}\"/>\n", numbers(axis));
            if (!is_revolute)
                all += "    <limit lower=\"-1e9\" upper=\"1e9\" effort=\"1e9\" velocity=\"1e9\"/>\n";
            if (of.damping != 0) all += fmt::format("    <dynamics damping=\"{}\"/>\n", of.damping);
        }
        return all + "  </joint>\n";
    }

    const dae::Description& d;
    const std::vector<dae::Body>& body;
    std::vector<std::string>& left_out;
    const io::JsonSource source;
    std::vector<Joint> joint;
    std::set<std::string> link_names, joint_names;
    std::string root;               ///< name of the link of the ground
    std::vector<int> parent_joint;  ///< of each body: index in `joint`; -1: free
};

}  // namespace

std::string urdf_text(const dae::Description& model, std::vector<std::string>& left_out)
{
    return Writer(model, left_out).text();
}

int export_model(const ExportOptions& options)
{
    dae::Description d = named_model(options.model, {}, "", options.allow_paths);
    dae::start(d);
    std::vector<std::string> left_out;
    const std::string text = urdf_text(d, left_out);
    if (options.output.empty() && d.name.find('/') != std::string::npos)
        throw io::InvalidInput("export: the name of the model, " + io::in_quotes(d.name) +
                               ", contains a /; --output gives the name of the file");
    const std::string output = options.output.empty() ? d.name + ".urdf" : options.output;
    std::error_code error;
    if (std::filesystem::exists(output, error) && !options.force)
        throw io::InvalidInput(output + ": the file exists; --force replaces it");
    io::write_named_file(output, text);
    for (const std::string& what : left_out) io::warning(d.name + ": not exported: " + what);
    std::cout << "written       " << output << '\n';
    return io::exit_code::done;
}

}  // namespace hilda::run
