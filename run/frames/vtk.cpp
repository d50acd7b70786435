// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/vtk.hpp"

#include "io/files.hpp"
#include "io/formats/vtk.hpp"
#include "run/frames/drawn_patches.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

namespace hilda::run {

std::string frame_file(const std::string& name, size_t k) { return fmt::format("vtk/{}-{:06}.vtp", name, k); }

bool EvenSelection::is_selected(long n)
{
    if (selected == count || n != next()) return false;
    while (selected < count && next() <= n) ++selected;
    return true;
}

long EvenSelection::next() const
{
    return count == 1 ? 0 : std::lround(static_cast<double>(steps) * selected / (count - 1));
}

void Snapshots::add(double t, std::vector<lie::Motion> bodies, std::vector<ContactData> contacts)
{
    frames.push_back({t, std::move(bodies), std::move(contacts)});
}

std::vector<Drawing::BodyMesh> Snapshots::meshes() const
{
    DrawnPatches patches(*this);
    for (const Frame& frame : frames) patches.extend(frame);
    return patches.meshes();
}

io::Json Snapshots::geometry() const { return Drawing::geometry(meshes()); }

void Snapshots::write(const std::string& directory, const std::string& name) const
{
    io::make_folder_in(directory, "vtk");
    const std::vector<BodyMesh> all = meshes();
    std::vector<std::pair<double, std::string>> files;
    for (size_t k = 0; k < frames.size(); ++k) {
        files.emplace_back(frames[k].t, frame_file(name, k));
        io::write_file(directory + '/' + files.back().second, poly_data(frames[k], all));
    }
    io::write_file(directory + '/' + name + ".pvd", io::vtk_collection(files));
}

void Snapshots::remove(const std::string& directory, const std::string& name)
{
    std::remove((directory + '/' + name + ".pvd").c_str());
    for (size_t k = 0; std::remove((directory + '/' + frame_file(name, k)).c_str()) == 0;) ++k;
}

}  // namespace hilda::run
