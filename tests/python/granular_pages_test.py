# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python examples of grains in the documentation run. In a process without the package hilda."""

import unittest

from pages_test import check_pages


class Pages(unittest.TestCase):
    def test_the_blocks_of_each_page_run_in_their_order(self):
        check_pages(self, "hilda_granular", ["docs/guide/python-granular.md"])


if __name__ == "__main__":
    unittest.main()
