// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/tables.hpp"

#include "io/formats/csv.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::run {

namespace {

using lie::Vec3;

/// The numbers of the frames nearest to these times
std::vector<size_t> nearest_frames(const std::vector<Snapshots::Frame>& frames,
                                   const std::vector<double>& times)
{
    std::vector<size_t> all;
    for (const double t : times) {
        const auto distance = [t](const Snapshots::Frame& f) { return std::abs(f.t - t); };
        const auto nearest =
            std::min_element(frames.begin(), frames.end(),
                             [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
        if (nearest != frames.end()) all.push_back(static_cast<size_t>(nearest - frames.begin()));
    }
    return all;
}

void append(std::string& row, const Vec3& v)
{
    for (const double x : v) row += ',' + io::shortest(x);
}

}  // namespace

SnapshotTables snapshot_tables(const Snapshots& snapshots, const std::string& run,
                               const std::vector<std::string>& bodies,
                               const std::vector<std::string>& contacts, const std::vector<double>& shown)
{
    const std::vector<Snapshots::Frame>& frames = snapshots.all_frames();
    const std::vector<size_t> selected = nearest_frames(frames, shown);
    const std::string name = io::csv_field(run);
    SnapshotTables to;
    for (size_t k = 0; k < frames.size(); ++k) {
        const bool is_shown = std::find(selected.begin(), selected.end(), k) != selected.end();
        const std::string when = ',' + io::shortest(frames[k].t) + (is_shown ? ",1" : ",0");
        for (size_t b = 0; b < frames[k].body.size(); ++b) {
            const lie::Motion& motion = frames[k].body[b];
            to.poses += name + ',' + io::csv_field(bodies.at(b)) + when;
            append(to.poses, motion.r);
            for (int row = 0; row < 3; ++row) append(to.poses, motion.A.row(row).transpose());
            append(to.poses, motion.rdot);
            to.poses += '\n';
        }
        for (const Snapshots::ContactData& c : frames[k].contacts) {
            to.contacts += name + ',' + io::csv_field(contacts.at(static_cast<size_t>(c.contact))) + when;
            for (const Vec3* v : {&c.C, &c.u, &c.N, &c.F}) append(to.contacts, *v);
            to.contacts += '\n';
        }
    }
    io::Json shapes = {{"run", run}, {"bodies", bodies}};
    shapes.update(snapshots.geometry());
    to.shapes = io::written(shapes);
    return to;
}

std::vector<std::pair<std::string, std::string>> snapshot_files(const std::string& prefix,
                                                                const std::vector<SnapshotTables>& runs)
{
    std::string poses, contacts, shapes;
    for (const SnapshotTables& run : runs) {
        if (run.poses.empty()) continue;
        poses += run.poses, contacts += run.contacts;
        shapes += (shapes.empty() ? "[\n" : ",\n") + run.shapes;
    }
    if (poses.empty()) return {};
    std::vector<std::pair<std::string, std::string>> files = {
        {prefix + "poses.csv",
         "run,body,t,shown,rx,ry,rz,A11,A12,A13,A21,A22,A23,A31,A32,A33,vx,vy,vz\n" + poses}};
    if (!contacts.empty())
        files.emplace_back(prefix + "contacts.csv",
                           "run,contact,t,shown,Cx,Cy,Cz,ux,uy,uz,Nx,Ny,Nz,Fx,Fy,Fz\n" + contacts);
    files.emplace_back(prefix + "shapes.json", shapes + "\n]\n");
    return files;
}

}  // namespace hilda::run
