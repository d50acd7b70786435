// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/drawn_patches.hpp"

#include <algorithm>

namespace hilda::run {

namespace {

using lie::Motion;
using lie::Vec3;

}  // namespace

DrawnPatches::DrawnPatches(const Drawing& drawing) : drawing(drawing)
{
    for (size_t k = 0; k < drawing.all_surfaces().size(); ++k) {
        const contact::Surface& surface = *drawing.all_surfaces()[k].shape.surface;
        radius.push_back(0);
        surface_mesh.emplace_back();
        if (surface.is_unbounded()) {
            unbounded.push_back({k, {}, {}});
            continue;
        }
        surface_mesh.back() = mesh(k, {});
        for (const Vec3& a : contact::tessellate(surface, {}).point)
            radius.back() = std::max(radius.back(), a.norm());
    }
}

Drawing::BodyMesh DrawnPatches::mesh(size_t surface, const DrawingExtent& extent) const
{
    const auto& [body, shape] = drawing.all_surfaces()[surface];
    Drawing::BodyMesh all{body, contact::tessellate(*shape.surface, extent), Drawing::surface,
                          shape.surface->is_unbounded()};
    for (Vec3& a : all.mesh.point) a = shape.to_body(a);
    return all;
}

bool DrawnPatches::extend(const Drawing::Frame& frame)
{
    bool grows = false;
    for (Region& region : unbounded) {
        const Region before = region;
        extend(region, frame);
        grows = grows || region.box.min() != before.box.min() || region.box.max() != before.box.max() ||
                region.whole.min() != before.whole.min() || region.whole.max() != before.whole.max();
    }
    return grows;
}

void DrawnPatches::extend(Region& region, const Drawing::Frame& frame) const
{
    const Drawing::BodySurface& of = drawing.all_surfaces()[region.surface];
    const Motion& own = motion(frame.body, of.body);
    const auto visit = [&](const Vec3& p, double R) {
        const Vec3 a = of.shape.to_surface(own.A.transpose() * (p - own.r));
        for (const double sign : {-R, R}) {
            region.box.extend(a + Vec3::Constant(sign));
            region.whole.extend(p + Vec3::Constant(sign));
        }
    };
    for (size_t k = 0; k < radius.size(); ++k) {
        const auto& [body, shape] = drawing.all_surfaces()[k];
        if (body == of.body || !(radius[k] > 0)) continue;
        const Motion& b = motion(frame.body, body);
        visit(b.r + b.A * shape.position, radius[k]);
    }
    for (const Drawing::ContactData& t : frame.contacts) visit(t.C, 0);
}

std::vector<Drawing::BodyMesh> DrawnPatches::meshes() const
{
    std::vector<Drawing::BodyMesh> all = drawing.all_solids();
    auto region = unbounded.begin();
    for (size_t k = 0; k < surface_mesh.size(); ++k) {
        Drawing::BodyMesh next = surface_mesh[k];
        if (region != unbounded.end() && region->surface == k) {
            DrawingExtent extent{.box = region->box};
            if (!region->whole.isEmpty()) extent.scene_size = region->whole.diagonal().norm();
            next = mesh(k, extent);
            ++region;
        }
        if (std::find(all.begin(), all.end(), next) == all.end()) all.push_back(std::move(next));
    }
    return all;
}

void DrawnPatches::transfer(io::Archive& a)
{
    for (Region& region : unbounded)
        for (Eigen::AlignedBox3d* box : {&region.box, &region.whole})
            for (Vec3* corner : {&box->min(), &box->max()})
                for (double& x : *corner) a.value(x);
}

}  // namespace hilda::run
