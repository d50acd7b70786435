// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter7/rigs/rig.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "run/cosim/run_case.hpp"
#include "run/cosim/run_cosim.hpp"
#include "studies/framework/study_context.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <unistd.h>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;

io::Json case_of(const RigBed& bed, double mu, double mu_r, const io::Json& fill)
{
    const double R = bed.R;
    io::Json law = {{"mu", mu},
                    {"normal", {{"law", "scaled-hooke"}, {"k_n", bed.k}, {"gamma_n", 1e3}}},
                    {"tangential", {{"law", "mindlin"}, {"k_t", bed.k}, {"gamma_t", 1e3}}}};
    if (mu_r > 0) law["rolling"] = {{"law", "constant-torque"}, {"mu_r", mu_r}, {"half_radius", true}};
    io::Json::List open = {"+z"};
    const double y_low = bed.periodic ? 0 : -R, y_high = bed.periodic ? bed.width : bed.width + R;
    if (bed.periodic) open.insert(open.end(), {"-y", "+y"});
    return {{"hilda_case", 1},
            {"domain",
             {{"low", {-R, y_low, -R}},
              {"high", {bed.length + R, y_high, 0.8}},
              {"periodic", {false, bed.periodic, false}}}},
            {"step", bed.h},
            {"end", 4},
            {"interval", 0.01},
            {"frame_interval", 0.05},
            {"materials", {{{"name", "rock"}, {"density", 2500}, {"E", 1e7}, {"nu", 0.3}}}},
            {"laws", {law}},
            {"boundaries",
             {{{"name", "box"},
               {"type", "box"},
               {"low", {0, 0, 0}},
               {"high", {bed.length, bed.width, 0.8}},
               {"open", open}}}},
            {"fill", {fill}}};
}

std::string name_of(const RigBed& bed) { return fmt::format("bed {}", bed.number); }

/// Folder of a run or a bed
std::string path_of(const std::string& parent, std::string name)
{
    std::replace(name.begin(), name.end(), ' ', '-');
    return parent + '/' + name;
}

}  // namespace

double RigRun::mean(const std::string& column, double after) const
{
    const std::vector<double> t = tools.values("t"), of = tools.values(column);
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < t.size(); ++k)
        if (t[k] > after) sum += of[k], count += 1;
    return sum / count;
}

double RigRun::last(const std::string& column) const { return tools.values(column).back(); }

Rigs::Rigs(const StudyContext& of) : study(of)
{
    const std::string &output = study.output, own = "hilda-" + study.name + '-' + std::to_string(getpid());
    if (output.empty()) temporary = (fs::temp_directory_path() / own).string();
    folder = output.empty() ? temporary : output + "/runs";
    bed_folder = temporary.empty() ? folder : temporary;
    fs::create_directories(bed_folder);
}

Rigs::~Rigs()
{
    std::error_code ignored;
    if (!temporary.empty()) fs::remove_all(temporary, ignored);
}

std::string Rigs::folder_of(const std::string& parent, const std::string& name) const
{
    if (!study.quiet) io::message("hilda: study " + study.name + ": " + name + '\n');
    std::string path = path_of(parent, name);
    fs::create_directories(path);
    return path;
}

double Rigs::settle(const RigBed& bed)
{
    const std::string path = folder_of(bed_folder, name_of(bed));
    io::Json all = case_of(bed, 0.1, bed.mu_r,
                           {{"type", "lattice"},
                            {"low", {0, 0, 0}},
                            {"high", {bed.length, bed.width, bed.depth}},
                            {"radius", bed.R},
                            {"spacing", 1.08},
                            {"jitter", 0.9},
                            {"random_v", 0.3},
                            {"seed", bed.number}});
    all["stages"] = {{{"name", "settle"},
                      {"duration", 3},
                      {"until", {{"share", 1e-3}, {"from", 0.1}}},
                      {"on_timeout", "fail"}}};
    io::write_file(path + "/case.json", io::written(all) + '\n');
    run::run_case(path + "/case.json", path + "/out");
    const io::CsvTable grains = io::read_csv_table(path + "/out/particles.csv");
    const std::vector<double> z = grains.values("z");
    return *std::max_element(z.begin(), z.end()) + bed.R;
}

RigRun Rigs::run(const std::string& name, const RigBed& bed, const io::Json& model,
                 const io::Json& boundaries, const io::Json& pair, long substeps, double end) const
{
    const std::string path = folder_of(folder, name), table = fs::absolute(path).string() + "/bed.csv";
    fs::copy_file(path_of(bed_folder, name_of(bed)) + "/out/particles.csv", table,
                  fs::copy_options::overwrite_existing);
    io::Json all = case_of(bed, bed.mu, bed.mu_r, {{"type", "csv"}, {"file", table}});
    for (const io::Json& b : *boundaries.list()) all["boundaries"].push_back(b);
    const double H = static_cast<double>(substeps) * bed.h;
    const io::Json cosim = {{"hilda_cosim", 1},    {"model", "model.json"},
                            {"case", "case.json"}, {"substeps", substeps},
                            {"end", end},          {"interval", H * std::max(1., std::round(1e-3 / H))},
                            {"pairs", {pair}}};
    io::write_file(path + "/model.json", io::written(model) + '\n');
    io::write_file(path + "/case.json", io::written(all) + '\n');
    io::write_file(path + "/cosim.json", io::written(cosim) + '\n');

    run::CosimOptions options{.file = path + "/cosim.json"};
    options.run.output = path + "/out", options.run.force = options.run.quiet = true;
    if (const int code = run::run_cosim(options); code != io::exit_code::done)
        throw io::Failure(code, "study " + study.name + ": the run " + name +
                                    " has not come to its end; see " + path + "/out/summary.json");
    RigRun result{.tools = io::read_csv_table(path + "/out/tools.csv")};
    const io::CsvTable grains = io::read_csv_table(path + "/out/grains/particles.csv");
    result.x = grains.values("x"), result.y = grains.values("y"), result.z = grains.values("z");
    const std::vector<double> vx = grains.values("vx"), vy = grains.values("vy"), vz = grains.values("vz");
    for (std::size_t k = 0; k < vx.size(); ++k) result.speed.push_back(std::hypot(vx[k], vy[k], vz[k]));
    const std::string summary = path + "/out/grains/summary.json";
    const io::JsonSource of(io::read_file(summary, io::JsonSource::max_bytes), summary);
    const auto energy = [&](const char* key) {
        return *of.root.member("watch")->value.member("energy")->value.member(key)->value.number();
    };
    result.work_on_grains = energy("work"), result.dissipated = energy("dissipated");
    return result;
}

void add_rows(Table& to, const std::vector<Table::Cell>& key, const std::vector<double>& matrix,
              std::size_t columns)
{
    for (std::size_t k = 0; k + columns <= matrix.size(); k += columns) {
        std::vector<Table::Cell> row = key;
        for (std::size_t column = 0; column < columns; ++column) row.emplace_back(matrix[k + column]);
        to.add(row);
    }
}

std::string smooth_step(double from, double to)
{
    const std::string s = fmt::format("min(max((t-{})/{},0),1)", from, to - from);
    return fmt::format("({0})^3*(10-15*({0})+6*({0})^2)", s);
}

}  // namespace hilda::studies
