// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/view.hpp"

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "run/frames/drawn_patches.hpp"
#include "run/frames/model_frames.hpp"
#include "studies/program/plot.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

namespace hilda::studies {

namespace fs = std::filesystem;

namespace {

constexpr size_t largest_table = size_t(2) << 30;  // [byte]

bool has_file(const fs::path& file)
{
    std::error_code error;
    return fs::is_regular_file(file, error);
}

/// The numbers of a row by the names of their columns
class Row {
public:
    explicit Row(const io::CsvRow& row) : row(row)
    {
        for (size_t k = 0; k < row.names.size(); ++k) index.try_emplace(row.names[k], k);
    }
    double at(const std::string& name) const
    {
        const auto found = index.find(name);
        if (found == index.end()) throw io::InvalidInput(row.place + ": there is no column " + name);
        const std::string_view cell = row.cells[found->second];
        double value = std::numeric_limits<double>::quiet_NaN();
        std::from_chars(cell.data(), cell.data() + cell.size(), value);
        return value;
    }

private:
    const io::CsvRow& row;
    std::map<std::string_view, size_t> index;
};

/// Extends the drawn patches by the rows of trajectory.csv.
void extend(run::DrawnPatches& patches, const std::string& file, const std::vector<dae::Body>& bodies)
{
    std::string text = io::read_file(file, largest_table);
    text.resize(text.rfind('\n') + 1);  // a run that goes on has written a part of its last row
    if (text.empty()) return;
    io::read_csv(text, file, [&](const io::CsvRow& cells) {
        const Row row(cells);
        run::Drawing::Frame frame{.t = row.at("t"), .body = {}, .contacts = {}};
        for (const dae::Body& of : bodies) {
            lie::Motion& body = frame.body.emplace_back();
            for (int i = 0; i < 3; ++i) {
                body.r[i] = row.at(of.name + ".r" + "xyz"[i]);
                for (int j = 0; j < 3; ++j)
                    body.A(i, j) = row.at(fmt::format("{}.A{}{}", of.name, i + 1, j + 1));
            }
        }
        patches.extend(frame);
    });
}

/// The meshes, joints and lines of the model of a run (Drawing::geometry)
std::string geometry(const fs::path& directory)
{
    const dae::Description d = dae::load_model(directory / "model.json");
    run::Drawing drawing;
    run::ModelDrawing(*d.model).add_to(drawing);
    run::DrawnPatches patches(drawing);
    if (patches.depend_on_frames()) {
        patches.extend({.t = d.x.t, .body = d.x.body, .contacts = {}});
        if (has_file(directory / "trajectory.csv"))
            extend(patches, directory / "trajectory.csv", d.model->all_bodies());
    }
    io::Json all = drawing.geometry(patches.meshes());
    all["bodies"] = io::Json::array();
    for (const dae::Body& body : d.model->all_bodies()) all["bodies"].push_back(body.name);
    return all.text();
}

/// Refuses to replace a file that is no page, or no video.
void refuse_other_file(const std::string& output, bool video)
{
    if (!has_file(output)) return;
    std::string begin(16, '\0');
    std::ifstream(output, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
    const bool is_same = video ? begin.find("ftyp") == 4 : begin.starts_with("<!DOCTYPE html>");
    if (!is_same)
        throw io::InvalidInput(output + ": the file exists and is no " +
                               (video ? "MP4 video" : "page of hilda view") + "; it is not replaced");
}

}  // namespace

void view(const ViewOptions& options)
{
    const fs::path directory = options.directory;
    std::error_code error;
    if (!fs::is_directory(directory, error))
        throw io::InvalidInput(options.directory +
                               ": is not a directory; hilda view needs the output of a run");
    const bool is_run = has_file(directory / "trajectory.csv") || has_file(directory / "run.h5");
    if (!is_run && !has_file(directory / "run.pvd") && !has_file(directory / "run.csv"))
        throw io::InvalidInput(options.directory +
                               ": contains no trajectory.csv, run.h5, run.pvd or run.csv; hilda view needs "
                               "the output of a run");
    if (is_run && !has_file(directory / "model.json"))
        throw io::InvalidInput(options.directory +
                               ": contains no model.json, from which the bodies are drawn");
    if (options.video && options.serve) throw io::UsageError("view: use either --mp4 or --serve");
    if (options.seconds > 0 && !options.video) throw io::UsageError("view: --seconds needs --mp4");
    const std::string output = !options.output.empty()
                                   ? options.output
                                   : (directory / (options.video ? "view.mp4" : "view.html")).string();
    if (!options.serve) refuse_other_file(output, options.video);

    std::vector<std::string> words = {options.directory, output, "--frames",
                                      fmt::format("{}", options.frames)};
    if (options.serve) words.insert(words.end(), {"--serve", fmt::format("{}", options.port)});
    if (options.video) words.insert(words.end(), {"--video", fmt::format("{}", options.seconds)});
    if (is_run) {
        // The script removes it.
        const std::string file = fmt::format("{}.geometry-{}.json", output, getpid());
        io::write_file(file, geometry(directory));
        words.insert(words.end(), {"--geometry", file});
    }
    start_script("view.py", words);
}

}  // namespace hilda::studies
