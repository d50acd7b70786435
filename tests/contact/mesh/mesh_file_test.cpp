// SPDX-License-Identifier: GPL-3.0-or-later
/// Meshes from OBJ and STL files, directly and in a model.
#include <catch2/catch.hpp>

#include "contact/compliant/contact_force.hpp"
#include "contact/mesh/mesh_file.hpp"
#include "contact/mesh/mesh_surface.hpp"
#include "dae/model_file.hpp"
#include "tests/support/icosphere.hpp"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace hilda;
using namespace hilda::contact;

namespace {

namespace fs = std::filesystem;

/// A directory that is removed at the end
struct Folder {
    fs::path path;

    Folder()
    {
        std::string name = (fs::temp_directory_path() / "hilda-mesh-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path); }

    std::string write(const std::string& name, const std::string& content) const
    {
        std::ofstream(path / name, std::ios::binary) << content;
        return (path / name).string();
    }
};

std::string obj(const tests::Triangles& mesh, const std::string& line_end = "\n")
{
    std::ostringstream text;
    text.precision(17);
    text << "# a mesh" << line_end << "o stone" << line_end;
    for (const Vec3& x : mesh.vertices) text << "v " << x[0] << ' ' << x[1] << '\t' << x[2] << line_end;
    for (const Triangle& t : mesh.triangles)
        text << "f " << t[0] + 1 << "/1/1 " << t[1] + 1 << "//2 " << t[2] + 1 << line_end;
    return text.str();
}

std::string stl_text(const tests::Triangles& mesh, const std::string& line_end = "\n")
{
    std::ostringstream text;
    text.precision(17);
    text << "solid stone" << line_end;
    for (const Triangle& t : mesh.triangles) {
        text << "  facet normal 0 0 0" << line_end << "    outer loop" << line_end;
        for (const int v : t)
            text << "      vertex " << mesh.vertices[v][0] << ' ' << mesh.vertices[v][1] << ' '
                 << mesh.vertices[v][2] << line_end;
        text << "    endloop" << line_end << "  endfacet" << line_end;
    }
    return text.str() + "endsolid stone" + line_end;
}

std::string stl_binary(const tests::Triangles& mesh, const std::string& title = "binary")
{
    std::string bytes = title;
    bytes.resize(80);
    const auto append = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    append(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) append(0.f);
        for (const int v : t)
            for (int k = 0; k < 3; ++k) append(static_cast<float>(mesh.vertices[v][k]));
        append(std::uint16_t{0});
    }
    return bytes;
}

std::string model(const std::string& surface)
{
    return R"({"hilda_model": 1, "name": "stone",
  "bodies": [{"name": "stone", "mass": 1, "inertia": [0.4, 0.4, 0.4], "r": [0, 0, 1.0]}],
  "contacts": [{"body_i": "stone", "body_j": "ground", "surface_i": {"type": "mesh", )" +
           surface + R"(}, "surface_j": {"type": "plane"}, "normal": {"type": "hooke", "stiffness": 1e4}}]})";
}

std::string refusal_of_file(const std::string& path)
{
    try {
        dae::load_model(path);
        return "";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

}  // namespace

TEST_CASE("OBJ and STL files of a sphere are read as the same mesh", "[contact][mesh]")
{
    const tests::Triangles sphere = tests::icosphere(2);
    const std::string end = GENERATE("\n", "\r\n");
    const MeshFile from_obj = parse_obj(obj(sphere, end), "s.obj");
    CHECK(from_obj.vertices == sphere.vertices);
    CHECK(from_obj.triangles == sphere.triangles);
    CHECK(from_obj.vertex_line.front() == 3);

    const std::string title = GENERATE("binary", "solid in the header of a binary file");
    for (const MeshFile& stl :
         {parse_stl(stl_text(sphere, end), "s.stl"), parse_stl(stl_binary(sphere, title), "s.stl")}) {
        CHECK(stl.vertices.size() == sphere.vertices.size());
        REQUIRE(stl.triangles.size() == sphere.triangles.size());
        double largest = 0;
        for (std::size_t t = 0; t < stl.triangles.size(); ++t)
            for (int k = 0; k < 3; ++k)
                largest = std::max(
                    largest,
                    (stl.vertices[stl.triangles[t][k]] - sphere.vertices[sphere.triangles[t][k]]).norm());
        CHECK(largest < 1e-7);  // single precision
        CHECK_FALSE(TriangleMesh::fault(stl.vertices, stl.triangles));
    }
}

TEST_CASE("a text of a mesh may begin with a byte order mark", "[contact][mesh]")
{
    const std::string mark = "\xEF\xBB\xBF";
    const tests::Triangles sphere = tests::icosphere(0);
    for (const std::string end : {"\n", "\r\n"}) {
        CHECK(parse_stl(mark + stl_text(sphere, end), "s.stl").triangles.size() == sphere.triangles.size());
        CHECK(parse_obj(mark + "v 0 0 0" + end + "v 1 0 0" + end + "v 0 1 0" + end + "f 1 2 3" + end, "s.obj")
                  .triangles.size() == 1);
    }
    CHECK_THROWS_WITH(parse_obj(mark + "v 0 x 0\n", "s.obj"),
                      "s.obj:1: a vertex must have three finite numbers, got \"v 0 x 0\"");
}

TEST_CASE("an OBJ text is read and its errors are reported with the line", "[contact][mesh]")
{
    const auto read = [](const std::string& text) { return parse_obj(text, "box.obj"); };
    const std::string corners = "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\nv 0 0 +1 1.0\nvn 0 0 1\n";
    const MeshFile mesh = read(corners + "f 1 3 2\nf 1/1 2/2/2 4//3\nf -4 -1 -2\nf 2 3 4\n");
    CHECK(mesh.vertices[3] == Vec3(0, 0, 1));
    CHECK(mesh.triangles == std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
    const MeshFile pyramid =
        read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
    CHECK(pyramid.triangles.size() == 6);

    CHECK_THROWS_WITH(read("v 0 0 0\nv 1 x 0\n"),
                      "box.obj:2: a vertex must have three finite numbers, got \"v 1 x 0\"");
    CHECK_THROWS_WITH(read("v 0 0\r\n"), "box.obj:1: a vertex must have three finite numbers, got \"v 0 0\"");
    CHECK_THROWS_WITH(read("v 0 nan 0\n"), Catch::StartsWith("box.obj:1: a vertex must have three finite"));
    CHECK_THROWS_WITH(read("v 0 1e999 0\n"), Catch::StartsWith("box.obj:1: a vertex must have three finite"));
    CHECK_THROWS_WITH(read(corners + "f 1 2\n"),
                      "box.obj:8: a face must have at least three corners, got \"f 1 2\"");
    CHECK_THROWS_WITH(read(corners + "f 1 2 5\n"),
                      "box.obj:8: vertex 5 is not defined; the number of vertices is 4");
    CHECK_THROWS_WITH(read(corners + "f 1 2 0\n"),
                      "box.obj:8: vertex 0 is not defined; the number of vertices is 4");
    CHECK_THROWS_WITH(read(corners + "f 1 2 x\n"),
                      "box.obj:8: a corner of a face must be the number of a vertex, got \"x\"");
    std::string many = corners;
    for (int k = 0; k < 200001; ++k) many += "f 1 2 3\n";
    CHECK_THROWS_WITH(read(many), "box.obj: a mesh may have at most 200000 triangles, got 200001 or more");
}

TEST_CASE("errors of an STL file are reported with the line or the number of bytes", "[contact][mesh]")
{
    const auto read = [](const std::string& text) { return parse_stl(text, "box.stl"); };
    const std::string facet = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
    CHECK(read(facet + "vertex 0 1 0\nendloop\nendfacet\nendsolid\n").triangles.size() == 1);
    CHECK_THROWS_WITH(read(facet + "endloop\nendfacet\n"),
                      "box.stl:7: a facet must have three vertices, got 2");
    CHECK_THROWS_WITH(read(facet + "vertex 0 1 0\nvertex 1 1 0\n"),
                      "box.stl:7: a facet must have three vertices");
    CHECK_THROWS_WITH(read(facet + "vertex 0 one 0\n"),
                      "box.stl:6: a vertex must have three finite numbers, got \"vertex 0 one 0\"");
    CHECK_THROWS_WITH(read(facet + "vertx 0 1 0\n"),
                      Catch::StartsWith("box.stl:6: a line of an STL text must begin"));
    CHECK_THROWS_WITH(read(facet), "box.stl:5: the file ends within a facet");
    CHECK_THROWS_WITH(read(facet + "facet\n"), Catch::Contains("must end with endfacet before the next one"));
    const std::string garbage(200, '\x7f');
    CHECK_THROWS_WITH(read(garbage), Catch::StartsWith("box.stl: is no STL file: a text begins with solid"));
    CHECK_THROWS_WITH(read(""), Catch::Contains("got 0"));
    std::string binary = stl_binary(tests::icosphere(0));
    CHECK_THROWS_WITH(
        read(binary.substr(0, binary.size() - 1)),
        "box.stl: is no STL file: a text begins with solid, and a binary file of 20 triangles has 1084 "
        "bytes, got 1083");
    const float nan = std::nanf("");
    std::memcpy(binary.data() + 84 + 50 * 7 + 16, &nan, sizeof nan);
    CHECK_THROWS_WITH(read(binary), "box.stl: the corners of triangle 7 must be finite");
}

TEST_CASE("a model reads the mesh of a file beside it, and its canonical form contains the mesh",
          "[contact][mesh]")
{
    const Folder folder;
    const tests::Triangles sphere = tests::icosphere(2);
    folder.write("stone.obj", obj(sphere));
    folder.write("Stone.STL", stl_binary(sphere));
    const std::string text = model(R"("file": "stone.obj", "scale": "1/2")");
    const std::string path = folder.write("m.json", text);
    const dae::Description d = dae::load_model(path);
    const auto surface = [](const dae::Description& of) {
        const auto* force = dynamic_cast<const ContactForce*>(of.model->forces()[0].get());
        return dynamic_cast<const MeshSurface*>(force->contact.i.surface.get());
    };
    REQUIRE(surface(d) != nullptr);
    CHECK(surface(d)->mesh.vertices[5] == Vec3(0.5 * sphere.vertices[5]));
    CHECK_THAT(d.text,
               Catch::Contains("\"vertices\"") && !Catch::Contains("stone.obj") && !Catch::Contains("scale"));
    const dae::Description again = dae::read_model(d.text, "again.json");
    CHECK(again.text == d.text);
    CHECK(surface(again)->mesh.vertices == surface(d)->mesh.vertices);

    const std::string stl = folder.write("s.json", model(R"("file": "Stone.STL")"));
    CHECK(surface(dae::load_model(stl))->mesh.triangles.size() == 320);
    const std::string absolute =
        folder.write("a.json", model("\"file\": \"" + (folder.path / "stone.obj").string() + "\""));
    CHECK(surface(dae::load_model(absolute))->mesh.triangles == sphere.triangles);
    CHECK_NOTHROW(dae::read_model(text, "other.json", {}, "", folder.path.string()));
}

TEST_CASE("a mesh file that cannot be used is refused with its place in the model and in the file",
          "[contact][mesh]")
{
    const Folder folder;
    const auto says = [&](const std::string& surface) {
        const std::string message = refusal_of_file(folder.write("m.json", model(surface)));
        const std::string place = (folder.path / "m.json").string() + ":3:";
        INFO(message);
        CHECK(message.starts_with(place));
        CHECK(message.find('\n') == std::string::npos);
        return message;
    };
    const std::string in = folder.path.string() + "/";
    CHECK_THAT(says(R"("file": "none.obj")"),
               Catch::EndsWith("(/contacts/0/surface_i/file): " + in + "none.obj: does not exist"));
    CHECK_THAT(says(R"("file": "stone.ply")"),
               Catch::EndsWith("stone.ply: the name of a mesh file must end in .obj or .stl"));
    CHECK_THAT(says(R"("file": "")"), Catch::EndsWith("file must be the path of a file, got \"\""));
    CHECK_THAT(says(R"("file": 7)"), Catch::EndsWith("file must be the path of a file, got 7"));
    fs::create_directory(folder.path / "d.obj");
    CHECK_THAT(says(R"("file": "d.obj")"), Catch::EndsWith("d.obj: is not a regular file"));
    tests::Triangles open = tests::icosphere(2);
    open.triangles.pop_back();
    folder.write("open.obj", obj(open));
    CHECK_THAT(says(R"("file": "open.obj")"),
               Catch::Contains("open.obj: the edge of the vertices ") && Catch::Contains("is open"));
    tests::Triangles flat = tests::icosphere(1);
    flat.triangles[3][2] = flat.triangles[3][1];
    folder.write("flat.obj", obj(flat));
    CHECK_THAT(says(R"("file": "flat.obj")"), Catch::EndsWith("flat.obj:48: triangle 3 has zero area"));
    folder.write("flat.stl", stl_text(flat));
    CHECK_THAT(says(R"("file": "flat.stl")"), Catch::EndsWith("flat.stl:23: triangle 3 has zero area"));
    folder.write("coarse.obj", obj(tests::icosphere(0)));
    CHECK_THAT(says(R"("file": "coarse.obj")"),
               Catch::Contains("coarse.obj: the mesh is too coarse for a smooth surface"));
    folder.write("empty.obj", "");
    CHECK_THAT(says(R"("file": "empty.obj")"), Catch::EndsWith("empty.obj: a mesh must have triangles"));
    std::ofstream(folder.path / "huge.stl").close();
    fs::resize_file(folder.path / "huge.stl", std::uintmax_t{1} << 40);
    CHECK_THAT(says(R"("file": "huge.stl")"), Catch::Contains("huge.stl: is larger than 67108864 bytes"));
    folder.write("ok.obj", obj(tests::icosphere(2)));
    CHECK_THAT(says(R"("file": "ok.obj", "scale": 0)"),
               Catch::EndsWith("(/contacts/0/surface_i/scale): scale must be positive, got 0"));
    CHECK_THAT(says(R"("file": "ok.obj", "vertices": [[0, 0, 0]])"),
               Catch::EndsWith("give one of file and vertices, not both"));
    CHECK_THAT(says(R"("vertices": [[0, 0, 0]], "triangles": [[0, 0, 0]], "scale": 2)"),
               Catch::EndsWith("scale is for a mesh from a file"));
}
