// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/error.hpp"
#include "run/importing/xml_scan.hpp"
#include "studies/program/repeating/rerun.hpp"
#include "tests/fuzz/targets.hpp"

#include <cstdlib>

namespace hilda::fuzz {

void words(std::string_view input)
{
    try {
        for (const std::string& word : studies::shell_words(std::string(input)))
            if (word.size() > input.size()) std::abort();
    } catch (const io::InvalidInput&) {
    }
}

void xml(std::string_view input)
{
    long last = 1;
    run::scan_xml(input, [&](const run::XmlElement& element) {
        if (element.depth < 1 || element.line < last) std::abort();
        last = element.line;
        for (const auto& [key, value] : element.attributes)
            if (element.attribute(key) != value) std::abort();
    });
}

}  // namespace hilda::fuzz
