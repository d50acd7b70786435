// SPDX-License-Identifier: GPL-3.0-or-later
/// The coupling of a mechanism with grains, see granular/cosim/exchange.hpp.

#pragma once

#include "granular/cosim/exchange.hpp"
#include "run/cosim/cosim_file.hpp"
#include "run/cosim/coupled_wrench.hpp"
#include "run/cosim/effective_mass.hpp"
#include "run/recording/coupling.hpp"

#include <memory>

namespace hilda::dae {
class Model;
}

namespace hilda::run {

class GrainCoupling final : public Coupling {
public:
    GrainCoupling(const CosimFile& file, std::unique_ptr<granular::Exchange> grains);

    /// Step of the mechanism [s]
    double H() const { return h * static_cast<double>(k); }
    const std::vector<CoupledTool>& tools() const override { return all; }

    /// Finds the bodies of the pairs. Throws io::InvalidInput for a pair without a body, and for a boundary
    /// that is not at the place of its body or has another mass.
    void find_bodies(const dae::Description& description);
    /// Prepares the functions below, after the start of the model.
    void analyse(const lie::System& system) { effective_mass = std::make_unique<EffectiveMass>(system); }
    /// The stability limit 2 √(m/K) of a body whose contacts have this stiffness K [N/m], with its
    /// EffectiveMass in the state x [s]
    double stable_step(std::size_t tool, double stiffness, const lie::State& x) const;
    /// Throws io::InvalidInput if the step is above the stability limit of a body on one contact, or on its
    /// present contacts.
    void refuse_unstable(const std::vector<granular::ToolStiffness>& stiffness, const lie::State& x) const;

    void prepare(dae::Description& description, std::optional<long> node) override;
    void begin(const lie::March& march, const std::function<void(const std::string&)>& warn) override;
    void before_step(lie::March& march) override;
    void before_finish() override;
    void save() override { grains->save(); }
    void close(int code) override;

private:
    /// Number of steps of the grains before the exchange at node n
    long steps_before(long n) const { return n == 0 ? 0 : k / 2 + 1 + (n - 1) * k; }
    void set_motions(const lie::State& x, double time);
    Vec6 velocity(const lie::State& x, int body) const;
    std::vector<Wrench6> loads(const lie::State& x);
    bool is_unstable(std::size_t tool, double stiffness, const lie::State& x) const;
    void check_stability(const lie::State& x);
    void check_tool(std::size_t number, const dae::Description& d) const;

    const CosimFile& file;
    std::unique_ptr<granular::Exchange> grains;
    const dae::Model* model = nullptr;
    const double h;  ///< of the grains [s]
    const long k;    ///< substeps
    std::vector<CoupledTool> all;
    std::vector<CoupledWrench*> force;
    std::vector<lie::Mat3> frame;  ///< rotation from the frame of Boundary::p to that of the body
    std::vector<granular::ToolMotion> motions;    ///< for the exchange
    std::vector<granular::ToolImpulse> impulses;  ///< of the exchange
    std::vector<double> mass;                     ///< of the bodies [kg]
    std::function<void(const std::string&)> warn;

    // Of the stability limit
    static constexpr long nodes_between_checks = 16;
    std::unique_ptr<EffectiveMass> effective_mass;
    std::vector<granular::ToolStiffness> stiffness;
    std::vector<bool> warned;  ///< by body
};

}  // namespace hilda::run
