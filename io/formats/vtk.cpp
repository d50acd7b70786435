// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/formats/vtk.hpp"

#include "io/error.hpp"
#include "io/formats/csv.hpp"

#include <cstdint>
#include <fstream>
#include <string_view>
#include <type_traits>

namespace hilda::io {

namespace {

std::string begin_of_file(const std::string& type, const std::string& of_file = "",
                          const std::string& attributes = "")
{
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
           "\" version=\"1.0\" byte_order=\"LittleEndian\"" + of_file + ">\n<" + type + attributes + ">\n";
}

/// An attribute with three values. append(text, k) appends value k.
template <class Append>
std::string attribute(const char* name, const Append& append)
{
    std::string text = std::string(" ") + name + "=\"";
    for (std::size_t k = 0; k < 3; ++k) {
        if (k > 0) text += ' ';
        append(text, k);
    }
    return text + '"';
}
std::string attribute(const char* name, const std::array<double, 3>& numbers)
{
    return attribute(name, [&](std::string& text, std::size_t k) { append_number(text, numbers[k]); });
}
std::string extent(const char* name, const std::array<int, 3>& cells)
{
    return attribute(name,
                     [&](std::string& text, std::size_t k) { text += "0 " + std::to_string(cells[k]); });
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

VtkFile::VtkFile(std::string of_type, const std::string& attributes, const std::string& of_piece)
    : type(std::move(of_type)), xml(begin_of_file(type, " header_type=\"UInt64\"", attributes))
{
    xml += "<Piece" + of_piece + ">\n";
}

VtkPolyData::VtkPolyData(std::initializer_list<std::pair<const char*, std::size_t>> counts)
    : VtkFile("PolyData", "", [&] {
          std::string all;
          for (const auto& [name, count] : counts)
              all += std::string(" ") + name + "=\"" + std::to_string(count) + '"';
          return all;
      }())
{}

VtkImageData::VtkImageData(const std::array<double, 3>& low, const std::array<double, 3>& edge,
                           const std::array<int, 3>& cells)
    : VtkFile("ImageData",
              extent("WholeExtent", cells) + attribute("Origin", low) + attribute("Spacing", edge),
              extent("Extent", cells))
{}

void VtkFile::section(const std::string& name)
{
    end_section();
    open_section = name;
    xml += '<' + name + ">\n";
}

void VtkFile::end_section()
{
    if (!open_section.empty()) xml += "</" + open_section + ">\n";
    open_section.clear();
}

template <class Number>
void VtkFile::array(const std::string& name, int components, const std::vector<Number>& values)
{
    array<Number>(name, components, values.size(),
                  [values](const std::function<void(std::span<const Number>)>& put) { put(values); });
}
template void VtkFile::array(const std::string&, int, const std::vector<float>&);
template void VtkFile::array(const std::string&, int, const std::vector<double>&);
template void VtkFile::array(const std::string&, int, const std::vector<std::int32_t>&);

template <class Number>
void VtkFile::array(const std::string& name, int components, std::size_t count,
                    std::function<void(const std::function<void(std::span<const Number>)>&)> numbers)
{
    const std::string type = std::is_integral_v<Number>      ? "Int32"
                             : std::is_same_v<Number, float> ? "Float32"
                                                             : "Float64";
    xml += "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(size) + "\"/>\n";
    const std::uint64_t bytes = count * sizeof(Number);
    size += sizeof bytes + bytes;
    blocks.emplace_back([bytes, numbers = std::move(numbers)](const Append& append) {
        constexpr std::size_t full = 1 << 20;
        std::string piece(reinterpret_cast<const char*>(&bytes), sizeof bytes);
        numbers([&](std::span<const Number> some) {
            piece.append(reinterpret_cast<const char*>(some.data()), some.size_bytes());
            if (piece.size() < full) return;
            append(piece);
            piece.clear();
        });
        append(piece);
    });
}
template void VtkFile::array(const std::string&, int, std::size_t,
                             std::function<void(const std::function<void(std::span<const float>)>&)>);
template void VtkFile::array(const std::string&, int, std::size_t,
                             std::function<void(const std::function<void(std::span<const double>)>&)>);
template void VtkFile::array(const std::string&, int, std::size_t,
                             std::function<void(const std::function<void(std::span<const std::int32_t>)>&)>);

void VtkFile::write(const Append& append)
{
    end_section();
    append(xml + "</Piece>\n</" + type + ">\n<AppendedData encoding=\"raw\">\n_");
    for (const auto& block : blocks) block(append);
    append("\n</AppendedData>\n</VTKFile>\n");
}

std::string VtkFile::text()
{
    std::string all;
    write([&](std::string_view piece) { all += piece; });
    return all;
}

namespace {

constexpr std::string_view end_of_collection = "</Collection>\n</VTKFile>\n";

void append_entry(std::string& xml, double t, int part, const std::string& file)
{
    xml += "<DataSet timestep=\"";
    append_number(xml, t);
    xml += "\" part=\"" + std::to_string(part) + "\" file=\"" + escaped(file) + "\"/>\n";
}

}  // namespace

std::string vtk_collection(const std::vector<std::pair<double, std::string>>& files)
{
    std::string xml = begin_of_file("Collection");
    int part = 0;
    for (size_t k = 0; k < files.size(); ++k) {
        part = k > 0 && files[k].first == files[k - 1].first ? part + 1 : 0;
        append_entry(xml, files[k].first, part, files[k].second);
    }
    return xml.append(end_of_collection);
}

void append_to_vtk_collection(const std::string& path, double t, const std::string& file, bool same_time)
{
    std::string entry;
    append_entry(entry, t, same_time ? 1 : 0, file);
    entry.append(end_of_collection);
    // One write over the end of the list, which the entry exceeds in length
    std::fstream list(path, std::ios::in | std::ios::out | std::ios::binary);
    list.seekp(-static_cast<std::streamoff>(end_of_collection.size()), std::ios::end);
    list << entry << std::flush;
    if (!list) throw IoError(path + ": cannot be written");
}

}  // namespace hilda::io
