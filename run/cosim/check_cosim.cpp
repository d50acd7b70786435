// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/check_cosim.hpp"

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "run/cosim/effective_mass.hpp"
#include "run/cosim/grain_coupling.hpp"
#include "run/cosim/local_grains.hpp"
#include "run/named_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

namespace hilda::run {

namespace {

/// A pair as the command prints it
struct PairInfo {
    std::string body, boundary;
    double mass, effective_mass;  ///< [kg]
    granular::ToolStiffness K;
    double contacts;     ///< number of contacts K.single with which the step is stable
    double stable_step;  ///< on the present contacts [s]
};

io::Json finite_or_null(double x) { return std::isfinite(x) ? io::Json(x) : nullptr; }

io::Json as_json(const PairInfo& p)
{
    return {{"body", p.body},
            {"boundary", p.boundary},
            {"mass", p.mass},
            {"effective_mass", finite_or_null(p.effective_mass)},
            {"contact_stiffness", p.K.present},
            {"stable_step", finite_or_null(p.stable_step)},
            {"single_contact_stiffness", p.K.single},
            {"stable_contacts", finite_or_null(p.contacts)}};
}

std::vector<std::string> to_text(const PairInfo& p)
{
    const std::string mass =
        std::isfinite(p.effective_mass)
            ? fmt::format("mass {:.6g} kg, effective {:.6g} kg", p.mass, p.effective_mass)
            : fmt::format("mass {:.6g} kg, no force moves its centre of mass", p.mass);
    std::vector<std::string> all = {fmt::format("boundary '{}', {}", p.boundary, mass)};
    all.push_back(p.K.present > 0
                      ? fmt::format("contacts at the start have {:.3g} N/m: stable up to H = {:.3g} s",
                                    p.K.present, p.stable_step)
                      : std::string("no contacts at the start"));
    if (p.K.single > 0 && std::isfinite(p.contacts))
        all.push_back(
            fmt::format("a contact with an overlap of {} % of the radius has {:.3g} N/m: stable with up "
                        "to {:.0f} such contacts",
                        100 * granular::ToolStiffness::single_overlap, p.K.single, std::floor(p.contacts)));
    return all;
}

std::string vector_text(const lie::Vec3& a)
{
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", a[0], a[1], a[2]);
}

}  // namespace

int check_cosim(const CheckOptions& o)
{
    if (o.fix_initial || !o.write.empty() || !o.normal_rows.empty())
        throw io::UsageError(
            "check: --fix-initial, --fix and --normal-rows are valid for models only; check " + o.model +
            " by its model");
    const CosimFile file = read_cosim(o.model, o.set, o.allow_paths);
    std::unique_ptr<granular::Soil> soil = local_grains(file, file.end, {.quiet = true}, o.allow_paths);
    soil->insert();
    const granular::Soil& grains = *soil;
    std::vector<granular::ToolStiffness> stiffness;
    soil->stiffness(stiffness);
    GrainCoupling coupling(file, std::move(soil));
    dae::Description d = named_model(file.model, {}, "", o.allow_paths);
    coupling.find_bodies(d);
    const dae::StartReport start = dae::start(d);
    coupling.analyse(*d.model);
    coupling.refuse_unstable(stiffness, d.x);

    std::vector<std::string> warnings = d.warnings;
    warnings.insert(warnings.end(), grains.notices().begin(), grains.notices().end());
    const granular::Vec3 g = grains.world().gravity();
    const lie::Vec3 of_grains{g.x, g.y, g.z}, of_model = d.model->gravity;
    if ((of_grains - of_model).norm() > 1e-9 * of_model.norm())
        warnings.push_back(fmt::format("{}: gravity of the model is {} m/s², that of the case is {} m/s²",
                                       o.model, vector_text(of_model), vector_text(of_grains)));

    EffectiveMass effective_mass(*d.model);
    std::vector<PairInfo> pairs;
    for (std::size_t j = 0; j < file.pairs.size(); ++j) {
        const CoupledTool& tool = coupling.tools()[j];
        const double m = d.model->mass().m[static_cast<size_t>(tool.body)],
                     effective = effective_mass(d.x, tool.body);
        pairs.push_back({.body = tool.name,
                         .boundary = file.pairs[j].boundary,
                         .mass = m,
                         .effective_mass = effective,
                         .K = stiffness[j],
                         .contacts = 4 * effective / (coupling.H() * coupling.H() * stiffness[j].single),
                         .stable_step = coupling.stable_step(j, stiffness[j].present, d.x)});
    }
    const long steps = std::lround(file.end / coupling.H());
    if (o.json) {
        io::Json out = {{"status", "ok"},
                        {"cosim", file.name},
                        {"model", file.model},
                        {"case", file.granular_case},
                        {"bodies", d.model->bodies()},
                        {"degrees_of_freedom", start.degrees_of_freedom},
                        {"particles", grains.world().count()},
                        {"step", coupling.H()},
                        {"grain_step", grains.h()},
                        {"substeps", file.substeps},
                        {"steps", steps},
                        {"end", file.end},
                        {"integrator", file.integrator},
                        {"pairs", io::Json::array()},
                        {"warnings", warnings}};
        for (const PairInfo& p : pairs) out["pairs"].push_back(as_json(p));
        std::cout << out.text();
        return io::exit_code::done;
    }
    for (const std::string& w : warnings) io::warning(w);
    if (o.quiet) return io::exit_code::done;
    const auto line = [](const std::string& what, const std::string& text) {
        std::cout << fmt::format("{:<20}{}\n", what, text);
    };
    line("co-simulation", file.name);
    line("model", fmt::format("{}, {}, {}", file.model, io::counted(d.model->bodies(), "body", "bodies"),
                              io::counted(start.degrees_of_freedom, "degree", "degrees") + " of freedom"));
    line("case", fmt::format("{}, {}", file.granular_case,
                             io::counted(static_cast<long>(grains.world().count()), "particle")));
    line("step", fmt::format("H = {:.6g} s = {} × {:.6g} s, {} to the end at {:g} s", coupling.H(),
                             file.substeps, grains.h(), io::counted(steps, "exchange"), file.end));
    for (const PairInfo& p : pairs) {
        std::string head = "  " + p.body;
        for (const std::string& text : to_text(p)) line(head, text), head.clear();
    }
    return io::exit_code::done;
}

}  // namespace hilda::run
