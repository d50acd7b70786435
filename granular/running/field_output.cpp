// SPDX-License-Identifier: GPL-3.0-or-later
/// fields-NAME.csv, fields-NAME.pvd and vtk/fields-NAME-*.vti: coarse-grained fields of a case with `fields`.

#include "granular/fields/field_files.hpp"
#include "granular/fields/field_input.hpp"
#include "granular/running/sink.hpp"
#include "io/formats/vtk.hpp"
#include "io/message.hpp"

#include <cstdio>
#include <filesystem>

namespace hilda::granular {

namespace {

namespace fs = std::filesystem;

/// One entry of `fields`
class FieldOutput {
public:
    FieldOutput(const FieldSpec& spec, const CaseSetup& run)
        : spec(spec), directory(run.directory + '/'), h(run.c.h),
          sums(spec.grid, spec.kernel), times{run.steps_in(spec.interval), spec.samples}
    {}

    int replica() const { return spec.replica; }
    const std::string& group() const { return spec.group; }
    /// Whether the fields take the state after n steps. The start is not part of a mean.
    bool takes(long n) const { return n > 0 ? times.takes(n) : spec.samples == 1; }
    long next(long n) const { return times.next(n); }

    void open()
    {
        file.emplace(directory + csv());
        file->buffer += fields_csv_header();
    }
    void add(const FieldInput& in, double t, long steps)
    {
        sums.add(in);
        if (sums.instants() < spec.samples) return;
        fields_csv(t, spec.grid, sums, [&](std::string_view line) {
            file->buffer += line;
            file->flush_when_full();
        });
        io::make_folder_in(directory, "vtk");
        io::write_file(directory + frame(steps / times.steps),
                       [&](const io::Append& append) { fields_vti(spec.grid, sums, append); });
        sums.reset();
    }
    void sync() { file->sync(); }
    void transfer(io::Archive& a)
    {
        std::uint64_t length = a.reads() ? 0 : file->size();
        a.value(length);
        sums.transfer(a);
        a.check(sums.instants() < spec.samples, "wrong number of samples of a field");
        if (a.reads()) file.emplace(directory + csv(), length, true);
    }
    /// Writes the list of the frames up to this number of steps, and removes later ones of an interrupted run
    /// to a later end.
    void close(long steps)
    {
        file->finish();
        std::vector<std::pair<double, std::string>> frames;
        for (long k = 0; k * times.steps <= steps; ++k)
            if (fs::exists(directory + frame(k)))
                frames.emplace_back(static_cast<double>(k * times.steps) * h, frame(k));
        for (long k = steps / times.steps + 1; std::remove((directory + frame(k)).c_str()) == 0;) ++k;
        io::write_file(directory + pvd(), io::vtk_collection(frames));
    }
    std::string csv() const { return "fields-" + spec.name + ".csv"; }
    std::string pvd() const { return "fields-" + spec.name + ".pvd"; }

private:
    std::string frame(long k) const { return "vtk/fields-" + spec.name + io::formatted("-%06ld.vti", k); }

    const FieldSpec& spec;
    const std::string directory;
    const double h;
    FieldSums sums;
    const SampleTimes times;
    std::optional<io::OutputFile> file;
};

class FieldOutputs final : public Sink {
public:
    explicit FieldOutputs(const CaseSetup& run) : c(run.c), world(*run.c.world)
    {
        for (const FieldSpec& spec : run.c.outputs.fields)
            all.push_back(std::make_unique<FieldOutput>(spec, run));
    }

    bool takes(long n) const override
    {
        return std::any_of(all.begin(), all.end(), [n](const auto& one) { return one->takes(n); });
    }
    long next(long n) const override
    {
        long first = std::numeric_limits<long>::max();
        for (const auto& one : all) first = std::min(first, one->next(n));
        return first;
    }
    void open() override
    {
        for (auto& one : all) one->open();
    }
    void node(const World& w) override
    {
        std::map<std::pair<int, std::string>, FieldInput> of_particles;
        std::optional<std::vector<ContactRecord>> contacts;
        for (auto& one : all) {
            if (!one->takes(w.steps())) continue;
            if (!contacts) contacts = finite_contacts(w);
            const auto [in, is_new] = of_particles.try_emplace({one->replica(), one->group()});
            if (is_new && one->group().empty())
                in->second = field_input(w, *contacts, one->replica());
            else if (is_new)
                in->second =
                    field_input(w, *contacts, one->replica(), c.groups.get(), c.groups->number(one->group()));
            one->add(in->second, w.t(), w.steps());
        }
    }
    void sync() override
    {
        for (auto& one : all) one->sync();
    }
    void transfer(io::Archive& a) override
    {
        for (auto& one : all) one->transfer(a);
    }
    void close() override
    {
        for (auto& one : all) one->close(world.steps());
    }
    std::vector<std::string> files() const override
    {
        std::vector<std::string> names;
        for (const auto& one : all) names.insert(names.end(), {one->csv(), one->pvd()});
        return names;
    }

private:
    const Case& c;
    const World& world;
    std::vector<std::unique_ptr<FieldOutput>> all;
};

/// Removes the files of a folder whose names begin and end so.
void remove_files(const std::string& folder, const std::string& begin, const std::string& end)
{
    std::error_code error;
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(begin) && name.ends_with(end)) found.push_back(entry.path());
    }
    for (const fs::path& path : found) fs::remove(path, error);
}

const bool registered_field_output =
    io::Registry<SinkType>::add({.name = "fields",
                                 .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> {
                                     if (run.c.outputs.fields.empty()) return nullptr;
                                     return std::make_unique<FieldOutputs>(run);
                                 },
                                 .remove =
                                     [](const std::string& directory) {
                                         remove_files(directory, "fields-", ".csv");
                                         remove_files(directory, "fields-", ".pvd");
                                         remove_files(directory + "/vtk", "fields-", ".vti");
                                     }});

}  // namespace

}  // namespace hilda::granular
