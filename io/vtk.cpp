// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vtk.hpp"

#include "io/csv.hpp"

#include <cstdint>
#include <string_view>
#include <type_traits>

namespace hilda::io {

namespace {

std::string begin_of_file(const std::string& type, const std::string& attributes = "")
{
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
           "\" version=\"1.0\" byte_order=\"LittleEndian\"" + attributes + ">\n<" + type + ">\n";
}

std::string escaped(const std::string& name)
{
    constexpr std::string_view special = "&<>\"";
    constexpr std::string_view as[] = {"&amp;", "&lt;", "&gt;", "&quot;"};
    std::string xml;
    for (const char& c : name) {
        const size_t k = special.find(c);
        xml += k < special.size() ? as[k] : std::string_view(&c, 1);
    }
    return xml;
}

}  // namespace

VtkPolyData::VtkPolyData(std::initializer_list<std::pair<const char*, std::size_t>> counts)
    : xml(begin_of_file("PolyData", " header_type=\"UInt64\""))
{
    xml += "<Piece";
    for (const auto& [name, count] : counts)
        xml += std::string(" ") + name + "=\"" + std::to_string(count) + '"';
    xml += ">\n";
}

void VtkPolyData::section(const std::string& name)
{
    end_section();
    open_section = name;
    xml += '<' + name + ">\n";
}

void VtkPolyData::end_section()
{
    if (!open_section.empty()) xml += "</" + open_section + ">\n";
    open_section.clear();
}

template <class Number>
void VtkPolyData::array(const std::string& name, int components, const std::vector<Number>& values)
{
    const std::string type = std::is_integral_v<Number>      ? "Int32"
                             : std::is_same_v<Number, float> ? "Float32"
                                                             : "Float64";
    xml += "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(blocks.size()) +
           "\"/>\n";
    const std::uint64_t size = values.size() * sizeof(Number);
    blocks.append(reinterpret_cast<const char*>(&size), sizeof size);
    blocks.append(reinterpret_cast<const char*>(values.data()), size);
}
template void VtkPolyData::array(const std::string&, int, const std::vector<float>&);
template void VtkPolyData::array(const std::string&, int, const std::vector<double>&);
template void VtkPolyData::array(const std::string&, int, const std::vector<std::int32_t>&);

std::string VtkPolyData::text()
{
    end_section();
    xml += "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" + blocks + "\n</AppendedData>\n";
    return std::move(xml += "</VTKFile>\n");
}

std::string vtk_collection(const std::vector<std::pair<double, std::string>>& files)
{
    std::string xml = begin_of_file("Collection");
    int part = 0;
    for (size_t k = 0; k < files.size(); ++k) {
        part = k > 0 && files[k].first == files[k - 1].first ? part + 1 : 0;
        xml += "<DataSet timestep=\"";
        append_number(xml, files[k].first);
        xml += "\" part=\"" + std::to_string(part) + "\" file=\"" + escaped(files[k].second) + "\"/>\n";
    }
    return xml + "</Collection>\n</VTKFile>\n";
}

}  // namespace hilda::io
