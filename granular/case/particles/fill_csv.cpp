// SPDX-License-Identifier: GPL-3.0-or-later
/// Fill csv: particles of a table.
#include "granular/case/particles/fill.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "io/nearest.hpp"
#include "io/option_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace hilda::granular {

namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 36;  ///< of a table

/// The names in quotes, as many as fit into a line
std::string list_of(const std::vector<std::string_view>& names)
{
    constexpr std::size_t longest = 200;
    std::string list;
    for (const std::string_view name : names) {
        if (list.size() + name.size() > longest) return list + " ...";
        list += (list.empty() ? "'" : ", '") + std::string(name) + '\'';
    }
    return list;
}

template <class Number>
Number number(const io::CsvRow& row, const std::string& name, const char* rule)
{
    const auto at =
        static_cast<std::size_t>(std::find(row.names.begin(), row.names.end(), name) - row.names.begin());
    if (at == row.names.size())
        throw io::InvalidInput(row.place + ": missing column " + name + "; the columns are " +
                               list_of(row.names));
    const auto value = io::number_in<Number>(row.cells[at]);
    if (!value || !std::isfinite(static_cast<double>(*value)))
        throw io::InvalidInput(row.place + ": " + name + ' ' + rule + ", got '" + std::string(row.cells[at]) +
                               '\'');
    return *value;
}

Particle particle(const io::CsvRow& row)
{
    // a part of the columns of a vector is not ignored: number() names those that are missing
    const auto has = [&](auto... names) {
        return ((std::find(row.names.begin(), row.names.end(), names) != row.names.end()) || ...);
    };
    const auto real = [&](const char* name) {
        const auto x = number<double>(row, name, "must be a finite number");
        if (constexpr double most = std::numeric_limits<float>::max(); std::abs(x) > most)
            throw io::InvalidInput(row.place + ": " + name + " must be at most " + io::shortest(most) +
                                   " in magnitude, got " + io::shortest(x));
        return x;
    };
    const auto vector = [&](const char* x, const char* y, const char* z) {
        return Vec3{real(x), real(y), real(z)};
    };
    Particle p;
    p.r = vector("x", "y", "z"), p.radius = real("radius");
    if (!(p.radius > 0))
        throw io::InvalidInput(row.place + ": radius must be positive, got " + io::shortest(p.radius));
    if (constexpr double least = std::numeric_limits<float>::min(); p.radius < least)
        throw io::InvalidInput(row.place + ": radius must be at least " + io::shortest(least) + ", got " +
                               io::shortest(p.radius));
    if (has("material")) p.material = number<int>(row, "material", "must be the number of a material");
    if (has("vx", "vy", "vz")) p.v = vector("vx", "vy", "vz");
    if (has("omega_x", "omega_y", "omega_z")) p.omega = vector("omega_x", "omega_y", "omega_z");
    if (has("e0", "e1", "e2", "e3")) p.e = {real("e0"), real("e1"), real("e2"), real("e3")};
    return p;
}

/// A message for each column that has no effect, with the known name that is probably meant
std::vector<std::string> unknown_columns(const io::CsvRow& row, const std::string& file)
{
    static const std::vector<std::string> known = {
        "id", "material", "radius",  "x",       "y",  "z",  "vx", "vy",
        "vz", "omega_x",  "omega_y", "omega_z", "e0", "e1", "e2", "e3"};
    // common names that are not near
    static const std::map<std::string, std::string, std::less<>> meant = {
        {"wx", "omega_x"},     {"wy", "omega_y"},     {"wz", "omega_z"}, {"omegax", "omega_x"},
        {"omegay", "omega_y"}, {"omegaz", "omega_z"}, {"r", "radius"},   {"R", "radius"},
        {"type", "material"},  {"q0", "e0"},          {"q1", "e1"},      {"q2", "e2"},
        {"q3", "e3"}};
    std::vector<std::string> absent, messages;
    const auto is_given = [&](const std::string& name) {
        return std::find(row.names.begin(), row.names.end(), name) != row.names.end();
    };
    for (const std::string& name : known)
        if (!is_given(name)) absent.push_back(name);
    for (const std::string_view name : row.names) {
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        const auto synonym = meant.find(name);
        const std::string nearest = synonym != meant.end() && !is_given(synonym->second)
                                        ? synonym->second
                                        : io::nearest(name, absent);
        messages.push_back(file + ":1: the column '" + std::string(name) + "' has no effect" +
                           (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    return messages;
}

FillSpec read_table(ObjectReader& o, const std::optional<double>&)
{
    FillSpec f;
    const std::string file = f.file = o.file(
        "file",
        {"CSV file with the particles. A relative path refers to the folder of the case. The "
         "file must be below the folder of the case, unless --allow-paths is given. The first line has the "
         "column names. Columns x, y, z and radius (m) are required; vx, vy, vz (m/s), omega_x, omega_y, "
         "omega_z (rad/s), e0, e1, e2, e3 and material (number of the material, counted from 0) are "
         "optional. Other columns but id have no effect; a warning names them, and --strict refuses them. "
         "The file particles.csv of a run has this format.",
         R"("out/bed/particles.csv")"});
    if (o.records_schema()) return f;
    try {
        const std::string text = io::read_file(file, most_bytes);
        f.particles = particles_of_csv(text, file, &f.unknown);
        f.checksum = io::checksum(text.data(), text.size());
    } catch (const io::IoError& e) {
        o.fail("file", e.what());
    } catch (const io::InvalidInput& e) {
        o.fail("file", e.what());
    }
    for (const Particle& p : f.particles) f.radius = std::max(f.radius, p.radius);
    return f;
}

const bool registered_fill_csv =
    io::Registry<FillType>::add({.name = "csv",
                                 .schema = {.description = "The particles of a CSV table.",
                                            .examples = {R"("file": "out/bed/particles.csv")"}},
                                 .read = read_table});

}  // namespace

std::vector<Particle> particles_of_csv(const std::string& text, const std::string& file,
                                       std::vector<std::string>* unknown)
{
    std::vector<Particle> all;
    all.reserve(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
    io::read_csv(text, file, [&](const io::CsvRow& row) {
        if (all.empty() && unknown != nullptr) *unknown = unknown_columns(row, file);
        all.push_back(particle(row));
    });
    if (all.empty()) throw io::InvalidInput(file + ": contains no particles");
    return all;
}

std::string place_in_table(const std::string& file, std::size_t particle)
{
    std::string place = file;
    std::size_t row = 0;
    try {
        io::read_csv(io::read_file(file, most_bytes), file, [&](const io::CsvRow& r) {
            if (row++ == particle) place = r.place;
        });
    } catch (const std::exception&) {  // it has changed since it was read
    }
    return place;
}

}  // namespace hilda::granular
