// SPDX-License-Identifier: GPL-3.0-or-later
/// VTK XML files, for ParaView.

#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace hilda::io {

/// A file of the type PolyData (.vtp) with one piece. The numbers are binary, after the XML elements
/// ("appended raw").
class VtkPolyData {
public:
    /// counts: attributes of the piece, such as {"NumberOfPoints", 3}
    explicit VtkPolyData(std::initializer_list<std::pair<const char*, std::size_t>> counts);

    /// Begins a section: PointData, CellData, Points, Verts, Lines, Polys.
    void section(const std::string& name);
    /// Adds an array to the section, with `components` numbers for each point or cell.
    /// Number: float, double or std::int32_t
    template <class Number>
    void array(const std::string& name, int components, const std::vector<Number>& values);
    /// Ends the file and returns it.
    std::string text();

private:
    void end_section();

    std::string xml, open_section, blocks;
};

/// A list of files with their times [s] (.pvd). Successive files with the same time are parts of one frame.
std::string vtk_collection(const std::vector<std::pair<double, std::string>>& files);

/// Adds a file, the second with this time if `same_time`, to the list in `path`, which vtk_collection() or
/// this function has written. The list is complete before and after. IoError.
void append_to_vtk_collection(const std::string& path, double t, const std::string& file, bool same_time);

}  // namespace hilda::io
