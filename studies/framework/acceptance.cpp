// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/acceptance.hpp"

#include "studies/framework/table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

Criterion between(const std::string& what, double measured, double least, double most)
{
    return {.what = what, .measured = measured, .least = least, .most = most};
}

Criterion criterion(const std::string& what, double measured, double value, double tolerance)
{
    return between(what, measured, value - tolerance, value + tolerance);
}

bool evaluate(const std::vector<Criterion>& criteria, StudyText& out, io::Json& json)
{
    Table table({{"measured", "{:.6g}"}, {"least", "{:.6g}"}, {"most", "{:.6g}"}, {"passed"}, {"what"}});
    json["checks"] = io::Json::array();
    for (const Criterion& d : criteria) {
        table.add({d.measured, d.least, d.most, d.passed() ? "yes" : "NO", d.what});
        json["checks"].push_back({{"what", d.what},
                                  {"measured", d.measured},
                                  {"least", d.least},
                                  {"most", d.most},
                                  {"passed", d.passed()}});
    }
    const auto passed =
        std::count_if(criteria.begin(), criteria.end(), [](const Criterion& d) { return d.passed(); });
    out << '\n';
    table.print(out);
    out << fmt::format("{} of {} passed\n", passed, criteria.size());
    return passed == static_cast<long>(criteria.size());
}

}  // namespace hilda::studies
