// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of bodies in contact, as files for ParaView.

#pragma once

#include "run/frames/drawing.hpp"

#include <string>
#include <vector>

namespace hilda::run {

/// Selects `count` evenly spaced nodes of 0 … steps, including the first and the last. The nodes must be
/// queried in ascending order.
class EvenSelection {
public:
    EvenSelection(int count, long steps) : count(count), steps(steps) {}

    bool is_selected(long n);

private:
    long next() const;

    int count;
    long steps;
    int selected = 0;
};

/// A drawing and the frames of a short run, kept in memory. FrameFiles writes those of a long run.
class Snapshots : public Drawing {
public:
    /// Adds a frame at the time t [s].
    void add(double t, std::vector<lie::Motion> bodies, std::vector<ContactData> contacts);

    /// Writes DIR/vtk/NAME-000000.vtp, -000001.vtp, ..., then DIR/NAME.pvd with the list of files and times.
    /// io::IoError.
    void write(const std::string& directory, const std::string& name) const;
    /// What is drawn, with the parts of unbounded surfaces that the frames need
    io::Json geometry() const;
    /// The frames in the order of add()
    const std::vector<Frame>& all_frames() const { return frames; }

    /// Removes the files of an earlier write() with this name.
    static void remove(const std::string& directory, const std::string& name);

    static constexpr int max_frames = 1000000;  ///< limit of the six-digit file names

private:
    std::vector<BodyMesh> meshes() const;

    std::vector<Frame> frames;
};

/// vtk/NAME-000123.vtp: the file of frame k, relative to the directory of NAME.pvd
std::string frame_file(const std::string& name, size_t k);

}  // namespace hilda::run
