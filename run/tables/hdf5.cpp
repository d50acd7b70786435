// SPDX-License-Identifier: GPL-3.0-or-later
/// Tables in one HDF5 file, run.h5: a group for each table, a one-dimensional dataset for each column with
/// the attributes name, unit and meaning; attributes of the root record the run. Numbers are binary64, counts
/// 64-bit integers.
///
/// The HDF5 library overwrites the metadata of a file in an order of its own: a process that is killed in
/// between leaves a file that cannot be read. Therefore a run appends the rows of a table to a file of its
/// own, run.h5.TABLE.0.rows, as binary64, row by row. A resumed run truncates this file to its checkpoint, as
/// it does with a CSV file. The end of the run writes run.h5.tmp from these files, renames it to run.h5 and
/// removes them, in this order. A run that continues after its end with N rows in run.h5 appends to
/// run.h5.TABLE.N.rows, and its end begins with a copy of run.h5.

#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "run/tables/run_table.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

namespace hilda::run {

namespace {

namespace fs = std::filesystem;

constexpr const char* hdf5_file_name = "run.h5";

/// An identifier of the library, closed at the end of its scope
class Hdf5Id {
public:
    Hdf5Id(hid_t id, herr_t (*release)(hid_t)) : id(id), release(release) {}
    Hdf5Id(Hdf5Id&& other) noexcept : id(std::exchange(other.id, H5I_INVALID_HID)), release(other.release) {}
    Hdf5Id& operator=(Hdf5Id&& other) = delete;
    ~Hdf5Id()
    {
        if (id >= 0) release(id);
    }
    operator hid_t() const { return id; }  // NOLINT(google-explicit-constructor)
    /// The result of the library
    herr_t close() { return release(std::exchange(id, H5I_INVALID_HID)); }

private:
    hid_t id;
    herr_t (*release)(hid_t);
};

/// Innermost message of the library's error stack: the text of strerror if it contains one
std::string library_error()
{
    std::string text = "error of the HDF5 library";
    H5Ewalk2(
        H5E_DEFAULT, H5E_WALK_UPWARD,
        [](unsigned n, const H5E_error2_t* e, void* to) -> herr_t {
            if (n == 0 && e->desc != nullptr) *static_cast<std::string*>(to) = e->desc;
            return 0;
        },
        &text);
    const std::string before = "error message = '";
    if (const size_t at = text.find(before); at != std::string::npos) {
        text.erase(0, at + before.size());
        text.erase(std::min(text.find('\''), text.size()));
    }
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

/// Rows of a chunk: a power of two from 256 to 4096; the rows of a table then take at most 2 MiB if it has at
/// most 1024 columns.
hsize_t rows_of_chunk(size_t columns)
{
    constexpr size_t most_bytes = 2 << 20;
    hsize_t rows = 4096;
    while (rows > 256 && rows * columns * sizeof(double) > most_bytes) rows /= 2;
    return rows;
}

/// Names of the datasets of columns: / is the separator of groups, and "." the group itself. A name that is
/// changed for this reason ends with more underscores if it is the name of another column.
std::vector<std::string> dataset_names(const std::vector<TableColumn>& columns)
{
    const auto allowed = [](std::string name) {
        std::replace(name.begin(), name.end(), '/', '_');
        if (name.empty() || name == "." || name == "..") name += '_';
        return name;
    };
    std::set<std::string> exact, taken;
    for (const TableColumn& column : columns) exact.insert(column.name);
    std::vector<std::string> names;
    for (const TableColumn& column : columns) {
        std::string name = allowed(column.name);
        if (name != column.name)
            while (exact.contains(name)) name += '_';
        while (!taken.insert(name).second) name += '_';
        names.push_back(name);
    }
    return names;
}

/// A table of the file
struct Part {
    std::string name;
    std::vector<TableColumn> columns;
    std::string path;           ///< run.h5.TABLE
    std::uint64_t written = 0;  ///< rows in run.h5
    std::uint64_t count = 0;    ///< rows after these, in rows_file()

    std::string rows_file() const { return path + '.' + std::to_string(written) + ".rows"; }
};

/// The file run.h5 of a run, which its tables share
class Hdf5File {
public:
    Hdf5File(const std::string& directory, RunRecord record)
        : path(directory + '/' + hdf5_file_name), record(std::move(record))
    {}

    const std::string path;
    std::vector<std::unique_ptr<Part>> parts;

    void begin() { ++open_tables; }
    /// Writes the file with the end of the last table. io::IoError.
    void end()
    {
        if (--open_tables == 0) write();
    }
    /// io::IoError if the file cannot be read or has fewer rows of a table than part.written
    void require(const Part& part) const;

private:
    void write() const;
    void write(hid_t file, const Part& part) const;
    Hdf5Id create() const;
    Hdf5Id create(hid_t group, const TableColumn& column, const std::string& name, hsize_t chunk) const;
    void attribute(hid_t object, const char* name, const std::string& text) const;
    hsize_t length(hid_t dataset) const;
    /// The result of a function of the library; io::IoError if it is negative
    template <class Result>
    Result check(Result result, const char* what = "written") const
    {
        if (result >= 0) return result;
        throw io::IoError(path + ": cannot be " + what + ": " + library_error());
    }
    Hdf5Id access() const;
    Hdf5Id open(const std::string& file, unsigned flags) const
    {
        return {check(H5Fopen(file.c_str(), flags, access()), "read"), H5Fclose};
    }

    const RunRecord record;
    int open_tables = 0;
};

/// The HDF5 library of Debian may be used by one thread at a time: concurrent runs of a study write in turn.
/// Errors of the library are exceptions, not text on stderr.
class LibraryLock {
public:
    LibraryLock() : lock(in_use())
    {
        H5dont_atexit();  // a file that could not be closed would be written again
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }

private:
    static std::mutex& in_use()
    {
        static std::mutex mutex;
        return mutex;
    }
    const std::lock_guard<std::mutex> lock;
};

void Hdf5File::require(const Part& part) const
{
    const LibraryLock lock;
    const Hdf5Id file = open(path, H5F_ACC_RDONLY);
    for (const std::string& name : dataset_names(part.columns)) {
        const Hdf5Id dataset(check(H5Dopen2(file, (part.name + '/' + name).c_str(), H5P_DEFAULT), "read"),
                             H5Dclose);
        if (const hsize_t rows = length(dataset); rows < part.written)
            throw io::IoError(path + ": is shorter than the checkpoint states: " + std::to_string(rows) +
                              " rows of " + part.name + ", not " + std::to_string(part.written));
    }
}

void Hdf5File::write() const
{
    const LibraryLock lock;
    const std::string temporary = path + ".tmp";
    std::remove(temporary.c_str());  // of a process that was killed; a link is removed, not followed
    try {
        const bool continues =
            std::any_of(parts.begin(), parts.end(), [](const auto& p) { return p->written > 0; });
        std::error_code error;
        if (continues && !fs::copy_file(path, temporary, fs::copy_options::overwrite_existing, error))
            throw io::IoError(path + ": cannot be copied: " + error.message());
        Hdf5Id file = continues ? open(temporary, H5F_ACC_RDWR) : create();
        for (const auto& part : parts) write(file, *part);
        check(file.close());
        io::OutputFile(temporary, fs::file_size(temporary), true).sync();
        io::rename_file(temporary, path);
    } catch (...) {
        std::remove(temporary.c_str());
        throw;
    }
    for (const auto& part : parts) {
        std::remove(part->rows_file().c_str());
        part->written += std::exchange(part->count, 0);
    }
}

/// Appends the rows of a table.
void Hdf5File::write(hid_t file, const Part& part) const
{
    hsize_t chunk = rows_of_chunk(part.columns.size());
    const bool exists = H5Lexists(file, part.name.c_str(), H5P_DEFAULT) > 0;
    const Hdf5Id creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    const Hdf5Id group(
        check(exists ? H5Gopen2(file, part.name.c_str(), H5P_DEFAULT)
                     : H5Gcreate2(file, part.name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT)),
        H5Gclose);
    const std::vector<std::string> names = dataset_names(part.columns);
    std::vector<Hdf5Id> datasets;
    const hsize_t rows = part.written + part.count;
    for (size_t k = 0; k < names.size(); ++k) {
        datasets.push_back(exists ? Hdf5Id(check(H5Dopen2(group, names[k].c_str(), H5P_DEFAULT)), H5Dclose)
                                  : create(group, part.columns[k], names[k], chunk));
        check(H5Dset_extent(datasets.back(), &rows));
    }
    std::ifstream in(part.rows_file(), std::ios::binary);
    std::vector<double> block(chunk * names.size()), column(chunk);
    for (hsize_t at = part.written, count = 0; at < rows; at += count) {
        count = std::min(chunk - at % chunk, rows - at);
        if (!in.read(reinterpret_cast<char*>(block.data()),
                     static_cast<std::streamsize>(count * names.size() * sizeof(double))))
            throw io::IoError(part.rows_file() + ": cannot be read");
        const Hdf5Id from(H5Screate_simple(1, &count, nullptr), H5Sclose),
            to(H5Screate_simple(1, &rows, nullptr), H5Sclose);
        check(H5Sselect_hyperslab(to, H5S_SELECT_SET, &at, nullptr, &count, nullptr));
        for (size_t k = 0; k < names.size(); ++k) {
            for (hsize_t n = 0; n < count; ++n) column[n] = block[n * names.size() + k];
            check(H5Dwrite(datasets[k], H5T_NATIVE_DOUBLE, from, to, H5P_DEFAULT, column.data()));
        }
    }
}

Hdf5Id Hdf5File::access() const
{
    Hdf5Id list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    check(H5Pset_libver_bounds(list, H5F_LIBVER_V18, H5F_LIBVER_V18));  // readable by HDF5 1.8 (2008)
    check(H5Pset_cache(list, 0, 1, 0, 1));  // no cache of chunks, which takes 1 MiB for each column
    return list;
}

Hdf5Id Hdf5File::create() const
{
    const Hdf5Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    check(H5Pset_istore_k(creation, 4));  // small index of chunks: 0.3 kB for each column, not 2 kB
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    Hdf5Id file(check(H5Fcreate((path + ".tmp").c_str(), H5F_ACC_TRUNC, creation, access())), H5Fclose);
    for (const auto& [name, text] : record) attribute(file, name.c_str(), text);
    return file;
}

Hdf5Id Hdf5File::create(hid_t group, const TableColumn& column, const std::string& name, hsize_t chunk) const
{
    constexpr unsigned fast = 1;  // level of deflate: level 6 saves little of binary numbers
    const hsize_t none = 0, most = H5S_UNLIMITED;
    const Hdf5Id space(H5Screate_simple(1, &none, &most), H5Sclose),
        links(H5Pcreate(H5P_LINK_CREATE), H5Pclose), creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    check(H5Pset_char_encoding(links, H5T_CSET_UTF8));
    check(H5Pset_obj_track_times(creation, false));  // equal runs give equal bytes
    check(H5Pset_chunk(creation, 1, &chunk));
    check(H5Pset_shuffle(creation));
    check(H5Pset_deflate(creation, fast));
    const hid_t type = column.is_integer ? H5T_STD_I64LE : H5T_IEEE_F64LE;
    Hdf5Id dataset(check(H5Dcreate2(group, name.c_str(), type, space, links, creation, H5P_DEFAULT)),
                   H5Dclose);
    attribute(dataset, "name", column.name);
    attribute(dataset, "unit", column.unit);
    attribute(dataset, "meaning", column.meaning);
    return dataset;
}

void Hdf5File::attribute(hid_t object, const char* name, const std::string& text) const
{
    const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    check(H5Tset_size(type, H5T_VARIABLE));
    check(H5Tset_cset(type, H5T_CSET_UTF8));
    const Hdf5Id attribute(check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
    const char* bytes = text.c_str();
    check(H5Awrite(attribute, type, &bytes));
}

hsize_t Hdf5File::length(hid_t dataset) const
{
    const Hdf5Id space(check(H5Dget_space(dataset), "read"), H5Sclose);
    hsize_t rows = 0;
    check(H5Sget_simple_extent_dims(space, &rows, nullptr), "read");
    return rows;
}

class Hdf5Table final : public RunTable {
public:
    Hdf5Table(std::shared_ptr<Hdf5File> of, Part& part)
        : file(std::move(of)), part(part), is_first(file->parts.size() == 1)
    {}

    void open() override
    {
        if (std::error_code error; fs::is_directory(file->path, error))
            throw io::IoError(file->path + ": cannot be written: Is a directory");
        rows.emplace(part.rows_file());
        file->begin();
    }
    void row(const std::vector<double>& values) override
    {
        rows->buffer.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
        ++part.count;
        rows->flush_when_full();
    }
    void sync() override { rows->sync(); }
    void transfer(io::Archive& a) override
    {
        a.value(part.written), a.value(part.count);
        if (!a.reads()) return;
        std::error_code error;
        if (!fs::exists(part.rows_file(), error))  // the run has ended: all rows are in run.h5
            part.written += std::exchange(part.count, 0);
        if (part.written > 0) file->require(part);
        rows.emplace(part.rows_file(), part.count * part.columns.size() * sizeof(double), part.count > 0);
        file->begin();
    }
    void close() override
    {
        rows->finish();
        rows.reset();
        file->end();
    }
    std::vector<std::string> files() const override
    {
        return is_first ? std::vector<std::string>{hdf5_file_name} : std::vector<std::string>{};
    }
    std::string label() const override { return std::string(hdf5_file_name) + '/' + part.name; }

private:
    const std::shared_ptr<Hdf5File> file;
    Part& part;  ///< of the file
    const bool is_first;
    std::optional<io::OutputFile> rows;
};

class Hdf5Tables final : public RunTables {
public:
    Hdf5Tables(const std::string& directory, RunRecord record)
        : file(std::make_shared<Hdf5File>(directory, std::move(record)))
    {}
    std::unique_ptr<RunTable> table(const std::string& name, std::vector<TableColumn> columns) override
    {
        file->parts.push_back(std::make_unique<Part>(
            Part{.name = name, .columns = std::move(columns), .path = file->path + '.' + name}));
        return std::make_unique<Hdf5Table>(file, *file->parts.back());
    }

private:
    const std::shared_ptr<Hdf5File> file;
};

}  // namespace

}  // namespace hilda::run

/// Called by hdf5_tables().
extern "C" void hilda_hdf5_tables(const std::string& directory, const hilda::run::RunRecord& record,
                                  std::shared_ptr<hilda::run::RunTables>& tables)
{
    tables = std::make_shared<hilda::run::Hdf5Tables>(directory, record);
}
