// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/model_frames.hpp"

#include "contact/compliant/contact_group.hpp"
#include "dae/constraints/d.hpp"
#include "dae/model.hpp"
#include "run/frames/body_drawing.hpp"

#include <algorithm>

namespace hilda::run {

namespace {

using lie::Vec3;

/// A constraint or force that acts between two points
struct Connection {
    dae::PointPair points;
    bool is_joint, is_link;  ///< a link: a massless rod, drawn as a line between the points
};

std::vector<Connection> connections(const dae::Model& model)
{
    std::vector<Connection> all;
    const auto add = [&](const dae::Constraint& c) {
        if (const std::optional<dae::PointPair> points = c.points())
            all.push_back({*points, true, dynamic_cast<const dae::D*>(&c) != nullptr});
    };
    for (const dae::Model::Row& row : model.all_rows()) add(*row.block);
    for (const auto& constraint : model.general_constraints()) add(*constraint);
    for (const auto& force : model.forces())
        if (const std::optional<dae::PointPair> points = force->points())
            all.push_back({*points, false, false});
    return all;
}

/// The points of each body at which its joints and forces act, with or without the ends of links
std::vector<std::vector<Vec3>> attachments(const dae::Model& model,
                                           const std::vector<Connection>& connections, bool with_links)
{
    std::vector<std::vector<Vec3>> points(model.all_bodies().size());
    const auto add = [&](int body, const Vec3& s_bar) {
        if (body == dae::ground) return;
        std::vector<Vec3>& of_body = points[body];
        const auto same = [&](const Vec3& p) { return (p - s_bar).norm() <= 1e-9 * (1 + s_bar.norm()); };
        if (std::none_of(of_body.begin(), of_body.end(), same)) of_body.push_back(s_bar);
    };
    for (const Connection& c : connections)
        if (with_links || !c.is_link) add(c.points.i, c.points.s_bar_i), add(c.points.j, c.points.s_bar_j);
    return points;
}

/// Draws a body as bars between its points: one bar for two points, else a bar from each point to their mean.
void add_bars(int body, const std::vector<Vec3>& points, Drawing& to)
{
    const auto add = [&](const Vec3& from, const Vec3& end) {
        to.add_line({body, body, from, end}, Drawing::bar);
    };
    if (points.size() == 2) return add(points[0], points[1]);
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
    for (const Vec3& p : points) add(p, mean);
}

/// Draws a bar from each point outside the box of the mesh to the centre of mass.
void connect_outer_points(int body, const std::vector<Vec3>& points, const contact::PolygonMesh& mesh,
                          Drawing& to)
{
    Eigen::AlignedBox3d box;
    for (const Vec3& p : mesh.point) box.extend(p);
    const double tolerance = 0.02 * box.diagonal().norm();
    for (const Vec3& p : points)
        if (box.exteriorDistance(p) > tolerance) to.add_line({body, body, p, Vec3::Zero()}, Drawing::bar);
}

/// A body with equal principal moments and at least two points is drawn as bars: its inertia says nothing
/// about its form, as in planar mechanisms that state one moment only.
void add_bodies(const dae::Model& model, const ContactOutputs& contacts,
                const std::vector<Connection>& connections, Drawing& to)
{
    std::vector<bool> has_surface(model.all_bodies().size());
    const auto add = [&](int body, const contact::Shape& shape) {
        to.add_surface(body, shape);
        if (body >= 0 && !shape.surface->is_unbounded()) has_surface[body] = true;
    };
    for (const ContactOutputs::Contact& c : contacts.contacts) add(c.i, c.shape_i), add(c.j, c.shape_j);
    for (const auto& group : model.near_forces().all_groups())
        if (const auto* of = dynamic_cast<const contact::ContactGroup*>(group.get())) {
            for (const int b : of->first_bodies()) add(b, of->shape_i);
            for (const int b : of->second_bodies()) add(b, of->shape_j);
        }
    for (const auto& rigid : model.rigid_contacts())
        if (const auto* of = dynamic_cast<const contact::RigidContacts*>(rigid.get())) {
            for (const int b : of->pairs().first) add(b, of->shape_i);
            for (const int b : of->pairs().second) add(b, of->shape_j);
        }
    const std::vector<std::vector<Vec3>> points = attachments(model, connections, true),
                                         without_links = attachments(model, connections, false);
    for (size_t b = 0; b < has_surface.size(); ++b) {
        const dae::Body& body = model.all_bodies()[b];
        if (has_surface[b]) continue;
        const int number = static_cast<int>(b);
        if (!body.shape && points[b].size() >= 2 && has_equal_moments(body)) {
            add_bars(number, points[b], to);
        } else {
            const contact::PolygonMesh mesh = body_drawing(body);
            connect_outer_points(number, without_links[b], mesh, to);
            to.add_solid(number, mesh);
        }
    }
}

void add_connections(const std::vector<Connection>& connections, Drawing& to)
{
    for (const Connection& c : connections) {
        if (c.is_joint) {
            to.add_joint(c.points.i, c.points.s_bar_i);
            to.add_joint(c.points.j, c.points.s_bar_j);
        }
        if (c.is_link) to.add_line(c.points, Drawing::link);
        if (!c.is_joint) to.add_line(c.points, Drawing::spring);
    }
}

}  // namespace

ModelDrawing::ModelDrawing(const dae::Model& model) : model(model), contacts(model) {}

void ModelDrawing::add_to(Drawing& drawing) const
{
    const std::vector<Connection> all = connections(model);
    add_bodies(model, contacts, all, drawing);
    add_connections(all, drawing);
}

Drawing::Frame ModelDrawing::frame(const lie::State& x) const
{
    Drawing::Frame frame{.t = x.t, .body = x.body, .contacts = {}};
    const auto add = [&](size_t k, int i, const ContactOutput& now) {
        if (!now.is_touching) return;
        frame.contacts.push_back({.contact = static_cast<int>(k),
                                  .i = i,
                                  .C = now.C,
                                  .N = now.F_N * now.n,
                                  .F = now.F,
                                  .slipping = now.slipping,
                                  .rolling = now.rolling});
    };
    for (size_t k = 0; k < contacts.contacts.size(); ++k) add(k, contacts.contacts[k].i, contacts.at(k, x));
    contacts.near_contacts(x, add);
    return frame;
}

ModelFrames::ModelFrames(const dae::Model& model, EvenSelection selected) : selected(selected), drawing(model)
{
    drawing.add_to(snapshots);
}

void ModelFrames::accepted(const lie::State& x, long n, int)
{
    if (!selected.is_selected(n)) return;
    Drawing::Frame frame = drawing.frame(x);
    snapshots.add(frame.t, std::move(frame.body), std::move(frame.contacts));
}

}  // namespace hilda::run
