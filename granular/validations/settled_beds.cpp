// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/settled_beds.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"

#include <unistd.h>

#include <filesystem>

namespace hilda::granular {

namespace {

constexpr io::Archive::Format format{"HILDABED", 1};
constexpr std::size_t most = std::size_t{1} << 36;

/// Writes or reads a line that must be as expected.
void line(io::Archive& a, const std::string& expected, const std::string& what)
{
    std::string text = expected;
    a.list(text);
    if (text != expected)
        throw io::IoError(a.name() + ": " + what + " is '" + text + "', not '" + expected + "'");
}

}  // namespace

std::string BedCase::description() const
{
    std::string text = name;
    for (std::size_t k = 0; k < parameters.size(); ++k)
        text += io::formatted("%s %s = %.17g", k == 0 ? ":" : ",", parameters[k].first.c_str(),
                              parameters[k].second);
    return text;
}

std::string BedCase::hash() const
{
    const std::string text = description();
    return io::formatted("%016llx", static_cast<unsigned long long>(io::checksum(text.data(), text.size())));
}

void SettledBeds::bed(const BedCase& of, const Compute& compute, const Transfer& transfer) const
{
    if (folder.empty()) return compute();
    const std::string file = folder + '/' + of.hash() + ".bed";
    const auto content = [&](io::Archive& a) {
        line(a, of.description(), "its case"), line(a, program, "its program");
        transfer(a);
    };
    std::error_code error;
    if (std::filesystem::exists(file, error)) {
        try {
            const std::string bytes = io::read_file(file, most);
            io::Archive a(format, bytes, file);
            content(a);
            a.end();
            return;
        } catch (const io::IoError& e) {
            io::warning(std::string(e.what()) + "; the bed is settled again");
        }
    }
    compute();
    try {
        io::make_directory(folder);
        io::Archive a(format);
        content(a);
        // A name of its own, because another process may write the same bed.
        const std::string own = file + '.' + std::to_string(getpid());
        io::write_file(own, a.bytes());
        io::rename_file(own, file);
    } catch (const io::IoError& e) {
        io::warning(std::string(e.what()) + "; the settled bed is not kept");
    }
}

}  // namespace hilda::granular
