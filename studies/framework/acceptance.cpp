// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/acceptance.hpp"

#include "studies/framework/study_output.hpp"
#include "studies/framework/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

namespace hilda::studies {

Demand between(const std::string& what, double measured, double least, double most)
{
    return {.what = what, .measured = measured, .least = least, .most = most};
}

Demand demand(const std::string& what, double measured, double value, double tolerance)
{
    return between(what, measured, value - tolerance, value + tolerance);
}

bool judge(const std::vector<Demand>& demands, std::ostream& out, nlohmann::ordered_json& json)
{
    Table table({{"measured", "{:.6g}"}, {"least", "{:.6g}"}, {"most", "{:.6g}"}, {"met"}, {"what"}});
    json["checks"] = nlohmann::ordered_json::array();
    for (const Demand& d : demands) {
        table.add({d.measured, d.least, d.most, d.met() ? "yes" : "NO", d.what});
        json["checks"].push_back({{"what", d.what},
                                  {"measured", number_or_null(d.measured)},
                                  {"least", d.least},
                                  {"most", d.most},
                                  {"met", d.met()}});
    }
    const auto met = std::count_if(demands.begin(), demands.end(), [](const Demand& d) { return d.met(); });
    out << '\n';
    table.print(out);
    out << fmt::format("{} of {} met\n", met, demands.size());
    return met == static_cast<long>(demands.size());
}

}  // namespace hilda::studies
