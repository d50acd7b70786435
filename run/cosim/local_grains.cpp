// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/local_grains.hpp"

#include "granular/running/earlier_run.hpp"
#include "io/files.hpp"
#include "io/json.hpp"

#include <filesystem>

namespace hilda::run {

std::vector<std::string> boundaries(const CosimFile& file)
{
    std::vector<std::string> names;
    for (const CosimPair& pair : file.pairs) names.push_back(pair.boundary);
    return names;
}

std::unique_ptr<granular::Soil> local_grains(const CosimFile& file, double end, granular::RunOptions options,
                                             bool allow_paths)
{
    options.file = file.granular_case;
    options.provenance = {{"program", "hilda cosim"}};
    granular::Environment here;
    here.settings = {{"/end=" + io::shortest(end)}};
    if (!allow_paths) here.folder = std::filesystem::absolute(file.granular_case).parent_path().string();
    const std::string text = io::read_file(file.granular_case, io::JsonSource::max_bytes);
    granular::Continuation run = granular::read_run(options, text, here);
    options.provenance["inputs"] = granular::inputs_of(run.c, options.file);
    return std::make_unique<granular::Soil>(options, std::move(run), boundaries(file));
}

}  // namespace hilda::run
