// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/vtk.hpp"

#include "contact/implicit_surface.hpp"
#include "contact/mesh/height_map.hpp"
#include "contact/mesh/mesh_surface.hpp"
#include "contact/surfaces/cone.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "contact/surfaces/torus.hpp"
#include "tests/support/icosphere.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>

using namespace hilda;
using Catch::Matchers::Contains;
using contact::PolygonMesh;
using lie::Vec3;
using run::Snapshots;
using tests::call;
using tests::Ended;
using tests::Scratch;

namespace {

/// The XML part of a VTK file: elements with quoted attributes; throws if it is not well-formed
struct Xml {
    struct Element {
        std::string name;
        std::map<std::string, std::string> attribute;
    };
    std::vector<Element> element;

    explicit Xml(const std::string& file)
    {
        std::vector<size_t> open;
        size_t at = 0;
        while ((at = file.find('<', at)) != std::string::npos) {
            const size_t end = file.find('>', at);
            if (end == std::string::npos) throw std::runtime_error("a tag has no end");
            std::string tag = file.substr(at + 1, end - at - 1);
            at = end + 1;
            if (tag.starts_with('?')) continue;
            if (tag.starts_with('/')) {
                if (open.empty() || element[open.back()].name != tag.substr(1))
                    throw std::runtime_error("</" + tag.substr(1) + "> closes nothing");
                open.pop_back();
                continue;
            }
            const bool empty = tag.ends_with('/');
            if (empty) tag.pop_back();
            read(tag);
            if (element.back().name == "AppendedData") at = file.rfind("</AppendedData>");
            if (!empty) open.push_back(element.size() - 1);
        }
        if (!open.empty()) throw std::runtime_error("<" + element[open.back()].name + "> is not closed");
    }

    /// The first element of that name, or the <DataArray> of that Name
    const Element& named(const std::string& name) const
    {
        return find(name, [&](const Element& e) { return e.name == name; });
    }
    const Element& array(const std::string& name) const
    {
        return find(
            name, [&](const Element& e) { return e.name == "DataArray" && e.attribute.at("Name") == name; });
    }

private:
    const Element& find(const std::string& name, const std::function<bool(const Element&)>& is) const
    {
        const auto at = std::find_if(element.begin(), element.end(), is);
        if (at == element.end()) throw std::runtime_error("there is no element " + name);
        return *at;
    }
    void read(const std::string& tag)
    {
        size_t at = tag.find(' ');
        Element e{.name = tag.substr(0, at), .attribute = {}};
        while (at < tag.size()) {
            const size_t is = tag.find("=\"", at);
            if (is == std::string::npos) throw std::runtime_error("an attribute has no value: " + tag);
            const size_t end = tag.find('"', is + 2);
            if (end == std::string::npos) throw std::runtime_error("a value has no end: " + tag);
            e.attribute[tag.substr(at + 1, is - at - 1)] = tag.substr(is + 2, end - is - 2);
            at = end + 1;
        }
        element.push_back(std::move(e));
    }
};

/// A frame; the constructor checks the sizes of its arrays
struct Frame {
    std::vector<Vec3> point, velocity, N, F;
    std::vector<double> slipping, rolling, body, contact, kind;
    using Cells = std::vector<std::vector<size_t>>;
    Cells vertex, line, polygon;

    explicit Frame(const tests::fs::path& file) : text(tests::read(file)), xml(text)
    {
        CHECK(xml.named("VTKFile").attribute.at("type") == "PolyData");
        const size_t points = count("Points"), all_cells = count("Verts") + count("Lines") + count("Polys");
        const auto array = [&](const std::string& name, size_t size) {
            std::vector<double> all = numbers(xml.array(name));
            INFO(name);
            REQUIRE(all.size() == size);
            return all;
        };
        const auto vectors = [&](const std::string& name) {
            const std::vector<double> all = array(name, 3 * points);
            std::vector<Vec3> v;
            for (size_t k = 0; k < all.size(); k += 3) v.emplace_back(all[k], all[k + 1], all[k + 2]);
            return v;
        };
        point = vectors("Points"), velocity = vectors("velocity");
        N = vectors("normal_force"), F = vectors("friction");
        slipping = array("slipping", points), rolling = array("rolling", points);
        body = array("body", all_cells), contact = array("contact", all_cells),
        kind = array("kind", all_cells);
        vertex = cells("Verts"), line = cells("Lines"), polygon = cells("Polys");
    }

