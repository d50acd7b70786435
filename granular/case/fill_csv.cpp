// SPDX-License-Identifier: GPL-3.0-or-later
// Reader of particle tables (CSV).
#include "granular/case/fill.hpp"
#include "io/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace hilda::granular {

namespace {

std::string_view trimmed(std::string_view s)
{
    const auto first = s.find_first_not_of(" \t\r"), last = s.find_last_not_of(" \t\r");
    return first == std::string_view::npos ? std::string_view{} : s.substr(first, last - first + 1);
}

std::vector<std::string_view> cells(std::string_view line)
{
    std::vector<std::string_view> all;
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t to = std::min(line.find(',', from), line.size());
        all.push_back(trimmed(line.substr(from, to - from)));
        from = to + 1;
    }
    return all;
}

/// A line of the table, with access by column name
struct Row {
    const std::vector<std::string_view>& names;
    std::vector<std::string_view> cell;
    std::string place;

    bool has(const std::string& name) const
    {
        return std::find(names.begin(), names.end(), name) != names.end();
    }
    template <class Number>
    Number number(const std::string& name, const char* rule) const
    {
        const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        if (at == names.size()) throw io::InvalidInput(place + ": missing column " + name);
        const std::string_view text = cell[at];
        Number value{};
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        bool good = error == std::errc() && end == text.data() + text.size();
        if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(value);
        if (!good)
            throw io::InvalidInput(place + ": " + name + ' ' + rule + ", got '" + std::string(text) + '\'');
        return value;
    }
    double real(const std::string& name) const { return number<double>(name, "must be a finite number"); }
    Vec3 vector(const std::string& x, const std::string& y, const std::string& z) const
    {
        return {real(x), real(y), real(z)};
    }
};

}  // namespace

std::vector<Particle> particles_of_csv(const std::string& text, const std::string& file)
{
    std::vector<Particle> all;
    std::vector<std::string_view> names;
    long line = 0;
    for (std::size_t from = 0; from < text.size(); ++line) {
        const std::size_t to = std::min(text.find('\n', from), text.size());
        const std::string_view here = trimmed(std::string_view(text).substr(from, to - from));
        from = to + 1;
        if (here.empty()) continue;
        if (names.empty()) {
            names = cells(here);
            for (auto name = names.begin(); name != names.end(); ++name)
                if (std::find(names.begin(), name, *name) != name)
                    throw io::InvalidInput(file + ':' + std::to_string(line + 1) +
                                           ": two columns have the same name, got '" + std::string(*name) +
                                           '\'');
            continue;
        }
        const Row row{names, cells(here), file + ':' + std::to_string(line + 1)};
        if (row.cell.size() != names.size())
            throw io::InvalidInput(row.place + ": the number of cells must be that of the column names, " +
                                   std::to_string(names.size()) + ", got " + std::to_string(row.cell.size()));
        Particle p;
        p.r = row.vector("x", "y", "z"), p.radius = row.real("radius");
        if (!(p.radius > 0))
            throw io::InvalidInput(row.place + ": radius must be positive, got " + std::to_string(p.radius));
        if (row.has("material")) p.material = row.number<int>("material", "must be the number of a material");
        if (row.has("vx")) p.v = row.vector("vx", "vy", "vz");
        if (row.has("omega_x")) p.omega = row.vector("omega_x", "omega_y", "omega_z");
        if (row.has("e0")) p.e = {row.real("e0"), row.real("e1"), row.real("e2"), row.real("e3")};
        all.push_back(p);
    }
    if (all.empty()) throw io::InvalidInput(file + ": contains no particles");
    return all;
}

}  // namespace hilda::granular
