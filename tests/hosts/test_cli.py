"""The command line: what it refuses, exit codes, options, signals."""
import json
import re
import shutil
import signal
import subprocess
import time

import pytest

from shell import HERE, HOODOO, ROOT, SANITIZED, SCENE, hoodoo

# -- Hostile scenes -------------------------------------------------------------------------------------------------------

HOSTILE = sorted((HERE / "hostile").glob("*.toml"))


def test_there_are_at_least_twelve_hostile_scenes():
    assert len(HOSTILE) >= 12


@pytest.mark.parametrize("path", HOSTILE, ids=lambda p: p.stem)
def test_a_hostile_scene_is_refused_with_a_position(path):
    started = time.monotonic()
    result = hoodoo("check", path, limit=1 << 30)
    assert result.returncode == (3 if path.stem == "missing_include" else 2), result.stderr
    assert re.match(rf"{re.escape(str(path))}:\d+:\d+: ", result.stderr), result.stderr
    assert result.stdout == ""
    assert len(result.stderr) < 100_000
    assert time.monotonic() - started < 60   # a watchdog: a second is normal


@pytest.mark.parametrize("text", ["a = 1\n" * 200_000, "x = [" + "1," * 400_000 + "]\n", "".join(f"k{i} = 1\n" for i in range(120_000)),
                                  "".join(f"[terrain.t{i}]\n" for i in range(60_000)), "[params]\n" + "".join(f"p{i} = '= 1 +'\n" for i in range(40_000))],
                         ids=["same_key", "long_list", "many_keys", "many_tables", "many_expressions"])
def test_a_scene_with_very_many_values_is_refused(tmp_path, text):
    path = tmp_path / "many.toml"
    path.write_text(text)
    result = hoodoo("check", path, limit=1 << 30)
    assert result.returncode == 2, result.stderr[:300]


def test_a_scene_over_64_megabytes_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "long.toml"
    with open(path, "wb") as file:
        file.truncate(70 << 20)
    result = hoodoo("check", path, limit=1 << 30)
    assert result.returncode == 2 and "too long" in result.stderr


@pytest.mark.skipif(SANITIZED, reason="the sanitizer reads /proc itself")
def test_no_file_outside_the_roots_is_opened(tmp_path):
    if subprocess.run(["which", "strace"], capture_output=True).returncode:
        pytest.skip("strace is not installed")
    log = tmp_path / "log"
    subprocess.run(["strace", "-f", "-e", "trace=openat,open,execve", "-o", log, HOODOO, "check", HERE / "hostile/foreign_path.toml"], capture_output=True, timeout=120)
    calls = [line for line in log.read_text().splitlines() if "passwd" in line or "environ" in line or "shadow" in line]
    assert calls == []


# -- Errors and exit codes ------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("arguments", [[], ["rendre"], ["render"], ["render", "x.toml", "--bad"], ["render", "x.toml", "-o", "a.jpg"], ["render", "x.toml"],
                                       ["render", "x.toml", "-o", "a.exr", "--spp", "0"], ["render", "x.toml", "-o", "a.exr", "-t", "-1"],
                                       ["render", "x.toml", "-o", "a.exr", "--crop-window", "0.5,0.2,0,1"], ["render", "x.toml", "-o", "a.exr", "--crop-window", "0,1,0"],
                                       ["render", "x.toml", "-o", "a.exr", "--pixel-bounds", "0,0,0,1"], ["render", "x.toml", "-o", "a.exr", "-D", "novalue"],
                                       ["render", "x.toml", "-o", "a.exr", "-r", "0", "10"], ["render", "x.toml", "-o", "a.exr", "--seed", "-3"]],
                         ids=lambda a: " ".join(a) or "nothing")
def test_wrong_arguments_are_exit_2(arguments):
    result = hoodoo(*arguments)
    assert result.returncode == 2, result.stderr
    assert result.stderr and result.stdout == ""


def test_help_and_version_are_exit_0():
    for arguments in (["--help"], ["render", "--help"], ["version"], ["--version"]):
        result = hoodoo(*arguments)
        assert result.returncode == 0 and result.stdout, arguments
    assert re.match(r"hoodoo \d+\.\d+\.\d+\n", hoodoo("version").stdout)


