// SPDX-License-Identifier: GPL-3.0-or-later
/// Variations of a model, assembled from its blocks and forces, compared with the central differences that
/// are the default of lie::System.

#include "dae/forces/bushing.hpp"
#include "dae/forces/limits.hpp"
#include "dae/forces/prescribed.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "dae/start.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <typeinfo>

using namespace hilda;
using namespace hilda::dae;

namespace {

/// The equations of a model with the default variations of lie::System
class DifferencedSystem final : public lie::System {
public:
    explicit DifferencedSystem(const Model& model) : model(model) {}

    const lie::Mass& mass() const override { return model.mass(); }
    const lie::Rows& pattern() const override { return model.pattern(); }
    void loads(const State& x, lie::Loads& out) const override { model.loads(x, out); }
    void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { model.phi(x, out); }
    void variation(const State& x, lie::Rows& out) const override { model.variation(x, out); }
    void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { model.nu(x, out); }
    void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { model.gamma(x, out); }

    const Model& model;
};

}  // namespace

TEST_CASE("the variations of a model are those of its blocks", "[dae][variations]")
{
    Model model;
    State x;
    GENERATE(0, 1) == 0 ? tests::slider_crank(model, x) : tests::four_link(model, x);
    start(model, x);
    tests::Random random(3);
    for (Motion& body : x.body) body.rdot = random.vector(2), body.omega_bar = random.vector(2);
    const DifferencedSystem by_differences(model);

    lie::SecondVariation H(model.pattern()), H_differences(model.pattern());
    model.second_variation(x, H);
    by_differences.second_variation(x, H_differences);
    REQUIRE(H.block.size() == H_differences.block.size());
    for (size_t k = 0; k < H.block.size(); ++k)
        CHECK((H.block[k] - H_differences.block[k]).cwiseAbs().maxCoeff() < 1e-8);

    lie::Rows nu = model.pattern(), nu_differences = model.pattern();
    model.nu_variation(x, nu);
    by_differences.nu_variation(x, nu_differences);
    lie::GammaVariation gamma(model.pattern()), gamma_differences(model.pattern());
    model.gamma_variation(x, gamma);
    by_differences.gamma_variation(x, gamma_differences);
    for (size_t n = 0; n < nu.entry.size(); ++n) {
        CHECK((nu.entry[n].r - nu_differences.entry[n].r).norm() < 1e-8);
        CHECK((nu.entry[n].pi - nu_differences.entry[n].pi).norm() < 1e-8);
        const auto &a = gamma.entry[n], &b = gamma_differences.entry[n];
        CHECK((a.r - b.r).norm() < 1e-6);  // differences of values up to 1e3
        CHECK((a.theta - b.theta).norm() < 1e-6);
        CHECK((a.rdot - b.rdot).norm() < 1e-6);
        CHECK((a.omega - b.omega).norm() < 1e-6);
    }
}

TEST_CASE("the variation of the loads is their derivative", "[dae][variations]")
{
    tests::Random random(GENERATE(range(1u, 4u)));
    Model model;
    State x = random.state(3);
    for (const char* name : {"one", "two", "three"})
        model.add({.name = name, .m = 2, .J_bar = Vec3(1, 1.2, 0.9).asDiagonal()});
    model.load(SpringDamper(0, random.vector(), 2, random.vector(), 30, 4, 0.2));
    model.load(SpringDamper(1, random.vector(), ground, random.vector(), 12, 0.5, 0.1));
    const Vec3 axis = random.unit();
    State aligned = x;
    aligned.body[1].A = aligned.body[0].A;
    model.load(TorsionSpring(0, axis, 1, axis, 7, 0.3, 0.1, aligned));
    model.load(PrescribedForce(
        2, random.vector(), Frame::body,
        {io::Expression("2", {"t"}), io::Expression("t", {"t"}), io::Expression("1", {"t"})}));
    model.prepare(x);

    lie::LoadVariation change = model.load_pattern();
    model.load_variation(x, change);
    using Vec6 = Eigen::Matrix<double, 6, 1>;
    for (int by = 0; by < 3; ++by)
        for (int c = 0; c < 12; ++c)
            for (int on = 0; on < 3; ++on) {
                const auto loads = [&](double s) {
                    State y = x;
                    Vec6 pose = Vec6::Zero();
                    if (c < 6)
                        pose[c] = s;
                    else
                        (c < 9 ? y.body[by].rdot : y.body[by].omega_bar)[c % 3] += s;
                    y.body[by] = tests::displaced(y.body[by], pose);
                    lie::Loads out(3);
                    model.loads(y, out);
                    Vec6 both;
                    both << out.F[on], out.n_bar[on];
                    return both;
                };
                Vec6 sum = Vec6::Zero();
                for (const auto& block : change.block)
                    if (block.on == on && block.by == by) sum += block.d.col(c);
                CHECK((sum - tests::derivative(loads)).cwiseAbs().maxCoeff() < 1e-6);
            }
}

