// SPDX-License-Identifier: GPL-3.0-or-later
/// Frames of a drawing as files for ParaView, written one after the other.

#pragma once

#include "io/files.hpp"
#include "run/frames/drawn_patches.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::run {

/// Writes DIR/vtk/NAME-000000.vtp, -000001.vtp, ..., and DIR/NAME.pvd with the list of files and times. Each
/// frame and the list are complete after add(). Kept in memory: the times and the regions of the unbounded
/// surfaces.
///
/// The drawn part of an unbounded surface depends on all frames. Until close() a frame shows the part that it
/// and the frames before it need. close() writes the frames with an earlier part again; their motions are in
/// DIR/checkpoint.NAME, an archive of Drawing::Frame for each frame, which drawings without unbounded
/// surfaces do not need. The result is that of Snapshots::write(). All functions: io::IoError.
class FrameFiles {
public:
    /// The drawing must outlive this object.
    FrameFiles(const Drawing& drawing, std::string directory, std::string name);

    /// Begins with a list without frames.
    void open();
    void add(const Drawing::Frame& frame);
    /// Synchronises the list and the motions with the disk; the frames are after add().
    void sync();
    /// Writes the state to a checkpoint; or reads it, and removes the list entries of later frames.
    void transfer(io::Archive& a);
    /// Writes the frames with an earlier part of an unbounded surface again, removes the files of later
    /// frames, and synchronises the list.
    void close();

    /// Removes the files of an earlier run with this name.
    static void remove(const std::string& directory, const std::string& name);

private:
    void write(size_t k, const Drawing::Frame& frame) const;
    void write_list() const;
    void remove_frames_from(size_t k) const;
    /// Calls take(k, frame) for the first `count` frames.
    template <class Take>
    void read_motions(size_t count, Take take) const;

    std::string path(const std::string& file) const { return directory + '/' + file; }

    const Drawing& drawing;
    const std::string directory, name;
    DrawnPatches patches;
    std::vector<Drawing::BodyMesh> meshes;  ///< of the last frame
    std::vector<double> times;              ///< of the frames [s]
    size_t outdated = 0;                    ///< frames before this number have an earlier part of a surface
    std::optional<io::OutputFile> motions;  ///< empty without unbounded surfaces
};

}  // namespace hilda::run
