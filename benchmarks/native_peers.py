"""FMUs of the same bouncing ball from elsewhere, in the C host of native_cost.py: python benchmarks/native_peers.py
[--pythonfmu3 PYTHON]

One written by hand in C as C programmers do (`fmu_peers/ball.c`), and, if PYTHON has pythonfmu3 and fmpy, a slave of as
little Python as it takes (`fmu_peers/ball_fmi3.py`). Both make explicit steps of a millisecond, so they find the height
after 3 s to a few hundredths of a metre.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import fmpy
from native_host import figures, host, under_fmpy

HERE = Path(__file__).parent
END = 3.0
ABOUT_PYTHON = (
    "import sysconfig as s; v = s.get_config_vars(); print(v['LIBDIR'], v['LDLIBRARY'], s.get_path('purelib'))"
)
BUILD = "import sys; from pythonfmu3 import FmuBuilder as B; print(B.build_FMU(sys.argv[1], dest=sys.argv[2]))"


def by_hand(folder: Path) -> None:
    """The one in C."""
    library, headers = folder / "ball.so", Path(fmpy.__file__).parent / "c-code"
    sources = [str(HERE / "fmu_peers" / name) for name in ("ball.c", "ball_absent.c")]
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", f"-I{headers}", "-o", str(library), *sources], check=True)
    found = figures(host(folder), [library, "file:///", "guid", END, 0, 1, 2])
    found["under_fmpy_us"] = under_fmpy(library, folder / "resources", "guid", [], [1, 2], 1e-12)
    print("by hand in C:", *(f"{k}={v:.4g}" for k, v in found.items()), flush=True)


def of_pythonfmu3(python: str, folder: Path) -> None:
    """The one of pythonfmu3. Its binary wants libpython in the host already, and to be told where its packages are."""
    script = HERE / "fmu_peers" / "ball_fmi3.py"
    built = _said([python, "-c", BUILD, str(script), str(folder)])[-1]
    unzipped = Path(fmpy.extract(built, unzipdir=str(folder / "unzipped")))
    token = fmpy.read_model_description(str(unzipped), validate=False).instantiationToken
    lib, name, packages = _said([python, "-c", ABOUT_PYTHON])[-1].split()
    environment = {**os.environ, "LD_PRELOAD": str(Path(lib, name)), "PYTHONPATH": packages}
    library = unzipped / "binaries" / "x86_64-linux" / "BallFmi3.so"
    arguments = [library, f"{unzipped / 'resources'}{os.sep}", token, END, 0, 1, 2]
    found = figures(host(folder, fmi=3), arguments, environment)
    found["bytes"] = Path(built).stat().st_size
    found["under_fmpy_us"] = float(_said([python, str(HERE / "fmu_peers" / "fmpy3.py"), str(unzipped), token])[-1])
    print("pythonfmu3:", *(f"{k}={v:.4g}" for k, v in found.items()), flush=True)


def _said(command: Sequence[str]) -> list[str]:
    """The lines that a command prints."""
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--pythonfmu3", metavar="PYTHON", default=sys.executable, help="an interpreter that has it")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        by_hand(Path(folder))
        if subprocess.run([given.pythonfmu3, "-c", "import pythonfmu3"], capture_output=True, check=False).returncode:
            print(f"pythonfmu3 is not installed for {given.pythonfmu3}: name another with --pythonfmu3", flush=True)
        else:
            of_pythonfmu3(given.pythonfmu3, Path(folder))


if __name__ == "__main__":
    main()
