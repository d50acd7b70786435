// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/formats/mesh_file.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

namespace hilda::io {

namespace {

/// The lines of a text and their words
class Lines {
public:
    Lines(std::string_view text, const std::string& name) : rest(text), name(name) {}

    /// Reads the next line that is not blank; false at the end
    bool next()
    {
        do {
            if (rest.empty()) return false;
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            line = rest.substr(0, end);
            rest.remove_prefix(std::min(end + 1, rest.size()));
            if (line.ends_with('\r')) line.remove_suffix(1);
            ++number;
            words = line;
            first = word();
        } while (first.empty());
        return true;
    }

    /// The next word of the line, or ""
    std::string_view word()
    {
        const std::size_t begin = std::min(words.find_first_not_of(blanks), words.size());
        words.remove_prefix(begin);
        const std::string_view found = words.substr(0, words.find_first_of(blanks));
        words.remove_prefix(found.size());
        return found;
    }

    std::array<double, 3> point()
    {
        std::array<double, 3> x{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::string_view w = word();
            const char* const begin = w.data() + (w.starts_with('+') ? 1 : 0);
            const auto [end, error] = std::from_chars(begin, w.data() + w.size(), x[k]);
            if (error != std::errc() || end != w.data() + w.size() || !std::isfinite(x[k]))
                refuse("a vertex must have three finite numbers, got " + in_quotes(line));
        }
        return x;
    }

    [[noreturn]] void refuse(const std::string& what) const
    {
        throw InvalidInput(name + ":" + std::to_string(number) + ": " + what);
    }

    std::string_view line, first;  ///< the whole line, and its first word
    int number = 0;

private:
    static constexpr std::string_view blanks = " \t\v\f\r";
    std::string_view rest, words;
    const std::string& name;
};

void check_count(std::size_t triangles, std::size_t most, const std::string& name)
{
    if (triangles > most)
        throw InvalidInput(name + ": a mesh may have at most " + std::to_string(most) + " triangles, got " +
                           std::to_string(triangles) + " or more");
}

/// Numbers the corners of triangles so that equal points have one number
class Corners {
public:
    explicit Corners(MeshFile& mesh) : mesh(mesh) {}

    int number(const std::array<double, 3>& x, int line)
    {
        const auto [at, is_new] = known.try_emplace({x[0] + 0., x[1] + 0., x[2] + 0.},  // -0 becomes 0
                                                    static_cast<int>(mesh.vertices.size()));
        if (is_new) {
            mesh.vertices.push_back(x);
            if (line > 0) mesh.vertex_line.push_back(line);
        }
        return at->second;
    }

private:
    MeshFile& mesh;
    std::map<std::array<double, 3>, int> known;
};

MeshFile parse_stl_text(std::string_view text, const std::string& name, std::size_t most)
{
    MeshFile mesh{.name = name, .vertices = {}, .triangles = {}, .vertex_line = {}, .triangle_line = {}};
    Corners corners(mesh);
    Lines lines(text, name);
    std::array<int, 3> triangle{};
    int count = -1, facet_line = 0;  // corners of the facet that is being read; -1: none
    while (lines.next()) {
        std::string word(lines.first);
        std::transform(word.begin(), word.end(), word.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        if (word == "facet") {
            if (count >= 0) lines.refuse("a facet must end with endfacet before the next one begins");
            count = 0;
            facet_line = lines.number;
        } else if (word == "vertex") {
            if (count < 0 || count == 3) lines.refuse("a facet must have three vertices");
            triangle[static_cast<std::size_t>(count++)] = corners.number(lines.point(), lines.number);
        } else if (word == "endfacet") {
            if (count != 3)
                lines.refuse("a facet must have three vertices, got " + std::to_string(std::max(count, 0)));
            mesh.triangles.push_back(triangle);
            mesh.triangle_line.push_back(facet_line);
            check_count(mesh.triangles.size(), most, name);
            count = -1;
        } else if (word != "solid" && word != "endsolid" && word != "outer" && word != "endloop") {
            lines.refuse(
                "a line of an STL text must begin with solid, facet, outer loop, vertex, endloop, "
                "endfacet or endsolid, got " +
                in_quotes(lines.line));
        }
    }
    if (count >= 0) lines.refuse("the file ends within a facet");
    return mesh;
}

}  // namespace

MeshFile parse_obj(std::string_view text, const std::string& name, std::size_t most)
{
    MeshFile mesh{.name = name, .vertices = {}, .triangles = {}, .vertex_line = {}, .triangle_line = {}};
    Corners vertices(mesh);
    std::vector<int> number;  // of the vertex of each line v
    Lines lines(without_byte_order_mark(text), name);
    while (lines.next()) {
        if (lines.first == "v") {
            number.push_back(vertices.number(lines.point(), lines.number));
        } else if (lines.first == "f") {
            // a corner is v, v/vt, v//vn or v/vt/vn; v counts from 1, or from the last vertex if negative
            std::vector<int> corners;
            const int known = static_cast<int>(number.size());
            for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
                int v = 0;
                const std::string_view digits = word.substr(0, word.find('/'));
                const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v);
                if (error != std::errc() || end != digits.data() + digits.size())
                    lines.refuse("a corner of a face must be the number of a vertex, got " + in_quotes(word));
                if (v == 0 || v > known || v < -known)
                    lines.refuse("vertex " + std::to_string(v) +
                                 " is not defined; the number of vertices is " + std::to_string(known));
                corners.push_back(number[static_cast<std::size_t>(v > 0 ? v - 1 : known + v)]);
            }
            if (corners.size() < 3)
                lines.refuse("a face must have at least three corners, got " + in_quotes(lines.line));
            const auto normal = [&](std::size_t k) {
                const auto corner = [&](std::size_t c) {
                    return mesh.vertices[static_cast<std::size_t>(corners[c])];
                };
                const std::array<double, 3> a = corner(0), b = corner(k), c = corner(k + 1);
                std::array<double, 3> n{};
                for (std::size_t x = 0; x < 3; ++x) {
                    const std::size_t y = (x + 1) % 3, z = (x + 2) % 3;
                    n[x] = (b[y] - a[y]) * (c[z] - a[z]) - (b[z] - a[z]) * (c[y] - a[y]);
                }
                return n;
            };
            for (std::size_t k = 2; k + 1 < corners.size(); ++k) {
                const auto m = normal(k - 1), n = normal(k);
                if (m[0] * n[0] + m[1] * n[1] + m[2] * n[2] < 0)
                    lines.refuse("a face of more than three corners must be convex, got " +
                                 in_quotes(lines.line));
            }
            for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
                mesh.triangles.push_back({corners[0], corners[k], corners[k + 1]});
                mesh.triangle_line.push_back(lines.number);
            }
            check_count(mesh.triangles.size(), most, name);
        }
    }
    return mesh;
}

