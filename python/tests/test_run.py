"""Running, stopping, resuming, and what is refused."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, layer, shaken

import pluvia


def test_the_version_is_that_of_the_crate() -> None:
    cargo = ROOT / "Cargo.toml"
    if not cargo.is_file():
        pytest.skip("the sources are not beside the tests")
    version = re.search(r'^version = "(.*)"$', cargo.read_text(), re.MULTILINE)
    assert version is not None and pluvia.__version__ == version[1]
    assert pluvia.info()["pluvia"] == version[1]


def test_a_file_and_a_dict_give_the_same_run(in_folder: Path, poured: pluvia.Run) -> None:
    Path("layer.json").write_text(json.dumps(layer(100.0)))
    again = pluvia.run("layer.json", out="out", progress=False)
    height = "standing_height_mm.mean_surface"
    assert again[height] == poured[height] and again[height] > 0
    assert np.array_equal(again.positions, poured.positions), "law: same scenario, same bits"


def test_a_dict_leaves_no_file_and_its_paths_count_from_the_working_directory(in_folder: Path) -> None:
    Path("below").mkdir()
    Path("below/base.json").write_text(json.dumps(layer(15.0)))
    run = pluvia.run({"extends": Path("below/base.json"), "name": "mine"}, "out", progress=False)
    assert run["scenario"] == "mine"
    assert sorted(p.name for p in in_folder.iterdir()) == ["below", "out"]


def test_changes_seed_and_numpys_numbers(in_folder: Path) -> None:
    scenario = layer(15.0)
    scenario["engine"]["rate_hz"] = np.int64(240)
    changes = {"grains.total_mass_g": np.float64(20.0), "stages.1.falling_height_mm": 10}
    run = pluvia.run(scenario, "out", changes=changes, seed=7, jobs=1, progress=False)
    assert run["seed"] == 7
    assert run["grains.mass_g"] == pytest.approx(20.0, abs=1e-9)
    assert run.scenario["stages"][1]["falling_height_mm"] == 10


def test_all_faults_are_said_at_once(in_folder: Path) -> None:
    bad = layer()
    bad["engine"]["rate_hz"] = -1
    bad["gravitation"] = 9.81
    with pytest.raises(pluvia.ScenarioError) as caught:
        pluvia.run(bad, "out", progress=False)
    said = str(caught.value)
    assert "rate_hz" in said and "gravitation" in said and "the dict" in said
    assert ".pluvia-dict" not in said, "law: the file of a dict is not named"
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, pluvia.Error)
    assert list(in_folder.iterdir()) == []


@pytest.mark.parametrize("value", [float("nan"), object()])
def test_what_json_does_not_have_is_refused(in_folder: Path, value: object) -> None:
    with pytest.raises(pluvia.ScenarioError, match="cannot stand in a scenario"):
        pluvia.run({**layer(), "seed": value}, "out", progress=False)


def test_files_that_cannot_be_read_or_written(in_folder: Path) -> None:
    with pytest.raises(pluvia.FileError, match="nowhere.json"):
        pluvia.run("nowhere.json", "out", progress=False)
    Path("file").write_text("")
    with pytest.raises(pluvia.FileError, match="file"):
        pluvia.run(layer(), "file", progress=False)
    with pytest.raises(OSError, match="not the folder of a finished run"):
        pluvia.load("nowhere")
    with pytest.raises(pluvia.FileError, match="quick/pluviation"):
        pluvia.example("nothing")


@pytest.mark.parametrize("text", ["", "{", "[1]", "3"])
def test_a_damaged_folder_is_a_file_error_that_names_the_file(tmp_path: Path, text: str) -> None:
    opened = {"summary.json": pluvia.load, "sweep.json": pluvia.load_sweep, "calibrate.json": pluvia.load_calibration}
    for name, load in opened.items():
        (tmp_path / name).write_text(text)
        with pytest.raises(pluvia.FileError, match=name):
            load(tmp_path)
    (tmp_path / "summary.json").write_text("{}")
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(pluvia.FileError, match="manifest.json"):
        _ = pluvia.load(tmp_path).scenario
    for table in (b"", b"time_s\n\xff\n"):
        (tmp_path / "series.csv").write_bytes(table)
        with pytest.raises(pluvia.FileError, match="series.csv"):
            _ = pluvia.load(tmp_path).series


def test_another_scenario_is_kept_unless_forced(in_folder: Path) -> None:
    pluvia.run(layer(15.0), "out", progress=False)
    with pytest.raises(pluvia.Error, match="grains.total_mass_g"):
        pluvia.run(layer(16.0), "out", progress=False)
    assert pluvia.run(layer(16.0), "out", force=True, progress=False)["grains.mass_g"] == pytest.approx(16.0)


def test_errors_are_known_by_the_exit_code() -> None:
    from pluvia._errors import raised

    for code, kind in ((2, pluvia.ScenarioError), (3, pluvia.SimulationError), (4, pluvia.FileError), (130, KeyboardInterrupt)):
        error = raised(code, "pour: the last good state is kept in out/bad.json")
        assert type(error) is kind and "out/bad.json" in str(error)
    assert issubclass(pluvia.SimulationError, RuntimeError) and issubclass(pluvia.SimulationError, pluvia.Error)


def test_a_run_without_rest_test_is_warned_of(in_folder: Path) -> None:
    with pytest.warns(pluvia.NotValidWarning, match="not valid"):
        run = pluvia.run({**layer(15.0), "rest_test_s": 0}, "out", progress=False)
    assert not run.valid and "NOT VALID" in repr(run)


def test_progress_is_heard_on_the_calling_thread(in_folder: Path) -> None:
    heard: list[pluvia.Progress] = []
    threads = set()

    def hear(far: pluvia.Progress) -> None:
        heard.append(far)
        threads.add(threading.get_ident())

    pluvia.run(shaken(), "out", progress=hear)
    assert threads == {threading.get_ident()}
    assert all(0.0 <= far.done <= far.total + 1e-9 for far in heard)
    assert [far.done for far in heard] == sorted(far.done for far in heard)
    assert len({far.stage for far in heard}) > 1, "law: stages are named"


def test_a_bar_is_drawn(in_folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    pluvia.run(layer(15.0), "out")
    shown = capfd.readouterr()
    assert "s done" in shown.err and "%" in shown.err
    assert shown.out == "", "law: results are returned, not printed"


def test_other_threads_go_on_meanwhile(in_folder: Path) -> None:
    counted, end = [0], threading.Event()

    def count() -> None:
        while not end.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    try:
        pluvia.run(shaken(), "out", progress=False)
    finally:
        took = time.monotonic() - began
        end.set()
        thread.join()
    # With the GIL held it would stand still: a tenth of what an idle machine counts is far from that.
    assert counted[0] > 100 * took, f"{counted[0]} in {took:.2f} s"


def test_runs_side_by_side(in_folder: Path) -> None:
    found: dict[int, pluvia.Run] = {}

    def one(n: int) -> None:
        found[n] = pluvia.run(layer(15.0 + n), f"out-{n}", progress=False)

    threads = [threading.Thread(target=one, args=(n,)) for n in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[n]["grains.mass_g"] for n in range(3)] == pytest.approx([15.0, 16.0, 17.0])


def long() -> dict[str, object]:
    """A scenario that takes some ten seconds at least."""
    scenario = shaken()
    scenario["name"] = "long"
    scenario["stages"][3]["duration_s"] = 60
    return scenario


def test_an_exception_of_a_callback_stops_the_run_and_the_same_call_resumes(in_folder: Path) -> None:
    class Enough(Exception):
        pass

    def stop(far: pluvia.Progress) -> None:
        if "vibrate" in far.stage and far.done > 0:
            raise Enough

    with pytest.raises(Enough):
        pluvia.run(long(), "out", progress=stop)
    assert not Path("out/summary.json").exists()
    stored = set(p.name for p in Path("out/stages").iterdir() if p.is_dir())
    assert len(stored) >= 2, "law: finished stages are kept"
    began: list[str] = []

    def hear(far: pluvia.Progress) -> None:
        began.append(far.stage)
        stop(far)

    with pytest.raises(Enough):
        pluvia.run(long(), "out", progress=hear)
    assert not any("pour" in stage for stage in began), f"law: finished stages are not run again, got {began}"


def test_a_callback_that_raises_is_not_called_again_and_the_run_has_stopped_then(in_folder: Path) -> None:
    class Enough(Exception):
        pass

    calls: list[pluvia.Progress] = []

    def stop(far: pluvia.Progress) -> None:
        calls.append(far)
        raise Enough

    with pytest.raises(Enough):
        pluvia.run(long(), "out", progress=stop)
    assert len(calls) == 1
    # While a run is at work in a folder, another scenario is refused there, by force, too.
    assert pluvia.run(layer(15.0), "out", force=True, progress=False)["grains.mass_g"] == pytest.approx(15.0)


WAITED = """
import json, sys, pluvia
print("ready", flush=True)
try:
    pluvia.run("long.json", "out", progress=lambda far: print(far.stage, far.done, flush=True))
