// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter8/method.hpp"

#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/trajectory.hpp"

namespace hilda::studies::methods {

namespace {

using contact::EvolvingContact;
using contact::Shape;
using lie::Motion;

bool has_finite_mass(const ContactScene& setup, int b)
{
    return std::isfinite(setup.body_types[setup.body[b].type].inertia.m);
}

class EvolvingContactMethod final : public Method {
public:
    EvolvingContactMethod(const ContactScene& setup, const EvolvingOptions& options)
    {
        for (const ContactScene::Interaction& interaction : setup.interaction)
            if (interaction.mu > 0)
                lie::reject("studies::methods::evolving", "the contacts must be frictionless, mu",
                            interaction.mu);
        model.gravity = setup.gravity;
        lie::State x;
        for (size_t b = 0; b < setup.body.size(); ++b) {
            const contact::BodyType& type = setup.body_types[setup.body[b].type];
            number.push_back(dae::ground);
            if (!has_finite_mass(setup, static_cast<int>(b))) continue;
            number.back() = model.add({"body " + std::to_string(b), type.inertia.m, type.inertia.J_bar});
            x.body.push_back(setup.body[b].start);
        }
        for (const contact::Candidate& pair : contact_pairs(setup, options.reach))
            add(setup, options, pair.i, pair.j);
        dae::start(model, x, {.fix_initial = true});
        integrator =
            contact::make_integrator(model, lie::scheme(options.scheme),
                                     {.tolerance = options.tolerance, .linear_solver = options.solver});
        start = x;
    }

    void step(double h) override
    {
        if (!march) march = std::make_unique<lie::March>(start, *integrator, h);
        march->advance({});
    }
    const Motion& body(int b) const override
    {
        return march ? march->node().body[number[b]] : start.body[number[b]];
    }
    int contacts() const override
    {
        int closed = 0;
        const lie::State& x = march ? march->node() : start;
        for (const auto& c : model.general_constraints()) closed += !dae::Model::inactive(*c, x);
        return closed;
    }
    long iterations() const override { return integrator->statistics().iterations; }
    int events() const override
    {
        const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(integrator.get());
        return unilateral != nullptr ? static_cast<int>(unilateral->events().size()) : 0;
    }

private:
    void add(const ContactScene& setup, const EvolvingOptions& options, int i, int j)
    {
        if (!has_finite_mass(setup, i) && !has_finite_mass(setup, j)) return;
        model.constrain(
            "contact " + std::to_string(i) + "-" + std::to_string(j),
            std::make_unique<EvolvingContact>(
                number[i], shape(setup, i), number[j], shape(setup, j), EvolvingContact::Friction::none,
                EvolvingContact::NormalRows::tangent, contact::Unilateral{.enabled = options.unilateral}));
    }

    /// Shape of body b, in the frame of the ground if the body is part of the ground
    Shape shape(const ContactScene& setup, int b) const
    {
        Shape s = setup.body_types[setup.body[b].type].shape;
        if (number[b] != dae::ground) return s;
        const Motion& at = setup.body[b].start;
        if (at.rdot != lie::Vec3::Zero() || at.omega_bar != lie::Vec3::Zero())
            lie::reject("studies::methods::evolving", "a body without a finite mass must be at rest", b);
        s.position = at.r + at.A * s.position;
        s.orientation = at.A * s.orientation;
        return s;
    }

    dae::Model model;
    std::vector<int> number;  // index of each body in the model; ground for fixed bodies
    lie::State start;
    std::unique_ptr<lie::Integrator> integrator;
    std::unique_ptr<lie::March> march;
};

class DviMethod final : public Method {
public:
    DviMethod(const ContactScene& setup, const DviMethodOptions& options) : scene(studies::rigid(setup))
    {
        scene.options.stabilised = options.stabilised;
        scene.options.half_kick = options.half_kick;
        scene.solver.tolerance = options.tolerance;
        scene.solver.max_iterations = options.max_iterations;
    }
    void step(double h) override
    {
        scene.step(h);
        sum += scene.outcome.iterations;
    }
    const Motion& body(int b) const override { return scene.body[b]; }
    int contacts() const override { return scene.contacts(); }
    long iterations() const override { return sum; }

private:
    contact::DviScene scene;
    long sum = 0;
};

class CompliantMethod final : public Method {
public:
    CompliantMethod(const ContactScene& setup, const Compliance& options) : scene(compliant(setup, options))
    {}
    void step(double h) override
    {
        scene.step(h);
        ++steps;
    }
    const Motion& body(int b) const override { return scene.body[b]; }
    int contacts() const override
    {
        int count = 0;
        for (const auto& p : scene.neighbors.pair()) count += p.state.contact_state.N > 0;
        return count;
    }
    long iterations() const override { return steps; }

private:
    contact::Scene scene;
    long steps = 0;
};

}  // namespace

std::unique_ptr<Method> evolving(const ContactScene& setup, const EvolvingOptions& options)
{
    return std::make_unique<EvolvingContactMethod>(setup, options);
}

std::unique_ptr<Method> dvi(const ContactScene& setup, const DviMethodOptions& options)
{
    return std::make_unique<DviMethod>(setup, options);
}

std::unique_ptr<Method> compliant_springs(const ContactScene& setup, const Compliance& options)
{
    return std::make_unique<CompliantMethod>(setup, options);
}

}  // namespace hilda::studies::methods
