"""The command ``polhode animate``: solves a scene and writes an animated picture."""

from __future__ import annotations

import argparse
import sys

from polhode._polhode import InputError, allow_outside_files
from polhode._solving import solve


def main() -> int:
    """Runs the command with the options that the program passes on. Returns its exit code."""
    parser = argparse.ArgumentParser(prog="polhode animate")
    parser.add_argument("scene")
    parser.add_argument("--method", required=True)
    parser.add_argument("--beside")
    for name in ("--step", "--tolerance", "--duration"):
        parser.add_argument(name, type=float)
    parser.add_argument("--frames", type=int, required=True)
    parser.add_argument("--fps", type=float, required=True)
    parser.add_argument("--allow-outside", action="store_true")
    parser.add_argument("--output", required=True)
    options = parser.parse_args()
    allow_outside_files(options.allow_outside)
    try:
        common = {"duration": options.duration, "samples": options.frames - 1}
        settings = {"step": options.step, "tolerance": options.tolerance}
        motions = [solve(options.scene, options.method, **common, **({} if options.beside else settings))]
        if options.beside:
            motions.append(solve(options.scene, options.beside, **common, **settings))
        for motion in motions:
            if motion.status != "ok":
                print(f"polhode: {motion.method}: {motion.status}: {motion.message}", file=sys.stderr)
                return 1
        motions[0].animation(options.output, frames=options.frames, fps=options.fps, beside=motions[1:])
    except ModuleNotFoundError as error:
        print(f"polhode: animate needs the Python module {error.name}; install python3-{error.name}", file=sys.stderr)
        return 2
    except (InputError, OSError) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
