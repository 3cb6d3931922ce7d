"""The command line, as a shell meets it. HOODOO is the program (ctest sets it)."""
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import struct
import subprocess
import time
import zipfile

import pytest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
HOODOO = os.environ.get("HOODOO", str(ROOT / "build/release/bin/hoodoo"))

SCENE = """version = 1
[params]
height = 3
[camera]
eye = [0, -10, "= height"]
target = [0, 0, 0]
[film]
width = 64
height = 36
[render]
spp = 4
[terrain.floor]
type = "plane"
material = "sand"
[light.sky]
type = "constant"
radiance = { grey = 0.5 }
"""

# A sanitizer maps terabytes of shadow memory, so a limit of the address space would only stop the sanitizer itself.
SANITIZED = os.environ.get("HOODOO_SANITIZED") == "1"


def hoodoo(*arguments, env=None, cwd=None, timeout=120, limit=None):
    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    return subprocess.run([HOODOO, *map(str, arguments)], capture_output=True, text=True, timeout=timeout, cwd=cwd,
                          env={**os.environ, **(env or {})}, preexec_fn=limits if limit and not SANITIZED else None)


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


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

    # The scene may follow the two numbers, whatever comes after it.
    assert hoodoo("render", "-r", 8, 6, scene, "-o", tmp_path / "b.png", "-q").returncode == 0


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


# -- Elevation models -----------------------------------------------------------------------------------------------------

def write_npz(path, name, rows):
    """A NumPy archive of one float32 array, without NumPy."""
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(rows)}, {len(rows[0])}), }}"
    header += " " * ((-11 - len(header)) % 64) + "\n"
    body = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode()
    body += b"".join(struct.pack("<f", x) for row in rows for x in row)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name + ".npy", body)


def test_import_dem_writes_a_height_image_that_a_scene_can_use(tmp_path):
    write_npz(tmp_path / "dem.npz", "elevation", [[100.0 + x + 2 * y for x in range(24)] for y in range(16)])
    result = hoodoo("import-dem", tmp_path / "dem.npz", "-o", tmp_path / "dem.exr", "--cell", "30 m")
    assert result.returncode == 0, result.stderr
    assert "24 x 16 heights of 30 m, from 100 to 153 m" in result.stderr   # 100 + 23 + 2 * 15 = 153
    assert hoodoo("import-dem", tmp_path / "dem.npz", "-o", tmp_path / "part.exr", "--cell", "0.03 km", "--subset", "0,8,4,16", "-q").stderr == ""
    (tmp_path / "dem.toml").write_text(SCENE.replace('type = "plane"\nmaterial = "sand"', 'type = "convolution"\n[[terrain.floor.layer]]\nshape = "image"\nfile = "dem.exr"\nmaterial = "bedrock"'))
    info = hoodoo("info", tmp_path / "dem.toml", "-D", "height=1000")
    assert info.returncode == 0, info.stderr
    assert json.loads(info.stdout)["terrain"]["floor"]["columns"] == 24 * 16


@pytest.mark.parametrize("arguments, code", [(["none.npz", "-o", "a.exr"], 3), (["dem.txt", "-o", "a.exr"], 3), (["dem.txt", "-o", "a.png"], 2), (["dem.txt"], 2),
                                             (["dem.txt", "-o", "a.exr", "--cell", "-1"], 2), (["dem.txt", "-o", "none/a.exr"], 3)])
def test_import_dem_refuses_what_it_cannot_use(tmp_path, arguments, code):
    (tmp_path / "dem.txt").write_text("no image")
    result = hoodoo("import-dem", *arguments, cwd=tmp_path)
    assert result.returncode == code, result.stderr
    assert not (tmp_path / "a.exr").exists()


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


# -- Baking ---------------------------------------------------------------------------------------------------------------

LAYERED = """version = 1
[camera]
eye = [8, -10, 12]
target = [8, 8, 4]
[light.sky]
type = "constant"
radiance = { grey = 1.0 }
[terrain.hill]
type = "convolution"
sigma_cells = 1.0
columns = [24, 16]
cell = 1.0
[[terrain.hill.layer]]
shape = "flat"
top = 6.0
[[terrain.hill.edit]]
tool = "sweep"
points = [[8, -2, 3], [8, 20, 3]]
radius = [1.5]
"""


def test_bake_read_bake_gives_equal_bytes_and_an_equal_scene(tmp_path):
    (tmp_path / "a.toml").write_text(LAYERED)
    head, grid = LAYERED.split("columns", 1)
    (tmp_path / "b.toml").write_text(head + 'stack = "a.exr"\n')
    assert hoodoo("bake", tmp_path / "a.toml", "-o", tmp_path / "a.exr", "-q").returncode == 0
    assert hoodoo("bake", tmp_path / "b.toml", "--terrain", "hill", "-o", tmp_path / "b.exr", "-q").returncode == 0
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    a, b = (json.loads(hoodoo("info", tmp_path / f"{name}.toml", "-q").stdout)["terrain"]["hill"] for name in "ab")
    assert a["layers"] == b["layers"] > 24 * 16 and a["patches"] == b["patches"]
    shown = subprocess.run(["oiiotool", "--info", "-v", tmp_path / "a.exr"], capture_output=True, text=True)
    assert shown.returncode == 0 and "24 x   16, 4 channel, deep" in shown.stdout and 'hoodoo:materials: "air", "water"' in shown.stdout


