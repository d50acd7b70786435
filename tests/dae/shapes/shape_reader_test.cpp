// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the reader of convex shapes: vertices, files, the position of the centre of mass, and messages.
#include <catch2/catch.hpp>

#include "dae/model_file.hpp"
#include "io/files.hpp"

#include <filesystem>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

std::string body_text(const std::string& keys)
{
    return R"({"hilda_model": 1, "name": "m", "bodies": [{"name": "b", )" + keys + R"(, "r": [0, 0, 0]}]})";
}

dae::Description read_shape_body(const std::string& keys)
{
    return dae::read_model(body_text(keys), "m.json");
}

std::string refusal_of_shape(const std::string& keys)
{
    try {
        read_shape_body(keys);
        return "";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

struct TemporaryFolder {
    std::filesystem::path path;

    TemporaryFolder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "hilda-shape-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path); }
};

const std::string corner = "[[0, 0, 0], [0.4, 0, 0], [0, 0.8, 0], [0, 0, 1.2]]";

}  // namespace

TEST_CASE("a convex shape and a density give mass and full inertia, and the canonical form is the same body",
          "[dae][shape]")
{
    const dae::Description d = read_shape_body(R"("density": 1000, "shape": {"convex": {"vertices": )" +
                                               corner + R"(, "position": [-0.1, -0.2, -0.3]}})");
    const dae::Body& b = d.model->all_bodies()[0];
    CHECK(b.m == Approx(64).epsilon(1e-14));
    CHECK(b.J_bar(0, 0) == Approx(64. / 80 * 3 * (0.64 + 1.44)).epsilon(1e-13));
    CHECK(b.J_bar(0, 1) == Approx(64. / 80 * 0.32).epsilon(1e-13));
    CHECK(b.J_bar == b.J_bar.transpose());
    REQUIRE(b.shape);
    CHECK(b.shape->centroid().norm() < 1e-15);
    const dae::Description again = dae::read_model(d.text, "again.json");
    CHECK(again.text == d.text);
    CHECK(again.model->all_bodies()[0].J_bar == b.J_bar);
    // with a mass
    CHECK((read_shape_body(R"("mass": 64, "shape": {"convex": {"vertices": )" + corner +
                           R"(, "position": [-0.1, -0.2, -0.3]}})")
               .model->all_bodies()[0]
               .J_bar -
           b.J_bar)
              .norm() < 1e-13 * b.J_bar.norm());
}

TEST_CASE("the message about a centre of mass beside the origin has the position that moves it there",
          "[dae][shape]")
{
    const std::string shape = R"("shape": {"convex": {"vertices": )" + corner;
    CHECK_THAT(
        refusal_of_shape(R"("density": 1, )" + shape + "}}"),
        Catch::Contains("(/bodies/0/shape/convex): the centre of mass of a homogeneous body must be at "
                        "the origin of the body frame, got [0.1, 0.2, 0.3] m") &&
            Catch::Contains(R"("position": [-0.1, -0.2, -0.3] moves it there)"));
    CHECK_THAT(refusal_of_shape(R"("mass": 1, )" + shape + R"(, "position": [-0.2, -0.2, -0.3]}})"),
               Catch::Contains(R"("position": [-0.1)"));
    // With an inertia the shape is for pictures only.
    CHECK(refusal_of_shape(R"("mass": 1, "inertia": [1, 1, 1], )" + shape + "}}").empty());
}

TEST_CASE("a convex shape is read from a mesh file", "[dae][shape]")
{
    const TemporaryFolder folder;
    io::write_file(folder.path / "stone.obj",
                   "v 0 0 0\nv 400 0 0\nv 0 800 0\nv 0 0 1200\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    const std::string keys = R"("density": 1000, "shape": {"convex": {"file": "stone.obj", "scale": 1e-3, )"
                             R"("position": [-0.1, -0.2, -0.3]}})";
    const dae::Description d = dae::read_model(body_text(keys), "m.json", {}, "", folder.path);
    CHECK(d.model->all_bodies()[0].m == Approx(64).epsilon(1e-13));
    CHECK_THAT(d.text, Catch::Contains("vertices") && !Catch::Contains("stone.obj"));
    CHECK(dae::read_model(d.text, "again.json").text == d.text);
}

TEST_CASE("wrong convex shapes are refused with their place and value", "[dae][shape]")
{
    const auto says = [](const std::string& convex, const std::string& expected) {
        CHECK_THAT(refusal_of_shape(R"("mass": 1, "shape": {"convex": )" + convex + "}"),
                   Catch::Contains("m.json:1:") && Catch::Contains(expected));
    };
    says("{}", "(/bodies/0/shape/convex): missing key 'vertices'");
    says("[[0, 0, 0]]", "(/bodies/0/shape/convex): must be an object, got a list of 1");
    says(R"({"vertices": []})", "vertices must not be empty");
    says(R"({"vertices": [[0, 0]]})", "vertices[0] must be a list of 3 numbers, got [0, 0]");
    says(R"({"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]})",
         "(/bodies/0/shape/convex/vertices): a convex shape: needs at least 4 vertices, got 3");
    says(R"({"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]})", "must not lie in a plane");
    says(R"({"vertices": [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [1, 1, 1]]})",
         "got vertex 4, which lies");
    says(R"({"vertices": )" + corner + R"(, "scale": 2})", "scale is for a shape from a file");
    says(R"({"vertices": )" + corner + R"(, "file": "a.stl"})", "give one of file and vertices, not both");
    says(R"({"file": "missing.stl"})", "missing.stl");
    says(R"({"vertices": )" + corner + R"(, "corner": 2})", "unknown key \"corner\"");
}
