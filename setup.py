"""What pyproject.toml cannot say: the version is that of CMakeLists.txt, and CMake compiles the extension.

Environment: CMAKE_ARGS, options for CMake; POLHODE_BUILD_DIRECTORY, a build directory to use as it is, else build/wheel.
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
# beside CMake's own files, which git does not track
SCRATCH = TOP / "build" / "wheel"


def version() -> str:
    """The version that CMakeLists.txt states."""
    found = re.search(r"^project\(polhode VERSION ([0-9.]+)", (TOP / "CMakeLists.txt").read_text(), re.MULTILINE)
    if not found:
        raise SystemExit("setup.py: CMakeLists.txt states no version")
    return found.group(1)


class CMakeExtension(build_ext):
    """Has CMake build the module and takes what it installs."""

    def build_extension(self, ext: Extension) -> None:
        given = os.environ.get("POLHODE_BUILD_DIRECTORY")
        directory = Path(given).resolve() if given else SCRATCH / f"python{sys.version_info[0]}.{sys.version_info[1]}"
        # a directory that was given and configured stays as it is
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
                raise SystemExit(f"setup.py: {directory} makes no {target.name}: it is for another Python")
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
    # the tree of the source stays as git has it
    options={"build": {"build_base": str(SCRATCH / "setuptools")}, "egg_info": {"egg_base": str(SCRATCH)}},
)
