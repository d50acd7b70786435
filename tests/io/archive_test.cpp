// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/archive.hpp"
#include "io/files.hpp"
#include "io/formats/vtk.hpp"

#include <catch2/catch.hpp>

#include <unistd.h>

#include <filesystem>

using namespace hilda;
namespace fs = std::filesystem;
using Catch::Contains;

namespace {

constexpr io::Archive::Format format = {.letters = "HILDATST", .version = 3};

struct Content {
    double t = 0;
    std::vector<int> list;
    std::map<std::string, std::string> map;

    void transfer(io::Archive& a) { a.value(t), a.list(list), a.map(map); }
    bool operator==(const Content&) const = default;
};

std::string written_content()
{
    Content c{.t = 0.1, .list = {1, 2, 3}, .map = {{"a", "first"}, {"b", std::string("\0\1", 2)}, {"c", ""}}};
    io::Archive a(format);
    c.transfer(a);
    return a.bytes();
}

Content read_content(const std::string& bytes, const io::Archive::Format& of = format)
{
    io::Archive a(of, bytes, "file");
    Content c;
    c.transfer(a);
    a.end();
    return c;
}

}  // namespace

TEST_CASE("an archive is read as it was written, and a damaged one is rejected", "[io][archive]")
{
    const std::string good = written_content();
    const Content c = read_content(good);
    CHECK(c.t == 0.1);
    CHECK(c.list == std::vector<int>{1, 2, 3});
    CHECK(c.map.at("b") == std::string("\0\1", 2));
    for (size_t k = 0; k < 8 * good.size(); ++k) {
        std::string bad = good;
        bad[k / 8] = static_cast<char>(bad[k / 8] ^ (1 << k % 8));
        CHECK_THROWS_AS(read_content(bad), io::IoError);
    }
    for (size_t length = 0; length < good.size(); ++length)
        CHECK_THROWS_AS(read_content(good.substr(0, length)), io::IoError);
    CHECK_THROWS_WITH(read_content(good + "x"),
                      Contains("file: the checkpoint is damaged: its length must be"));
}

TEST_CASE("an archive of another program or version is rejected with its version", "[io][archive]")
{
    CHECK_THROWS_WITH(read_content(written_content(), {.letters = "HILDATST", .version = 4}),
                      "file: the checkpoint has format 3; this program reads format 4");
    CHECK_THROWS_WITH(read_content(written_content(), {.letters = "HILDAXYZ", .version = 3}),
                      Contains("the header is not that"));
}

TEST_CASE("a length in an archive is compared with its size, and unread values are an error", "[io][archive]")
{
    io::Archive wrong(format);
    Content c;
    wrong.value(c.t);
    std::uint64_t most = ~std::uint64_t{0} / 4;  // the product with the size of an element overflows
    wrong.value(most);
    CHECK_THROWS_WITH(read_content(wrong.bytes()), Contains("invalid length of a list"));
    io::Archive more(format);
    c.transfer(more);
    more.value(c.t);
    CHECK_THROWS_WITH(read_content(more.bytes()), Contains("unread bytes"));
}

TEST_CASE("of two checkpoints the last complete one is read", "[io][archive]")
{
    const fs::path in = fs::temp_directory_path() / ("hilda-checkpoints-" + std::to_string(getpid()));
    fs::create_directories(in);
    io::CheckpointFiles files(in.string());
    std::string got;
    const auto load = [&] {
        return files.load([&](const std::string& bytes, const std::string& file) {
            if (bytes == "damaged") throw io::IoError(file + ": is damaged");
            got = bytes;
        });
    };
    CHECK_FALSE(load());
    for (const char* bytes : {"first", "second", "damaged"}) files.save(bytes);
    CHECK((load() && got == "second"));
    fs::remove(in / "checkpoint");  // as after a kill between the two renamings
    CHECK((files.exist() && load() && got == "second"));
    files.save("damaged"), files.save("damaged");
    CHECK_THROWS_WITH(load(), Contains("/checkpoint: is damaged"));
    files.save_final([](const io::Append& append) { append("end"); });
    files.save("unfinished");
    CHECK((files.exist() && load() && got == "unfinished"));
    files.remove_unfinished();
    CHECK((!files.exist() && load() && got == "end"));
    files.remove();
    CHECK(fs::is_empty(in));
    fs::remove(in);
}

TEST_CASE("VTK files have an XML part and raw blocks", "[io][vtk]")
{
    io::VtkPolyData f({{"NumberOfPoints", 1}});
    f.section("PointData");
    f.array("id", 1, std::vector<std::int32_t>{7});
    f.section("Points");
    f.array("Points", 3, std::vector<float>{0.5, 1, -2});
    const std::string text = f.text();
    CHECK_THAT(text, Catch::StartsWith("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
                                       "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n"
                                       "<Piece NumberOfPoints=\"1\">\n<PointData>\n"));
    CHECK_THAT(text,
               Contains("Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" offset=\"12\"/>"));
    CHECK(text.find(std::string("\n_\4\0\0\0\0\0\0\0\7\0\0\0\14\0\0\0", 18)) != std::string::npos);
    CHECK_THAT(text, Catch::EndsWith("</AppendedData>\n</VTKFile>\n"));
    io::VtkImageData grid({-0.5, 0, 1}, {0.25, 1, 2}, {2, 1, 3});
    grid.section("CellData");
    grid.array("density", 1, std::vector<double>(6, 1.5));
    CHECK_THAT(grid.text(),
               Contains("<ImageData WholeExtent=\"0 2 0 1 0 3\" Origin=\"-0.5 0 1\" Spacing=\"0.25 1 2\">\n"
                        "<Piece Extent=\"0 2 0 1 0 3\">\n<CellData>\n"));
    CHECK_THAT(grid.text(), Contains("</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_"));
    CHECK_THAT(io::vtk_collection({{0, "a"}, {0.1, "a&b.vtp"}, {0.1, "c"}}),
               Contains("<DataSet timestep=\"0.1\" part=\"0\" file=\"a&amp;b.vtp\"/>\n"
                        "<DataSet timestep=\"0.1\" part=\"1\" file=\"c\"/>"));
}
