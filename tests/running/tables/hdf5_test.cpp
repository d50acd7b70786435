// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda run --format hdf5: run.h5 is read back by the C library of HDF5 and compared with the CSV files of
/// the same run.
///
/// This file is compiled if CMake has found HDF5, see tests/CMakeLists.txt.

#include "io/files.hpp"
#include "run/tables/run_table.hpp"
#include "tests/support/program/csv.hpp"

#include <hdf5.h>
#include <hilda/version.hpp>

#include <sys/syscall.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <set>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using nlohmann::ordered_json;

namespace {

/// The process is killed before this call of one of the functions below, counted from 1; 0: never
long kill_at = 0;

void count_call()
{
    if (kill_at > 0 && --kill_at == 0) raise(SIGKILL);
}

}  // namespace

// Definitions that take precedence over those of the C library
extern "C" ssize_t write(int descriptor, const void* bytes, size_t count)
{
    count_call();
    return syscall(SYS_write, descriptor, bytes, count);
}
extern "C" ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t at)
{
    count_call();
    return syscall(SYS_pwrite64, descriptor, bytes, count, at);
}
extern "C" int rename(const char* from, const char* to) noexcept
{
    count_call();
    return static_cast<int>(syscall(SYS_rename, from, to));
}
extern "C" int remove(const char* path) noexcept
{
    count_call();
    const long removed = syscall(SYS_unlink, path);
    return static_cast<int>(removed != 0 && errno == EISDIR ? syscall(SYS_rmdir, path) : removed);
}

namespace {

struct Column {
    std::string name, unit, meaning;
    std::vector<double> values;
    bool is_integer;
    std::string dataset;  ///< name of the dataset
};
/// The columns of a group, in the order of their creation
using Columns = std::vector<Column>;

std::string text_attribute(hid_t object, const char* name)
{
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    REQUIRE(attribute >= 0);
    const hid_t type = H5Aget_type(attribute);
    char* bytes = nullptr;
    REQUIRE(H5Aread(attribute, type, &bytes) >= 0);
    std::string text = bytes;
    H5free_memory(bytes);
    H5Tclose(type), H5Aclose(attribute);
    return text;
}

Columns columns_of(hid_t group)
{
    Columns all;
    H5G_info_t info;
    REQUIRE(H5Gget_info(group, &info) >= 0);
    for (hsize_t k = 0; k < info.nlinks; ++k) {
        std::array<char, 256> name{};
        H5Lget_name_by_idx(group, ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, k, name.data(), name.size(),
                           H5P_DEFAULT);
        const hid_t dataset = H5Dopen2(group, name.data(), H5P_DEFAULT);
        REQUIRE(dataset >= 0);
        const hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
        hsize_t rows = 0;
        REQUIRE(H5Sget_simple_extent_ndims(space) == 1);
        H5Sget_simple_extent_dims(space, &rows, nullptr);
        Column column{text_attribute(dataset, "name"),    text_attribute(dataset, "unit"),
                      text_attribute(dataset, "meaning"), std::vector<double>(rows),
                      H5Tget_class(type) == H5T_INTEGER,  name.data()};
        CHECK(H5Tget_size(type) == 8);
        if (rows > 0)
            REQUIRE(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                            column.values.data()) >= 0);
        all.push_back(std::move(column));
        H5Tclose(type), H5Sclose(space), H5Dclose(dataset);
    }
    return all;
}

/// All tables of a file, by name
std::map<std::string, Columns> tables_of(const fs::path& path)
{
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    CAPTURE(path);
    REQUIRE(file >= 0);
    std::map<std::string, Columns> all;
    H5G_info_t info;
    H5Gget_info(file, &info);
    for (hsize_t k = 0; k < info.nlinks; ++k) {
        std::array<char, 256> name{};
        H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, k, name.data(), name.size(), H5P_DEFAULT);
        const hid_t group = H5Gopen2(file, name.data(), H5P_DEFAULT);
        all[name.data()] = columns_of(group);
        H5Gclose(group);
    }
    H5Fclose(file);
    return all;
}

