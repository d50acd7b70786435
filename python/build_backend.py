# SPDX-License-Identifier: GPL-3.0-or-later
"""Build backend of the Python packages hilda and hilda_granular (PEP 517).

Compiles the extension modules against the libraries of build/release, which it builds first where they are missing or old, in
build/python-cpython-311. The wheel contains the modules, the files of python/ and these libraries. Uses the standard library only.

Environment:
    HILDA_LIBRARIES             another build folder, or the prefix of an installation, whose libraries are used as they are
    CMAKE_BUILD_PARALLEL_LEVEL  number of jobs
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODULES = {"hilda": "_hilda", "hilda_granular": "_granular"}  # the extension module of each package
BUILD = ROOT / "build" / f"python-{sys.implementation.cache_tag}"


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """The metadata without a build."""
    info, texts = wheel_information(metadata())
    for path, text in texts.items():
        file = pathlib.Path(metadata_directory) / path
        file.parent.mkdir(exist_ok=True)
        file.write_text(text)
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    compile_modules()
    installed = BUILD / "wheel"
    shutil.rmtree(installed, ignore_errors=True)
    command(["cmake", "--install", BUILD, "--prefix", installed])
    files = {}
    for package, module in MODULES.items():
        for path in sorted((ROOT / "python" / package).iterdir()):
            if path.suffix in (".py", ".pyi", ".typed"):
                files[f"{package}/{path.name}"] = path
        compiled = f"{package}/{module}{sysconfig.get_config_var('EXT_SUFFIX')}"
        files[compiled] = installed / compiled
    for library in (BUILD / "libraries.txt").read_text().split("\n"):
        if library:
            files[f"hilda/lib/{pathlib.Path(library).name}"] = pathlib.Path(library)
    return write_wheel(pathlib.Path(wheel_directory), files)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """A wheel with a path to the packages of the build folder, which are links to the files of the tree (PEP 660)."""
    compile_modules()
    return write_wheel(pathlib.Path(wheel_directory), {"hilda.pth": f"{BUILD / 'python'}\n"})


prepare_metadata_for_build_editable = prepare_metadata_for_build_wheel


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("hilda: error: there is no source distribution; install from a clone of the repository")


def metadata():
    """The table [project] of pyproject.toml, with the version of the library."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    version = re.search(r"project\(hilda VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())
    return {**project, "version": version[1]}


def libraries():
    """The prefix in which CMake finds the libraries. Builds those of build/release."""
    if given := os.environ.get("HILDA_LIBRARIES"):
        prefix = pathlib.Path(given).resolve()
        check_commit(prefix)
        return prefix
    folder = ROOT / "build" / "release"
    cache = folder / "CMakeCache.txt"
    options = ["-DHILDA_WITH_GRAINS=ON"]
    if cache.exists():
        generator = re.search(r"^CMAKE_GENERATOR:INTERNAL=(.*)$", cache.read_text(), re.MULTILINE)
        if generator and generator[1] != "Ninja":
            raise SystemExit(f"hilda: error: build/release was configured with {generator[1]}, and the presets use Ninja; "
                             "remove the folder: rm -r build/release")
    else:
        options.append("-DHILDA_TESTS=OFF")  # tests/run adds them
    command(["cmake", "--preset", "release", *options])
    build(folder, "hilda_library", *(f"hilda_{room}_library" for room in ("granular", "reference", "studies")))
    return folder


def check_commit(prefix):
    """The modules are compiled with the headers of these sources, which must be those of the libraries."""
    headers = [prefix / folder / "hilda/version.hpp" for folder in ("generated", "include/hilda")]
    header = next((file for file in headers if file.exists()), None)
    if header is None:
        raise SystemExit(f"hilda: error: HILDA_LIBRARIES: {prefix} is neither a build folder nor the prefix of an installation")
    theirs = re.search(r' git = R"\((.*)\)"', header.read_text())[1]
    ours = "unknown"
    if shutil.which("git") and (ROOT / ".git").exists():
        describe = ["git", "describe", "--tags", "--always", "--dirty"]
        ours = subprocess.run(describe, cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip() or "unknown"
    if theirs != ours:
        raise SystemExit(f"hilda: error: HILDA_LIBRARIES: {prefix} has the libraries of commit {theirs}, and the sources are those of "
                         f"{ours}; build or install them again")


def compile_modules():
    """Configures and builds the extension modules."""
    for tool in ("cmake", "ninja", "c++"):
        if shutil.which(tool) is None:
            raise SystemExit(f"hilda: error: {tool} was not found (Debian: apt-get install g++ cmake ninja-build)")
    command(["cmake", "-S", ROOT / "python", "-B", BUILD, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={libraries()}",
             f"-DHILDA_PYTHON={sys.executable}"])
    build(BUILD, "all")


def build(folder, *targets):
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count()))
    command(["cmake", "--build", folder, "--parallel", jobs, "--target", *targets])


def command(arguments):
    try:
        subprocess.run(arguments, check=True, cwd=ROOT)
    except subprocess.CalledProcessError as error:
        raise SystemExit(f"hilda: error: '{' '.join(map(str, arguments[:2]))} ...' ended with {error.returncode}") from None


def wheel_tag():
    version = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{version}-{version}-{platform}"


def wheel_information(project):
    """The folder .dist-info of the wheel, and the texts of its files by path."""
    info = f"hilda-{project['version']}.dist-info"
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}",
             f"Summary: {project['description']}", f"Author: {', '.join(author['name'] for author in project['authors'])}",
             f"License: {project['license']['text']}", f"Requires-Python: {project['requires-python']}",
             *(f"Requires-Dist: {package}" for package in project["dependencies"])]
    texts = {f"{info}/METADATA": "\n".join(lines) + "\n\n" + (ROOT / "README.md").read_text(),
             f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: hilda\nRoot-Is-Purelib: false\nTag: {wheel_tag()}\n",
             f"{info}/LICENSE": (ROOT / "LICENSE").read_text()}
    return info, texts


def write_wheel(folder, files):
    """Writes the wheel with these files, paths or texts (PEP 427), and returns its name."""
    project = metadata()
    info, texts = wheel_information(project)
    name = f"hilda-{project['version']}-{wheel_tag()}.whl"
    record = []
    with zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        def add(path, content):
            wheel.writestr(path, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{path},sha256={digest},{len(content)}")

        for path, file in files.items():
            add(path, file.encode() if isinstance(file, str) else file.read_bytes())
        for path, text in texts.items():
            add(path, text.encode())
        record.append(f"{info}/RECORD,,")
        wheel.writestr(f"{info}/RECORD", "\n".join(record) + "\n")
    return name
