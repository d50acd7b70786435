// SPDX-License-Identifier: GPL-3.0-or-later
/// run.csv and the frames beside it, as a run goes on.

#pragma once

#include "granular/case/case_file.hpp"

namespace hilda::granular {

class Rows {
public:
    /// In `directory`, a row and a frame every so many steps; no frames where that is 0
    Rows(std::string directory, const Case& c, long every, long frames_every);

    /// The row and the frame of this moment, where it is one for them
    void record();
    /// Those of an earlier run up to this moment; later ones are made again. FileError
    void load();
    void write() const;
    /// The collection of the frames
    void write_frames() const;
    std::size_t count() const { return rows; }

private:
    static std::string frame(std::size_t k);

    const std::string directory;
    const Case& c;
    const long every, frames_every;
    std::size_t rows = 0, next_frame = 0;
    std::string csv;
    std::vector<std::pair<double, std::string>> frames;
};

}  // namespace hilda::granular