except KeyboardInterrupt:
    print("stopped", flush=True)
    sys.exit(9)
"""


def test_ctrl_c_stops_at_a_resumable_point(in_folder: Path) -> None:
    Path("long.json").write_text(json.dumps(long()))
    program = subprocess.Popen([sys.executable, "-c", WAITED], stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    for line in program.stdout:
        if "vibrate" in line:
            break
    program.send_signal(signal.SIGINT)
    rest, _ = program.communicate(timeout=60)
    assert program.returncode == 9 and "stopped" in rest
    assert not Path("out/summary.json").exists()
    stored = set(Path("out/stages").glob("*/stage.json"))
    assert len(stored) == 3, f"law: the stages before the vibration are kept, got {len(stored)}"
    # Shorter by a change that leaves the stages before as they are.
    pluvia.run("long.json", "out", changes={"stages.3.duration_s": 0.5}, force=True, progress=False)
    added = set(Path("out/stages").glob("*/stage.json")) - stored
    assert len(added) == 2, f"law: the vibration and the rest test alone are run, got {len(added)}"


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_process_is_told(in_folder: Path) -> None:
    pluvia.info()
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        said = ""
        try:
            pluvia.info()
        except RuntimeError as error:
            said = str(error)
        os.write(write, said.encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read) as end:
        said = end.read()
    os.waitpid(child, 0)
    assert "spawn" in said


def test_examples_come_with_the_package(in_folder: Path) -> None:
    assert {"quick/pluviation", "quick/vibration", "paper/pluviation"} <= set(pluvia.examples())
    scenario = {
        "extends": pluvia.example("quick/pluviation"),
        "name": "few",
        "grains": {"total_mass_g": 60},
    }
    run = pluvia.run(scenario, "out", changes={"rest_test_s": 0.2}, progress=False)
    assert run["grains.mass_g"] == pytest.approx(60.0)
    assert "$defs" in pluvia.schema() or "properties" in pluvia.schema()
