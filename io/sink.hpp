// SPDX-License-Identifier: GPL-3.0-or-later
/// Outputs of a run: written as the run goes, and continued to the byte by a resumed run.

#pragma once

#include "io/archive.hpp"
#include "io/files.hpp"
#include "io/option_values.hpp"
#include "io/registry.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hilda::io {

/// One output of a run. Node: the state of the run at one instant.
template <class Node>
class Sink {
public:
    virtual ~Sink() = default;

    /// By default the sink receives the nodes whose numbers are multiples of this.
    virtual long interval() const { return 1; }
    /// Whether it receives node n
    virtual bool takes(long n) const { return n % interval() == 0; }
    /// Number of the first node after n that it receives
    virtual long next(long n) const { return (n / interval() + 1) * interval(); }
    /// Creates the files of a new run. IoError.
    virtual void open() {}
    /// Takes a node. Not called before open() or transfer().
    virtual void node(const Node& node) = 0;
    /// Synchronises the files with the disk, before a checkpoint is written. IoError.
    virtual void sync() {}
    /// Writes what a resumed run needs to the archive; or reads it, instead of open(), and continues the
    /// files there.
    virtual void transfer(Archive&) {}
    /// Writes what remains. Called once at the end of the run, also after an interruption or a failure.
    /// IoError.
    virtual void close() {}
    /// Names of the written files in the output directory, for summary.json
    virtual std::vector<std::string> files() const = 0;
};

/// The given command-line options of the sinks and their texts; a switch has the text ""
using SinkOptions = std::map<std::string, std::string>;

/// An output format. Run: what the sinks of a run are made from; it has a type Node. A file registers a
/// format by
///
///     const bool registered = io::Registry<io::SinkType<Run>>::add({.name = "energy", .make = ...});
template <class Run>
struct SinkType {
    std::string name;
    std::vector<Option> options = {};
    /// The sink of a run; nullptr if the options of the run do not request it. Throws UsageError for options
    /// that do not apply. Writes no file.
    std::unique_ptr<Sink<typename Run::Node>> (*make)(const Run& run) = nullptr;
    /// Files of an earlier run in the same directory, which a new run removes
    std::vector<std::string> files = {};
    /// Removes the other files of an earlier run, whose names are not fixed.
    void (*remove)(const std::string& directory) = [](const std::string&) {};
};

/// The sinks of one run: those of all registered formats that its options request
template <class Run>
class Sinks {
public:
    using Node = typename Run::Node;
    using Type = SinkType<Run>;
    /// What a resumed run needs, by the name of the format
    using Saved = std::map<std::string, std::string>;

    explicit Sinks(const Run& run)
    {
        for (const Type& type : Registry<Type>::all())
            if (auto sink = type.make(run)) all.emplace_back(type.name, std::move(sink));
    }

    /// Removes the files of an earlier run.
    static void remove(const std::string& directory)
    {
        for (const Type& type : Registry<Type>::all()) {
            for (const std::string& file : type.files) std::remove((directory + '/' + file).c_str());
            type.remove(directory);
        }
    }

    /// Continues the sinks in `saved`, which is from the checkpoint `file`, and opens the others.
    void open(const Saved& saved = {}, const std::string& file = "")
    {
        for (auto& [name, sink] : all) {
            const auto at = saved.find(name);
            if (at == saved.end()) {
                sink->open();
                continue;
            }
            Archive a(at->second, file);
            sink->transfer(a);
            a.end();
        }
    }
    /// Passes node n to the sinks that take it.
    void node(long n, const Node& node)
    {
        for (auto& [name, sink] : all)
            if (sink->takes(n)) sink->node(node);
    }
    /// Number of the first node after n that a sink takes
    long next(long n) const
    {
        long first = std::numeric_limits<long>::max();
        for (const auto& [name, sink] : all) first = std::min(first, sink->next(n));
        return first;
    }
    void sync()
    {
        for (auto& [name, sink] : all) sink->sync();
    }
    Saved save()
    {
        Saved saved;
        for (auto& [name, sink] : all) {
            Archive a;
            sink->transfer(a);
            saved[name] = a.bytes();
        }
        return saved;
    }
    void close()
    {
        for (auto& [name, sink] : all) sink->close();
    }
    std::vector<std::string> files() const
    {
        std::vector<std::string> names;
        for (const auto& [name, sink] : all)
            for (std::string& file : sink->files()) names.push_back(std::move(file));
        return names;
    }

private:
    std::vector<std::pair<std::string, std::unique_ptr<Sink<Node>>>> all;
};

/// Adds the options of all registered formats to a command line. App: CLI::App
template <class Run, class App>
void add_sink_options(App& app, SinkOptions& given)
{
    for (const SinkType<Run>& type : Registry<SinkType<Run>>::all())
        for (const Option& option : type.options) {
            const auto set = [&given, option](const std::string& text) {
                if (option.check != nullptr) option.check(option.name, text);
                given[option.name] = text;
            };
            if (option.is_switch())
                app.add_flag_callback(
                    option.name, [set] { set(""); }, option.help);
            else
                app.template add_option_function<std::string>(option.name, set, option.help)
                    ->type_name(option.value);
        }
}

/// A sink with one text file of rows, such as a CSV file
template <class Node>
class RowsSink : public Sink<Node> {
public:
    RowsSink(const std::string& directory, std::string name)
        : path(directory + '/' + name), name(std::move(name))
    {}

    void open() override
    {
        file.emplace(path);
        file->buffer += header();
    }
    void node(const Node& node) override
    {
        append(file->buffer, node);
        file->flush_when_full();
    }
    void sync() override { file->sync(); }
    void transfer(Archive& a) override
    {
        std::uint64_t length = a.reads() ? 0 : file->size();
        a.value(length);
        if (a.reads()) file.emplace(path, length, true);
    }
    void close() override { file->finish(); }
    std::vector<std::string> files() const override { return {name}; }

protected:
    /// The first lines of the file
    virtual std::string header() const = 0;
    /// Appends the rows of a node; none if it is not an output row.
    virtual void append(std::string& text, const Node& node) = 0;

private:
    const std::string path, name;
    std::optional<OutputFile> file;
};

}  // namespace hilda::io
