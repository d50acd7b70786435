// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter8/method.hpp"

#include "dae/start.hpp"
#include "lie/trajectory.hpp"

namespace hilda::studies::methods {

namespace {

using contact::EvolvingContact;
using contact::Shape;
using lie::Motion;

bool moves(const ContactScene& of, int b) { return std::isfinite(of.kind[of.body[b].kind].inertia.m); }

class ByConstraints final : public Method {
public:
    ByConstraints(const ContactScene& of, const Evolving& how)
    {
        for (const ContactScene::Interaction& interaction : of.interaction)
            if (interaction.mu > 0)
                lie::reject("studies::methods::evolving", "contacts must be without friction, mu",
                            interaction.mu);
        model.gravity = of.gravity;
        lie::State x;
        for (size_t b = 0; b < of.body.size(); ++b) {
            const contact::BodyType& kind = of.kind[of.body[b].kind];
            number.push_back(dae::ground);
            if (!moves(of, static_cast<int>(b))) continue;
            number.back() = model.add({"body " + std::to_string(b), kind.inertia.m, kind.inertia.J_bar});
            x.body.push_back(of.body[b].start);
        }
        for (const contact::Candidate& pair : touching(of, how.reach)) add(of, how, pair.i, pair.j);
        dae::start(model, x, {.fix_initial = true});
        integrator = contact::make_integrator(model, lie::scheme(how.scheme),
                                              {.tolerance = how.tolerance, .linear_solver = how.solver});
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
        for (const auto& c : model.evolving()) closed += !dae::Model::inactive(*c, x);
        return closed;
    }
    long iterations() const override { return integrator->statistics().iterations; }
    int events() const override
    {
        const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(integrator.get());
        return unilateral != nullptr ? static_cast<int>(unilateral->events().size()) : 0;
    }

private:
    void add(const ContactScene& of, const Evolving& how, int i, int j)
    {
        if (!moves(of, i) && !moves(of, j)) return;
        model.constrain("contact " + std::to_string(i) + "-" + std::to_string(j),
                        std::make_unique<EvolvingContact>(number[i], shape(of, i), number[j], shape(of, j),
                                                          EvolvingContact::Friction::none,
                                                          EvolvingContact::NormalRows::tangent,
                                                          contact::Unilateral{.enabled = how.unilateral}));
    }

    /// Of the body, or of the ground where it is part of that
    Shape shape(const ContactScene& of, int b) const
    {
        Shape s = of.kind[of.body[b].kind].shape;
        if (number[b] != dae::ground) return s;
        const Motion& at = of.body[b].start;
        if (at.rdot != lie::Vec3::Zero() || at.omega_bar != lie::Vec3::Zero())
            lie::reject("studies::methods::evolving", "a body without a finite mass must stand still", b);
        s.position = at.r + at.A * s.position;
        s.orientation = at.A * s.orientation;
        return s;
    }

    dae::Model model;
    std::vector<int> number;  // of each body in the model
    lie::State start;
    std::unique_ptr<lie::Integrator> integrator;
    std::unique_ptr<lie::March> march;
};

class ByInequality final : public Method {
public:
    ByInequality(const ContactScene& of, const Rigid& how) : scene(studies::rigid(of))
    {
        scene.options.stabilised = how.stabilised;
        scene.options.half_kick = how.half_kick;
        scene.solver.tolerance = how.tolerance;
        scene.solver.max_iterations = how.most_iterations;
    }
    void step(double h) override
    {
        scene.step(h);
        sum += scene.solved.iterations;
    }
    const Motion& body(int b) const override { return scene.body[b]; }
    int contacts() const override { return scene.contacts(); }
    long iterations() const override { return sum; }

private:
    contact::DviScene scene;
    long sum = 0;
};

class BySprings final : public Method {
public:
    BySprings(const ContactScene& of, const Compliance& how) : scene(compliant(of, how)) {}
    void step(double h) override
    {
        scene.step(h);
        ++steps;
    }
    const Motion& body(int b) const override { return scene.body[b]; }
    int contacts() const override
    {
        int touching = 0;
        for (const auto& p : scene.neighbors.pair()) touching += p.state.contact_state.N > 0;
        return touching;
    }
    long iterations() const override { return steps; }

private:
    contact::Scene scene;
    long steps = 0;
};

}  // namespace

std::unique_ptr<Method> evolving(const ContactScene& of, const Evolving& how)
{
    return std::make_unique<ByConstraints>(of, how);
}

std::unique_ptr<Method> rigid(const ContactScene& of, const Rigid& how)
{
    return std::make_unique<ByInequality>(of, how);
}

std::unique_ptr<Method> springs(const ContactScene& of, const Compliance& how)
{
    return std::make_unique<BySprings>(of, how);
}

}  // namespace hilda::studies::methods
