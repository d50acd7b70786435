// SPDX-License-Identifier: GPL-3.0-or-later
/// The watch in the summary of a run, and its warnings.

#pragma once

#include "granular/world/watch.hpp"
#include "io/json.hpp"

#include <functional>

namespace hilda::granular {

/// A warning of the watch, which ends the run with --strict
class StrictWarning : public io::NumericalFailure {
public:
    StrictWarning(const std::string& status, const std::string& what) : NumericalFailure(status, what) {}
};

constexpr const char* strict_suffix = " (a warning, with --strict)";  ///< of the message of StrictWarning

/// The block `watch` of summary.json
io::Json watch_summary(const WatchRecord& record);

/// Calls warn(text) for each warning of the record that is not in `known`, and adds it there. With `strict`,
/// throws StrictWarning instead. `boundaries`: their names
void report_watch(const WatchRecord& record, std::int64_t& known, bool strict,
                  const std::vector<std::string>& boundaries,
                  const std::function<void(const std::string&)>& warn);

}  // namespace hilda::granular
