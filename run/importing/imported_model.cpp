// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/importing/imported_model.hpp"

#include "io/error.hpp"
#include "io/json_source.hpp"
#include "run/importing/imported_contacts.hpp"
#include "run/importing/imported_surface.hpp"

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace hilda::run {

namespace {

using lie::Mat3;
using lie::Vec3;

/// Largest deviation of axes that are parallel or perpendicular, and of points that coincide relative to the
/// size of the model
constexpr double tolerance = 1e-9;

io::Json list(const Vec3& v)
{
    io::Json all = io::Json::array();
    for (const double x : v) all.push_back(x == 0 ? 0. : x);  // without the sign of zero
    return all;
}

io::Json list(const Mat3& M)
{
    io::Json all = io::Json::array();
    for (int i = 0; i < 3; ++i) all.push_back(list(Vec3(M.row(i).transpose())));
    return all;
}

bool are_parallel(const Vec3& a, const Vec3& b) { return a.cross(b).norm() <= tolerance; }
bool are_perpendicular(const Vec3& a, const Vec3& b) { return std::abs(a.dot(b)) <= tolerance; }

class ModelWriter {
public:
    ModelWriter(ImportedModel& from, const std::string& file) : from(from), file(file), body(from.bodies) {}

    std::string text()
    {
        weld();
        io::Json all = {{"hilda_model", 1L}, {"name", from.name}, {"gravity", list(from.gravity)}};
        if (from.balances_inertia) balance();
        io::Json contacts;
        if (from.imports_contacts) contacts = imported_contacts(from, body, owners, file);
        if (!from.warnings.empty()) all["note"] = note(from.warnings);
        all["bodies"] = io::Json::array();
        for (size_t n = 0; n < body.size(); ++n)
            if (moves(n)) all["bodies"].push_back(body_json(n));
        if (all["bodies"].size() == 0) refuse("the model", "has no body that moves");
        for (size_t n = 0; n < body.size(); ++n)
            if (moves(n)) add_joints(n);
        for (const ImportedLoop& loop : from.loops) {
            io::Json one = pair(loop.name, loop.is_weld ? "fixed" : "spherical", owner(loop.i), owner(loop.j),
                                constraint_names);
            if (!loop.is_weld) add_points(one, owner(loop.i), loop.point, owner(loop.j), loop.point);
            constraints.push_back(std::move(one));
        }
        all["constraints"] = std::move(constraints);
        all["forces"] = std::move(forces);
        if (from.imports_contacts) all["contacts"] = std::move(contacts);
        return io::written(all) + "\n";
    }

private:
    /// The warnings, or the numbers of those of a kind if they are too long for a key of a model file
    static std::string note(const std::vector<std::string>& warnings)
    {
        constexpr size_t most = 4000;  // [byte]
        const auto listed = [](const std::vector<std::string>& all) {
            std::string text = "Not imported:";
            for (const std::string& one : all) text += ' ' + one + ';';
            text.back() = '.';
            return text;
        };
        if (std::string text = listed(warnings); text.size() <= most) return text;
        std::vector<std::string> kinds, counts;
        std::map<std::string, long> number;
        for (const std::string& warning : warnings) {
            const std::string kind = warning.substr(0, warning.find(" '"));
            if (number[kind]++ == 0) kinds.push_back(kind);
        }
        for (const std::string& kind : kinds) counts.push_back(fmt::format("{} ({})", kind, number[kind]));
        std::string text = listed(counts);
        while (text.size() > most) {  // many kinds
            counts.pop_back();
            text = listed(counts) + " And others.";
        }
        return text;
    }

    /// Replaces principal moments that no body has by their mean, as the option balanceinertia of MuJoCo
    /// does.
    void balance()
    {
        for (size_t n = 0; n < body.size(); ++n) {
            if (!moves(n)) continue;
            const Mat3 J = 0.5 * (body[n].J_bar + body[n].J_bar.transpose());
            const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(J, Eigen::EigenvaluesOnly).eigenvalues();
            if (moments[0] + moments[1] >= moments[2]) continue;
            from.warnings.push_back(
                fmt::format("inertia of body '{}', whose principal moments {:.4g}, {:.4g} and {:.4g} violate "
                            "the triangle "
                            "inequality and are replaced by their mean",
                            body[n].name, moments[0], moments[1], moments[2]));
            body[n].J_bar = moments.mean() * Mat3::Identity();
        }
    }

    [[noreturn]] void refuse(const std::string& what, const std::string& why) const
    {
        throw io::InvalidInput(file + ": " + what + ": " + why);
    }
    bool moves(size_t n) const { return !body[n].joints.empty(); }
    /// The body to which a body is welded; -1: the ground
    int owner(int n) const { return n < 0 ? -1 : owners[static_cast<size_t>(n)]; }

    /// Adds the masses and inertias of welded bodies to those of their owners.
    void weld()
    {
        for (size_t n = 0; n < body.size(); ++n) {
            owners.push_back(moves(n) ? static_cast<int>(n) : owner(body[n].parent));
            if (moves(n) || owners[n] < 0 || (body[n].m == 0 && body[n].J_bar.isZero(0))) continue;
            ImportedBody& to = body[static_cast<size_t>(owners[n])];
            const ImportedBody& part = body[n];
            if (to.m == 0) to.name = part.name;  // a frame without mass
            const double m = to.m + part.m;
            const Vec3 r = m > 0 ? Vec3((to.m * to.r + part.m * part.r) / m) : to.r;
            const auto about_r = [&](const ImportedBody& of) {
                const Vec3 d = of.r - r;
                return Mat3(of.A * of.J_bar * of.A.transpose() +
                            of.m * (d.squaredNorm() * Mat3::Identity() - d * d.transpose()));
            };
            to.J_bar = (to.A.transpose() * (about_r(to) + about_r(part)) * to.A).eval();
            to.r = r;
            to.m = m;
        }
    }

    std::string name_of(int n) const { return n < 0 ? "ground" : body[static_cast<size_t>(n)].name; }

    io::Json body_json(size_t n) const
    {
        const ImportedBody& of = body[n];
        const std::string what = "body '" + of.name + "'";
        if (!(of.m > 0))
            refuse(what, fmt::format("it moves (joint '{}') and has no mass", of.joints[0].name));
        const Mat3 J_bar = 0.5 * (of.J_bar + of.J_bar.transpose());
        if (!(J_bar.diagonal().minCoeff() > 0))
            refuse(what, fmt::format("it moves (joint '{}') and has no inertia", of.joints[0].name));
        const Mat3 beside = J_bar - Mat3(J_bar.diagonal().asDiagonal());
        const bool is_diagonal = beside.cwiseAbs().maxCoeff() <= 1e-14 * J_bar.diagonal().maxCoeff();
        io::Json one = {{"name", of.name}, {"mass", of.m}};
        one["inertia"] = is_diagonal ? list(Vec3(J_bar.diagonal())) : list(J_bar);
        one["r"] = list(of.r);
        if (of.A != Mat3::Identity()) one["A"] = list(of.A);
        return one;
    }

    Vec3 in_body(int n, const Vec3& v) const
    {
        return n < 0 ? v : Vec3(body[static_cast<size_t>(n)].A.transpose() * v);
    }
    Vec3 point_bar(int n, const Vec3& p) const
    {
        return n < 0 ? p : in_body(n, p - body[static_cast<size_t>(n)].r);
    }
    /// `names`: of the entries before. A name that is among them gets a number.
    io::Json pair(const std::string& name, const std::string& type, int i, int j,
                  std::set<std::string>& names) const
    {
        if (i == j) refuse("'" + name + "'", "its two bodies are welded together");
        std::string own = name;
        for (int k = 2; !names.insert(own).second; ++k) own = fmt::format("{}_{}", name, k);
        return {{"name", own}, {"type", type}, {"body_i", name_of(i)}, {"body_j", name_of(j)}};
    }
    void add_points(io::Json& to, int i, const Vec3& P, int j, const Vec3& Q) const
    {
        to["s_bar_p_i"] = list(point_bar(i, P));
        to["s_bar_q_j"] = list(point_bar(j, Q));
    }
    void add_axes(io::Json& to, int i, const Vec3& axis_i, int j, const Vec3& axis_j) const
    {
        to["axis_bar_i"] = list(in_body(i, axis_i));
        to["axis_bar_j"] = list(in_body(j, axis_j));
    }

    void add_joints(size_t n)
    {
        const int j = static_cast<int>(n), i = owner(body[n].parent);
        const std::vector<ImportedJoint>& joints = body[n].joints;
        const std::string name = joint_name(joints);
        const auto add = [&](const char* type, const Vec3& anchor, const Vec3* axis_i, const Vec3* axis_j) {
            io::Json one = pair(name, type, i, j, constraint_names);
            add_points(one, i, anchor, j, anchor);
            if (axis_i != nullptr) add_axes(one, i, *axis_i, j, *axis_j);
            constraints.push_back(std::move(one));
        };
        const Vec3 &anchor = joints.front().anchor, &axis = joints.front().axis;
        const std::string kinds = kinds_of(joints);
        if (kinds == "free") {
            refuse_springs(joints);
        } else if (kinds == "ball" ||
                   (kinds == "hinge hinge hinge" && have_common_anchor(joints) &&
                    !are_parallel(axis, joints[1].axis) && !are_parallel(joints[1].axis, joints[2].axis))) {
            refuse_springs(joints);
            add("spherical", anchor, nullptr, nullptr);
        } else if (kinds == "hinge") {
            add("revolute", anchor, &axis, &axis);
            add_springs(joints, i, j, anchor);
        } else if (kinds == "slide") {
            add("translational", anchor, &axis, &axis);
            add_springs(joints, i, j, anchor);
        } else if (kinds == "hinge hinge" && have_common_anchor(joints) &&
                   are_perpendicular(axis, joints[1].axis)) {
            refuse_springs(joints);
            add("universal", anchor, &axis, &joints[1].axis);
        } else if ((kinds == "hinge slide" || kinds == "slide hinge") && are_parallel(axis, joints[1].axis)) {
            const Vec3& on_axis = joints[kinds == "hinge slide" ? 0 : 1].anchor;
            add("cylindrical", on_axis, &axis, &axis);
            add_springs(joints, i, j, on_axis);
        } else if (kinds == "slide slide hinge" && are_perpendicular(axis, joints[2].axis) &&
                   are_perpendicular(joints[1].axis, joints[2].axis) && !are_parallel(axis, joints[1].axis)) {
            refuse_springs(joints);
            add("planar", joints[2].anchor, &joints[2].axis, &joints[2].axis);
        } else {
            refuse(
                "body '" + body[n].name + "'",
                fmt::format("its joints ({}) have no counterpart; allowed are hinge, slide, ball, free, two "
                            "perpendicular hinges or three hinges with one anchor, hinge and slide on one "
                            "line, and two slides and a hinge normal to them",
                            kinds));
        }
    }

    static std::string joint_name(const std::vector<ImportedJoint>& joints)
    {
        std::string all = joints.front().name;
        for (size_t k = 1; k < joints.size(); ++k) all += "+" + joints[k].name;
        return all;
    }
    static std::string kinds_of(const std::vector<ImportedJoint>& joints)
    {
        static const char* const names[] = {"hinge", "slide", "ball", "free"};
        std::string all;
        for (const ImportedJoint& joint : joints)
            all += (all.empty() ? "" : " ") + std::string(names[joint.type]);
        return all;
    }
    bool have_common_anchor(const std::vector<ImportedJoint>& joints) const
    {
        return std::all_of(joints.begin(), joints.end(), [&](const ImportedJoint& joint) {
            return (joint.anchor - joints.front().anchor).norm() <= tolerance * size();
        });
    }
    /// Largest distance of a centre of mass or an anchor from the origin [m]; at least 1e-3
    double size() const
    {
        double largest = 1e-3;
        for (const ImportedBody& of : body) {
            largest = std::max(largest, of.r.norm());
            for (const ImportedJoint& joint : of.joints) largest = std::max(largest, joint.anchor.norm());
        }
        return largest;
    }

    void refuse_springs(const std::vector<ImportedJoint>& joints) const
    {
        for (const ImportedJoint& joint : joints)
            if (joint.stiffness != 0 || joint.damping != 0)
                refuse("joint '" + joint.name + "'",
                       "stiffness and damping are imported for single hinges and slides only");
    }

    /// `anchor` is on the axis of the joint: it stays there when body j turns.
    void add_springs(const std::vector<ImportedJoint>& joints, int i, int j, const Vec3& anchor)
    {
        for (const ImportedJoint& joint : joints) {
            if (joint.stiffness == 0 && joint.damping == 0) continue;
            const bool is_hinge = joint.type == ImportedJoint::hinge;
            io::Json one = pair(joint.name, is_hinge ? "torsion-spring" : "spring-damper", i, j, force_names);
            one["stiffness"] = joint.stiffness;
            one["damping"] = joint.damping;
            if (is_hinge) {
                add_axes(one, i, joint.axis, j, joint.axis);
                one["free_angle"] = joint.rest;
            } else {
                // The length of a spring is positive: its first point is far behind the anchor.
                const double behind = 100 * std::ceil(size());
                add_points(one, i, anchor - behind * joint.axis, j, anchor);
                one["free_length"] = behind + joint.rest;
            }
            forces.push_back(std::move(one));
        }
    }

    ImportedModel& from;
    const std::string& file;
    std::vector<ImportedBody> body;
    std::vector<int> owners;
    std::set<std::string> constraint_names, force_names;
    io::Json constraints = io::Json::array(), forces = io::Json::array();
};

}  // namespace

std::string model_text(ImportedModel& from, const std::string& file)
{
    if (from.has_floor) raise_above_floor(from);
    return ModelWriter(from, file).text();
}

std::string message_about(const std::string& text, const std::string& message)
{
    const size_t begin = message.find(" (/"), end = message.find("): ");
    if (begin == message.npos || end == message.npos || end < begin) return message;
    const std::string pointer = message.substr(begin + 2, end - begin - 2);
    const size_t group_end = std::min(pointer.find('/', 1), pointer.size()),
                 number_end = std::min(pointer.find('/', group_end + 1), pointer.size());
    const std::string group = pointer.substr(1, group_end - 1);
    const std::string number =
        pointer.substr(std::min(group_end + 1, pointer.size()), number_end - group_end - 1);
    const io::JsonSource model(text, "model", text.size() + 1);
    const io::Json::Member* const entries = model.root.member(group);
    const bool is_number =
        !number.empty() && number.size() < 9 && number.find_first_not_of("0123456789") == number.npos;
    if (entries == nullptr || !is_number || std::stoul(number) >= entries->value.size()) return message;
    const io::Json::Member* const name = entries->value.at(std::stoul(number)).member("name");
    const std::string kind = group == "bodies"        ? "body"
                             : group == "constraints" ? "joint"
                             : group == "forces"      ? "force"
                             : group == "contacts"    ? "contact"
                                                      : group;
    const std::string key = pointer.substr(std::min(number_end + 1, pointer.size()));
    const std::string of = fmt::format(
        "{} '{}'", kind, name != nullptr && name->value.string() != nullptr ? *name->value.string() : number);
    std::string reason = message.substr(end + 3);
    if (reason.starts_with(of + ": ")) reason.erase(0, of.size() + 2);
    return of + (key.empty() ? "" : " (" + key + ")") + ": " + reason;
}

}  // namespace hilda::run
