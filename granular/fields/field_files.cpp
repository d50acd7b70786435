// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/fields/field_files.hpp"

#include "io/formats/csv.hpp"
#include "io/formats/vtk.hpp"
#include "io/message.hpp"

namespace hilda::granular {

namespace {

/// Calls f(name, numbers) for each member of the values, numbers being an array of 1, 3 or 9 of them
template <class F>
void each_field(const FieldValues& v, const F& f)
{
    const auto three = [](const Vec3& a) { return std::array{a.x, a.y, a.z}; };
    f("density", std::array{v.density});
    f("volume_fraction", std::array{v.volume_fraction});
    f("momentum", three(v.momentum));
    f("velocity", three(v.velocity));
    f("kinetic_stress", v.kinetic_stress);
    f("contact_stress", v.contact_stress);
    f("boundary_force", three(v.boundary_force));
}

}  // namespace

std::string fields_csv_header()
{
    std::string names = "t,x,y,z";
    each_field({}, [&](const std::string& name, const auto& numbers) {
        names += ',' + name;
        if (numbers.size() == 3) names += "_x," + name + "_y," + name + "_z";
        for (std::size_t k = 0; numbers.size() == 9 && k < 9; ++k)
            names += (k == 0 ? "_" : ',' + name + '_') + "xyz"[k / 3] + "xyz"[k % 3];
    });
    return names + '\n';
}

void fields_csv(double t, const FieldGrid& grid, const FieldSums& sums, const io::Append& append_line)
{
    const std::string time = io::formatted("%.12g", t);
    std::string line;
    const auto append = [&](const auto& numbers) {
        for (const double x : numbers) line += ',', io::append_number(line, x);
    };
    for (int k = 0; k < grid.cells[2]; ++k)
        for (int j = 0; j < grid.cells[1]; ++j)
            for (int i = 0; i < grid.cells[0]; ++i) {
                const Vec3 at = grid.centre(i, j, k);
                line = time + io::formatted(",%.12g,%.12g,%.12g", at.x, at.y, at.z);
                each_field(sums.values(grid.number(i, j, k)),
                           [&](const char*, const auto& numbers) { append(numbers); });
                line += '\n';
                append_line(line);
            }
}

void fields_vti(const FieldGrid& grid, const FieldSums& sums, const io::Append& append)
{
    io::VtkImageData file(grid.low, {grid.edge(0), grid.edge(1), grid.edge(2)}, grid.cells);
    file.section("CellData");
    each_field({}, [&](const std::string& name, const auto& zeros) {
        const auto components = zeros.size();
        file.array<double>(name, static_cast<int>(components), grid.count() * components,
                           [&, name](const std::function<void(std::span<const double>)>& put) {
                               for (std::size_t n = 0; n < grid.count(); ++n)
                                   each_field(sums.values(n), [&](std::string_view of, const auto& numbers) {
                                       if (of == name) put(numbers);
                                   });
                           });
    });
    file.write(append);
}

}  // namespace hilda::granular
