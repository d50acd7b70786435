// SPDX-License-Identifier: GPL-3.0-or-later
/// Fields as tables (CSV) and as grids for ParaView (VTK).

#pragma once

#include "granular/fields/field_sums.hpp"
#include "io/files.hpp"

#include <string>

namespace hilda::granular {

/// t,x,y,z,density,...: the columns of fields_csv()
std::string fields_csv_header();
/// Passes on one line per cell, x fastest, with the centre of the cell and the members of FieldValues. SI
/// units, global frame.
void fields_csv(double t, const FieldGrid& grid, const FieldSums& sums, const io::Append& append);
/// The same as VTK XML ImageData: cell data with the names of the members of FieldValues
void fields_vti(const FieldGrid& grid, const FieldSums& sums, const io::Append& append);

}  // namespace hilda::granular
