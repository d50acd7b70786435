# SPDX-License-Identifier: GPL-3.0-or-later
"""The directive `hilda-header`: the declarations of one header, rendered by Breathe.

It is the directive `doxygenfile` of Breathe without its search, which reads the index of all files again for each header.
"""
from breathe.directives import BaseDirective
from breathe.renderer import RenderContext
from breathe.renderer.mask import NullMaskFactory
from breathe.renderer.sphinxrenderer import SphinxRenderer
from breathe.renderer.target import create_target_handler
from docutils.parsers.rst.directives import flag, unchanged_required


class HeaderDirective(BaseDirective):
    required_arguments = 1
    option_spec = {"project": unchanged_required, "outline": flag, "no-link": flag, "sections": unchanged_required}

    def run(self):
        project = self.project_info_factory.create_project_info(self.options)
        name = self.arguments[0]
        identifiers = self.config.hilda_headers.get(name)
        if not identifiers:
            raise self.error(f"the header {name} is not in the XML output of Doxygen")
        parser = self.parser_factory.create_compound_parser(project)
        handler = create_target_handler(self.options, project, self.state.document)

        def render(stack, accept):
            renderer = SphinxRenderer(self.parser_factory.app, project, stack, self.state, self.state.document, handler, parser, accept)
            return renderer.render(stack[0], RenderContext(stack, NullMaskFactory(), self.directive_args))

        file_data = parser.parse(identifiers[0])
        nodes = render([file_data.compounddef, file_data], self.filter_factory.create_file_filter(name, self.options))
        for identifier in identifiers[1:]:  # the members of a namespace in this header
            data = parser.parse(identifier)
            for section in data.compounddef.sectiondef:
                nodes += render([section, data.compounddef, data], self.filter_factory.create_open_filter())
        return nodes


def setup(app):
    app.add_config_value("hilda_headers", {}, "env")  # from the names of headers to the files of Doxygen
    app.add_directive("hilda-header", HeaderDirective)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
