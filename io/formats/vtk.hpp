// SPDX-License-Identifier: GPL-3.0-or-later
/// VTK XML files, for ParaView.

#pragma once

#include "io/files.hpp"

#include <array>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hilda::io {

/// A file with one piece. The numbers are binary, after the XML elements ("appended raw").
class VtkFile {
public:
    /// Begins a section: PointData, CellData, Points, Verts, Lines, Polys.
    void section(const std::string& name);
    /// Adds an array to the section, with `components` numbers for each point or cell.
    /// Number: float, double or std::int32_t
    template <class Number>
    void array(const std::string& name, int components, const std::vector<Number>& values);
    /// The same for numbers that are not in a list: write() calls numbers(put), which passes the `count`
    /// numbers to put in pieces.
    template <class Number>
    void array(const std::string& name, int components, std::size_t count,
               std::function<void(const std::function<void(std::span<const Number>)>& put)> numbers);
    /// Ends the file and passes it on in pieces.
    void write(const Append& append);
    /// Ends the file and returns it.
    std::string text();

protected:
    /// type: PolyData, ImageData. The attributes are those of the element of this name, and of the piece.
    VtkFile(std::string type, const std::string& attributes, const std::string& of_piece);

private:
    void end_section();

    std::string type, xml, open_section;
    std::vector<std::function<void(const Append&)>> blocks;  ///< they pass the arrays on
    std::size_t size = 0;                                    ///< of all blocks [byte]
};

/// A file of the type PolyData (.vtp)
class VtkPolyData : public VtkFile {
public:
    /// counts: attributes of the piece, such as {"NumberOfPoints", 3}
    explicit VtkPolyData(std::initializer_list<std::pair<const char*, std::size_t>> counts);
};

/// A file of the type ImageData (.vti): a regular grid. Arrays of cells have x fastest.
class VtkImageData : public VtkFile {
public:
    /// Lower corner, edges and number of the cells along x, y, z
    VtkImageData(const std::array<double, 3>& low, const std::array<double, 3>& edge,
                 const std::array<int, 3>& cells);
};

/// A list of files with their times [s] (.pvd). Successive files with the same time are parts of one frame.
std::string vtk_collection(const std::vector<std::pair<double, std::string>>& files);

/// Adds a file, the second with this time if `same_time`, to the list in `path`, which vtk_collection() or
/// this function has written. The list is complete before and after. IoError.
void append_to_vtk_collection(const std::string& path, double t, const std::string& file, bool same_time);

}  // namespace hilda::io
