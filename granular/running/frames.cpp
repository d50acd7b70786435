// SPDX-License-Identifier: GPL-3.0-or-later
/// run.pvd, vtk/particles-*.vtp, vtk/boundaries-*.vtp and, of a case with contacts.network,
/// vtk/contacts-*.vtp: the particles, the boundaries and the contacts, for ParaView.

#include "granular/running/sink.hpp"
#include "granular/world/boundary_drawing.hpp"
#include "granular/world/contact_output.hpp"
#include "granular/world/output.hpp"
#include "io/files.hpp"
#include "io/formats/vtk.hpp"
#include "io/message.hpp"

#include <cstdio>
#include <filesystem>

namespace hilda::granular {

namespace {

std::string frame(long k) { return io::formatted("vtk/particles-%06ld.vtp", k); }
std::string boundary_frame(long k) { return io::formatted("vtk/boundaries-%06ld.vtp", k); }
std::string contact_frame(long k) { return io::formatted("vtk/contacts-%06ld.vtp", k); }

/// Removes the frames from number k on.
void remove_frames(const std::string& folder, long k)
{
    for (; std::remove((folder + frame(k)).c_str()) == 0; ++k)
        for (const std::string& part : {boundary_frame(k), contact_frame(k)})
            std::remove((folder + part).c_str());
}

class Frames final : public Sink {
public:
    explicit Frames(const CaseSetup& run)
        : c(run.c), directory(run.directory + '/'), steps(run.steps_in(c.frame_interval))
    {}

    long interval() const override { return steps; }

    void node(const World& w) override
    {
        io::make_folder_in(directory, "vtk");
        const long k = w.steps() / steps;
        if (!w.all_boundaries().empty()) io::write_file(directory + boundary_frame(k), boundaries_vtp(w));
        if (c.outputs.contacts && c.outputs.contacts->network)
            io::write_file(directory + contact_frame(k), contact_network_vtp(w, finite_contacts(w)));
        io::write_file(directory + frame(k),
                       [&](const io::Append& append) { particles_vtp(w, append, c.groups.get()); });
    }

    /// Frames are missing if an earlier part of the run used --no-vtk. Later ones are of an interrupted run
    /// to a later end.
    void close() override
    {
        remove_frames(directory, c.world->steps() / steps + 1);
        std::vector<std::pair<double, std::string>> frames;
        for (long k = 0; k * steps <= c.world->steps(); ++k)
            for (const std::string& file : {frame(k), boundary_frame(k), contact_frame(k)})
                if (std::filesystem::exists(directory + file))
                    frames.emplace_back(static_cast<double>(k * steps) * c.h, file);
        if (!frames.empty()) io::write_file(directory + "run.pvd", io::vtk_collection(frames));
    }

    std::vector<std::string> files() const override { return {"run.pvd"}; }

private:
    const Case& c;
    const std::string directory;
    const long steps;
};

const bool registered_frames =
    io::Registry<SinkType>::add({.name = "frames",
                                 .options = {{.name = "--no-vtk", .help = "write no frames for ParaView"}},
                                 .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> {
                                     if (run.options.contains("--no-vtk")) return nullptr;
                                     return std::make_unique<Frames>(run);
                                 },
                                 .remove =
                                     [](const std::string& directory) {
                                         const std::string folder = directory + '/';
                                         std::remove((folder + "run.pvd").c_str());
                                         remove_frames(folder, 0);
                                     }});

}  // namespace

}  // namespace hilda::granular
