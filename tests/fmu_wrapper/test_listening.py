"""Messages of FMI 2.0 FMUs under fmpy come to the listener of their own instance, and to none that is gone."""

import subprocess
import sys
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from tlismni.fmu_wrapper.master.listening import instantiate
from tlismni.fmu_wrapper.platforms import fmi2_platform


@pytest.fixture
def unzipped(fake_fmu, tmp_path):
    def make(version):
        return fmpy.extract(str(fake_fmu(f"{version}.fmu", fmi_version=version)), unzipdir=str(tmp_path / version))

    return make


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_each_instance_has_its_own_listener(unzipped, version):
    folder = unzipped(version)
    description = fmpy.read_model_description(folder)
    heard = [[], []]
    fmus = [instantiate(folder, description, messages.append) for messages in heard]
    for fmu, messages, other in zip(fmus, heard, heard[::-1], strict=True):
        before = len(other)
        with pytest.raises(FMICallException):
            fmu.doStep(0.0, 0.1)  # not before initialization
        assert len(messages) == 1 and "doStep" in messages[0].replace("DoStep", "doStep")
        assert len(other) == before
        fmu.freeInstance()


def test_binaries_for_arm_are_found(unzipped, monkeypatch):
    """fmpy looks for those of FMI 2.0 in the folder for x86-64 alone."""
    folder = Path(unzipped("2.0"))
    here = folder / "binaries" / fmi2_platform()
    monkeypatch.setattr("platform.machine", lambda: "arm64")
    assert fmi2_platform().startswith("aarch64-")
    here.rename(here.with_name(fmi2_platform()))
    instantiate(str(folder), fmpy.read_model_description(str(folder)), print).freeInstance()


AFTERWARDS = """
import gc, sys
import fmpy, fmpy.fmi2
from tlismni.fmu_wrapper.master.listening import instantiate

description = fmpy.read_model_description(sys.argv[1])
for kept in (True, False):
    fmu = instantiate(sys.argv[1], description, lambda message: print("heard"))
    if not kept:
        fmu.freeInstance()
    del fmu
    gc.collect()
    fmpy.fmi2.defaultCallbacks.logger(None, b"another", 0, b"category", b"a message of another FMU")
print("done")
"""


def test_messages_after_the_end_of_a_listener(unzipped):
    """Those of FMUs that somebody else in the process drives come through the same function of fmpy's."""
    command = [sys.executable, "-c", AFTERWARDS, unzipped("2.0")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert (done.returncode, done.stdout.split()) == (0, ["done"]), done.stderr
