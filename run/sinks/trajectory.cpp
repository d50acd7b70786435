// SPDX-License-Identifier: GPL-3.0-or-later
/// Table trajectory: the motion of all bodies at the output rows; with --reactions also forces and
/// multipliers.

#include "dae/model.hpp"
#include "dae/start.hpp"
#include "run/columns/contact_outputs.hpp"
#include "run/columns/state_columns.hpp"

namespace hilda::run {

namespace {

class Trajectory final : public TableSink {
public:
    explicit Trajectory(const RunSetup& run)
        : TableSink(run, "trajectory"), model(run.model), bodies(body_columns(model)),
          with_reactions(run.options.contains("--reactions")), contacts(model), C(model.pattern())
    {}

private:
    std::vector<TableColumn> columns() const override
    {
        std::vector<TableColumn> all = {time_column};
        run::append(all, bodies->columns);
        all.push_back(
            {"energy", "J", "kinetic energy plus potential energy of gravity, springs and contact springs"});
        all.push_back({"constraint_norm", "m or rad", "largest scaled residual of the position constraints"});
        if (with_reactions) add_columns_of_reactions(all);
        return all;
    }

    void add_columns_of_reactions(std::vector<TableColumn>& all) const
    {
        const auto vector = [&](const std::string& name, const char* unit, const char* meaning) {
            for (const char* axis : {"x", "y", "z"}) all.push_back({name + axis, unit, meaning});
        };
        for (const dae::Body& body : model.all_bodies()) {
            vector(body.name + ".F", "N", "resultant of all constraint forces on the body, global frame");
            vector(body.name + ".T", "N m",
                   "resultant constraint torque about the centre of mass, body frame");
        }
        // A dropped row has no multiplier. The rows of a constraint with several rows are numbered.
        std::vector<int> rows(model.constraints());
        for (const dae::Model::Row& r : model.all_rows()) ++rows[r.constraint];
        for (const int k : model.active_rows()) {
            const dae::Model::Row& r = model.all_rows()[k];
            const std::string number = rows[r.constraint] > 1 ? std::to_string(r.number) : "";
            all.push_back({model.constraint_name(r.constraint) + ".lambda" + number, "N or N m",
                           "Lagrange multiplier of the equation; the constraint force is -Phi_r' lambda"});
        }
        for (const ContactOutputs::Contact& c : contacts.contacts) {
            if (c.constraint == nullptr) continue;
            all.push_back({c.name + ".F_N", "N", "normal force, positive in compression"});
            vector(c.name + ".C", "m", "contact point, global frame");
            vector(c.name + ".ai_", "m", "contact point on body i, frame of body i");
            vector(c.name + ".aj_", "m", "contact point on body j, frame of body j");
            all.push_back({c.name + ".lambda_N", "N",
                           "magnitude of the multiplier of the normal equations, zero in theory"});
            if (has_friction(c)) vector(c.name + ".Ff_", "N", "friction force on body i, global frame");
            if (c.constraint->may_be_inactive())
                all.push_back({c.name + ".gap", "m", "distance of the surfaces, negative for an overlap"});
        }
    }

    void append(std::vector<double>& row, const RunNode& node) override
    {
        if (!node.is_row) return;
        const lie::State& x = node.x;
        row.resize(1 + bodies->columns.size());
        row[0] = x.t;
        bodies->values(x, row.data() + 1);
        row.push_back(node.energy);
        row.push_back(node.constraint_norm);
        if (with_reactions) append_reactions(row, x);
    }

    void append_reactions(std::vector<double>& row, const lie::State& x)
    {
        dae::reactions(model, x, C, reactions);
        for (const dae::Reaction& on : reactions) {
            run::append(row, on.F);
            run::append(row, on.T);
        }
        row.insert(row.end(), x.lambda.begin(),
                   x.lambda.begin() + static_cast<std::ptrdiff_t>(model.active_rows().size()));
        append_contacts(row, x);
    }

    /// True if a contact constraint has friction, by multipliers or by a force element
    static bool has_friction(const ContactOutputs::Contact& c)
    {
        return c.constraint->velocity_rows() > 0 || c.friction != nullptr;
    }

    /// Writes F_N, the contact point of the constraint (global and in both body frames), |λ_N|, the friction
    /// force on body i and the gap of the contact constraints
    void append_contacts(std::vector<double>& row, const lie::State& x)
    {
        for (size_t k = 0; k < contacts.contacts.size(); ++k) {
            const contact::EvolvingContact* c = contacts.contacts[k].constraint;
            if (c == nullptr) continue;
            const dae::Constraint::Arguments at = model.arguments(*c, x);
            const ContactOutput loads = contacts.at(k, x);
            row.push_back(loads.F_N);
            run::append(row, c->contact_point(at).C());
            run::append(row, lie::Vec3::Map(at.alpha));
            run::append(row, lie::Vec3::Map(at.alpha + 3));
            row.push_back(forces(model, *c, x).N.norm());
            if (has_friction(contacts.contacts[k])) run::append(row, loads.F);
            if (c->may_be_inactive()) row.push_back(c->contact_point(at).gap);
        }
    }

    const dae::Model& model;
    const std::unique_ptr<ColumnGroup> bodies;
    const bool with_reactions;
    const ContactOutputs contacts;
    lie::Rows C;
    std::vector<dae::Reaction> reactions;
};

const bool registered_trajectory = io::Registry<SinkType>::add(
    {.name = "trajectory",
     .options = {{.name = "--reactions",
                  .help = "write constraint forces and multipliers to trajectory.csv as well"}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         return std::make_unique<Trajectory>(run);
     },
     .files = {"trajectory.csv"}});

}  // namespace

}  // namespace hilda::run
