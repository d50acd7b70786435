// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/frame_files.hpp"

#include "io/formats/vtk.hpp"
#include "run/frames/vtk.hpp"

#include <cstdint>
#include <cstdio>
#include <fstream>

namespace hilda::run {

namespace {

std::string motions_file(const std::string& name) { return "checkpoint." + name; }

}  // namespace

FrameFiles::FrameFiles(const Drawing& drawing, std::string directory, std::string name)
    : drawing(drawing), directory(std::move(directory)), name(std::move(name)), patches(drawing),
      meshes(patches.meshes())
{}

void FrameFiles::open()
{
    io::make_folder_in(directory, "vtk");
    if (patches.depend_on_frames()) motions.emplace(path(motions_file(name)));
    write_list();
}

void FrameFiles::add(const Drawing::Frame& frame)
{
    if (patches.extend(frame)) {
        meshes = patches.meshes();
        outdated = times.size();
    }
    write(times.size(), frame);
    if (motions) {
        io::Archive a;
        Drawing::Frame copy = frame;
        copy.transfer(a);
        const std::string bytes = a.bytes();
        const std::uint64_t size = bytes.size();
        motions->buffer.append(reinterpret_cast<const char*>(&size), sizeof size);
        motions->buffer += bytes;
        motions->flush_when_full();
    }
    io::append_to_vtk_collection(path(name + ".pvd"), frame.t, frame_file(name, times.size()),
                                 !times.empty() && times.back() == frame.t);
    times.push_back(frame.t);
}

void FrameFiles::sync()
{
    if (motions) motions->sync();
    write_list();
}

void FrameFiles::transfer(io::Archive& a)
{
    a.list(times);
    std::uint64_t length = a.reads() || !motions ? 0 : motions->size();
    a.value(length);
    patches.transfer(a);
    if (!a.reads()) return;
    io::make_folder_in(directory, "vtk");
    if (patches.depend_on_frames()) motions.emplace(path(motions_file(name)), length, true);
    meshes = patches.meshes();
    outdated = times.size();  // the frames of a completed run have the part of its end
    write_list();
}

void FrameFiles::close()
{
    if (motions) {
        motions->sync();
        read_motions(outdated, [&](size_t k, const Drawing::Frame& frame) { write(k, frame); });
    }
    remove_frames_from(times.size());
    write_list();
}

template <class Take>
void FrameFiles::read_motions(size_t count, Take take) const
{
    const std::string file = path(motions_file(name));
    std::ifstream in(file, std::ios::binary);
    std::string bytes;
    for (size_t k = 0; k < count; ++k) {
        std::uint64_t size = 0;
        in.read(reinterpret_cast<char*>(&size), sizeof size);
        if (!in || size > motions->size()) throw io::IoError(file + ": is damaged");
        bytes.resize(size);
        if (!in.read(bytes.data(), static_cast<std::streamsize>(size)))
            throw io::IoError(file + ": is damaged");
        io::Archive a(bytes, file);
        Drawing::Frame frame;
        frame.transfer(a);
        a.end();
        for (const Drawing::BodySurface& s : drawing.all_surfaces())
            a.check(s.body < static_cast<int>(frame.body.size()), "a frame with too few bodies");
        take(k, frame);
    }
}

void FrameFiles::write(size_t k, const Drawing::Frame& frame) const
{
    io::write_file(path(frame_file(name, k)), drawing.poly_data(frame, meshes));
}

void FrameFiles::write_list() const
{
    std::vector<std::pair<double, std::string>> files;
    for (size_t k = 0; k < times.size(); ++k) files.emplace_back(times[k], frame_file(name, k));
    io::write_file(path(name + ".pvd"), io::vtk_collection(files));
}

void FrameFiles::remove_frames_from(size_t k) const
{
    while (std::remove(path(frame_file(name, k)).c_str()) == 0) ++k;
}

void FrameFiles::remove(const std::string& directory, const std::string& name)
{
    Snapshots::remove(directory, name);
    std::remove((directory + '/' + motions_file(name)).c_str());
}

}  // namespace hilda::run