def test_bake_names_what_it_cannot_bake(tmp_path, scene):
    result = hoodoo("bake", scene, "-o", tmp_path / "a.exr")
    assert result.returncode == 2 and 'a terrain without layers cannot be baked, expected type = "convolution", got "plane"' in result.stderr
    result = hoodoo("bake", scene, "--terrain", "flor", "-o", tmp_path / "a.exr")
    assert result.returncode == 2 and 'there is no terrain "flor", expected one of floor (did you mean "floor")' in result.stderr, result.stderr
    assert hoodoo("bake", scene, "-o", tmp_path / "a.png").returncode == 2


# -- Meshes ---------------------------------------------------------------------------------------------------------------

def test_mesh_writes_a_terrain_that_another_scene_reads(tmp_path):
    (tmp_path / "a.toml").write_text(LAYERED + '[[terrain.hill.edit]]\ntool = "sweep"\npoints = [[16, 8, 12]]\nradius = [4.0]\n')
    result = hoodoo("mesh", tmp_path / "a.toml", "-o", tmp_path / "a.ply", "-q")
    assert result.returncode == 0, result.stderr
    report = json.loads(result.stdout)
    # A tunnel through a slab of 24 x 16 m: the top, and the tunnel's wall of about 2 pi 1.5 m x 16 m.
    assert report["spacing"] == 1.0 and 2 * 24 * 16 < report["triangles"] < 4 * 24 * 16 and report["unrefined"] == 0
    assert 0 < report["mean_error"] < 0.1 < report["maximum_error"] * 10
    assert report["without_material"] == 0
    head = (tmp_path / "a.ply").read_bytes().split(b"end_header\n")[0].decode()
    assert f"element vertex {report['vertices']}\n" in head and "property float material_bedrock\n" in head
    finer = json.loads(hoodoo("mesh", tmp_path / "a.toml", "-o", tmp_path / "fine.obj", "--spacing", "25 cm", "-q").stdout)
    assert finer["triangles"] > 10 * report["triangles"] and finer["mean_error"] < report["mean_error"] / 3
    (tmp_path / "b.toml").write_text(LAYERED.split("[terrain.hill]")[0] + '[terrain.hill]\ntype = "mesh"\nfile = "a.ply"\nmaterial = "bedrock"\n')
    assert hoodoo("check", tmp_path / "b.toml").returncode == 0
    again = hoodoo("mesh", tmp_path / "b.toml", "-o", tmp_path / "b.ply")
    assert again.returncode == 2 and "a terrain without a field has no mesh" in again.stderr
    assert not list(tmp_path.glob(".*"))


# -- Cracked ground -----------------------------------------------------------------------------------------------------------

CRACKED = SCENE.replace("""[terrain.floor]
type = "plane"
material = "sand"
""", """[terrain.mud]
type = "cracked"
zero = -1.0
one = 3.0
[[terrain.mud.ground]]
type = "plane"
extent = 8.0
""")


def test_the_pictures_behind_cracked_ground(tmp_path):
    path = tmp_path / "mud.toml"
    path.write_text(CRACKED)
    done = hoodoo("bake", path, "--crack-map", tmp_path / "m.exr", "--height", tmp_path / "h.exr", "--diagram", tmp_path / "d.svg", "--cell", "0.1 m")
    assert done.returncode == 0, done.stderr
    assert "160 x 160 pixels of 0.1 m" in done.stderr and "h = 0 at -1 m, h = 1 at 3 m" in done.stderr
    share = float(re.search(r"([\d.]+) % in cracks", done.stderr).group(1))
    assert 17.5 < share < 19.5
    assert (tmp_path / "d.svg").read_text().startswith("<svg")
    assert hoodoo("bake", path, "--diagram", tmp_path / "d.png", "-q").returncode == 0
    assert (tmp_path / "d.png").read_bytes().startswith(b"\x89PNG")


def test_a_terrain_without_cracks_has_no_crack_map(scene, tmp_path):
    done = hoodoo("bake", scene, "--crack-map", tmp_path / "m.exr")
    assert done.returncode == 2
    assert 'a terrain without cracks has no crack map, expected type = "cracked", got "plane"' in done.stderr
    assert not (tmp_path / "m.exr").exists()
    assert hoodoo("bake", scene).returncode == 2
    assert hoodoo("bake", scene, "-o", tmp_path / "a.exr", "--crack-map", tmp_path / "m.exr").returncode == 2


# -- Analyses -----------------------------------------------------------------------------------------------------------------

