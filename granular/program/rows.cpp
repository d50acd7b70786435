// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/rows.hpp"

#include "granular/world/output.hpp"
#include "io/files.hpp"

#include <cstdio>
#include <filesystem>

namespace hilda::granular {

Rows::Rows(std::string directory, const Case& c, long interval, long frame_interval)
    : directory(std::move(directory)), c(c), interval(interval), frame_interval(frame_interval)
{
    csv = "t,kinetic_energy,contacts,pairs";
    for (const char a : {'x', 'y', 'z'})
        for (const char b : {'x', 'y', 'z'}) csv += std::string(",stress_") + a + b;
    for (const std::string& b : c.boundaries)
        for (const char* of : {"_Fx", "_Fy", "_Fz", "_Tx", "_Ty", "_Tz"}) csv += ',' + b + of;
    csv += '\n';
}

void Rows::record()
{
    const World& w = *c.world;
    if (frame_interval > 0 && w.steps() % frame_interval == 0) {
        io::make_directory(directory + "/vtk");
        io::write_file(directory + "/vtk/" + frame(next_frame), particles_vtp(w));
        frames.emplace_back(w.t(), frame(next_frame++));
    }
    if (w.steps() % interval != 0) return;
    const World::Totals totals = w.totals();
    char row[128];
    std::snprintf(row, sizeof row, "%.12g,%.9g,%zu,%zu", w.t(), w.kinetic_energy(), totals.contacts,
                  w.candidates());
    csv += row;
    for (const double part : totals.stress) {
        std::snprintf(row, sizeof row, ",%.9g", part);
        csv += row;
    }
    for (const Wrench& on : totals.on_boundary) {
        for (const Vec3& part : {on.F, on.T}) {
            std::snprintf(row, sizeof row, ",%.9g,%.9g,%.9g", part.x, part.y, part.z);
            csv += row;
        }
    }
    csv += '\n';
    ++rows;
}

void Rows::load()
{
    const std::string name = directory + "/run.csv";
    csv = io::read_file(name, std::size_t{1} << 32);
    rows = static_cast<std::size_t>(c.world->steps() / interval) + 1;  // including t = 0
    std::size_t at = 0;
    for (std::size_t k = 0; k <= rows; ++k) {  // and the header line
        at = csv.find('\n', at);
        if (at++ == std::string::npos)
            throw io::IoError(name + ": must have at least " + std::to_string(rows + 1) + " lines, got " +
                              std::to_string(k));
    }
    csv.resize(at);
    if (frame_interval == 0) return;
    // frames may be missing if an earlier part of the run used --no-vtk
    for (long step = 0; step <= c.world->steps(); step += frame_interval, ++next_frame)
        if (std::filesystem::exists(directory + "/vtk/" + frame(next_frame)))
            frames.emplace_back(static_cast<double>(step) * c.h, frame(next_frame));
}

void Rows::write() const { io::write_file(directory + "/run.csv", csv); }

void Rows::write_frames() const
{
    if (!frames.empty()) io::write_file(directory + "/vtk/run.pvd", pvd(frames));
}

std::string Rows::frame(std::size_t k)
{
    char name[48];
    std::snprintf(name, sizeof name, "particles-%06zu.vtp", k);
    return name;
}

}  // namespace hilda::granular
