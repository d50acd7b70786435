// SPDX-License-Identifier: GPL-3.0-or-later
/// Texts and tables in LaTeX, for \input in a document with \usepackage{booktabs}.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

/// A text of a cell or caption in LaTeX: special characters are escaped; numbers with an exponent, such as
/// 1.5e-03, are written as $1.5\times10^{-3}$; a cell that is a number is in math mode, "-" is a dash. Greek
/// letters and the symbols of our tables become commands; other characters beyond Latin letters become "?",
/// because pdflatex does not know them.
std::string latex(const std::string& text);

/// A table environment with booktabs rules. The first row contains the headings. Columns of numbers are
/// right-aligned.
std::string latex_table(const std::vector<std::vector<std::string>>& rows, const std::string& caption,
                        const std::string& label);

}  // namespace hilda::studies
