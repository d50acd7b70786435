// SPDX-License-Identifier: GPL-3.0-or-later
/// Tables as CSV files: a header row with the names, numbers as the shortest decimals that read back as the
/// same double.

#include "io/formats/csv.hpp"
#include "io/files.hpp"
#include "run/tables/run_table.hpp"

#include <optional>

namespace hilda::run {

namespace {

class CsvTable final : public RunTable {
public:
    CsvTable(const std::string& directory, const std::string& name, std::vector<TableColumn> columns)
        : path(directory + '/' + name + ".csv"), name(name + ".csv"), columns(std::move(columns))
    {}

    void open() override
    {
        file.emplace(path);
        for (const TableColumn& column : columns)
            file->buffer += (&column == columns.data() ? "" : ",") + io::csv_field(column.name);
        file->buffer += '\n';
    }
    void row(const std::vector<double>& values) override
    {
        std::string& text = file->buffer;
        for (size_t k = 0; k < values.size(); ++k) {
            if (k > 0) text += ',';
            if (columns[k].is_integer)
                io::append_number(text, static_cast<long>(values[k]));
            else
                io::append_number(text, values[k]);
        }
        text += '\n';
        file->flush_when_full();
    }
    void sync() override { file->sync(); }
    void transfer(io::Archive& a) override
    {
        std::uint64_t length = a.reads() ? 0 : file->size();
        a.value(length);
        if (a.reads()) file.emplace(path, length, true);
    }
    void close() override { file->finish(); }
    std::vector<std::string> files() const override { return {name}; }
    std::string label() const override { return name; }

private:
    const std::string path, name;
    const std::vector<TableColumn> columns;
    std::optional<io::OutputFile> file;
};

class CsvTables final : public RunTables {
public:
    explicit CsvTables(std::string directory) : directory(std::move(directory)) {}
    std::unique_ptr<RunTable> table(const std::string& name, std::vector<TableColumn> columns) override
    {
        return std::make_unique<CsvTable>(directory, name, std::move(columns));
    }

private:
    const std::string directory;
};

}  // namespace

std::shared_ptr<RunTables> csv_tables(const std::string& directory)
{
    return std::make_shared<CsvTables>(directory);
}

}  // namespace hilda::run
