// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/run_case.hpp"

#include "granular/running/earlier_run.hpp"
#include "granular/running/run.hpp"
#include "io/error.hpp"
#include "io/files.hpp"

#include <filesystem>

namespace hilda::run {

void run_case(const std::string& file, const std::string& output)
{
    const granular::RunOptions options{
        .file = file, .output = output, .checkpoint = 0, .quiet = true, .force = true};
    granular::Environment here;
    here.folder = std::filesystem::absolute(file).parent_path().string();
    const std::string text = io::read_file(file, io::JsonSource::max_bytes);
    const auto read = [&] { return granular::read_run(options, text, here); };
    const int code = granular::run(options, read(), read);
    if (code != io::exit_code::done) throw io::Failure(code, file + ": the run has not come to its end");
}

}  // namespace hilda::run
