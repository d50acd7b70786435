// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of URDF files, by liburdfdom. In the module hilda-urdf.so.

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/formats/mesh_file.hpp"
#include "run/importing/import_model.hpp"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <fmt/format.h>

#include <filesystem>
#include <set>

namespace hilda::run {

namespace {

namespace fs = std::filesystem;
using lie::Mat3;
using lie::Vec3;

/// Collects the messages of the library, which returns none.
class Messages final : public console_bridge::OutputHandler {
public:
    Messages() { console_bridge::useOutputHandler(this); }
    ~Messages() override { console_bridge::restorePreviousOutputHandler(); }
    Messages(const Messages&) = delete;
    Messages& operator=(const Messages&) = delete;

    void log(const std::string& message, console_bridge::LogLevel level, const char*, int) override
    {
        if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) text += (text.empty() ? "" : "; ") + message;
    }

    std::string text;
};

struct Pose {
    Vec3 p = Vec3::Zero();
    Mat3 A = Mat3::Identity();

    Pose operator*(const urdf::Pose& next) const
    {
        const urdf::Rotation& q = next.rotation;
        const Eigen::Quaterniond rotation = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
        return {p + A * Vec3(next.position.x, next.position.y, next.position.z),
                A * rotation.toRotationMatrix()};
    }
};

class Reader {
public:
    Reader(std::string file, bool free_base, ImportedModel& to)
        : file(std::move(file)), free_base(free_base), to(to)
    {}

    void read()
    {
        Messages messages;
        const std::string text = io::read_file(file, size_t(64) << 20);
        const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
        if (model == nullptr || model->getRoot() == nullptr)
            refuse(messages.text.empty() ? "is no valid URDF file" : messages.text);
        // The library leaves out an element that it cannot read, such as the inertia of a link.
        if (!messages.text.empty()) refuse(messages.text);
        to.name = model->getName();
        add(*model->getRoot(), {}, -1, nullptr);
        if (!to.imports_contacts) return;
        to.has_floor = true;
        to.shapes.push_back({.name = "the floor", .type = ImportedShape::plane, .touches_neighbours = true});
    }

private:
    [[noreturn]] void refuse(const std::string& why) const { throw io::InvalidInput(file + ": " + why); }

    void add(const urdf::Link& link, const Pose& pose, int parent, const urdf::Joint* joint)
    {
        if (!visited.insert(link.name).second)
            refuse("link '" + link.name + "': it is the child of two joints; loops are not supported");
        ImportedBody body{.name = link.name == "ground" ? "ground_link" : link.name, .parent = parent};
        body.A = pose.A;
        body.r = pose.p;
        if (link.inertial != nullptr) {
            const urdf::Inertial& of = *link.inertial;
            const Pose frame = pose * of.origin;
            body.J_bar << of.ixx, of.ixy, of.ixz, of.ixy, of.iyy, of.iyz, of.ixz, of.iyz, of.izz;
            body.m = of.mass;
            body.r = frame.p;
            body.A = frame.A;
        }
        if (joint != nullptr)
            add_joints(*joint, pose, body);
        else if (free_base)
            body.joints.push_back({.name = "base", .type = ImportedJoint::free});
        for (const urdf::VisualSharedPtr& visual : link.visual_array) check_mesh(link, visual->geometry);
        const int own = static_cast<int>(to.bodies.size());
        for (const urdf::CollisionSharedPtr& of : link.collision_array)
            if (to.imports_contacts)
                add_shape(link, *of, pose, own);
            else
                check_mesh(link, of->geometry);
        if (!link.collision_array.empty() && !to.imports_contacts && !warned_of_contacts) {
            to.warnings.emplace_back("contacts between collision geometries, which --contacts imports");
            warned_of_contacts = true;
        }
        to.bodies.push_back(body);
        for (const urdf::JointSharedPtr& next : link.child_joints) {
            const Pose child = pose * next->parent_to_joint_origin_transform;
            for (const urdf::LinkSharedPtr& below : link.child_links)
                if (below->name == next->child_link_name) add(*below, child, own, next.get());
        }
    }

    void add_joints(const urdf::Joint& joint, const Pose& pose, ImportedBody& body)
    {
        const std::string what = "joint '" + joint.name + "'";
        if (joint.mimic != nullptr) refuse(what + ": mimic is not supported");
        ImportedJoint one{.name = joint.name, .anchor = pose.p};
        one.axis = pose.A * Vec3(joint.axis.x, joint.axis.y, joint.axis.z);
        const bool has_axis = joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
                              joint.type == urdf::Joint::PRISMATIC || joint.type == urdf::Joint::PLANAR;
        if (has_axis && !(one.axis.norm() > 0)) refuse(what + ": its axis is zero");
        if (has_axis) one.axis.normalize();
        if (joint.dynamics != nullptr) {
            one.damping = joint.dynamics->damping;
            if (joint.dynamics->friction != 0) to.warnings.push_back("friction of " + what);
        }
        switch (joint.type) {
            case urdf::Joint::FIXED:
                return;
            case urdf::Joint::FLOATING:
                one.type = ImportedJoint::free;
                break;
            case urdf::Joint::PRISMATIC:
                one.type = ImportedJoint::slide;
                break;
            case urdf::Joint::REVOLUTE:
            case urdf::Joint::CONTINUOUS:
                one.type = ImportedJoint::hinge;
                break;
            case urdf::Joint::PLANAR:
                return add_planar(one, body);
            default:
                refuse(what + ": its type is not supported");
        }
        const bool has_limits = joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::PRISMATIC;
        if (has_limits && joint.limits != nullptr) to.warnings.push_back("limits of " + what);
        body.joints.push_back(one);
    }

