// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/csv_trajectory.hpp"

#include "dae/model.hpp"
#include "io/csv.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

TrajectoryCsv::TrajectoryCsv(const dae::Model& model, const lie::TimeGrid& grid, io::OutputFile& file,
                             bool with_reactions)
    : model(model), grid(grid), file(file), with_reactions(with_reactions),
      contacts(evolving_contacts(model)), C(model.pattern())
{
    invariants.contact.resize(contacts.size());
    for (const contact::EvolvingContact* c : contacts)
        force_elements.push_back(find_force_elements(model, *c));
}

void TrajectoryCsv::write_header()
{
    std::string& row = file.buffer;
    const auto columns = [&](const std::string& name, std::initializer_list<const char*> of) {
        for (const char* column : of) row += ',' + io::csv_field(name + '.' + column);
    };
    row += "t";
    for (const dae::Body& body : model.all_bodies())
        columns(body.name, {"rx", "ry", "rz", "A11", "A12", "A13", "A21", "A22", "A23", "A31", "A32", "A33",
                            "vx", "vy", "vz", "wx",  "wy",  "wz",  "ax",  "ay",  "az",  "alx", "aly", "alz"});
    row += ",energy,constraint_norm";
    if (with_reactions) {
        for (const dae::Body& body : model.all_bodies())
            columns(body.name, {"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"});
        // A dropped row has no multiplier. The rows of a constraint with several rows are numbered.
        std::vector<int> rows(model.constraints());
        for (const dae::Model::Row& r : model.all_rows()) ++rows[r.constraint];
        for (const int k : model.active_rows()) {
            const dae::Model::Row& r = model.all_rows()[k];
            const std::string number = rows[r.constraint] > 1 ? std::to_string(r.number) : "";
            row += ',' + io::csv_field(model.constraint_name(r.constraint) + ".lambda" + number);
        }
        for (size_t k = 0; k < contacts.size(); ++k) {
            const contact::EvolvingContact* c = contacts[k];
            columns(c->name,
                    {"F_N", "Cx", "Cy", "Cz", "ai_x", "ai_y", "ai_z", "aj_x", "aj_y", "aj_z", "lambda_N"});
            if (has_friction(k)) columns(c->name, {"Ff_x", "Ff_y", "Ff_z"});
            if (c->may_be_inactive()) columns(c->name, {"gap"});
        }
    }
    row += '\n';
}

void TrajectoryCsv::accepted(const lie::State& x, long n, int)
{
    const double energy = lie::energy(model, x), constraint_norm = model.largest_residual(x).value;
    update_invariants(x, energy, constraint_norm);
    if (!grid.is_row(n)) return dae::check_dropped_rows(model, x);
    ++invariants.rows;
    std::string& row = file.buffer;
    io::append_number(row, x.t);
    for (const lie::Motion& body : x.body) {
        io::append_vector(row, body.r);
        for (int i = 0; i < 3; ++i) io::append_vector(row, body.A.row(i));
        io::append_vector(row, body.rdot);
        io::append_vector(row, body.omega_bar);
        io::append_vector(row, body.rddot);
        io::append_vector(row, body.omegadot_bar);
    }
    row += ',';
    io::append_number(row, energy);
    row += ',';
    io::append_number(row, constraint_norm);
    if (with_reactions) {
        dae::reactions(model, x, C, reactions);
        for (const dae::Reaction& on : reactions) {
            io::append_vector(row, on.F);
            io::append_vector(row, on.T);
        }
        io::append_vector(row, x.lambda.head(static_cast<Eigen::Index>(model.active_rows().size())));
        write_contacts(x);
    }
    row += '\n';
    file.flush_when_full();

    dae::check_dropped_rows(model, x);
}

/// True if contact k has friction, by multipliers or by a force element
bool TrajectoryCsv::has_friction(size_t k) const
{
    return contacts[k]->velocity_rows() > 0 || force_elements[k].friction != nullptr;
}

/// Writes F_N, the contact point (global and in both body frames), |λ_N|, the friction force on body i and
/// the gap
void TrajectoryCsv::write_contacts(const lie::State& x)
{
    std::string& row = file.buffer;
    for (size_t k = 0; k < contacts.size(); ++k) {
        const contact::EvolvingContact* c = contacts[k];
        const dae::Constraint::Arguments at = model.arguments(*c, x);
        const ContactLoads loads = contact_loads(model, *c, force_elements[k], x);
        row += ',';
        io::append_number(row, loads.F_N);
        io::append_vector(row, c->contact_point(at).C());
        io::append_vector(row, lie::Vec3::Map(at.alpha));
        io::append_vector(row, lie::Vec3::Map(at.alpha + 3));
        row += ',';
        io::append_number(row, forces(model, *c, x).N.norm());
        if (has_friction(k)) io::append_vector(row, loads.friction);
        if (!c->may_be_inactive()) continue;
        row += ',';
        io::append_number(row, c->contact_point(at).gap);
    }
}

void TrajectoryCsv::update_invariants(const lie::State& x, double energy, double constraint_norm)
{
    if (invariants.nodes++ == 0) invariants.energy_start = energy;
    invariants.energy_end = energy;
    invariants.energy_drift = std::max(invariants.energy_drift, std::abs(energy - invariants.energy_start));
    invariants.constraint_norm = std::max(invariants.constraint_norm, constraint_norm);
    for (const lie::Motion& body : x.body)
        invariants.orthogonality = std::max(invariants.orthogonality, lie::orthogonality_error(body.A));
    for (size_t k = 0; k < contacts.size(); ++k) {
        const auto of = forces(model, *contacts[k], x);
        ContactExtremes& extremes = invariants.contact[k];
        extremes.F_N_least = std::min(extremes.F_N_least, of.F_N);
        extremes.F_N_most = std::max(extremes.F_N_most, of.F_N);
        extremes.lambda_N = std::max(extremes.lambda_N, of.N.norm());
    }
}

}  // namespace hilda::studies
