// SPDX-License-Identifier: GPL-3.0-or-later
/// run.pvd and vtk/run-*.vtp: the bodies, joints, springs and contacts, for ParaView.

#include "io/option_values.hpp"
#include "run/frames/frame_files.hpp"
#include "run/frames/model_frames.hpp"
#include "run/tables/sink.hpp"

#include <fmt/format.h>

namespace hilda::run {

namespace {

class Vtk final : public io::Sink<RunNode> {
public:
    Vtk(const RunSetup& run, const lie::TimeGrid& at)
        : at(at), model(run.model), drawing(drawing_of(model)), frames(drawing, run.directory, "run")
    {}

    void open() override { frames.open(); }
    void node(const RunNode& node) override
    {
        if (at.is_row(node.n)) frames.add(model.frame(node.x));
    }
    void sync() override { frames.sync(); }
    void transfer(io::Archive& a) override { frames.transfer(a); }
    void close() override { frames.close(); }
    std::vector<std::string> files() const override { return {"run.pvd"}; }

private:
    static Drawing drawing_of(const ModelDrawing& model)
    {
        Drawing drawing;
        model.add_to(drawing);
        return drawing;
    }

    const lie::TimeGrid at;
    const ModelDrawing model;
    const Drawing drawing;
    FrameFiles frames;
};

std::unique_ptr<io::Sink<RunNode>> make(const RunSetup& run)
{
    const auto option = run.options.find("--vtk");
    if (option == run.options.end()) return nullptr;
    const double between = io::positive_number("--vtk", option->second);
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

const bool registered_vtk = io::Registry<SinkType>::add(
    {.name = "vtk",
     .options = {{.name = "--vtk",
                  .value = "DT",
                  .help = "time between ParaView frames of the model [s]; default: no frames",
                  .check = [](const std::string& option,
                              const std::string& text) { io::positive_number(option, text); }}},
     .make = make,
     .remove = [](const std::string& directory) { FrameFiles::remove(directory, "run"); }});

}  // namespace

}  // namespace hilda::run
