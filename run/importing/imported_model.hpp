// SPDX-License-Identifier: GPL-3.0-or-later
/// A mechanism read from a file of another program, in the form that its readers have in common.

#pragma once

#include "lie/so3.hpp"

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace hilda::run {

/// A joint of a body with its parent, in the initial configuration. All vectors are global.
struct ImportedJoint {
    enum Type { hinge, slide, ball, free };

    std::string name;
    Type type = hinge;
    lie::Vec3 anchor = lie::Vec3::Zero();  ///< [m]
    lie::Vec3 axis = lie::Vec3::UnitZ();   ///< of a hinge or slide
    double stiffness = 0, damping = 0;     ///< of a hinge or slide [N m/rad, N m s/rad or N/m, N s/m]
    double rest = 0;                       ///< coordinate without spring force [rad or m]; initially 0
};

struct ImportedBody {
    std::string name;
    int parent = -1;                      ///< index of an earlier body; -1: the ground
    double m = 0;                         ///< [kg]
    lie::Vec3 r = lie::Vec3::Zero();      ///< centre of mass [m], global
    lie::Mat3 A = lie::Mat3::Identity();  ///< of the body frame to be used
    lie::Mat3 J_bar = lie::Mat3::Zero();  ///< inertia about r [kg m²], in the body frame
    /// In the order from the parent to the body. None: the body is welded to its parent.
    std::vector<ImportedJoint> joints{};
};

/// A constraint that closes a loop
struct ImportedLoop {
    std::string name;
    bool is_weld = false;  ///< else the bodies have a common point
    int i = -1, j = -1;
    lie::Vec3 point = lie::Vec3::Zero();  ///< global [m]
};

/// A collision geometry, in the initial configuration. Pose and points are those of its own frame; the axis
/// of a capsule or disk and the normal of a plane are z.
struct ImportedShape {
    enum Type { plane, box, sphere, capsule, ellipsoid, disk, convex };

    std::string name;  ///< in messages, such as "box of link 'base'"
    int body = -1;     ///< index; -1: the ground
    Type type = box;
    lie::Vec3 p = lie::Vec3::Zero();      ///< origin of its frame [m], global
    lie::Mat3 A = lie::Mat3::Identity();  ///< axes of its frame, global
    /// box: lengths; sphere and disk: radius; capsule: radius, distance of the centres; ellipsoid: semi-axes
    /// [m]
    lie::Vec3 size = lie::Vec3::Zero();
    std::vector<lie::Vec3> points{};  ///< convex: the shape is their convex hull [m]
    double mu = 0.5;                  ///< coefficient of friction [-]
    bool is_frictionless = false;     ///< without friction, whatever mu is
    int priority = 0;                 ///< of its friction
    /// Two shapes may touch if the type mask of one and the partner mask of the other have a common bit.
    int type_mask = 1, partner_mask = 1;
    bool touches_neighbours = false;  ///< of the ground: also bodies with a joint to the ground
};

struct ImportedModel {
    std::string name;
    lie::Vec3 gravity{0, 0, -9.81};  ///< [m/s²]
    std::vector<ImportedBody> bodies;
    std::vector<ImportedLoop> loops;
    bool imports_contacts = false;  ///< fill `shapes`
    std::vector<ImportedShape> shapes;
    std::set<std::pair<int, int>> without_contact;  ///< bodies i < j that do not touch each other
    bool has_floor = false;  ///< the plane z = 0 is a part of `shapes`: raise_above_floor()
    long contact_pairs = 0;  ///< of shapes in the model text
    /// Replace principal moments of inertia that violate the triangle inequality by their mean.
    bool balances_inertia = false;
    std::vector<std::string> warnings;  ///< what the model file does not have
};

/// Adds the two ends of a cylinder about the z axis of `shape`, with a radius and a length [m]. On a plane
/// the rims are its contact.
inline void add_cylinder(ImportedModel& model, ImportedShape shape, double radius, double length)
{
    shape.type = ImportedShape::disk;
    shape.size = lie::Vec3(radius, 0, 0);
    const lie::Vec3 centre = shape.p, half = 0.5 * length * shape.A.col(2);
    for (const double sign : {-1., 1.}) {
        shape.p = centre + sign * half;
        model.shapes.push_back(shape);
    }
}

/// The text of the model file. Welded bodies are added to their parents. Consecutive joints of a body become
/// a joint of HILDA: two perpendicular hinges with a common point a universal joint, three a spherical one,
/// a hinge and a slide on one line a cylindrical one, two slides and a hinge normal to them a planar one.
///
/// With imports_contacts it has the rigid contacts of imported_contacts().
///
/// Throws io::InvalidInput "FILE: ..." for other combinations, for springs and dampers of joints without a
/// single axis, and for bodies that move and have no mass or inertia.
///
/// The key `note` lists the warnings. Those of more than 4000 bytes are counted by kind, "limits of joint
/// (45)".
std::string model_text(ImportedModel& from, const std::string& file);

/// A message about the model text: its place "PATH:LINE:COL (/bodies/3/mass)" in a file that is not written
/// is replaced by the body or joint, "body 'arm' (mass)". Other messages are returned as they are.
std::string message_about(const std::string& text, const std::string& message);

}  // namespace hilda::run