def test_an_unknown_instruction_set_is_exit_2():
    result = hoodoo("version", env={"HOODOO_ISA": "avx1024"})
    assert result.returncode == 2 and "HOODOO_ISA" in result.stderr


def test_an_absent_scene_is_exit_3(tmp_path):
    result = hoodoo("check", tmp_path / "none.toml")
    assert result.returncode == 3 and "none.toml" in result.stderr


@pytest.mark.parametrize("output", ["missing/a.exr", "folder.exr"])
def test_a_place_that_cannot_be_written_is_exit_3_before_the_work(scene, tmp_path, output):
    (tmp_path / "folder.exr").mkdir()
    result = hoodoo("render", scene, "-o", tmp_path / output)
    assert result.returncode == 3 and "cannot write" in result.stderr
    assert "tracing" not in result.stderr


@pytest.mark.skipif(SANITIZED, reason="needs a limit of the address space")
def test_a_picture_that_does_not_fit_into_memory_is_exit_4(scene, tmp_path):
    result = hoodoo("render", scene, "-o", tmp_path / "a.exr", "-r", 16384, 16384, limit=1 << 30)
    assert result.returncode == 4, result.stderr
    assert "memory" in result.stderr and not (tmp_path / "a.exr").exists()


def test_a_picture_over_the_limits_is_exit_2(scene, tmp_path):
    result = hoodoo("render", scene, "-o", tmp_path / "a.exr", "-r", 65536, 65536)
    assert result.returncode == 2 and "429 GB" in result.stderr