    /// The contact points, which precede the points of joints
    Cells contacts() const
    {
        return {vertex.begin(),
                vertex.begin() + std::count(kind.begin(), kind.end(), Snapshots::contact_point)};
    }

private:
    size_t count(const std::string& of) const
    {
        return std::stoul(xml.named("Piece").attribute.at("NumberOf" + of));
    }
    /// The numbers of an array of appended raw data
    std::vector<double> numbers(const Xml::Element& array) const
    {
        const size_t begin = text.find('_', text.find("<AppendedData")) + 1;
        const char* at = text.data() + begin + std::stoul(array.attribute.at("offset"));
        std::uint64_t size = 0;
        std::memcpy(&size, at, sizeof size);
        REQUIRE(at + sizeof size + size <= text.data() + text.size());
        std::vector<double> all;
        const auto read = [&](auto number) {
            for (size_t k = 0; k < size; k += sizeof number) {
                std::memcpy(&number, at + sizeof size + k, sizeof number);
                all.push_back(static_cast<double>(number));
            }
        };
        array.attribute.at("type") == "Int32" ? read(std::int32_t()) : read(float());
        return all;
    }
    Cells cells(const std::string& section) const
    {
        const size_t at = static_cast<size_t>(&xml.named(section) - xml.element.data());
        const auto connectivity = numbers(xml.element[at + 1]), offsets = numbers(xml.element[at + 2]);
        REQUIRE(offsets.size() == count(section));
        Cells all;
        size_t from = 0;
        for (const double offset : offsets) {
            const size_t end = static_cast<size_t>(offset);
            REQUIRE(from < end);
            all.emplace_back();
            for (; from < end; ++from) {
                const size_t point_number = static_cast<size_t>(connectivity.at(from));
                REQUIRE(point_number < count("Points"));
                all.back().push_back(point_number);
            }
        }
        REQUIRE(from == connectivity.size());
        return all;
    }

    const std::string text;
    const Xml xml;
};

template <class Surface, class... Of>
contact::Shape shape(Of... of)
{
    return {.surface = std::make_shared<Surface>(of...)};
}

lie::Motion at(const Vec3& r, const Vec3& rdot = Vec3::Zero())
{
    lie::Motion m;
    m.r = r, m.rdot = rdot;
    return m;
}

struct Data {
    std::string time, file;
};
std::vector<Data> collection(const tests::fs::path& file)
{
    std::vector<Data> all;
    for (const auto& e : Xml(tests::read(file)).element)
        if (e.name == "DataSet") all.push_back({e.attribute.at("timestep"), e.attribute.at("file")});
    return all;
}

size_t file_count(const tests::fs::path& directory)
{
    return static_cast<size_t>(
        std::distance(tests::fs::directory_iterator(directory), tests::fs::directory_iterator()));
}

}  // namespace

