// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/outputs/event.hpp"

#include "dae/object_reader.hpp"
#include "dae/outputs/expression.hpp"

#include <algorithm>

namespace hilda::dae {

const std::vector<std::string>& event_directions()
{
    static const std::vector<std::string> names = {"both", "rising", "falling"};
    return names;
}

Event read_event(ObjectReader& o, const std::vector<std::string>& columns)
{
    const std::vector<std::string>& directions = event_directions();
    Event event;
    event.value = std::make_unique<ExpressionOutput>(
        o.formula_of_names("value", columns,
                           {"The formula, in the variables of an output of type expression: t, the "
                            "parameters of the model and the columns of the run.",
                            R"("bar.vz", "spring.force - 10")"}),
        "");
    event.value->place = o.place("value");
    const std::string direction = o.one_of(
        "direction", directions,
        {"Which zeros count: those at which the formula rises, falls, or both.", R"("rising")"}, "both");
    event.direction = static_cast<lie::Event::Direction>(
        std::find(directions.begin(), directions.end(), direction) - directions.begin());
    event.stops =
        o.one_of("action", {"record", "stop"},
                 {"record: a row of events.csv. stop: the row, and the end of the run.", R"("stop")"},
                 "record") == "stop";
    return event;
}

}  // namespace hilda::dae