MeshFile parse_stl(std::string_view bytes, const std::string& name, std::size_t most)
{
    constexpr std::size_t header = 80, each = 50;
    std::uint32_t count = 0;  // the bytes of the file and of this processor are little-endian
    if (bytes.size() >= header + sizeof count) std::memcpy(&count, bytes.data() + header, sizeof count);
    const bool binary = bytes.size() >= header + sizeof count &&
                        bytes.size() == header + sizeof count + each * std::size_t{count};
    const std::string_view text = without_byte_order_mark(bytes);
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    const bool is_text = begin != std::string_view::npos && [&] {
        constexpr std::string_view word = "solid";
        const std::string_view first = text.substr(begin, word.size());
        return std::equal(first.begin(), first.end(), word.begin(), word.end(),
                          [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
    }();
    if (!binary && is_text) return parse_stl_text(text, name, most);
    if (!binary)
        throw InvalidInput(name + ": is no STL file: a text begins with solid, and a binary file of " +
                           std::to_string(count) + " triangles has " +
                           std::to_string(header + sizeof count + each * std::size_t{count}) +
                           " bytes, got " + std::to_string(bytes.size()));
    check_count(count, most, name);
    MeshFile mesh{.name = name, .vertices = {}, .triangles = {}, .vertex_line = {}, .triangle_line = {}};
    Corners corners(mesh);
    for (std::size_t t = 0; t < count; ++t) {
        float x[12];  // normal and three corners
        std::memcpy(x, bytes.data() + header + sizeof count + each * t, sizeof x);
        std::array<int, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::array<double, 3> corner = {x[3 + 3 * k], x[4 + 3 * k], x[5 + 3 * k]};
            if (!std::all_of(corner.begin(), corner.end(), [](double c) { return std::isfinite(c); }))
                throw InvalidInput(name + ": the corners of triangle " + std::to_string(t) +
                                   " must be finite");
            triangle[k] = corners.number(corner, 0);
        }
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

MeshFile read_mesh_file(const std::string& path, std::size_t max_bytes, std::size_t most)
{
    std::string ending = path.substr(path.size() - std::min<std::size_t>(path.size(), 4));
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending != ".obj" && ending != ".stl")
        throw InvalidInput(path + ": the name of a mesh file must end in .obj or .stl");
    try {
        const std::string bytes = read_file(path, max_bytes);
        return ending == ".obj" ? parse_obj(bytes, path, most) : parse_stl(bytes, path, most);
    } catch (const IoError& e) {
        throw InvalidInput(e.what());
    }
}

}  // namespace hilda::io
