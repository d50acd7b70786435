// SPDX-License-Identifier: GPL-3.0-or-later
/// Output of a run in progress: run.csv and the frames.

#pragma once

#include "granular/case/case_file.hpp"

namespace hilda::granular {

class Rows {
public:
    /// `interval`, `frame_interval`: numbers of steps between rows and between frames; frame_interval 0: no
    /// frames
    Rows(std::string directory, const Case& c, long interval, long frame_interval);

    /// Records the row and the frame of the current step, if it is a multiple of their intervals
    void record();
    /// Reads the rows and frames of an interrupted run up to the current step. Throws io::IoError.
    void load();
    /// Writes run.csv
    void write() const;
    /// Writes the collection of the frames, vtk/run.pvd
    void write_frames() const;
    std::size_t count() const { return rows; }

private:
    static std::string frame(std::size_t k);

    const std::string directory;
    const Case& c;
    const long interval, frame_interval;
    std::size_t rows = 0, next_frame = 0;
    std::string csv;
    std::vector<std::pair<double, std::string>> frames;
};

}  // namespace hilda::granular
