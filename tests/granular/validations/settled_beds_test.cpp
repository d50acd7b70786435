// SPDX-License-Identifier: GPL-3.0-or-later
// Settled beds that are kept in files.
#include "granular/validations/settled_beds.hpp"

#include "granular/validations/cratering.hpp"
#include "io/files.hpp"

#include <fcntl.h>
#include <omp.h>
#include <unistd.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <set>

using namespace hilda;
using namespace hilda::granular;

namespace {

/// A folder for beds, which does not exist yet, and a file that receives stderr while the object exists
struct Folder {
    std::filesystem::path path;
    int stderr_before = -1;

    Folder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "hilda-beds-XXXXXX").string();
        path = mkdtemp(name.data());
        std::fflush(stderr);
        stderr_before = dup(STDERR_FILENO);
        const int file = open((path / "stderr").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(file, STDERR_FILENO);
        close(file);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder()
    {
        dup2(stderr_before, STDERR_FILENO);
        close(stderr_before);
        std::filesystem::remove_all(path);
    }

    std::string beds() const { return (path / "settled").string(); }
    std::string file(const BedCase& of) const { return beds() + '/' + of.hash() + ".bed"; }
    /// The lines on stderr since the last call
    std::string messages() const
    {
        std::string all = io::read_file((path / "stderr").string(), 1 << 20);
        CHECK(truncate((path / "stderr").c_str(), 0) == 0);
        lseek(STDERR_FILENO, 0, SEEK_SET);
        return all;
    }
};

/// A bed of two numbers that counts how often it is computed
struct Counted {
    int computed = 0;
    std::string bytes;

    void get(const SettledBeds& beds, const BedCase& of)
    {
        bytes.clear();
        beds.bed(
            of, [&] { ++computed, bytes = "grains of " + of.name; }, [&](io::Archive& a) { a.list(bytes); });
        CHECK(bytes == "grains of " + of.name);
    }
};

const BedCase a_case{"test", {{"R", 0.1}, {"h", 1e-5}}};

}  // namespace

TEST_CASE("the description of a bed has all its parameters, and its hash depends on each of them",
          "[granular][beds]")
{
    CHECK(a_case.description() == "test: R = 0.10000000000000001, h = 1.0000000000000001e-05");
    CHECK(a_case.hash() == a_case.hash());
    CHECK(a_case.hash().size() == 16);
    std::set<std::string> hashes = {a_case.hash()};
    hashes.insert(BedCase{"tests", a_case.parameters}.hash());
    for (std::size_t k = 0; k < a_case.parameters.size(); ++k) {
        BedCase other = a_case;
        other.parameters[k].second = std::nextafter(other.parameters[k].second, 1);
        hashes.insert(other.hash());
        other = a_case, other.parameters[k].first += 'x';
        hashes.insert(other.hash());
    }
    CHECK(hashes.size() == 6);
    CHECK(bed_case(1e-3).hash() != bed_case(2e-3).hash());
}

TEST_CASE("a settled bed is computed once for each case and read afterwards", "[granular][beds]")
{
    const Folder folder;
    const SettledBeds beds{folder.beds(), "1.0"};
    Counted counted;
    counted.get(beds, a_case);
    counted.get(beds, a_case);
    CHECK(counted.computed == 1);
    BedCase other = a_case;
    other.parameters[0].second = 0.2;
    counted.get(beds, other);
    CHECK(counted.computed == 2);
    CHECK(folder.messages().empty());
    // Only the two beds are in the folder, no temporary files.
    CHECK(std::distance(std::filesystem::directory_iterator(folder.beds()), {}) == 2);
    // Without a folder each call computes.
    counted.get({}, a_case);
    CHECK(counted.computed == 3);
}

TEST_CASE("a damaged or outdated bed is settled again with one warning", "[granular][beds]")
{
    const Folder folder;
    const SettledBeds beds{folder.beds(), "1.0"};
    Counted counted;
    counted.get(beds, a_case);
    const std::string file = folder.file(a_case), whole = io::read_file(file, 1 << 20);

    const auto is_replaced = [&](const std::string& content, const std::string& reason) {
        INFO(reason);
        std::filesystem::remove(file);
        io::write_file(file, content);
        const int before = counted.computed;
        counted.get(beds, a_case);
        CHECK(counted.computed == before + 1);
        const std::string said = folder.messages();
        CHECK(said.find("hilda: warning: " + file) == 0);
        CHECK(said.find(reason) != std::string::npos);
        CHECK(std::count(said.begin(), said.end(), '\n') == 1);
        CHECK(io::read_file(file, 1 << 20) == whole);
    };
    std::string flipped = whole;
    flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 4);
    is_replaced(flipped, "wrong checksum");
    is_replaced(whole.substr(0, whole.size() - 1), "its length must be");
    is_replaced("", "the header is not that");
    counted.get({folder.beds(), "0.9"}, a_case);
    folder.messages();
    is_replaced(io::read_file(file, 1 << 20), "its program is '0.9', not '1.0'");
    // The file of another case under this name
    BedCase other = a_case;
    other.name = "other";
    counted.get(beds, other);
    is_replaced(io::read_file(folder.file(other), 1 << 20), "its case is 'other: ");

    // A folder that cannot be created: the bed is computed, and the warning says that it is not kept.
    const SettledBeds nowhere{file + "/beds", "1.0"};
    counted.get(nowhere, a_case);
    CHECK(folder.messages().find("the settled bed is not kept") != std::string::npos);
}

TEST_CASE("a kept bed of grains has the same bytes for any number of threads and is that of a run (long)",
          "[granular][beds]")
{
    const Folder folder;
    const double R = 6e-3;
    ValidationOptions options;
    const SettledBed computed = settled_bed(R, options);
    const int threads = omp_get_max_threads();
    std::string before;
    for (const int n : {1, 2}) {
        omp_set_num_threads(n);
        std::filesystem::remove_all(folder.beds());
        options.beds = {folder.beds(), "1.0"};
        settled_bed(R, options);
        const std::string now = io::read_file(folder.file(bed_case(R)), 1 << 26);
        if (n > 1) CHECK(now == before);
        before = now;
    }
    omp_set_num_threads(threads);
    bool settled = false;
    const SettledBed read = settled_bed(R, options, [&](double) { settled = true; });
    CHECK_FALSE(settled);
    CHECK(read.bytes == computed.bytes);
    CHECK(read.surface == computed.surface);
    CHECK(read.density == computed.density);
    const Impact of{R, 8000, 0.1};
    CHECK(impact(of, read, {}).motion == impact(of, computed, {}).motion);
}