TEST_CASE("the polygons of a surface lie on it and their normals point out of the body", "[run][vtk]")
{
    using namespace contact;
    const auto egg = [](auto x, auto y, auto z) { return x * x + y * y + z * z * (1.0 + 0.3 * z) - 1.0; };
    const auto waves = [](auto x, auto, auto z) { return z - 0.1 * x * x; };
    const auto waves_of = [](double x, double y) { return 0.1 * std::sin(x) * std::cos(y); };
    const auto as_it_is = [](const Vec3& a) { return a; };
    struct SurfaceExample {
        std::string name;
        std::shared_ptr<const Surface> surface;
        bool closed;
    };
    const std::vector<SurfaceExample> examples = {
        {"sphere", std::make_shared<Sphere>(0.2), true},
        {"bowl", std::make_shared<Sphere>(0.2, true), true},
        {"ellipsoid", std::make_shared<Ellipsoid>(Vec3(0.2, 0.3, 0.5)), true},
        {"box", std::make_shared<Superquadric>(Vec3(1, 2, 3), 8), true},
        {"torus", std::make_shared<Torus>(1, 0.2), true},
        {"egg", std::make_shared<ImplicitSurface<decltype(egg)>>(egg, 1.0), true},
        {"waves", std::make_shared<ImplicitSurface<decltype(waves)>>(waves, 1.0), false},
        {"terrain", std::make_shared<HeightMap>(HeightMap::sampled(waves_of, {-3, -3}, {3, 3}, 9, 9)), false},
        {"mesh", std::make_shared<MeshSurface>(tests::image(tests::icosphere(2), as_it_is)), true},
        {"cylinder", std::make_shared<Cylinder>(0.3), false},
        {"pipe", std::make_shared<Cylinder>(0.3, true), false},
        {"plane", std::make_shared<Plane>(), false},
        {"foot", std::make_shared<Foot>(), false},
        {"disk", std::make_shared<Disk>(0.1), false}};
    const contact::DrawingExtent reach{.box = {Vec3(-1, -2, 0), Vec3(1, 1, 1)}, .scene_size = 4};
    for (const SurfaceExample& c : examples) {
        CAPTURE(c.name);
        const PolygonMesh mesh = contact::tessellate(*c.surface, reach);
        CHECK(mesh.point.size() > 10);
        CHECK(mesh.point.size() <= 500);
        if (c.name != "disk" && c.name != "mesh")
            for (const Vec3& a : mesh.point) CHECK(std::abs(c.surface->value(a)) < 1e-12);
        std::map<std::pair<int, int>, int> edges;
        for (const std::vector<int>& polygon : mesh.polygon) {
            Vec3 centre = Vec3::Zero(), area = Vec3::Zero();
            for (size_t k = 0; k < polygon.size(); ++k) {
                const int from = polygon[k], to = polygon[(k + 1) % polygon.size()];
                centre += mesh.point[from] / static_cast<double>(polygon.size());
                area += 0.5 * mesh.point[from].cross(mesh.point[to]);
                ++edges[{from, to}];
            }
            if (c.name != "disk") CHECK(area.dot(c.surface->normal(centre)) > 0.9 * area.norm());
        }
        bool once = true, paired = true;
        for (const auto& [edge, count] : edges) {
            once = once && count == 1;
            paired = paired && edges.contains({edge.second, edge.first});
        }
        CHECK(once);
        CHECK(paired == c.closed);
    }
    CHECK(Plane().is_unbounded());
    CHECK_FALSE(Sphere(1).is_unbounded());
}