def test_all_errors_of_a_scene_come_at_once_with_their_places(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(SCENE.replace("width", "widht").replace('"plane"', '"plain"').replace("= height", "= heigth"))
    result = hoodoo("check", path)
    assert result.returncode == 2
    for part in (":5:19: unknown name in the expression", ':8:1: unknown key "widht" in film (did you mean "width")', ":13:8: type has an unknown value"):
        assert f"{path}{part}" in result.stderr, result.stderr
    assert '    eye = [0, -10, "= heigth"]\n                      ^\n' in result.stderr


# -- Commands -------------------------------------------------------------------------------------------------------------

def test_render_writes_each_output(scene, tmp_path):
    result = hoodoo("render", scene, "-o", tmp_path / "a.exr", "-o", tmp_path / "a.png", "-t", 1)
    assert result.returncode == 0, result.stderr
    assert result.stdout == ""
    assert (tmp_path / "a.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"
    assert (tmp_path / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.exr", "a.png", "scene.toml"], "nothing else is left behind"


def test_quiet_says_nothing_and_plain_progress_has_no_control_codes(scene, tmp_path):
    assert hoodoo("render", scene, "-o", tmp_path / "a.exr", "--quiet").stderr == ""
    loud = hoodoo("render", scene, "-o", tmp_path / "a.exr").stderr
    assert "100%" in loud and "\r" not in loud and "\x1b" not in loud


def test_quick_is_a_quarter_and_resolution_wins_over_the_scene(scene, tmp_path):
    def size(*arguments):
        assert hoodoo("render", scene, "-o", tmp_path / "a.png", "-q", *arguments).returncode == 0
        header = (tmp_path / "a.png").read_bytes()
        return int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")

    assert size() == (64, 36)
    assert size("--quick") == (16, 9)
    assert size("-r", 40, 20) == (40, 20)
    assert size("--set", "film.width=20") == (20, 36)

    # The scene may follow an option of several numbers, whatever comes after it.
    for numbers in (["-r", 8, 6], ["--pixel-bounds", "0,8,0,8"], ["--crop-window", "0,0.5,0,0.5"], ["--pixel-bounds", 0, 8, 0, 8]):
        assert hoodoo("render", *numbers, scene, "-o", tmp_path / "b.png", "-q").returncode == 0, numbers


def test_parameters_and_sets_reach_the_scene(scene):
    def digest(*arguments):
        return json.loads(hoodoo("info", scene, *arguments).stdout)["scene_hash"]

    base = digest()
    assert digest("-D", "height=3") == base
    assert digest("-D", "height=4") != base
    assert digest("-Dheight=4") == digest("--set", "camera.eye=[0, -10, 4]") == digest("--define=height=4")
    assert digest("--seed", 1) == base   # it chooses samples, not hills
    result = hoodoo("check", scene, "-D", "heigth=4")
    assert result.returncode == 2 and 'did you mean "height"' in result.stderr


def test_info_is_json_on_stdout(scene):
    result = hoodoo("info", scene)
    assert result.returncode == 0
    floor = json.loads(result.stdout)["terrain"]["floor"]
    assert {"columns", "layers", "stack_bytes", "trace_bytes", "patches", "build_seconds"} <= floor.keys()


def test_dry_run_estimates_and_writes_nothing(scene, tmp_path):
    result = hoodoo("render", scene, "-o", tmp_path / "a.exr", "--dry-run")
    assert result.returncode == 0, result.stderr
    assert "64 x 36 pixels, 4 samples" in result.stdout
    assert [p.name for p in tmp_path.iterdir()] == ["scene.toml"]


def test_files_are_read_from_declared_roots_only(scene, tmp_path):
    config = tmp_path / "data" / "config.ocio"
    config.parent.mkdir()
    config.write_bytes((ROOT / "renderer/film/config.ocio").read_bytes())
    inner = tmp_path / "scenes" / "scene.toml"
    inner.parent.mkdir()
    inner.write_text(SCENE.replace("[film]\n", '[film]\ncolorconfig = "../data/config.ocio"\n'))
    refused = hoodoo("check", inner)
    assert refused.returncode == 2 and "lies outside the folders" in refused.stderr
    allowed = hoodoo("check", inner, "--allow-read", config.parent)
    assert allowed.returncode == 0, allowed.stderr


# -- Old processors -------------------------------------------------------------------------------------------------------

def test_the_processor_is_checked_before_any_library_runs_and_by_code_that_every_processor_has():
    assert "PREINIT_ARRAY" in subprocess.run(["readelf", "-d", HOODOO], capture_output=True, text=True, check=True).stdout
    listing = subprocess.run(["objdump", "-d", "--no-show-raw-insn", "-C", HOODOO], capture_output=True, text=True, check=True).stdout
    body = re.search(r"<[^>]*check_processor\([^\n]*>:\n(.*?)\n\n", listing, re.S).group(1)
    assert "_exit" in body
    assert not re.search(r"\t(v\w+|andn|bextr|blsi|blsr|shlx|shrx|sarx|rorx|mulx|pdep|pext)\s", body), body


@pytest.mark.skipif(shutil.which("qemu-x86_64") is None, reason="qemu-user is not installed")
def test_a_processor_without_the_baseline_gets_a_sentence():
    result = subprocess.run(["qemu-x86_64", "-cpu", "Nehalem", HOODOO, "version"], capture_output=True, text=True, timeout=300)
    assert result.returncode == 1 and "this processor lacks instructions" in result.stderr


# -- Signals --------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_stops_the_work_and_leaves_the_old_picture(scene, tmp_path, number, code):
    target = tmp_path / "a.exr"
    target.write_bytes(b"the old picture")
    with subprocess.Popen([HOODOO, "render", scene, "-o", target, "--spp", "1000000", "-t", "1"], stderr=subprocess.PIPE, text=True) as process:
        time.sleep(2.0)
        process.send_signal(number)
        try:
            _, log = process.communicate(timeout=60)
        finally:
            process.kill()
    assert process.returncode == code, log
    assert target.read_bytes() == b"the old picture"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.exr", "scene.toml"]


def test_a_signal_while_the_scene_is_built_stops_at_once(scene, tmp_path):
    process = subprocess.Popen([HOODOO, "render", scene, "-o", tmp_path / "a.exr", "--spp", "1000000"], stderr=subprocess.DEVNULL)
    time.sleep(0.15)
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=60) in (143, -signal.SIGTERM)   # -15: before main
    assert not (tmp_path / "a.exr").exists()
