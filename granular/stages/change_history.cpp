// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/change_history.hpp"

#include "granular/stages/continuation.hpp"
#include "io/archive.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

void transfer(io::Archive& a, std::vector<ChangeHistory::Change>& all)
{
    std::size_t n = all.size();
    a.count(n, 1);
    all.resize(n);
    for (ChangeHistory::Change& change : all) {
        a.value(change.t), a.value(change.step), a.value(change.rows);
        a.check(std::isfinite(change.t) && change.step >= 0 && change.rows >= 0,
                "invalid change of the case");
        std::size_t lines = change.what.size();
        a.count(lines, 1);
        change.what.resize(lines);
        for (std::string& line : change.what) a.list(line);
    }
}

}  // namespace

long ChangeHistory::rows(long step, long interval) const
{
    if (all.empty()) return step / interval + 1;  // including t = 0
    return all.back().rows + step / interval - all.back().step / interval;
}

io::Json ChangeHistory::summary() const
{
    io::Json list = io::Json::array();
    for (std::size_t k = 0; k < all.size(); ++k)
        list.push_back({{"t", all[k].t},
                        {"step", all[k].step},
                        {"changes", io::Json(all[k].what)},
                        {"case_before", name_of_earlier_case(k + 1)}});
    return list;
}

std::string ChangeHistory::bytes() const
{
    io::Archive a;
    std::vector<Change> copy = all;
    transfer(a, copy);
    return a.bytes();
}

void ChangeHistory::read(const std::string& bytes, const std::string& file)
{
    io::Archive a(bytes, file);
    transfer(a, all);
    a.end();
}

}  // namespace hilda::granular
