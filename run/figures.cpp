// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/figures.hpp"

#include <filesystem>

namespace hilda::run {

namespace fs = std::filesystem;

const std::vector<std::string>& figure_formats()
{
    static const std::vector<std::string> all = {"png",  "pdf", "svg",  "eps", "ps",  "svgz",
                                                 "jpeg", "jpg", "tiff", "tif", "webp"};
    return all;
}

void remove_figure(const std::string& directory, const std::string& name)
{
    std::error_code error;
    for (const std::string& format : figure_formats())
        fs::remove((fs::path(directory) / name).replace_extension(format), error);
}

std::vector<std::string> existing_figures(const std::string& directory, const std::string& name,
                                          const std::vector<std::string>& formats)
{
    std::vector<std::string> files;
    std::error_code error;
    for (const std::string& format : formats.empty() ? std::vector<std::string>{"png"} : formats) {
        const std::string file = fs::path(name).replace_extension(format).string();
        if (fs::is_regular_file(fs::path(directory) / file, error)) files.push_back(file);
    }
    return files;
}

}  // namespace hilda::run
