// SPDX-License-Identifier: GPL-3.0-or-later
/// A plug-in with a function that neither it nor the program has.

int function_without_definition();

const int value = function_without_definition();
