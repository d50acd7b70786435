// SPDX-License-Identifier: GPL-3.0-or-later
/// A plug-in that registers nothing.

int hilda_test_nothing() { return 0; }
