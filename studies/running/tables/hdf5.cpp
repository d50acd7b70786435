// SPDX-License-Identifier: GPL-3.0-or-later
/// Tables in one HDF5 file, run.h5: a group for each table, a one-dimensional dataset for each column with
/// the attributes name, unit and meaning; attributes of the root record the run. Numbers are binary64, counts
/// 64-bit integers.
///
/// The datasets have chunks of the same number of rows. A chunk is written once, when it is full, because an
/// overwritten chunk could be lost (Hdf5Storage). The rows after the last full chunk are in memory and in the
/// checkpoints; close() writes them.

#include "studies/running/tables/hdf5_file.hpp"

#include <algorithm>
#include <mutex>
#include <set>

namespace hilda::studies {

namespace {

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

class Hdf5Table final : public RunTable {
public:
    Hdf5Table(std::shared_ptr<Hdf5File> of, std::string name, std::vector<TableColumn> columns)
        : file(std::move(of)), name(std::move(name)), columns(std::move(columns)),
          chunk(rows_of_chunk(this->columns.size())), is_first(file->is_first_table())
    {}

    void open() override
    {
        file->open_table(false);
        group = file->group(name, false);
        const std::vector<std::string> names = dataset_names(columns);
        for (size_t k = 0; k < columns.size(); ++k) create(columns[k], names[k]);
        values.resize(columns.size() * chunk);
        file->changed();
    }
    void row(const std::vector<double>& row) override
    {
        for (size_t k = 0; k < row.size(); ++k) values[k * chunk + count] = row[k];
        if (++count < chunk) return;
        file->before_rows();
        write();
        file->after_rows();
    }
    /// The rows after the last full chunk are part of transfer().
    void sync() override { file->commit(); }
    void transfer(io::Archive& a) override;
    void close() override
    {
        file->before_rows();
        if (count > 0) write();
        file->close_table();
    }
    std::vector<std::string> files() const override
    {
        return is_first ? std::vector<std::string>{hdf5_file_name} : std::vector<std::string>{};
    }
    std::string label() const override { return std::string(hdf5_file_name) + '/' + name; }

private:
    void create(const TableColumn& column, const std::string& dataset_name);
    void restore();
    void write();

    const std::shared_ptr<Hdf5File> file;
    const std::string name;
    const std::vector<TableColumn> columns;
    hsize_t chunk;               ///< rows of a chunk
    hsize_t full = 0;            ///< rows in full chunks, in the file
    hsize_t count = 0;           ///< rows after these, in `values`
    std::vector<double> values;  ///< of one chunk, column by column
    const bool is_first;
    Hdf5Id group;
    std::vector<Hdf5Id> datasets;  ///< of the columns
};

/// Access to a dataset without a cache of chunks, which takes 1 MiB for each column
Hdf5Id without_cache()
{
    Hdf5Id access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access, 1, 0, 1);
    return access;
}

void Hdf5Table::create(const TableColumn& column, const std::string& dataset_name)
{
    constexpr unsigned fast = 1;  // level of deflate: level 6 saves little of binary numbers
    const hsize_t none = 0, most = H5S_UNLIMITED;
    const Hdf5Id space(H5Screate_simple(1, &none, &most), H5Sclose),
        links(H5Pcreate(H5P_LINK_CREATE), H5Pclose), creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose),
        access = without_cache();
    file->check(H5Pset_char_encoding(links, H5T_CSET_UTF8));
    file->check(H5Pset_obj_track_times(creation, false));  // equal runs give equal bytes
    file->check(H5Pset_chunk(creation, 1, &chunk));
    file->check(H5Pset_shuffle(creation));
    file->check(H5Pset_deflate(creation, fast));
    const hid_t type = column.is_integer ? H5T_STD_I64LE : H5T_IEEE_F64LE;
    datasets.emplace_back(
        file->check(H5Dcreate2(group, dataset_name.c_str(), type, space, links, creation, access)), H5Dclose);
    file->attribute(datasets.back(), "name", column.name);
    file->attribute(datasets.back(), "unit", column.unit);
    file->attribute(datasets.back(), "meaning", column.meaning);
}

void Hdf5Table::transfer(io::Archive& a)
{
    a.value(chunk), a.value(full), a.value(count);
    a.check(chunk > 0 && chunk <= 4096 && count < chunk && full % chunk == 0, "invalid number of rows");
    std::vector<double> tail;  // column by column
    for (size_t k = 0; !a.reads() && k < columns.size(); ++k) {
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(k * chunk);
        tail.insert(tail.end(), first, first + static_cast<std::ptrdiff_t>(count));
    }
    a.list(tail);
    if (!a.reads()) return;
    a.check(tail.size() == columns.size() * count, "wrong number of columns of " + label());
    values.resize(columns.size() * chunk);
    for (size_t k = 0; k < columns.size(); ++k)
        std::copy_n(tail.begin() + static_cast<std::ptrdiff_t>(k * count), count,
                    values.begin() + static_cast<std::ptrdiff_t>(k * chunk));
    restore();
}