/// Requires that a group has the columns and rows of a CSV file, each number with the same bits.
void check_equal(const Columns& columns, const fs::path& file, const std::string& except = "")
{
    CAPTURE(file);
    std::istringstream in(read(file));
    std::string line;
    std::getline(in, line);
    std::vector<std::string> names;
    for (const Column& column : columns) names.push_back(column.name);
    REQUIRE(names == fields(line));
    size_t row = 0, different = 0;
    for (; std::getline(in, line); ++row) {
        const std::vector<std::string> values = fields(line);
        for (size_t k = 0; k < columns.size(); ++k) {
            REQUIRE(row < columns[k].values.size());
            if (names[k] != except && std::bit_cast<std::uint64_t>(std::strtod(values[k].c_str(), nullptr)) !=
                                          std::bit_cast<std::uint64_t>(columns[k].values[row]))
                ++different;
        }
    }
    CHECK(row > 0);
    CHECK(different == 0);
    for (const Column& column : columns) {
        CAPTURE(column.name);
        CHECK(column.values.size() == row);
        CHECK_FALSE(column.unit.empty());
        CHECK_FALSE(column.meaning.empty());
    }
}

void check_same(const fs::path& a, const fs::path& b)
{
    const auto of_a = tables_of(a), of_b = tables_of(b);
    REQUIRE(of_a.size() == of_b.size());
    for (const auto& [name, columns] : of_a) {
        CAPTURE(name);
        REQUIRE(of_b.contains(name));
        REQUIRE(columns.size() == of_b.at(name).size());
        for (size_t k = 0; k < columns.size(); ++k) {
            const Column& other = of_b.at(name)[k];
            CAPTURE(columns[k].name);
            CHECK(columns[k].name == other.name);
            REQUIRE(columns[k].values.size() == other.values.size());
            const bool same = std::memcmp(columns[k].values.data(), other.values.data(),
                                          other.values.size() * sizeof(double)) == 0;
            CHECK((same || other.name == "wall_ns"));
        }
    }
}

void require_success(const Ended& ended)
{
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
}

const std::vector<run::TableColumn> two_columns = {{"t", "s", "time"}, {"n", "1", "number", true}};

/// Writes rows `first` to `last` of a table of known contents.
void add_rows(run::RunTable& table, long first, long last)
{
    for (long n = first; n < last; ++n) table.row({0.1 * static_cast<double>(n), static_cast<double>(n * n)});
}

}  // namespace

TEST_CASE("run.h5 contains the tables of the CSV files to the last bit", "[run][hdf5]")
{
    struct Case {
        const char* model;
        std::vector<std::string> options;
        std::set<std::string> tables;
    };
    const auto c = GENERATE(values<Case>(
        {{"slider_crank", {"--reactions", "--log-steps", "--euler", "zxz"}, {"trajectory", "steps", "euler"}},
         {"braked_ball_in_bowl", {"--reactions", "--contacts"}, {"trajectory", "contacts"}},
         {"bouncing_ellipsoid", {"--contacts", "--step", "1e-4"}, {"trajectory", "contacts"}}}));
    CAPTURE(c.model);
    const Scratch in;
    for (const char* format : {"csv", "hdf5"})
        require_success(call(in, with({"run", c.model, "--end", "0.2", "--interval", "1e-3", "--quiet",
                                       "--format", format, "--output", format},
                                      c.options)));
    const auto tables = tables_of(in / "hdf5/run.h5");
    std::set<std::string> names;
    for (const auto& [name, columns] : tables) {
        names.insert(name);
        check_equal(columns, in / ("csv/" + name + ".csv"), "wall_ns");
        CHECK_FALSE(fs::exists(in / ("hdf5/" + name + ".csv")));
    }
    CHECK(names == c.tables);
    CHECK(ordered_json::parse(read(in / "hdf5/summary.json"))["files"] ==
          ordered_json({"model.json", "run.h5", "summary.json"}));
}

TEST_CASE("run.h5 contains forces and outputs of the model, and names with any character", "[run][hdf5]")
{
    const Scratch in;
    std::string model = read(fs::path(source_dir) / "examples/models/slider_crank_with_spring.json");
    auto json = ordered_json::parse(model);
    json["outputs"] = {{{"name", "a/b, \"c\" \u00e9"}, {"type", "expression"}, {"value", "sqrt(t-0.05)"}},
                       {{"name", "a_b, \"c\" \u00e9"}, {"type", "expression"}, {"value", "1/3"}}};
    write(in / "model.json", json.dump());
    for (const char* format : {"csv", "hdf5"})
        require_success(call(in, {"run", "model.json", "--forces", "--end", "0.1", "--quiet", "--format",
                                  format, "--output", format}));
    const auto tables = tables_of(in / "hdf5/run.h5");
    REQUIRE(tables.contains("forces"));
    check_equal(tables.at("forces"), in / "csv/forces.csv");
    REQUIRE(tables.at("outputs").size() == 3);
    CHECK(tables.at("outputs")[1].name == "a/b, \"c\" \u00e9");
    CHECK(tables.at("outputs")[2].name == "a_b, \"c\" \u00e9");
    // the dataset with the name of a column is that of this column
    CHECK(tables.at("outputs")[2].dataset == tables.at("outputs")[2].name);
    CHECK(tables.at("outputs")[1].dataset == tables.at("outputs")[2].name + '_');
    CHECK(std::isnan(tables.at("outputs")[1].values[0]));
    CHECK(tables.at("outputs")[2].values.back() == 1. / 3);
}

