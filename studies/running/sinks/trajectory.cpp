// SPDX-License-Identifier: GPL-3.0-or-later
/// trajectory.csv: the motion of all bodies at the output rows; with --reactions also forces and multipliers.

#include "dae/model.hpp"
#include "dae/start.hpp"
#include "io/csv.hpp"
#include "studies/running/contact_rows.hpp"
#include "studies/running/sink.hpp"

namespace hilda::studies {

namespace {

class Trajectory final : public RowsSink {
public:
    explicit Trajectory(const RunSetup& run)
        : RowsSink(run.directory, "trajectory.csv"), model(run.model),
          with_reactions(run.options.contains("--reactions")), contacts(evolving_contacts(model)),
          C(model.pattern())
    {
        for (const contact::EvolvingContact* c : contacts)
            force_elements.push_back(find_force_elements(model, *c));
    }

private:
    std::string header() const override
    {
        std::string row = "t";
        const auto columns = [&](const std::string& name, std::initializer_list<const char*> of) {
            for (const char* column : of) row += ',' + io::csv_field(name + '.' + column);
        };
        for (const dae::Body& body : model.all_bodies())
            columns(body.name,
                    {"rx", "ry", "rz", "A11", "A12", "A13", "A21", "A22", "A23", "A31", "A32", "A33",
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
                columns(c->name, {"F_N", "Cx", "Cy", "Cz", "ai_x", "ai_y", "ai_z", "aj_x", "aj_y", "aj_z",
                                  "lambda_N"});
                if (has_friction(k)) columns(c->name, {"Ff_x", "Ff_y", "Ff_z"});
                if (c->may_be_inactive()) columns(c->name, {"gap"});
            }
        }
        return row + '\n';
    }

    void append(std::string& row, const RunNode& node) override
    {
        if (!node.is_row) return;
        const lie::State& x = node.x;
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
        io::append_number(row, node.energy);
        row += ',';
        io::append_number(row, node.constraint_norm);
        if (with_reactions) append_reactions(row, x);
        row += '\n';
    }

    void append_reactions(std::string& row, const lie::State& x)
    {
        dae::reactions(model, x, C, reactions);
        for (const dae::Reaction& on : reactions) {
            io::append_vector(row, on.F);
            io::append_vector(row, on.T);
        }
        io::append_vector(row, x.lambda.head(static_cast<Eigen::Index>(model.active_rows().size())));
        append_contacts(row, x);
    }

    /// True if contact k has friction, by multipliers or by a force element
    bool has_friction(size_t k) const
    {
        return contacts[k]->velocity_rows() > 0 || force_elements[k].friction != nullptr;
    }

    /// Writes F_N, the contact point (global and in both body frames), |λ_N|, the friction force on body i and
    /// the gap
    void append_contacts(std::string& row, const lie::State& x)
    {
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

    const dae::Model& model;
    const bool with_reactions;
    std::vector<const contact::EvolvingContact*> contacts;
    std::vector<ContactForceElements> force_elements;  ///< of these contacts
    lie::Rows C;
    std::vector<dae::Reaction> reactions;
};

const bool registered = io::Registry<SinkType>::add(
    {.name = "trajectory",
     .options = {{.name = "--reactions",
                  .help = "write constraint forces and multipliers to trajectory.csv as well"}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         return std::make_unique<Trajectory>(run);
     },
     .files = {"trajectory.csv"}});

}  // namespace

}  // namespace hilda::studies
