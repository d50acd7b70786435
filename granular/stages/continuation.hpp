// SPDX-License-Identifier: GPL-3.0-or-later
/// The case of a run that is continued: that of the output directory, with changes by options or by an edited
/// case file.
///
/// An output directory has
///
///     case.json            the case as it is run
///     case-given.json      the case file that was given, if options have changed it: --resume compares the
///                          given file with it, because case.json does not show whether the file was edited
///                          or differs from case.json by the options
///     case-1.json, ...     the cases before the first change, the second one, ...

#pragma once

#include "granular/stages/case_parameters.hpp"

namespace hilda::granular {

/// A case that is ready to run, and what it continues
struct Continuation {
    Case c;
    /// Entries that the run has to change when it continues: a text for each, and its pointer
    std::vector<std::string> changes = {}, pointers = {};
    CaseParameters changed = {};  ///< the new parameters, of a run that is or was changed
    /// Identity of the case before the changes, which its checkpoints have
    std::string earlier_id = {};
    std::string earlier_text = {};  ///< of case.json
    double earlier_interval = 0;    ///< of run.csv [s]
    std::string given = {};         ///< the text of case-given.json; empty: there is no such file
};

/// The identity of a run, which its checkpoints have: see identity()
std::string id_of(const Case& c);

/// Reads a case for a new run.
Continuation new_run(const std::string& text, const std::string& file, const Environment& environment);

/// Reads the case of a run that continues that in an output directory, whose case.json is `earlier`.
///
/// If the case file is that of the earlier run, the case is case.json with the changes by the options, so
/// that options need not be repeated. An edited file replaces it. The world is that of the first case, which
/// takes over the parameters of the present one.
///
/// Without a checkpoint the run starts again, with the changes.
///
/// Throws io::IoError if an entry has changed that cannot change, with changeable_entries().
Continuation continued_run(const std::string& text, const std::string& file, const Environment& environment,
                           const std::string& directory, const io::JsonSource& earlier);

/// Name of the case before change number k, from 1, without the directory
std::string name_of_earlier_case(std::size_t k);

/// Removes case-given.json and the earlier cases.
void remove_earlier_cases(const std::string& directory);

}  // namespace hilda::granular
