// SPDX-License-Identifier: GPL-3.0-or-later
/// The elements of an XML text, for checks before a library reads it.

#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace hilda::run {

/// An opening tag
struct XmlElement {
    std::string_view name;
    std::map<std::string_view, std::string_view> attributes;  ///< without entities resolved
    int depth;                                                ///< 1: the root element
    long line;

    /// The text of an attribute; "" if it is missing
    std::string_view attribute(std::string_view key) const;
};

/// Calls take(element) for each opening tag, in the order of the text, also of one that is not well-formed.
void scan_xml(std::string_view text, const std::function<void(const XmlElement&)>& take);

/// Refuses a file that the libraries cannot read safely: elements that are nested deeper than 200 levels, a
/// chain of more than 1000 links of URDF, a file that it names (`include`, meshes) and that is a pipe, device
/// or folder, and a composite of more than 10 000 bodies. Included files are checked as well.
/// io::InvalidInput "FILE:LINE: ...", io::IoError.
void check_robot_file(const std::string& file);

}  // namespace hilda::run
