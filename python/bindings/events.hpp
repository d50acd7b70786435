// SPDX-License-Identifier: GPL-3.0-or-later
/// The events of a run, in memory.

#pragma once

#include "run/events/run_events.hpp"

#include <pybind11/pybind11.h>

namespace hilda::python {

/// The rows of the table of events, which RunEvents writes
class EventTables final : public run::RunTables {
public:
    std::unique_ptr<run::RunTable> table(const std::string& name,
                                         std::vector<run::TableColumn> columns) override;

    /// Arrays event, direction, t, r, A, rdot, omega_bar, rddot, omegadot_bar; the event is the first index
    pybind11::dict arrays(size_t bodies) const;

private:
    size_t columns = 1;
    std::vector<double> values;  ///< row by row
};

}  // namespace hilda::python
