"""Complements pyproject.toml: reads the version from CMakeLists.txt and compiles the extension by CMake.

Environment variables: CMAKE_ARGS, options for CMake; POLHODE_BUILD_DIRECTORY, an existing build directory to use instead
of build/wheel.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

TOP = Path(__file__).resolve().parent
# in the build directory, which git does not track
SCRATCH = TOP / "build" / "wheel"


def version() -> str:
    """The version in CMakeLists.txt."""
    found = re.search(r"^project\(polhode VERSION ([0-9.]+)", (TOP / "CMakeLists.txt").read_text(), re.MULTILINE)
    if not found:
        raise SystemExit("setup.py: CMakeLists.txt: no version found")
    return found.group(1)


class CMakeExtension(build_ext):
    """Builds the module by CMake and copies the file that CMake installs."""

    def build_extension(self, ext: Extension) -> None:
        given = os.environ.get("POLHODE_BUILD_DIRECTORY")
        directory = Path(given).resolve() if given else SCRATCH / f"python{sys.version_info[0]}.{sys.version_info[1]}"
        # a given directory that is already configured is not configured again
        if not given or not (directory / "CMakeCache.txt").exists():
            generator = ["-G", "Ninja"] if shutil.which("ninja") and "CMAKE_GENERATOR" not in os.environ else []
            self.cmake("-S", TOP, "-B", directory, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DPOLHODE_PYTHON=ON",
                       f"-DPOLHODE_PYTHON_EXECUTABLE={sys.executable}",
                       *shlex.split(os.environ.get("CMAKE_ARGS", "")))
        parallel = [] if "CMAKE_BUILD_PARALLEL_LEVEL" in os.environ else ["--parallel", str(os.cpu_count() or 1)]
        self.cmake("--build", directory, "--target", "polhode_python", *parallel)
        target = Path(self.get_ext_fullpath(ext.name)).resolve()
        with tempfile.TemporaryDirectory() as installed:
            self.cmake("--install", directory, "--component", "python", "--strip", "--prefix", installed)
            made = list(Path(installed).rglob(target.name))
            if len(made) != 1:
                raise SystemExit(f"setup.py: {directory} does not build {target.name}; configure it for this Python")
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(made[0], target)

    @staticmethod
    def cmake(*arguments: object) -> None:
        subprocess.run(["cmake", *map(str, arguments)], check=True)


SCRATCH.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    ext_modules=[Extension("polhode._polhode", sources=[])],
    cmdclass={"build_ext": CMakeExtension},
    # no files are written to the source tree outside the build directory
    options={"build": {"build_base": str(SCRATCH / "setuptools")}, "egg_info": {"egg_base": str(SCRATCH)}},
)