def test_analyse_measures_an_elevation_model(tmp_path):
    numpy = pytest.importorskip("numpy")
    y, x = numpy.mgrid[20:0:-1, 0:30]
    numpy.savez(tmp_path / "dem.npz", elevation=(5.0 * y + 0.0 * x))
    done = hoodoo("analyse", tmp_path / "dem.npz", "--cell", "5 m", "-o", tmp_path / "metrics.exr")
    assert done.returncode == 0, done.stderr
    assert "30 x 20 cells of 5 m" in done.stderr
    # A ramp of 45 degrees that faces south.
    assert re.search(r"slope +0.785398 to 0.785398", done.stderr)
    assert re.search(r"aspect +3.14159 to 3.14159", done.stderr)
    # The southern row drains a whole column: 20 cells of 25 m2.
    assert re.search(r"drainage +25 to 500", done.stderr)
    names = subprocess.run(["exrheader", str(tmp_path / "metrics.exr")], capture_output=True, text=True).stdout
    for name in ("slope", "aspect", "plan", "profile", "drainage", "wetness", "wetness_cover", "hoodoo:cell"):
        assert name in names


# -- Looking at a terrain -----------------------------------------------------------------------------------------------------

def test_samples_slices_contours_hillshade_and_mesh_errors(tmp_path):
    path = tmp_path / "mud.toml"
    path.write_text(CRACKED)
    for name in ("f.npy", "f.exr", "f.vdb"):
        done = hoodoo("sample", path, "--terrain", "mud", "--grid", "9,5,3", "--bounds", "-4,4,-2,2,-1,1", "-o", tmp_path / name)
        assert done.returncode == 0, done.stderr
        assert "9 x 5 x 3 values" in done.stderr and "step (1, 1, 1) m" in done.stderr
    numpy = pytest.importorskip("numpy")
    values = numpy.load(tmp_path / "f.npy")
    assert values.shape == (9, 5, 3)
    assert (values[:, :, 0] < 0).all() and (values[:, :, 2] > 0).all()
    # What was written is read back as a terrain.
    vdb = tmp_path / "vdb.toml"
    vdb.write_text(CRACKED[:CRACKED.index("[terrain.mud]")] + '[terrain.v]\ntype = "voxels"\nfile = "f.vdb"\nvalues = "distance"\n' + CRACKED[CRACKED.index("[light.sky]"):])
    again = hoodoo("check", vdb)
    assert again.returncode == 0, again.stderr

    assert hoodoo("slice", path, "--from", "-4,0.1", "--to", "4,0.1", "-o", tmp_path / "s.svg").returncode == 0
    assert (tmp_path / "s.svg").read_text().count("<rect") > 10
    assert hoodoo("hillshade", path, "--cell", "0.1", "-o", tmp_path / "h.png").returncode == 0
    assert (tmp_path / "h.png").read_bytes().startswith(b"\x89PNG")
    done = hoodoo("contours", path, "--cell", "0.1", "--interval", "0.1 m", "-o", tmp_path / "c.png")
    assert done.returncode == 0 and "contours every 0.1 m of 160 x 160 heights" in done.stderr

    flat = tmp_path / "flat.obj"
    flat.write_text("v -1 -1 0.25\nv 1 -1 0.25\nv 1 1 0.25\nf 1 2 3\n")
    floor = tmp_path / "floor.toml"
    floor.write_text(SCENE)
    done = hoodoo("mesh-error", floor, flat, "-q")
    error = json.loads(done.stdout)
    # The diagonal is 2.83 m, a fiftieth of it does not reach the floor a quarter below.
    assert error["far_triangles"] == 1 and error["triangles"] == 1
    error = json.loads(hoodoo("mesh-error", floor, flat, "-q", "--reach", "1").stdout)
    assert error["mean_error"] == pytest.approx(0.25) and error["maximum_error"] == pytest.approx(0.25) and error["area"] == pytest.approx(2.0)


def test_what_cannot_be_looked_at_is_said(tmp_path):
    path = tmp_path / "mud.toml"
    path.write_text(CRACKED)
    for arguments, words in [(("slice", path, "--from", "1,1", "--to", "1,1", "-o", tmp_path / "s.png"), "the section has no length"),
                             (("sample", path, "--grid", "2,2,2", "-o", tmp_path / "f.txt"), "the ending of a grid's file, expected .npy, .exr or .vdb"),
                             (("hillshade", path, "--bounds", "100,101,100,101", "-o", tmp_path / "h.png"), "nothing of the terrain lies in the area"),
                             (("contours", path, "--interval", "1e-7", "--cell", "0.5", "-o", tmp_path / "c.svg"), "--interval makes too many contours"),
                             (("sample", path, "--terrain", "mut", "--grid", "2,2,2", "-o", tmp_path / "f.npy"), 'did you mean "mud"')]:
        done = hoodoo(*arguments)
        assert done.returncode in (2, 3) and words in done.stderr, (arguments, done.stderr)