namespace {

std::array<io::Expression, 3> components()
{
    return {io::Expression("2", {"t"}), io::Expression("1-t", {"t"}), io::Expression("-0.5", {"t"})};
}

/// Each force law between two bodies, in each of its regimes
std::vector<std::unique_ptr<Force>> forces_between(int i, int j, tests::Random& random, const State& x,
                                                   double turn)
{
    std::vector<std::unique_ptr<Force>> all;
    const Vec3 s_i = random.vector(), s_j = random.vector(), axis = random.unit();
    const auto add = [&](auto force) { all.push_back(std::make_unique<decltype(force)>(std::move(force))); };
    add(SpringDamper(i, s_i, j, s_j, 30, 4, 0.2));
    add(SpringDamper(i, s_i, j, s_j, 30, 4, 0.2, io::Expression("-5*ldot^3+l^2*ldot", {"l", "ldot", "t"})));
    for (const auto& [minimum, maximum] : {std::pair(-1., 1e-2), {1e2, 1e3}, {0., 1e3}})
        for (const double damping : {0.1, -0.1, 1e3})
            add(DistanceLimit(i, s_i, j, s_j, {minimum, maximum, 40, damping}));
    // The axes of the forces between hinged bodies are parallel in another state than x.
    State start = x;
    if (j == ground)
        start.body[i].A.setIdentity();
    else
        start.body[j].A = i == ground ? Mat3(Mat3::Identity()) : x.body[i].A;
    add(TorsionSpring(i, axis, j, axis, 7, 0.3, 0.1, start));
    for (const auto& [minimum, maximum] : {std::pair(-10., -5.), {5., 10.}, {-10., 10.}})
        for (const double damping : {0.1, -0.1})
            add(AngleLimit(i, axis, j, axis, {minimum, maximum, 40, damping}, start));
    // The rotation of the bushing in the state x is `turn`.
    start = x;
    const Mat3 back = lie::exp(turn * random.unit());
    (i == ground ? start.body[j] : start.body[i]).A = (i == ground ? x.body[j] : x.body[i]).A * back;
    add(Bushing(i, s_i, j, s_j, {{3, 4, 5}, {0.3, 0.2, 0.1}, {2, 1, 3}, {0.1, 0.4, 0.2}}, start));
    if (i == ground) return all;
    for (const Frame frame : {Frame::global, Frame::body}) {
        add(PrescribedForce(i, s_i, frame, components()));
        add(PrescribedTorque(i, frame, components()));
    }
    return all;
}

}  // namespace

TEST_CASE("the closed formulas of the derivatives of each force are its differences", "[dae][variations]")
{
    tests::Random random(GENERATE(range(1u, 6u)));
    State x = random.state(2);
    x.t = 0.3;
    const double turn = GENERATE(0., 1e-6, 0.3, 0.6, 2.5);
    const auto [i, j] =
        GENERATE(std::pair(0, 1), std::pair(1, 0), std::pair(ground, 1), std::pair(0, ground));
    for (const auto& force : forces_between(i, j, random, x, turn)) {
        x.discrete_state.assign(static_cast<size_t>(force->discrete_states()), 0);
        Force::LoadDerivatives closed;
        closed.setConstant(std::nan(""));
        REQUIRE(force->load_derivatives(x, closed));
        const auto bodies = force->bodies();
        for (int by = 0; by < 2; ++by)
            for (int c = 0; c < 12 && bodies[by] != ground; ++c) {
                const auto loads = [&](double s) {
                    State y = x;
                    Motion& body = y.body[bodies[by]];
                    Eigen::Matrix<double, 6, 1> pose = Eigen::Matrix<double, 6, 1>::Zero();
                    if (c < 6)
                        pose[c] = s;
                    else
                        (c < 9 ? body.rdot : body.omega_bar)[c % 3] += s;
                    body = tests::displaced(body, pose);
                    lie::Loads out(2);
                    force->add(y, out);
                    Eigen::Matrix<double, 12, 1> both = Eigen::Matrix<double, 12, 1>::Zero();
                    for (int on = 0; on < 2; ++on)
                        if (const int b = bodies[on]; b != ground)
                            both.segment<6>(6 * on) << out.F[b], out.n_bar[b];
                    return both;
                };
                Eigen::Matrix<double, 12, 1> column = closed.col((c < 6 ? 0 : 6) + 6 * by + c);
                for (int on = 0; on < 2; ++on)
                    if (bodies[on] == ground) column.segment<6>(6 * on).setZero();
                const Eigen::Matrix<double, 12, 1> differences = tests::derivative(loads);
                INFO(typeid(*force).name()
                     << ", bodies " << i << ' ' << j << ", turn " << turn << ", component " << c);
                CHECK((column - differences).norm() < 1e-6 * (1 + differences.norm()));
            }
    }
}
