// SPDX-License-Identifier: GPL-3.0-or-later
/// trajectory.csv: the motion of all bodies at the output rows; with --reactions also forces and multipliers.

#include "dae/model.hpp"
#include "dae/start.hpp"
#include "io/csv.hpp"
#include "studies/running/contact_outputs.hpp"
#include "studies/running/state_columns.hpp"

namespace hilda::studies {

namespace {

class Trajectory final : public RowsSink {
public:
    explicit Trajectory(const RunSetup& run)
        : RowsSink(run.directory, "trajectory.csv"), model(run.model),
          with_reactions(run.options.contains("--reactions")), bodies(body_columns(model)),
          of_bodies(bodies->columns.size()), contacts(model), C(model.pattern())
    {}

private:
    std::string header() const override
    {
        std::string row = "t";
        const auto columns = [&](const std::string& name, std::initializer_list<const char*> of) {
            for (const char* column : of) row += ',' + io::csv_field(name + '.' + column);
        };
        for (const dae::Quantity& column : bodies->columns) row += ',' + io::csv_field(column.name);
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
            for (const ContactOutputs::Contact& c : contacts.contacts) {
                if (c.constraint == nullptr) continue;
                columns(c.name, {"F_N", "Cx", "Cy", "Cz", "ai_x", "ai_y", "ai_z", "aj_x", "aj_y", "aj_z",
                                 "lambda_N"});
                if (has_friction(c)) columns(c.name, {"Ff_x", "Ff_y", "Ff_z"});
                if (c.constraint->may_be_inactive()) columns(c.name, {"gap"});
            }
        }
        return row + '\n';
    }

    void append(std::string& row, const RunNode& node) override
    {
        if (!node.is_row) return;
        const lie::State& x = node.x;
        io::append_number(row, x.t);
        bodies->values(x, of_bodies.data());
        io::append_vector(row, of_bodies);
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

    /// True if a contact constraint has friction, by multipliers or by a force element
    static bool has_friction(const ContactOutputs::Contact& c)
    {
        return c.constraint->velocity_rows() > 0 || c.friction != nullptr;
    }

    /// Writes F_N, the contact point of the constraint (global and in both body frames), |λ_N|, the friction
    /// force on body i and the gap of the contact constraints
    void append_contacts(std::string& row, const lie::State& x)
    {
        for (size_t k = 0; k < contacts.contacts.size(); ++k) {
            const contact::EvolvingContact* c = contacts.contacts[k].constraint;
            if (c == nullptr) continue;
            const dae::Constraint::Arguments at = model.arguments(*c, x);
            const ContactOutput loads = contacts.at(k, x);
            row += ',';
            io::append_number(row, loads.F_N);
            io::append_vector(row, c->contact_point(at).C());
            io::append_vector(row, lie::Vec3::Map(at.alpha));
            io::append_vector(row, lie::Vec3::Map(at.alpha + 3));
            row += ',';
            io::append_number(row, forces(model, *c, x).N.norm());
            if (has_friction(contacts.contacts[k])) io::append_vector(row, loads.F);
            if (!c->may_be_inactive()) continue;
            row += ',';
            io::append_number(row, c->contact_point(at).gap);
        }
    }

    const dae::Model& model;
    const bool with_reactions;
    const std::unique_ptr<ColumnGroup> bodies;
    Eigen::VectorXd of_bodies;
    const ContactOutputs contacts;
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