TEST_CASE("a plane is drawn over the region of the other bodies", "[run][vtk]")
{
    const Scratch in;
    Snapshots snapshots;
    snapshots.add_surface(0, shape<contact::Sphere>(0.2));
    const contact::Shape floor = shape<contact::Plane>();
    snapshots.add_surface(-1, floor);
    snapshots.add_surface(-1, floor);
    snapshots.add_surface(-1, shape<contact::Plane>());  // another object with the same shape
    lie::Motion later = at({3, 1, 0.2}, {1, 2, 3});
    later.omega_bar = {0, 0, 5};
    snapshots.add(0, {at({0, 1, 0.2})}, {});
    snapshots.add(0.1, {later}, {{2, 0, Vec3(3, 1, 0), Vec3(0, 0, 9), Vec3(-1, 0, 0), true, false}});
    snapshots.write(in.path.string(), "a<b>&\"c\"");

    const std::vector<Data> listed = collection(in / "a<b>&\"c\".pvd");
    REQUIRE(listed.size() == 2);
    CHECK(listed[0].time == "0");
    CHECK(listed[1].time == "0.1");
    CHECK(listed[1].file == "vtk/a&lt;b&gt;&amp;&quot;c&quot;-000001.vtp");
    const Frame start(in / "vtk/a<b>&\"c\"-000000.vtp"), end(in / "vtk/a<b>&\"c\"-000001.vtp");
    CHECK(start.vertex.empty());
    REQUIRE(end.vertex.size() == 1);
    CHECK(end.polygon == [&] {
        auto shifted = start.polygon;  // by one: the contact is the first point
        for (auto& polygon : shifted)
            for (size_t& k : polygon) ++k;
        return shifted;
    }());
    CHECK(end.contact[0] == 2);
    CHECK(end.point[0] == Vec3(3, 1, 0));
    CHECK(end.N[0] == Vec3(0, 0, 9));
    CHECK(end.F[0] == Vec3(-1, 0, 0));
    CHECK(end.slipping[0] == 1);
    CHECK(end.rolling[0] == 0);

    Eigen::AlignedBox3d patch;
    size_t of_ball = 0;
    for (size_t cell = 1; cell < end.body.size(); ++cell)
        for (const size_t k : end.polygon[cell - 1]) {
            const Vec3& p = end.point[k];
            if (end.body[cell] == -1) {
                patch.extend(p);
                CHECK(end.velocity[k] == Vec3::Zero());
                continue;
            }
            ++of_ball;
            CHECK((p - later.r).norm() == Approx(0.2).epsilon(1e-5));
            CHECK((end.velocity[k] - later.rdot - Vec3(0, 0, 5).cross(p - later.r)).norm() < 1e-5);
        }
    CHECK(of_ball > 500);
    CHECK(patch.contains(Vec3(-0.2, 0.8, 0)));
    CHECK(patch.contains(Vec3(3.2, 1.2, 0)));
    CHECK(patch.sizes().x() < 1.2 * 3.4);
    CHECK(patch.sizes().y() == Approx(patch.sizes().x()));
    CHECK(end.point.size() == 1 + 266 + 81);  // contact, ball, floor once

    Snapshots::remove(in.path.string(), "a<b>&\"c\"");
    CHECK(file_count(in.path) == 1);
    CHECK(file_count(in / "vtk") == 0);
}

TEST_CASE("the friction study writes frames with the contact forces", "[run][vtk][friction]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"study", "friction", "--problem", "incline,brick", "--vtk", "4", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("out/friction/incline-*.pvd"));
    CHECK(file_count(in / "out/friction/vtk") == 2 * 4);
    for (const std::string run : {"dissertation", "balanced"}) {
        const std::vector<Data> listed = collection(in / ("out/friction/incline-" + run + ".pvd"));
        REQUIRE(listed.size() == 4);
        CHECK(listed[0].time == "0");
        CHECK(std::stod(listed[1].time) == Approx(0.1));
        CHECK(std::stod(listed[3].time) == Approx(0.3));
        for (const Data& d : listed) {
            const Frame frame(in / ("out/friction/" + d.file));
            REQUIRE(frame.vertex.size() == 1);
            CHECK(frame.N[0].z() == Approx(5 * 9.8 * std::cos(35 * 3.14159265358979 / 180)));
            CHECK(std::abs(frame.point[0].z()) < 1e-6);
        }
    }
    // a second run with fewer frames removes the old ones
    CHECK(
        call(in, {"study", "friction", "--problem", "incline", "--vtk", "1", "--force", "--no-plot"}).code ==
        0);
    CHECK(file_count(in / "out/friction/vtk") == 2);
}

TEST_CASE("a study rejects --vtk if it would write no frames", "[run][vtk]")
{
    const Scratch in;
    const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
        tests::check_refused(in, tests::with({"study"}, more), 2, message);
    };
    for (const std::string text : {"0", "-1", "1.5", "1000001", "many"})
        refused({"friction", "--vtk", text},
                "--vtk: must be a whole number from 1 to 1000000, got '" + text + "'");
    refused({"energy", "--vtk", "3"},
            "study energy: --vtk is for evolving-contact, evolving-friction, friction");
    refused(
        {"friction", "--problem", "brick", "--output", "new", "--vtk", "3"},
        "study friction: --vtk is available for disk, ellipsoid, incline, spin, spin-ellipsoid, turntable");
    refused({"friction", "--json", "--vtk", "3"}, "--vtk writes files");
}