TEST_CASE("run.h5 records the model and the command, and counts are integers", "[run][hdf5]")
{
    const Scratch in;
    const std::vector<std::string> run = {"run",     "double_pendulum", "--end",    "0.1",
                                          "--quiet", "--log-steps",     "--format", "hdf5"};
    require_success(call(in, with(run, {"--output", "a"})));
    const hid_t file = H5Fopen((in / "a/run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    REQUIRE(file >= 0);
    CHECK(text_attribute(file, "model") == "double_pendulum");
    CHECK(text_attribute(file, "model_text") == read(in / "a/model.json"));
    CHECK(text_attribute(file, "integrator") == "rA-half-1-momentum");
    CHECK_THAT(text_attribute(file, "command_line"), Contains("run double_pendulum --end 0.1"));
    CHECK_THAT(text_attribute(file, "program"), Contains("hilda 0."));
    H5Fclose(file);
    const Columns steps = tables_of(in / "a/run.h5").at("steps");
    for (const Column& column : steps) {
        CAPTURE(column.name);
        CHECK(column.is_integer == (column.name == "newton_iterations" || column.name == "factorizations" ||
                                    column.name == "wall_ns"));
    }

    // --force removes the files of the other format.
    require_success(
        call(in, {"run", "double_pendulum", "--end", "0.1", "--quiet", "--force", "--output", "a"}));
    CHECK_FALSE(fs::exists(in / "a/run.h5"));
    require_success(call(in, with(run, {"--force", "--output", "a"})));
    CHECK_FALSE(fs::exists(in / "a/trajectory.csv"));
}

TEST_CASE("an extended run and an interrupted run give the run.h5 of an uninterrupted run", "[run][hdf5]")
{
    const Scratch in;
    const std::vector<std::string> run = {"run",        "slider_crank", "--step",      "1e-4",
                                          "--interval", "1e-4",         "--quiet",     "--format",
                                          "hdf5",       "--log-steps",  "--reactions", "--output"};
    // 6001 rows: more than a chunk. The first end is within the first chunk, the second within another.
    require_success(call(in, with(run, {"whole", "--end", "0.6"})));
    require_success(call(in, with(run, {"parts", "--end", "0.0123"})));
    require_success(call(in, with(run, {"parts", "--end", "0.5", "--resume"})));
    require_success(call(in, with(run, {"parts", "--end", "0.6", "--resume"})));
    check_same(in / "parts/run.h5", in / "whole/run.h5");

    // After the first chunk, with a checkpoint after each step, the signal comes in the middle of the 150th.
    const int signal = GENERATE(SIGINT, SIGKILL);
    require_success(call(in, with(run, {"killed", "--end", "0.25"})));
    const std::vector<std::string> longer = with(run, {"killed", "--end", "0.6", "--resume"});
    const Ended killed = call(in, with(longer, {"--checkpoint", "1e-9"}),
                              {.end_at = {signal, 150, "killed/checkpoint.new.tmp"}});
    REQUIRE(killed.code == 128 + signal);
    require_success(call(in, longer));
    check_same(in / "killed/run.h5", in / "whole/run.h5");

    const Ended other =
        call(in, {"run", "slider_crank", "--step", "1e-4", "--interval", "1e-4", "--log-steps", "--reactions",
                  "--end", "0.7", "--resume", "--output", "parts"});
    CHECK(other.code == 2);
    CHECK_THAT(other.err, Contains("--format hdf5"));
}

TEST_CASE("hilda plot draws the figure of run.h5, and says so if Python has no h5py", "[run][hdf5]")
{
    const Scratch in;
    if (call(in, {"info"}).out.find("matplotlib 3") == std::string::npos) {
        WARN("no matplotlib here: no figure was drawn");
        return;
    }
    for (const char* format : {"csv", "hdf5"})
        require_success(call(
            in, {"run", "double_pendulum", "--end", "1", "--quiet", "--format", format, "--output", format}));
    require_success(call(in, {"plot", "csv"}));
    const Ended drawn = call(in, {"plot", "hdf5"});
    CAPTURE(drawn.err);
    CHECK(drawn.code == 0);
    CHECK(read(in / "hdf5/trajectory.png") == read(in / "csv/trajectory.png"));

    // a damaged file is an error of files
    const std::string whole = read(in / "hdf5/run.h5");
    for (const std::string& damage : {std::string("not an HDF5 file"), whole.substr(0, whole.size() / 2)}) {
        write(in / "hdf5/run.h5", damage);
        const Ended damaged = call(in, {"plot", "hdf5"});
        CHECK(damaged.code == 5);
        CHECK_THAT(damaged.err, StartsWith("hilda: error: hdf5/run.h5: cannot be read: "));
        CHECK(std::count(damaged.err.begin(), damaged.err.end(), '\n') == 1);
    }
    write(in / "hdf5/run.h5", whole);

    // the same Python without h5py
    fs::create_directories(in / "without/h5py");
    write(in / "without/h5py/__init__.py", "raise ImportError()\n");
    write(in / "python",
          "#!/bin/sh\nPYTHONPATH='" + (in / "without").string() + "' exec " + version::python + " \"$@\"\n");
    fs::permissions(in / "python", fs::perms::owner_all);
    const Ended missing = call(in, {"plot", "hdf5"}, {.python = (in / "python").string()});
    CHECK(missing.code == 7);
    CHECK_THAT(missing.err, Contains("hdf5/run.h5: ") && Contains("apt-get install python3-h5py"));
    CHECK(std::count(missing.err.begin(), missing.err.end(), '\n') == 1);
}

// The child process is killed at each place of its writing, in turn: in a new run, and in one that continues
// a complete run.
TEST_CASE("after a kill at any write run.h5 is complete or absent, and the run continues from the checkpoint",
          "[run][hdf5]")
{
    const Scratch in;
    const auto open_tables = [&] {
        const auto tables = run::hdf5_tables(in.path.string(), {{"program", "test"}});
        return std::array{tables->table("a", two_columns), tables->table("b", two_columns)};
    };
    const auto save = [&](const auto& tables) {
        io::Archive all;
        for (const auto& table : tables) {
            table->sync();
            table->transfer(all);
        }
        io::write_file((in / "checkpoint").string(), all.bytes());
    };
    // Continues from the checkpoint, if there is one, up to each of these numbers of rows in turn.
    const auto run = [&](const std::vector<long>& ends) {
        const auto tables = open_tables();
        long rows = 0;
        if (fs::exists(in / "checkpoint")) {
            const std::string bytes = read(in / "checkpoint");
            std::array<std::uint64_t, 2> numbers{};  // of the first table: rows in run.h5, rows after them
            std::memcpy(numbers.data(), bytes.data(), sizeof numbers);
            rows = static_cast<long>(numbers[0] + numbers[1]);
            io::Archive all(bytes, "checkpoint");
            for (const auto& table : tables) table->transfer(all);
            all.end();
        } else {
            for (const auto& table : tables) table->open();
        }
        for (const long end : ends) {
            for (const auto& table : tables) add_rows(*table, rows, end);
            rows = std::max(rows, end);
            save(tables);
        }
        for (const auto& table : tables) table->close();
    };
    const auto check_rows = [&](size_t rows) {
        for (const auto& [name, columns] : tables_of(in / "run.h5")) {
            REQUIRE(columns[0].values.size() == rows);
            size_t different = 0;
            for (size_t n = 0; n < rows; ++n)
                different += columns[0].values[n] != 0.1 * static_cast<double>(n) ||
                             columns[1].values[n] != static_cast<double>(n * n);
            REQUIRE(different == 0);
        }
    };
    const bool continues = GENERATE(false, true);
    long killed = 0;
    for (long call = 1;; ++call) {
        CAPTURE(continues, call);
        for (const auto& file : fs::directory_iterator(in.path)) fs::remove(file);
        if (continues) run({5000});
        const pid_t child = fork();
        if (child == 0) {
            kill_at = call;
            run({100, 6000, 9000, 13000});
            _exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
        if (WIFEXITED(status)) {
            REQUIRE(WEXITSTATUS(status) == 0);
            break;
        }
        REQUIRE(WTERMSIG(status) == SIGKILL);
        ++killed;
        if (fs::exists(in / "run.h5")) {
            const size_t rows = tables_of(in / "run.h5").at("a")[0].values.size();
            CHECK((rows == 13000 || (continues && rows == 5000)));
            check_rows(rows);
        } else {
            CHECK_FALSE(continues);
        }
        run({13000});
        check_rows(13000);
        for (const auto& file : fs::directory_iterator(in.path))
            CHECK((file.path().filename() == "run.h5" || file.path().filename() == "checkpoint"));
    }
    CHECK(killed > 30);
}

TEST_CASE("a full disk, a read-only folder and a damaged run.h5 are reported in one line", "[run][hdf5]")
{
    const Scratch in;
    const std::vector<std::string> run = {"run",  "slider_crank", "--step",   "1e-4", "--interval",
                                          "1e-4", "--quiet",      "--format", "hdf5", "--output"};
    // the last one: the rows fit, and run.h5 does not
    for (const auto& [bytes, end] : {std::pair{6000L, "2"}, {50000L, "2"}, {400000L, "2"}, {8000L, "1e-3"}}) {
        CAPTURE(bytes);
        const Ended full = call(in, with(run, {"a", "--end", end, "--force"}), {.file_bytes = bytes});
        CHECK(full.code == 5);
        CHECK_THAT(full.err, Contains("hilda: error: a/run.h5") && Contains("File too large"));
        CHECK(std::count(full.err.begin(), full.err.end(), '\n') == 1);
        CHECK_FALSE(fs::exists(in / "a/run.h5"));
        CHECK_FALSE(fs::exists(in / "a/run.h5.tmp"));
    }
    CHECK(fs::exists(in / "a/run.h5.trajectory.0.rows"));
    require_success(call(in, {"run", "slider_crank", "--end", "0.1", "--quiet", "--force", "--output", "a"}));
    CHECK_FALSE(fs::exists(in / "a/run.h5.trajectory.0.rows"));
    fs::create_directories(in / "b/run.h5/x");
    const Ended folder = call(in, with(run, {"b", "--force"}));
    CHECK(folder.code == 5);
    CHECK_THAT(folder.err, Contains("hilda: error: b/run.h5: cannot be written: Is a directory"));

    require_success(call(in, with(run, {"c", "--end", "0.1"})));
    const std::string bytes = read(in / "c/run.h5");
    write(in / "c/run.h5", "not an HDF5 file");
    const Ended damaged = call(in, with(run, {"c", "--end", "0.2", "--resume"}));
    CHECK(damaged.code == 5);
    CHECK_THAT(damaged.err, Contains("hilda: error: c/run.h5: cannot be read: "));
    fs::remove(in / "c/run.h5");
    const Ended missing = call(in, with(run, {"c", "--end", "0.2", "--resume"}));
    CHECK(missing.code == 5);
    CHECK_THAT(missing.err, Contains("hilda: error: c/run.h5: cannot be read: No such file"));
    write(in / "c/run.h5", bytes);
    require_success(call(in, with(run, {"c", "--end", "0.2", "--resume"})));
}

TEST_CASE("a sweep keeps the motions of concurrent runs in HDF5 files, also after an interruption",
          "[run][hdf5][sweep]")
{
    const Scratch in;
    const std::vector<std::string> study = {
        "study",  "sweep",   "slider_crank", "--sweep", "/gravity/2=-10:0:12",
        "--end",  "0.3",     "--steps",      "1e-4",    "--no-plot",
        "--keep", "--quiet", "--jobs",       "2"};
    require_success(call(in, with(study, {"--output", "csv"})));
    const std::vector<std::string> hdf5 = with(study, {"--format", "hdf5", "--output"});
    require_success(call(in, with(hdf5, {"whole"})));
    CHECK(call(in, with(hdf5, {"parts"}), {.end_at = {SIGTERM, 5, "parts/study.part"}}).code ==
          128 + SIGTERM);
    require_success(call(in, with(hdf5, {"parts", "--resume"})));
    for (int k = 1; k <= 12; ++k) {
        const std::string run = (k < 10 ? "/runs/000" : "/runs/00") + std::to_string(k);
        CAPTURE(run);
        CHECK_FALSE(fs::exists(in / ("whole" + run + "/trajectory.csv")));
        check_equal(tables_of(in / ("whole" + run + "/run.h5")).at("trajectory"),
                    in / ("csv" + run + "/trajectory.csv"));
        check_same(in / ("whole" + run + "/run.h5"), in / ("parts" + run + "/run.h5"));
    }
    CHECK(call(in, {"study", "sweep", "--sweep", "/end=1,2", "--format", "hdf5"}).code ==
          2);  // without --keep
    CHECK(call(in, {"study", "energy", "--format", "hdf5"}).code == 2);
}