    static void add_planar(ImportedJoint one, ImportedBody& body)
    {
        const Vec3 normal = one.axis, first = normal.unitOrthogonal();
        const std::string name = one.name;
        one.type = ImportedJoint::slide;
        one.name = name + "_1";
        one.axis = first;
        body.joints.push_back(one);
        one.name = name + "_2";
        one.axis = normal.cross(first);
        body.joints.push_back(one);
        one.type = ImportedJoint::hinge;
        one.name = name + "_3";
        one.axis = normal;
        body.joints.push_back(one);
    }

    void add_shape(const urdf::Link& link, const urdf::Collision& of, const Pose& pose, int own)
    {
        const Pose at = pose * of.origin;
        const auto add_type = [&](const char* type, ImportedShape::Type number, const Vec3& size,
                                  std::vector<Vec3> points = {}) {
            to.shapes.push_back({.name = fmt::format("{} of link '{}'", type, link.name),
                                 .body = own,
                                 .type = number,
                                 .p = at.p,
                                 .A = at.A,
                                 .size = size,
                                 .points = std::move(points)});
        };
        if (of.geometry == nullptr) {
            to.warnings.push_back("collision of link '" + link.name + "', which has no geometry");
            return;
        }
        switch (of.geometry->type) {
            case urdf::Geometry::SPHERE: {
                const double R = dynamic_cast<const urdf::Sphere&>(*of.geometry).radius;
                return add_type("sphere", ImportedShape::sphere, Vec3(R, 0, 0));
            }
            case urdf::Geometry::BOX: {
                const urdf::Vector3& d = dynamic_cast<const urdf::Box&>(*of.geometry).dim;
                return add_type("box", ImportedShape::box, Vec3(d.x, d.y, d.z));
            }
            case urdf::Geometry::CYLINDER: {
                const auto& of_type = dynamic_cast<const urdf::Cylinder&>(*of.geometry);
                return add_cylinder(
                    to, {.name = "cylinder of link '" + link.name + "'", .body = own, .p = at.p, .A = at.A},
                    of_type.radius, of_type.length);
            }
            case urdf::Geometry::MESH:
                break;
        }
        const auto& mesh = dynamic_cast<const urdf::Mesh&>(*of.geometry);
        const std::string what = "mesh " + mesh.filename + " of link '" + link.name + "'";
        if (mesh.filename.find("://") != std::string::npos) {
            to.warnings.push_back(what + ": the place of a package is not known");
            return;
        }
        try {
            const io::MeshFile read = io::read_mesh_file(
                (fs::path(file).parent_path() / mesh.filename).string(), size_t(64) << 20, 200000);
            std::vector<Vec3> points;
            for (const auto& [x, y, z] : read.vertices)
                points.emplace_back(mesh.scale.x * x, mesh.scale.y * y, mesh.scale.z * z);
            add_type(("mesh " + mesh.filename).c_str(), ImportedShape::convex, Vec3::Zero(),
                     std::move(points));
        } catch (const io::InvalidInput& error) {
            to.warnings.push_back(what + ": " + error.what());
        }
    }

    /// The geometry is not imported: a mesh that is missing does not change the model.
    void check_mesh(const urdf::Link& link, const urdf::GeometrySharedPtr& geometry)
    {
        if (geometry == nullptr || geometry->type != urdf::Geometry::MESH) return;
        const std::string& name = dynamic_cast<const urdf::Mesh&>(*geometry).filename;
        if (name.find("://") != std::string::npos) return;  // the place of a package is not known
        std::error_code error;
        if (!fs::exists(fs::path(file).parent_path() / name, error))
            to.warnings.push_back("mesh " + name + " of link '" + link.name + "', which does not exist");
    }

    const std::string file;
    const bool free_base;
    ImportedModel& to;
    std::set<std::string> visited;  ///< names of links
    bool warned_of_contacts = false;
};

}  // namespace

}  // namespace hilda::run

extern "C" void hilda_import_urdf(const std::string& file, bool free_base, hilda::run::ImportedModel& to)
{
    hilda::run::Reader(file, free_base, to).read();
}
