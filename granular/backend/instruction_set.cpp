// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/backend/instruction_set.hpp"

#include "io/error.hpp"
#include "io/option_values.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>

using hilda::granular::CpuLoops;

extern "C" {
const CpuLoops* hilda_granular_loops_base();
#ifdef HILDA_LOOPS_X86_64
const CpuLoops* hilda_granular_loops_v3();
const CpuLoops* hilda_granular_loops_v4();
#endif
}

namespace hilda::granular {

namespace {

std::atomic<const InstructionSet*> chosen = nullptr;

bool always() { return true; }
#ifdef HILDA_LOOPS_X86_64
bool has_v3()
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2");
}
bool has_v4()
{
    return has_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}
#endif

const InstructionSet& named(const std::string& name, const std::string& origin)
{
    std::vector<std::string> all;
    std::string available;
    for (const InstructionSet& set : instruction_sets()) {
        all.emplace_back(set.name);
        if (set.available()) available += (available.empty() ? "" : ", ") + all.back();
    }
    io::one_of(origin, name, all);
    const InstructionSet& found = *std::find_if(instruction_sets().begin(), instruction_sets().end(),
                                                [&](const InstructionSet& set) { return name == set.name; });
    if (!found.available())
        throw io::NotAvailable(origin + ": this processor does not have " + name + " (" + found.description +
                               "); it has " + available);
    return found;
}

const InstructionSet& default_set()
{
    if (const char* const name = std::getenv("HILDA_ISA"); name != nullptr && *name != '\0')
        return named(name, "HILDA_ISA");
    const InstructionSet* widest = nullptr;
    for (const InstructionSet& set : instruction_sets())
        if (set.available()) widest = &set;
    return *widest;
}

}  // namespace

const std::vector<InstructionSet>& instruction_sets()
{
#ifdef HILDA_LOOPS_X86_64
    static const std::vector<InstructionSet> sets = {
        {"sse2", "x86-64, vectors of 128 bits", hilda_granular_loops_base, always},
        {"v3", "x86-64-v3, AVX2", hilda_granular_loops_v3, has_v3},
        {"v4", "x86-64-v4, AVX-512", hilda_granular_loops_v4, has_v4}};
#else
    static const std::vector<InstructionSet> sets = {
        {"native", "the flags of this build", hilda_granular_loops_base, always}};
#endif
    return sets;
}

const InstructionSet& instruction_set()
{
    if (const InstructionSet* const set = chosen_instruction_set()) return *set;
    static const InstructionSet& by_default = default_set();
    return by_default;
}

const InstructionSet* chosen_instruction_set() { return chosen.load(std::memory_order_acquire); }

std::string described_instruction_set()
{
    try {
        const InstructionSet& set = instruction_set();
        return std::string(set.name) + " (" + set.description + ")";
    } catch (const io::Failure& wrong) {
        return wrong.what();
    }
}

void choose_instruction_set(const std::string& name, const std::string& origin)
{
    chosen.store(&named(name, origin), std::memory_order_release);
}

}  // namespace hilda::granular
