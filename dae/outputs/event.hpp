// SPDX-License-Identifier: GPL-3.0-or-later
/// Events that a model file lists under "events": zeros of formulas in the columns of the run.

#pragma once

#include "dae/outputs/output.hpp"
#include "lie/events.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::dae {

struct Event {
    std::unique_ptr<Output> value;  ///< the formula; it has the name and the places of the event
    lie::Event::Direction direction = lie::Event::both;
    bool stops = false;  ///< "action": "stop"
};

/// Reads an event without its name. `columns`: as OutputType::read.
Event read_event(ObjectReader& o, const std::vector<std::string>& columns);

/// "both", "rising", "falling", in the order of lie::Event::Direction
const std::vector<std::string>& event_directions();

}  // namespace hilda::dae
