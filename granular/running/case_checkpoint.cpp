// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/running/case_checkpoint.hpp"

#include "granular/stages/stages.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

/// The parts of the state that only some runs have, beside those of the sinks
constexpr const char *changes_part = "run.changes", *stages_part = "run.stages", *groups_part = "run.groups";

template <class F>
void read_part(const CaseCheckpoint::Saved& parts, const char* part, const std::string& file,
               const F& transfer)
{
    const auto at = parts.find(part);
    if (at == parts.end()) throw io::IoError(file + ": the checkpoint is damaged: it has no " + part);
    io::Archive a(at->second, file);
    transfer(a);
    a.end();
}

}  // namespace

void CaseCheckpoint::write(Saved parts, const io::Append& append) const
{
    add_parts(parts);
    c.world->write(id, append, [&](io::Archive& a) {
        a.map(parts);
        transfer_insertions(a);
    });
}

bool CaseCheckpoint::read(const std::string& bytes, const std::string& file, io::Sinks<CaseSetup>& sinks)
{
    const auto read = [&](const std::string& run_id) {
        c.world->from_bytes(bytes, run_id, file, [&](io::Archive& a) {
            Saved parts;
            a.map(parts);
            transfer_insertions(a);
            read_parts(parts, file);
            sinks.open(parts, file);
        });
    };
    try {
        if (from.changes.empty()) return read(id), false;
        try {
            return read(from.earlier_id), true;
        } catch (const io::IoError& e) {
            try {
                return read(id), false;
            } catch (const io::IoError&) {
            }
            throw;
        }
    } catch (const MeshChanged& e) {
        throw MeshChanged(file, e.boundary, '\'' + c.boundaries[e.boundary] + '\'');
    }
}

void CaseCheckpoint::add_parts(Saved& parts) const
{
    if (!history.all.empty()) parts[changes_part] = history.bytes();
    const auto add = [&](bool has_part, const char* part, const auto& write) {
        if (!has_part) return;
        io::Archive a;
        write(a);
        parts[part] = a.bytes();
    };
    add(c.stages != nullptr, stages_part, [&](io::Archive& a) { c.stages->transfer(a); });
    add(changes_groups(), groups_part, [&](io::Archive& a) { c.groups->transfer(a); });
}

void CaseCheckpoint::read_parts(const Saved& parts, const std::string& file)
{
    if (const auto at = parts.find(changes_part); at != parts.end()) history.read(at->second, file);
    if (changes_groups()) read_part(parts, groups_part, file, [&](io::Archive& a) { c.groups->transfer(a); });
    if (c.stages == nullptr) return;
    read_part(parts, stages_part, file, [&](io::Archive& a) { c.stages->transfer(a); });
    c.stages->resume(c);
}

bool CaseCheckpoint::changes_groups() const
{
    const auto assigns = [](const StageSpec& s) { return !s.groups.empty(); };
    return c.groups != nullptr &&
           (c.insertions != nullptr || std::any_of(c.stage_specs.begin(), c.stage_specs.end(), assigns));
}

void CaseCheckpoint::transfer_insertions(io::Archive& a) const
{
    if (c.insertions != nullptr) c.insertions->transfer(a);
}

}  // namespace hilda::granular