/// Opens the datasets and removes the rows after those of the checkpoint.
void Hdf5Table::restore()
{
    file->open_table(true);
    group = file->group(name, true);
    for (const std::string& dataset_name : dataset_names(columns)) {
        const Hdf5Id access = without_cache();
        datasets.emplace_back(file->check(H5Dopen2(group, dataset_name.c_str(), access)), H5Dclose);
        const Hdf5Id space(file->check(H5Dget_space(datasets.back())), H5Sclose);
        hsize_t length = 0;
        file->check(H5Sget_simple_extent_dims(space, &length, nullptr));
        if (length < full)
            throw io::IoError(file->name() + ": is shorter than the checkpoint states: " +
                              std::to_string(length) + " rows of " + name + ", not " + std::to_string(full));
        file->check(H5Dset_extent(datasets.back(), &full));
    }
    file->changed();
}

/// Appends the rows in `values` to the datasets.
void Hdf5Table::write()
{
    const hsize_t rows = full + count;
    const Hdf5Id from(H5Screate_simple(1, &count, nullptr), H5Sclose),
        to(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    file->check(H5Sselect_hyperslab(to, H5S_SELECT_SET, &full, nullptr, &count, nullptr));
    for (size_t k = 0; k < datasets.size(); ++k) {
        file->check(H5Dset_extent(datasets[k], &rows));
        file->check(
            H5Dwrite(datasets[k], H5T_NATIVE_DOUBLE, from, to, H5P_DEFAULT, values.data() + k * chunk));
    }
    full = rows, count = 0;
}

class Hdf5Tables final : public RunTables {
public:
    Hdf5Tables(const std::string& directory, RunRecord record)
        : file(std::make_shared<Hdf5File>(directory, std::move(record)))
    {}
    std::unique_ptr<RunTable> table(const std::string& name, std::vector<TableColumn> columns) override
    {
        return std::make_unique<Hdf5Table>(file, name, std::move(columns));
    }

private:
    const std::shared_ptr<Hdf5File> file;
};

/// The HDF5 library of Debian may be used by one thread at a time: concurrent runs of a study write in turn.
std::mutex& library()
{
    static std::mutex in_use;
    return in_use;
}

/// A table whose functions, the destructor included, hold the lock of the library
class LockedTable final : public RunTable {
public:
    explicit LockedTable(std::unique_ptr<RunTable> table) : table(std::move(table)) {}
    ~LockedTable() override
    {
        const std::lock_guard lock(library());
        table.reset();
    }
    LockedTable(const LockedTable&) = delete;
    LockedTable& operator=(const LockedTable&) = delete;

    void open() override
    {
        locked([&] { table->open(); });
    }
    void row(const std::vector<double>& values) override
    {
        locked([&] { table->row(values); });
    }
    void sync() override
    {
        locked([&] { table->sync(); });
    }
    void transfer(io::Archive& a) override
    {
        locked([&] { table->transfer(a); });
    }
    void close() override
    {
        locked([&] { table->close(); });
    }
    std::vector<std::string> files() const override { return table->files(); }
    std::string label() const override { return table->label(); }

private:
    template <class Call>
    static void locked(Call call)
    {
        const std::lock_guard lock(library());
        call();
    }

    std::unique_ptr<RunTable> table;
};

/// Tables that are made, and whose file is closed, under the lock of the library
class LockedTables final : public RunTables {
public:
    LockedTables(const std::string& directory, const RunRecord& record)
    {
        const std::lock_guard lock(library());
        tables = std::make_unique<Hdf5Tables>(directory, record);
    }
    ~LockedTables() override
    {
        const std::lock_guard lock(library());
        tables.reset();
    }
    LockedTables(const LockedTables&) = delete;
    LockedTables& operator=(const LockedTables&) = delete;

    std::unique_ptr<RunTable> table(const std::string& name, std::vector<TableColumn> columns) override
    {
        const std::lock_guard lock(library());
        return std::make_unique<LockedTable>(tables->table(name, std::move(columns)));
    }

private:
    std::unique_ptr<RunTables> tables;
};

}  // namespace

}  // namespace hilda::studies

/// Called by hdf5_tables().
extern "C" void hilda_hdf5_tables(const std::string& directory, const hilda::studies::RunRecord& record,
                                  std::shared_ptr<hilda::studies::RunTables>& tables)
{
    tables = std::make_shared<hilda::studies::LockedTables>(directory, record);
}
