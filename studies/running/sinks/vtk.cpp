// SPDX-License-Identifier: GPL-3.0-or-later
/// run.pvd and vtk/run-*.vtp: the bodies, joints, springs and contacts, for ParaView. The files are written at
/// the end of the run (see Snapshots); a checkpoint contains the frames.

#include "studies/program/arguments.hpp"
#include "studies/running/frames/model_frames.hpp"
#include "studies/running/sink.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

class Vtk final : public io::Sink<RunNode> {
public:
    Vtk(const RunSetup& run, const lie::TimeGrid& at) : frames(run.model, at), directory(run.directory) {}

    void node(const RunNode& node) override { frames.accepted(node.x, node.n, node.iterations); }
    void transfer(io::Archive& a) override { frames.snapshots.transfer(a); }
    void close() override { frames.snapshots.write(directory, "run"); }
    std::vector<std::string> files() const override { return {"run.pvd"}; }

private:
    ModelFrames frames;
    const std::string directory;
};

std::unique_ptr<io::Sink<RunNode>> make(const RunSetup& run)
{
    const auto option = run.options.find("--vtk");
    if (option == run.options.end()) return nullptr;
    const double between = positive_number("--vtk", option->second);
    const lie::TimeGrid at = lie::TimeGrid::over(run.end, run.grid.h, between);
    if (at.steps / at.interval + 2 > Snapshots::max_frames)
        throw io::UsageError(fmt::format("{}: --vtk {} gives {} frames, more than {}", run.command, between,
                                         at.steps / at.interval + 1, Snapshots::max_frames));
    const double spacing = static_cast<double>(at.interval) * at.h;
    if (spacing > between * (1 + 1e-9))
        run.warn(fmt::format("--vtk {} is not a multiple of the step: frames are {:.12g} s apart", between,
                             spacing));
    return std::make_unique<Vtk>(run, at);
}

const bool registered = io::Registry<SinkType>::add(
    {.name = "vtk",
     .options = {{.name = "--vtk",
                  .value = "DT",
                  .help = "time between ParaView frames of the model [s]; default: no frames",
                  .check = [](const std::string& option,
                              const std::string& text) { positive_number(option, text); }}},
     .make = make,
     .remove = [](const std::string& directory) { Snapshots::remove(directory, "run"); }});

}  // namespace

}  // namespace hilda::studies
