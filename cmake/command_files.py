#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the man pages and the bash completion of the programs from their help texts.

    command_files.py HILDA HILDA_GRANULAR FOLDER      writes hilda.1, hilda-granular.1 and hilda.bash
"""
import os
import re
import subprocess
import sys

VALUES = re.compile(r"^[a-z0-9_-]+(\|[a-z0-9_-]+)+$")  # of an option with fixed values, such as csv|hdf5


def output_of(*command):
    environment = {**os.environ, "LC_ALL": "C", "COLUMNS": "80", "TERM": "dumb"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
    if done.returncode != 0:
        sys.exit(f"command_files: {' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def commands_of(help_text):
    """The names of the commands and their descriptions"""
    lines = help_text.partition("Subcommands:")[2].splitlines()
    names = []
    for line in lines:
        found = re.match(r"  ([a-z][\w-]*)\s+(\S.*)$", line)
        if found:
            names.append([found[1], found[2]])
        elif names and line.startswith("    "):
            names[-1][1] += " " + line.strip()
        elif names:
            break
    return names


def options_of(help_text):
    """The long options and, of those with fixed values, the values"""
    found = {}
    for line in help_text.splitlines():
        option = re.match(r"  (?:-\w,)?(--[\w-]+)(?: (\S+))?", line)
        if option:
            found[option[1]] = option[2].split("|") if option[2] and VALUES.match(option[2]) else []
    return found


def roff(text):
    return re.sub(r"^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"), flags=re.MULTILINE)


def preformatted(text):
    return f".nf\n{roff(text.strip())}\n.fi\n"


def man_page(name, version, what, sections):
    page = f'.TH {name.upper()} 1 "" "{version}" "User Commands"\n.SH NAME\n{roff(name)} \\- {roff(what)}\n'
    for title, text in sections:
        page += f'.SH "{title}"\n{text}'
    return page


def without_path(text, program):
    """The help text with the name of the program in place of its path"""
    return re.sub(r"^Usage: \S*/", "Usage: ", text, flags=re.MULTILINE).replace(program, os.path.basename(program))


def completion(commands, granular):
    """A completion function for bash. Names of files complete where no option or command does."""
    cases = ""
    for name, options in commands.items():
        values = "".join(f"            {option}) words='{' '.join(of)}' ;;\n" for option, of in options.items() if of)
        cases += f"    {name})\n        case $before in\n{values}            *) words='{' '.join(options)}' ;;\n        esac ;;\n"
    return f"""# bash completion for hilda and hilda-granular
_hilda() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words=''
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        mapfile -t COMPREPLY < <(compgen -W '{' '.join(commands)}' -- "$word")
        return
    fi
    case ${{COMP_WORDS[1]}} in
{cases}    esac
    case $word$before in
        -*) mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word") ;;
        *) mapfile -t COMPREPLY < <(compgen -f -- "$word") ;;
    esac
}}
complete -o filenames -F _hilda hilda
_hilda_granular() {{
    local word=${{COMP_WORDS[COMP_CWORD]}}
    case $word in
        -*) mapfile -t COMPREPLY < <(compgen -W '{' '.join(granular)}' -- "$word") ;;
        *) mapfile -t COMPREPLY < <(compgen -f -- "$word") ;;
    esac
}}
complete -o filenames -F _hilda_granular hilda-granular
"""


def main():
    if len(sys.argv) != 4:
        sys.exit("command_files: usage: command_files.py HILDA HILDA_GRANULAR FOLDER")
    hilda, granular, folder = sys.argv[1:]
    version = output_of(hilda, "--version").split(" (")[0].strip()
    general = output_of(hilda, "help")
    names = commands_of(general)
    if not names:
        sys.exit("command_files: hilda help lists no commands")
    texts = {name: output_of(hilda, "help", name) for name, _ in names if name != "granular"}
    sections = [("SYNOPSIS", "hilda COMMAND [OPTIONS]\n"), ("DESCRIPTION", preformatted(without_path(general, hilda)))]
    sections += [(f"hilda {name}", preformatted(without_path(text, hilda))) for name, text in texts.items()]
    sections.append(("SEE ALSO", roff("hilda-granular(1)") + "\n"))
    granular_text = output_of(granular, "--help")
    files = {
        "hilda.1": man_page("hilda", version, "multibody dynamics with friction and contact on the Lie group", sections),
        "hilda-granular.1": man_page("hilda-granular", version, "granular cases by the discrete element method",
                                     [("DESCRIPTION", preformatted(without_path(granular_text, granular))),
                                      ("SEE ALSO", "hilda(1)\n")]),
        "hilda.bash": completion({name: options_of(texts[name]) if name in texts else options_of(granular_text) for name, _ in names},
                                 options_of(granular_text)),
    }
    os.makedirs(folder, exist_ok=True)
    for name, text in files.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)


if __name__ == "__main__":
    main()
