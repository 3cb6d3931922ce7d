"""The command line about terrains: elevation models, layers, meshes, cracks, analyses, samples."""
import json
import re
import struct
import subprocess
import zipfile

import pytest

from shell import SCENE, hoodoo

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
