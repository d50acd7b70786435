// SPDX-License-Identifier: GPL-3.0-or-later
/// What is drawn of a model or a scene: surfaces and solids of bodies, joints, lines; and its frames as VTK
/// files.

#pragma once

#include "contact/compliant/contact.hpp"
#include "contact/tessellation.hpp"
#include "dae/body.hpp"
#include "io/archive.hpp"
#include "io/json.hpp"

#include <map>
#include <string>
#include <vector>

namespace hilda::run {

using contact::DrawingExtent;
using contact::PolygonMesh;

/// The bodies, joints and lines of a drawing, and the VTK file of a frame.
///
/// File format: VTK XML PolyData with the polygons of the surfaces and solids, a vertex for each contact with
/// a positive normal force and for each point of a joint, and a line for each spring and link.
///     cell data    `body` (number, -1: ground; of a line the first body), `contact` (number, -1 for other cells),
///                  `kind` (see Kind)
///     point data   `velocity` [m/s]; for vertices of contacts also `normal_force` and `friction` on the
///                  first body [N], `slipping`, `rolling` (0 or 1); all vectors global
class Drawing {
public:
    /// What a cell shows
    enum Kind { contact_point, joint, spring, link, solid, surface, bar };

    /// Adds a surface of a body (-1: ground). A surface that was added before is ignored.
    void add_surface(int body, const contact::Shape& shape);
    /// Adds the drawing of a body without a surface, in the frame of the body.
    void add_solid(int body, PolygonMesh mesh) { solids.push_back({body, std::move(mesh), solid}); }
    /// Adds a point of a joint [m], in the frame of the body.
    void add_joint(int body, const lie::Vec3& s_bar);
    /// Adds a line between two points: a spring or a link.
    void add_line(const dae::PointPair& ends, Kind kind) { lines.push_back({ends, kind}); }

    /// A contact in a frame: contact point C [m], normal force N and friction force F on body i [N], and the
    /// first tangent u of the contact frame, all global. u is zero where the contact frame is not known, and
    /// is not part of an archive.
    struct ContactData {
        int contact, i;  ///< number of the contact, and of its first body
        lie::Vec3 C, N, F;
        bool slipping, rolling;
        lie::Vec3 u = lie::Vec3::Zero();
    };
    struct Frame {
        double t;  ///< [s]
        std::vector<lie::Motion> body;
        std::vector<ContactData> contacts;

        void transfer(io::Archive& a);
    };
    static ContactData contact_data(int contact, int i, const contact::ContactState& now,
                                    const contact::Wrench& friction, const contact::Deflections& history);

    struct BodySurface {
        int body;
        contact::Shape shape;
    };
    /// A mesh, in the frame of its body
    struct BodyMesh {
        int body;
        PolygonMesh mesh;
        Kind kind;
        bool is_unbounded = false;  ///< the drawn part of an unbounded surface

        bool operator==(const BodyMesh&) const = default;
    };

    const std::vector<BodySurface>& all_surfaces() const { return surfaces; }
    const std::vector<BodyMesh>& all_solids() const { return solids; }

    /// The VTK file of a frame with these meshes, see DrawnPatches::meshes()
    std::string poly_data(const Frame& now, const std::vector<BodyMesh>& meshes) const;
    /// The meshes, joints and lines, in the frames of the bodies (-1: ground):
    ///     meshes   [{body, kind: surface or solid, unbounded, points: [[x, y, z], ...], polygons: [[point, ...], ...]}]
    ///     joints   [{body, point}]
    ///     lines    [{kind: spring, link or bar, body_i, point_i, body_j, point_j}]
    /// `unbounded`: the mesh is the part of an unbounded surface that the frames need.
    io::Json geometry(const std::vector<BodyMesh>& meshes) const;

private:
    struct Joint {
        int body;
        lie::Vec3 s_bar;

        bool operator==(const Joint&) const = default;
    };
    struct Line {
        dae::PointPair ends;
        Kind kind;
    };

    std::vector<BodySurface> surfaces;
    std::map<int, std::vector<size_t>> surfaces_of_body;  ///< their numbers
    std::vector<BodyMesh> solids;
    std::vector<Joint> joints;
    std::vector<Line> lines;
};

/// The motion of a body of a frame; body -1, the ground, is at rest in the global frame.
const lie::Motion& motion(const std::vector<lie::Motion>& bodies, int body);

}  // namespace hilda::run
