// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda-granular: runs a granular case or a validation. It is separate from hilda because it may
/// link the CUDA runtime, which must not be linked with GSL.

#include "granular/files.hpp"
#include "granular/program/formula.hpp"
#include "granular/program/memory.hpp"
#include "granular/program/run.hpp"
#include "granular/program/validate.hpp"

#include <omp.h>
#include <cstdio>
#include <filesystem>

using namespace hilda::granular;

namespace {

int run_case(const Options& o)
{
    Environment here{.memory = available_memory(),
                     .compile = compile,
                     .device = o.device,
                     .settings = o.settings,
                     .seed = o.seed};
    make_engine(o.device);  // reports a missing device before the case is read
    if (o.device.kind == Device::cuda) here.device_memory = gpu_memory(o.device.number);
    std::string text;
    try {
        text = read_file(o.file, std::size_t{64} << 20);
    } catch (const FileError& e) {
        throw InvalidCase(e.what() + (std::filesystem::exists(o.file) ? "" : known_validations()));
    }
    return run(o, read_case(text, o.file, here));
}

void catch_signals()
{
    for (const int s : {SIGINT, SIGTERM})
        std::signal(s, [](int which) {
            caught = which;
            std::signal(which, SIG_DFL);  // a second signal ends the program at once
        });
    std::signal(SIGXFSZ, SIG_IGN);
}

int fail(int code, const std::string& what)
{
    std::fprintf(stderr, "hilda: error: %s\n", what.c_str());
    return code;
}

}  // namespace

int main(int argc, char** argv)
{
    Options o;
    if (const auto code = read_arguments(argc, argv, o)) return *code;
    omp_set_num_threads(o.threads);
    const Validation* const validation = find_validation(o.file);
    if (validation != nullptr && !o.case_only_option.empty())
        return fail(usage, "granular: " + o.case_only_option + ": is valid for cases only, but " + o.file +
                               " is a validation");
    if (o.full && validation == nullptr && std::filesystem::exists(o.file))
        return fail(usage, "granular: --full: is valid for validations only, but " + o.file + " is a file");
    try {
        if (validation != nullptr)
            return validate(*validation, {.full = o.full, .device = o.device}, o.quiet);
        catch_signals();
        return run_case(o);
    } catch (const InvalidCase& e) {
        return fail(bad_case, e.what());
    } catch (const FileError& e) {
        return fail(io, e.what());
    } catch (const DeviceError& e) {
        return fail(no_device, "--device " + o.device_name + ": " + e.what());
    } catch (const std::bad_alloc&) {
        return fail(bad_case, "the memory is not sufficient for this case");
    } catch (const std::exception& e) {
        return fail(internal, e.what());
    }
}
