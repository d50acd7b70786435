// SPDX-License-Identifier: GPL-3.0-or-later
/// The choice of the instruction set for the loops of the CPU. It has no influence on the results.

#pragma once

#include <string>
#include <vector>

namespace hilda::granular {

struct CpuLoops;

/// An instruction set for which the loops are compiled
struct InstructionSet {
    const char* name;         ///< sse2, v3 or v4; native in a build for one processor
    const char* description;  ///< for users: the level of x86-64 and its vector instructions
    const CpuLoops* (*loops)();
    bool (*available)();  ///< whether the processor has it
};

/// All instruction sets of this build, the widest one last
const std::vector<InstructionSet>& instruction_sets();

/// The instruction set of engines that are made from now on: the one of the last choose_instruction_set(),
/// otherwise the one that the environment variable HILDA_ISA names, otherwise the widest one that the
/// processor has. Throws as choose_instruction_set().
const InstructionSet& instruction_set();

/// The one of the last choose_instruction_set(); nullptr without a call
const InstructionSet* chosen_instruction_set();

/// Chooses the instruction set `name` for engines that are made from now on. `origin`: of the name, for
/// messages. Throws io::UsageError if the build does not have it, and io::NotAvailable if the processor does
/// not; the messages list what there is.
void choose_instruction_set(const std::string& name, const std::string& origin = "--isa");

/// Name and description of instruction_set(), or what is wrong with HILDA_ISA: for descriptions of the
/// program, which a report of a defect contains
std::string described_instruction_set();

/// The loops of instruction_set()
inline const CpuLoops& cpu_loops() { return *instruction_set().loops(); }

}  // namespace hilda::granular