TEST_CASE("a run writes frames of compliant contacts", "[run][vtk]")
{
    const Scratch in;
    const Ended ended = call(in, {"run", "rolling_ball", "--end", "0.1", "--vtk", "0.02", "--output", "out"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const std::vector<Data> listed = collection(in / "out/run.pvd");
    REQUIRE(listed.size() == 6);
    CHECK(file_count(in / "out/vtk") == 6);
    for (size_t k = 0; k < listed.size(); ++k) {
        CHECK(std::stod(listed[k].time) == Approx(0.02 * static_cast<double>(k)));
        const Frame frame(in / ("out/" + listed[k].file));
        REQUIRE(frame.contacts().size() == 1);  // the ball is in contact with the floor
        CHECK(frame.body[0] == 0);
        CHECK(frame.body.back() == -1);
        CHECK(frame.N[0].z() == Approx(5 * 9.81).epsilon(1e-3));
        CHECK(frame.slipping[0] == (k > 0));
        if (k > 0) CHECK(frame.F[0].x() == Approx(-0.2 * frame.N[0].z()).epsilon(1e-2));
    }
    CHECK_THAT(tests::read(in / "out/summary.json"), Contains("run.pvd"));
    // a second run without --vtk removes the frames
    CHECK(call(in, {"run", "rolling_ball", "--end", "0.1", "--output", "out", "--force"}).code == 0);
    CHECK_FALSE(tests::fs::exists(in / "out/run.pvd"));
    CHECK(file_count(in / "out/vtk") == 0);
}

TEST_CASE("a run writes frames of a mechanism without contacts", "[run][vtk]")
{
    const Scratch in;
    const std::string model =
        std::string(tests::source_dir) + "/examples/models/slider_crank_with_spring.json";
    REQUIRE(call(in, {"run", model, "--end", "0.1", "--interval", "0.05", "--vtk", "0.05", "--forces",
                      "--output", "out"})
                .code == 0);
    const auto motion = tests::csv(in / "out/trajectory.csv"), forces = tests::csv(in / "out/forces.csv");
    const std::vector<Data> listed = collection(in / "out/run.pvd");
    REQUIRE(listed.size() == motion.size());
    for (size_t k = 0; k < listed.size(); ++k) {
        const Frame frame(in / ("out/" + listed[k].file));
        CHECK(frame.contacts().empty());
        CHECK(std::count(frame.kind.begin(), frame.kind.end(), Snapshots::solid) ==
              6 + 6 + 288);  // two boxes, a sphere
        REQUIRE(frame.line.size() == 1);
        CHECK(frame.kind[frame.vertex.size()] == double(Snapshots::spring));
        const Vec3 P = frame.point[frame.line[0][0]], Q = frame.point[frame.line[0][1]];
        CHECK((P - Vec3(0.6, 0, 0)).norm() < 1e-6);
        CHECK((Q - P).norm() == Approx(tests::number(forces[k], "spring.length")).epsilon(1e-6));
        const auto joint_at = [&](const Vec3& p) {
            return std::any_of(frame.vertex.begin(), frame.vertex.end(),
                               [&](const auto& cell) { return (frame.point[cell[0]] - p).norm() < 1e-6; });
        };
        const Vec3 crank(tests::number(motion[k], "crank.rx"), tests::number(motion[k], "crank.ry"), 0);
        CHECK(joint_at(Vec3::Zero()));
        CHECK(joint_at(2 * crank));
        CHECK(joint_at(Q));
    }
}

TEST_CASE("a body with equal moments and several joints is drawn as bars between them", "[run][vtk]")
{
    const Scratch in;
    REQUIRE(call(in, {"run", "andrews_squeezer", "--step", "1e-5", "--end", "2e-3", "--vtk", "1e-3",
                      "--output", "out"})
                .code == 0);
    const Frame first(in / "out/vtk/run-000000.vtp"), last(in / "out/vtk/run-000002.vtp");
    const auto length = [](const Frame& frame, size_t line) {
        return (frame.point[frame.line[line][1]] - frame.point[frame.line[line][0]]).norm();
    };
    size_t bars = 0;
    REQUIRE(first.line.size() == last.line.size());
    for (size_t k = 0; k < first.line.size(); ++k) {
        if (first.kind[first.vertex.size() + k] != double(Snapshots::bar)) continue;
        ++bars;
        CHECK(length(first, k) > 1e-3);
        CHECK(length(last, k) == Approx(length(first, k)).epsilon(1e-5));
    }
    CHECK(bars >= 7);
}

TEST_CASE("a joint outside the solid of its body is connected with the centre of mass by a bar", "[run][vtk]")
{
    const Scratch in;
    const auto bars = [&](const std::string& model) {
        REQUIRE(call(in, {"run", model, "--end", "0.02", "--vtk", "0.02", "--output", model}).code == 0);
        const Frame frame(in / (model + "/vtk/run-000001.vtp"));
        std::vector<std::pair<Vec3, Vec3>> all;
        for (size_t k = 0; k < frame.line.size(); ++k)
            if (frame.kind[frame.vertex.size() + k] == double(Snapshots::bar))
                all.emplace_back(frame.point[frame.line[k][0]], frame.point[frame.line[k][1]]);
        return all;
    };
    // the tip of the top is at the origin, 0.1 m below its disc
    const auto top = bars("heavy_top");
    REQUIRE(top.size() == 1);
    CHECK(top[0].first.norm() < 1e-6);
    CHECK(top[0].second.norm() == Approx(0.1).epsilon(1e-5));
    // joints at the ends of boxes need none, nor do the ends of links (row trans_D of the slider-crank)
    for (const char* model : {"double_pendulum", "slider_crank", "four_link"}) CHECK(bars(model).empty());
}

TEST_CASE("the drawn patch of an unbounded surface covers the region of the other bodies", "[run][vtk]")
{
    // A cone of 45 degrees: the point above (x, y) is at the height sqrt(x² + y²), its projection is
    // elsewhere.
    const contact::Cone cone(0.25 * 3.14159265358979, true);
    const contact::DrawingExtent reach{.box = {Vec3(-1, -1, 0.1), Vec3(1, 1, 1.2)}, .scene_size = 3};
    Eigen::AlignedBox3d box;
    for (const Vec3& a : contact::tessellate(cone, reach).point) {
        CHECK(a.z() == Approx(a.head<2>().norm()).margin(1e-12));
        box.extend(a);
    }
    CHECK(box.min().head<2>().maxCoeff() < -1);
    CHECK(box.max().head<2>().minCoeff() > 1);
}

TEST_CASE("a run writes frames of a contact constraint", "[run][vtk][evolving]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"run", "rolling_ball_in_bowl", "--end", "0.1", "--vtk", "0.05", "--output", "out"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const std::vector<Data> listed = collection(in / "out/run.pvd");
    REQUIRE(listed.size() == 3);
    const Frame frame(in / ("out/" + listed[0].file));
    REQUIRE(frame.vertex.size() == 1);
    CHECK((frame.point[frame.vertex[0][0]] - Vec3(0, 1.5, -1.7320508)).norm() < 1e-6);
    CHECK(frame.N[0].normalized().z() == Approx(0.9332565).epsilon(1e-6));
    CHECK(frame.F[0].norm() == Approx(1.0068160).epsilon(1e-3));
    CHECK(frame.slipping[0] == 0);
    CHECK(frame.rolling[0] == 1);
}

TEST_CASE("a run rejects --vtk if it would write no frames", "[run][vtk][run]")
{
    const Scratch in;
    for (const std::string text : {"0", "-1", "nan", "often"})
        tests::check_refused(in, {"run", "rolling_ball", "--vtk", text}, 2,
                             "--vtk: must be a positive, finite number");
    tests::check_refused(in, {"run", "rolling_ball", "--step", "1e-7", "--vtk", "1e-7"}, 2,
                         "more than 1000000");
}

TEST_CASE("a killed and resumed run writes the frames of an uninterrupted run", "[run][vtk][resume]")
{
    const Scratch in;
    tests::check_resumed(in, {"run", "rolling_ball", "--end", "0.5", "--vtk", "0.02"});
    CHECK(file_count(in / "parts/vtk") == 26);
    CHECK(collection(in / "parts/run.pvd").size() == 26);
}
